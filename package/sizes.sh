#!/bin/sh
# sizes.sh BUILD CLASS...: bytes of the library (code and constants, as `size` counts them), with every shader and for
# each class of scenes alone, as CSV.
set -eu
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
