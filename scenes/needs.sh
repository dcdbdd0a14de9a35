#!/bin/sh
# needs.sh FOLDER...: prints `FOLDER/NAME.json:FILE,FILE` for each scene description: the files of these folders that it
# names, directly or through a file that it names (an .obj names its .mtl). make bakes a scene again when one of them
# changes.
set -eu
find "$@" -maxdepth 1 -type f | sort | awk '
{ path[NR] = $0; name[NR] = $0; sub(/.*\//, "", name[NR]) }
END {
    for (i = 1; i <= NR; i++) {
        while ((getline line < path[i]) > 0)
            while (match(line, /[A-Za-z0-9_.-]+\.[a-z0-9]+/)) {
                named[i, substr(line, RSTART, RLENGTH)] = 1
                line = substr(line, RSTART + RLENGTH)
            }
        close(path[i])
    }
    for (i = 1; i <= NR; i++) {
        if (name[i] !~ /\.json$/) continue
        split("", needs)
        needs[i] = 1
        for (changed = 1; changed;) {
            changed = 0
            for (j in needs)
                for (k = 1; k <= NR; k++)
                    if (!(k in needs) && (j, name[k]) in named) needs[k] = changed = 1
        }
        text = ""
        for (k = 1; k <= NR; k++) if (k in needs && k != i) text = text "," path[k]
        print path[i] ":" substr(text, 2)
    }
}'
