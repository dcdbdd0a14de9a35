#!/bin/bash
# masu-lab world, and masu-bake with its output: the city is the same every time and has the expected size, and
# errors are one line. forza is only tested if its data is installed.
set -u
cd "$(dirname "$0")/../../.." || exit 1
lab=$(realpath "${BUILD:-build}/bin/masu-lab")
bin=$(realpath "${MADE:-build}/bin")
bake=$bin/masu-bake
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}
number() { sed -n "s/.*\"$2\": \([0-9]*\).*/\1/p" "$1" | head -1; }
count_of() { sed -n "/\"$2\": {/,/}/s/.*\"count\": \([0-9]*\).*/\1/p" "$1" | head -1; }
between() { [ "$2" -ge "$3" ] && [ "$2" -le "$4" ] || fail "$1 is $2, not $3 to $4"; }

# ---- the city ------------------------------------------------------------------------------------

"$lab" world city "$folder/a" || fail "masu-lab world city"
"$lab" world city "$folder/b" || fail "masu-lab world city, again"
diff -r "$folder/a" "$folder/b" > /dev/null || fail "the city differs from itself"
grep -q ': nan\|inf' "$folder/a/city.json" && fail "a number of the city is none"
keys=$(grep -c '"time"' "$folder/a/city.json")
[ "$keys" = 605 ] || fail "$keys camera keys"
frame() { sed -n "s/.*\"time\": $1, \"position\": \[\([^]]*\)\].*/\1/p" "$folder/a/city.json"; }
[ "$(frame 0.0000)" != "$(frame 10.0000)" ] || fail "the camera stands still"

# city_night is the same city at night, lit by its lamps and by the windows of some facades.
for member in '"models"' '"ambient_occlusion": {' '"lambda"'; do
    for name in city city_night; do
        grep -q -e "$member" "$folder/a/$name.json" || fail "$name.json has no $member"
    done
done
parts() { grep -o '"file": "[^"]*", "group": "[^"]*", "translate": [^]]*' "$folder/a/$1.json"; }
[ "$(parts city)" = "$(parts city_night)" ] || fail "the city by night has other parts than by day"
between "lamps of the night" "$(grep -c '"type": "point"' "$folder/a/city_night.json")" 200 1024
between "lit facades" "$(grep -c '"match": "glass", "emissive"' "$folder/a/city_night.json")" 300 700
grep -q '"type": "point"\|"emissive"' "$folder/a/city.json" && fail "a lamp is lit by day"

# Baked without light probes, which take half a minute, and without LODs of its meshes, which take ten seconds and have
# their own tests.
grep -q '"probes": {' "$folder/a/city.json" || fail "the city has no probes"
sed -i '/"probes": {/d' "$folder/a/city.json" "$folder/b/city.json"
sed 's/"lods": 3/"lods": 0/' "$folder/a/city.json" > "$folder/a/plain.json"
"$bake" "$folder/a/plain.json" -o "$folder/city.masu" --stats "$folder/city.stats" --quiet \
    2> "$folder/stderr" || fail "the city does not bake: $(cat "$folder/stderr")"
[ ! -s "$folder/stderr" ] || fail "the city bakes with: $(cat "$folder/stderr")"
between "objects" "$(count_of "$folder/city.stats" instances)" 3000 8000
between "drawn triangles" "$(number "$folder/city.stats" drawn_triangles)" 2500000 4000000
between "stored triangles" "$(number "$folder/city.stats" triangles)" 10000 60000
between "meshes" "$(count_of "$folder/city.stats" meshes)" 20 60 # one per part and colour
between "occluders" "$(count_of "$folder/city.stats" occluders)" 8 60
if [ -n "${LONG:-}" ]; then # ten seconds
    "$bake" "$folder/b/city.json" -o "$folder/b.masu" --stats "$folder/b.stats" --quiet ||
        fail "the city does not bake with LODs"
    between "LODs" "$(count_of "$folder/b.stats" lods)" 30 120
    between "peak bytes of the baker" "$(number "$folder/b.stats" peak_bytes)" 1 200000000
fi

# ---- errors --------------------------------------------------------------------------------------

