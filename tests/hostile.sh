#!/bin/bash
# hostile.sh: masu-bake over every file of Debian's assimp-testmodels, broken ones included. Each must
# end within 30 seconds and 2 GiB with a blob that the runtime's reader accepts (masu-bake asks it), or
# with exit code 1 and one line that says why. With RENDER=1 each blob is drawn too, 64x64, on each of $DRIVERS (system;
# drivers.sh has others).
#
#   hostile.sh [FOLDER]     prints a table of outcomes; exit code 1 if any is another
set -u
cd "$(dirname "$0")/.." || exit 1
bake=$(realpath "${BUILD:-build}/bin/masu-bake")
masu=$(realpath "${BUILD:-build}/bin/masu")
cache=$(realpath -m "${BUILD:-build}/cache")
models=${1:-/usr/share/assimp/models}
if [ ! -d "$models" ]; then
    echo "hostile: $models is missing (package assimp-testmodels): skipped"
    exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
config_sanitize=; [ "${config:-}" != sanitize ] || config_sanitize=1 # there Assimp's own stderr is shown
drivers=${RENDER:+${DRIVERS:-system}}
[ "$drivers" != all ] || drivers="system lavapipe-25 swiftshader"
for driver in $drivers; do tests/drivers.sh "$driver" > /dev/null || exit 1; done
declare -A count=()
bad=0 slowest=0 slowest_file=- largest=0 largest_file=-

note() { count[$1]=$((${count[$1]:-0} + 1)); }
wrong() {
    note "WRONG: $1"
    echo "WRONG: $file: $1: $(head -c 300 "$folder/stderr")"
    bad=$((bad + 1))
}

# draw DRIVER: the blob, on it; its words go to $folder/render
draw() (
    icd=$(tests/drivers.sh "$1")
    [ -z "$icd" ] || export VK_ICD_FILENAMES=$icd VK_DRIVER_FILES=$icd
    export NODEVICE_SELECT=1
    # shellcheck disable=SC1090
    [ ! -e "build/drivers/$1/env" ] || . "build/drivers/$1/env"
    # As in run.sh: other widths of vectors have other code.
    export MESA_SHADER_CACHE_DIR=$cache/$1${LP_NATIVE_VECTOR_WIDTH:+-$LP_NATIVE_VECTOR_WIDTH}
    mkdir -p "$MESA_SHADER_CACHE_DIR"
    exec timeout 180 "$masu" render "$folder/x.masu" --frame -o "$folder/x.png" --size 64x64 --quiet \
        > "$folder/stdout" 2> "$folder/render"
)

# drawn: if one of them fails, exit 1 with $driver and the exit code in $code (124: not within 180 s) set
drawn() {
    for driver in $drivers; do
        draw "$driver"
        code=$?
        [ $code = 0 ] || return 1
    done
}

while read -r file; do
    rm -f "$folder/x.masu" "$folder/x.json"
    start=$(date +%s%N)
    (
        # address space of the sanitizer's shadow is no memory
        [ "$config_sanitize" ] || ulimit -v 2097152
        exec timeout 30 "$bake" "$file" -o "$folder/x.masu" --stats "$folder/x.json" --quiet
    ) > "$folder/stdout" 2> "$folder/stderr" < /dev/null
    code=$?
    took=$((($(date +%s%N) - start) / 1000000))
    if [ $took -gt $slowest ]; then slowest=$took slowest_file=$file; fi
    if [ $code = 0 ]; then
        peak=$(sed -n 's/.*"peak_bytes": \([0-9]*\).*/\1/p' "$folder/x.json")
        if [ "$peak" -gt $largest ]; then largest=$peak largest_file=$file; fi
        if [ ! -s "$folder/x.masu" ]; then
            wrong "no output"
        elif ! drawn; then
            wrong "does not render on $driver, exit code $code: $(head -c 200 "$folder/render")"
        elif grep -q 'warning:' "$folder/stderr"; then
            note "blob, with warnings"
        else
            note "blob"
        fi
    elif [ $code = 1 ]; then
        lines=$(grep -vc 'warning: ' "$folder/stderr")
        case $(cat "$folder/stderr") in
        *"importer crashed"*) note "error: the importing library crashed in its child" ;;
        *"importer took"*) note "error: the importing library took too long" ;;
        *"no triangles"*) note "error: no triangles" ;;
        *) note "error: the library refuses the file" ;;
        esac
        [ "$config_sanitize" ] || [ "$lines" = 1 ] || wrong "$lines lines"
    elif [ $code = 124 ]; then
        wrong "hangs"
    else
        wrong "exit code $code"
    fi
    ! grep -q -e Sanitizer -e 'runtime error' "$folder/stderr" || wrong "sanitizer"
done < <(find "$models" -type f ! -size +64M | sort)

for outcome in "${!count[@]}"; do printf '%5d  %s\n' "${count[$outcome]}" "$outcome"; done | sort -rn
echo "slowest: $slowest ms, ${slowest_file#"$models"/}"
echo "largest of those with a blob: $((largest >> 20)) MiB, ${largest_file#"$models"/}"
[ $bad = 0 ]
