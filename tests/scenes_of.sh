#!/bin/sh
# scenes_of.sh [FOLDER]: prints `KIND/TEST:SCENE,SCENE` for each test program and script below tests/, or lab/tests/,
# that names baked scenes, for make: only these are baked before the test runs. KIND is unit, gpu or scripts. A scene is
# named as "NAME" or NAME.masu, or by a suite that the test runs (--suite suites/NAME.json). A test that reads
# `scenes/*.masu` needs all of them: `*`.
set -eu
names=$(find scenes tests/scenes -maxdepth 1 -name '*.json' | sed 's|.*/||; s|\.json$||')
in=${1:-tests}
find "$in/unit" "$in/gpu" "$in/scripts" -name '*.c' -o -name '*.sh' | sort | xargs awk -v names="$names" '
function finish(    text, n) {
    if (file == "") return
    text = all ? ",*" : ""
    if (!all) for (n in found) text = text "," n
    sub(/\.(c|sh)$/, "", file)
    n = split(file, part, "/")
    if (text != "") print part[n - 1] "/" part[n] ":" substr(text, 2)
}
BEGIN { n = split(names, list, /[ \n]+/); for (i = 1; i <= n; i++) scene[list[i]] = 1 }
FNR == 1 { finish(); file = FILENAME; all = 0; split("", found) }
/scenes"?\/\*\.masu/ { all = 1 }
match($0, /--suite suites\/[a-z0-9_]+\.json/) && !/--list/ {
    suite = substr($0, RSTART + 8, RLENGTH - 8)
    while ((getline line < suite) > 0)
        if (match(line, /"scene": *"[^"]*"/)) {
            split(substr(line, RSTART, RLENGTH), quoted, "\"")
            if (quoted[4] in scene) found[quoted[4]] = 1
        }
    close(suite)
}
{
    line = $0
    while (match(line, /["\/{,][a-z0-9_]+(["},]|\\"[^:]|\.masu)/)) { # \"NAME\": is a member of JSON
        word = substr(line, RSTART + 1)
        sub(/[^a-z0-9_].*/, "", word)
        if (word in scene) found[word] = 1
        line = substr(line, RSTART + 1)
    }
}
END { finish() }'
