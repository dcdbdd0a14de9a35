#!/bin/sh
# The library, the generators of its tables and the reference refuse to be compiled where floats are computed in more
# digits than they have, and say what helps. On x86-64 the old coprocessor can be asked for by an option.
set -e
text=$(printf '#include <float.h>\nint method = FLT_EVAL_METHOD;\n' |
    ${CC:-gcc} -std=c11 -mfpmath=387 -E -x c - 2> /dev/null | tail -n 1) || exit 77
[ "$text" = 'int method = 2;' ] || { echo 'this compiler has no other floats'; exit 77; }

said=$(mktemp)
trap 'rm -f "$said"' EXIT
refuses() {
    # shellcheck disable=SC2086
    if ${CC:-gcc} -std=c11 -mfpmath=387 -fsyntax-only -Iinclude -Isrc -Ishaders -Itools -Itests \
        -I${MADE:-build}/gen "$1" 2> "$said"; then
        echo "$1 is compiled with -mfpmath=387"
        exit 1
    fi
    grep -q -- '#error.*-mfpmath=sse -msse2' "$said" || { head -n 3 "$said"; exit 1; }
}
for file in src/api.c src/frame/sky.c src/frame/shadow.c src/scene/cull.c src/scene/punctual_light.c \
    src/quality/governor.c tools/generate/make_smaa_area.c tools/generate/make_split_sum.c \
    tools/generate/make_blue_noise.c tests/reference/fsr1.c; do
    refuses "$file"
done
