#!/bin/bash
# masu-lab simulate: the table, the CSV's columns, plots if gnuplot is installed, and errors.
set -u
lab=${BUILD:-build}/bin/masu-lab
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failed=0

fail() {
    echo "$1"
    failed=1
}

# refuses CODE TEXT ARGUMENTS...: checks the exit code, and that a line contains TEXT
refuses() {
    local out code
    out=$("$lab" simulate "${@:3}" 2>&1 > /dev/null)
    code=$?
    [ "$code" = "$1" ] && [[ $out == *"$2"* ]] || fail "simulate ${*:3}: exit code $code, $out"
}

"$lab" simulate --quiet --seeds 2 --csv "$folder/all.csv" lab/simulate/traces/city.csv || fail 'simulate fails'
[ "$(head -1 "$folder/all.csv" | cut -d, -f1-7)" = \
    model,controller,frames,over_budget,changes,mean_scale,settle_frames ] || fail 'the CSV has other columns'
for name in standard constant step_4x lies_lavapipe city; do
    for controller in masu three_state filament unreal; do
        grep -q "^$name,$controller,[0-9]*,[0-9.]*,[0-9.]*,0\.[4-9][0-9]*\|^$name,$controller,[0-9]*,[0-9.]*,[0-9.]*,1\." \
            "$folder/all.csv" || fail "the CSV has no row of $name, $controller"
    done
done
# All controllers use only rungs of the ladder, on every model.
awk -F, 'NR > 1 && $NF != 0 { print; bad = 1 } END { exit bad }' "$folder/all.csv" || fail 'invalid scales'

[ "$("$lab" simulate --model constant --controller masu --seeds 1 | wc -l)" = 4 ] || fail 'the table is not four lines'

if command -v gnuplot > /dev/null; then
    "$lab" simulate --quiet --seeds 1 --model constant --plots "$folder/plots" || fail 'plots fail'
    grep -q '</svg>' "$folder/plots/constant.svg" || fail 'there is no whole constant.svg'
    # A name is only a title, whatever it contains.
    trace="$folder/it's \`touch STRUCK\`.csv"
    head -40 lab/simulate/traces/city.csv > "$trace"
    "$lab" simulate --quiet --seeds 1 --model "it's \`touch STRUCK\`" --controller masu \
        --plots "$folder/plots" "$trace" || fail 'a name with quotes is refused'
    [ ! -e "$folder/plots/STRUCK" ] && [ ! -e STRUCK ] || { rm -f STRUCK; fail 'a name was run'; }
    grep -q '</svg>' "$folder/plots/it's \`touch STRUCK\`.svg" || fail 'there is no plot of a name with quotes'
fi

refuses 2 "there is no model 'no'" --model no
refuses 2 --controller --controller no
refuses 2 --seeds --seeds 0
refuses 1 "$folder/missing.csv" "$folder/missing.csv"
printf 'frame,1,0.5\n0,10,nan\n' > "$folder/bad.csv"
refuses 1 "$folder/bad.csv" "$folder/bad.csv"
refuses 1 "$folder/no/folder.csv" --csv "$folder/no/folder.csv"
refuses 2 'needs the file' --record scene.masu
exit $failed