# refuses CODE PATTERN COMMAND...: checks for one line on stderr
refuses() {
    local wanted=$1 pattern=$2 code
    shift 2
    "$@" > /dev/null 2> "$folder/stderr"
    code=$?
    [ $code = "$wanted" ] || fail "$*: exit code $code: $(cat "$folder/stderr")"
    [ "$(wc -l < "$folder/stderr")" = 1 ] || fail "$*: not one line: $(cat "$folder/stderr")"
    grep -q -e "$pattern" "$folder/stderr" || fail "\"$pattern\" is not in: $(cat "$folder/stderr")"
}
refuses 2 'no folder given' "$lab" world city
refuses 1 'cannot make the folder' "$lab" world city /dev/null/x
refuses 1 'cannot read .*forza.xml: No such file' "$lab" world forza "$folder/f" --torcs "$folder"
mkdir -p "$folder/torcs/tracks/road/forza"
xml=$folder/torcs/tracks/road/forza/forza.xml
echo '<params/>' > "$xml"
refuses 1 'no track segments' "$lab" world forza "$folder/f" --torcs "$folder/torcs"
{
    echo '<section name="Track Segments">'
    for i in 1 2 3 4 5; do
        echo "<section name=\"$i\"><attstr name=\"type\" val=\"str\"/><attnum name=\"lg\" val=\"200\"/>"
    done
} > "$xml"
refuses 1 'does not close' "$lab" world forza "$folder/f" --torcs "$folder/torcs"

# ---- forza ---------------------------------------------------------------------------------------

torcs=/usr/share/games/torcs
if [ -d $torcs/tracks/road/forza ] && [ -d $torcs/cars/p406 ]; then
    "$lab" world forza "$folder/forza" > "$folder/stdout" 2> /dev/null || fail "masu-lab world forza"
    grep -q 'a lap of 57[0-9][0-9] m' "$folder/stdout" || fail "the lap: $(cat "$folder/stdout")"
    # Lamps are outside the barriers along the whole lap, only at night; a plain is below the lowest ground.
    between "forza's lamps" "$(grep -c '"intensity": 400' "$folder/forza/forza_night.json")" 120 180
    between "their poles" "$(grep -c '\[0.16, 10, 0.16\]' "$folder/forza/forza_night.json")" 120 180
    grep -q '"intensity": 400' "$folder/forza/forza.json" && fail "a lamp of forza is lit by day"
    for name in forza forza_night; do
        grep -q '"name": "plain"' "$folder/forza/$name.json" || fail "$name.json has no plain"
    done
    # Ten cars on four wheels each: a wheel's scale is its diameter, its centre is half of that above
    # the road, and the road a hand's breadth below the body's origin; two wheels are rotated.
    awk -F'[][,]+' '
        /cars\/[^"]*\.acc/ { cars++; body = $10 }
        /wheels\/[^"]*\.acc/ {
            wheels++
            if ($5 < 0 && $7 < 0) turned++
            road = $14 - $6 / 2
            if (!($6 > 0.5 && $6 < 0.8 && road > body - 0.3 && road < body + 0.1)) print
        }
        END { if (cars != 10 || wheels != 40 || turned != 20) print cars, wheels, turned }
    ' "$folder/forza/forza.json" > "$folder/wheels"
    [ ! -s "$folder/wheels" ] || fail "wheels: $(cat "$folder/wheels")"
    # The road in numbers: rows of twelve, unit normals, barriers beyond the edges; the cars are on it.
    awk '
        NR == 2 { points = $2 }
        NF == 12 && $1 != "car" {
            rows++
            if ($4 * $4 + $5 * $5 + $6 * $6 < 0.999 || $5 < 0.9 || $9 < $7 || $10 < $8 || $11 < -5 || $11 > 5) print
        }
        $1 == "car" { cars++ }
        $1 == "wheel" { wheels++; if ($5 < 0.25 || $5 > 0.4) print }
        END { if (rows != points || points < 1400 || cars != 10 || wheels != 40) print rows, points, cars, wheels }
    ' "$folder/forza/forza.track" > "$folder/road"
    [ ! -s "$folder/road" ] || fail "forza.track: $(head -3 "$folder/road")"
    for relief in asphalt grass gravel; do
        "$bin/masu-meso" --make $relief -o "$folder/forza/$relief" --size 32 --rays 24 \
            --sky-rays 4 > /dev/null || fail "masu-meso --make $relief"
    done
    sed 's/"lods": 3/"lods": 0/' "$folder/forza/forza.json" > "$folder/forza/plain.json"
    "$bake" "$folder/forza/plain.json" -o "$folder/forza.masu" --stats "$folder/forza.stats" --quiet \
        2> /dev/null || fail "forza does not bake"
    between "forza's triangles" "$(number "$folder/forza.stats" triangles)" 90000 130000
    between "forza's meshes" "$(count_of "$folder/forza.stats" meshes)" 200 2500
fi

[ $failures = 0 ] && echo "masu-lab world: all as expected"
[ $failures = 0 ]
