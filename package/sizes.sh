#!/bin/sh
# sizes.sh BUILD CLASS...: bytes of the library (code and constants, as `size` counts them), with every shader and for
# each class of scenes alone, as CSV.
# sizes.sh FILE.csv: that as rows of docs/embedding.md.
set -eu

if [ $# = 1 ]; then
    awk -F, '
        function thousands(n, s) { for (s = ""; n >= 1000; n = int(n / 1000)) s = sprintf(",%03d%s", n % 1000, s); return n s }
        NR > 1 { print "| " $1 " | " thousands($2) " | " thousands($3) " |" }' "$1"
    exit
fi
build=$1
shift

# text + data of objects or an archive
bytes() { size "$@" | awk 'NR > 1 { sum += $1 + $2 } END { print sum + 0 }'; }

all=$(bytes "$build/lib/libmasu.a")
rest=$((all - $(bytes "$build/obj/src/device/shaders.o")))
echo 'classes,bytes,shaders'
echo "all,$all,$((all - rest))"
for class; do
    shaders=$(bytes "$build/classes/$class/shaders.o")
    echo "$class,$((rest + shaders)),$shaders"
done
