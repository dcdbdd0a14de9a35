#!/bin/bash
# ladder_devices.sh CLASS=SCENE.masu=LADDER.json...: prints src/quality/ladder_devices.h: what the rungs of each measured
# ladder cost on the GPUs of the model sheet, by `masu plan --model --isa`. MASU_ISA_DRIVERS names the folder with
# Intel's and Adreno's drivers (make isa-drivers). Options of a scene's sheet: SHEET_ARGS_NAME.
set -euo pipefail
masu=${BUILD:-build}/bin/masu
[ -n "${MASU_ISA_DRIVERS:-}" ] || { echo "ladder_devices.sh: MASU_ISA_DRIVERS is not set (make isa-drivers)" >&2; exit 1; }
table=$(mktemp)
trap 'rm -f "$table"' EXIT
cat <<'END'
/* ladder_devices.h: what the rungs of ladder_tables.h cost on classes of GPUs, beside the first; part of ladder.c.
 * COMPUTED by the model sheet of the instructions that the GPUs' own compilers make (docs/design/33-model.md), not
 * measured on any of them. Written by `make ladder-devices`: not to be edited. */
/* clang-format off */
#ifndef MASU_LADDER_DEVICES_H
#define MASU_LADDER_DEVICES_H

static const float computed[MASU_SCENE_CLASSES][MASU_DEVICE_CLASSES][MASU_MAX_RUNGS] = {
END
for ladder; do
    IFS='=' read -r class scene rungs <<< "$ladder"
    name=$(basename "$scene" .masu)
    args=SHEET_ARGS_${name//-/_}
    # shellcheck disable=SC2086 # options are words
    "$masu" plan "$scene" --model --isa tgl,kbl,raven,vangogh,a630 --ladder "$rungs" --csv "$table" --quiet ${!args:-} \
        > /dev/null
    constant=$(echo "$class" | tr 'a-z-' 'A-Z_')
    echo "    [MASU_SCENE_$constant] = { /* $name.masu, ladder.json $(cksum < "$rungs" | cut -d' ' -f1) */"
    awk -F, '
    NR == 1 {
        split("Xe80 UHD620 Vega8 Deck low_mobile", name, " ")
        split("XE80 UHD620 VEGA8 DECK MOBILE", constant, " ")
        for (i = 1; i <= NF; i++)
            for (k = 1; k <= 5; k++) {
                wanted = "COMPUTED realistic_ms " name[k]
                sub(/_mobile/, " mobile", wanted)
                if ($i == wanted) column[k] = i
            }
        next
    }
    $9 == "sum" {
        rung = $5 + 0
        if (rung >= count) count = rung + 1
        for (k = 1; k <= 5; k++) ms[k, rung] = $(column[k])
    }
    END {
        for (k = 1; k <= 5; k++) {
            if (!column[k] || !count) exit 1
            line = ""
            for (r = 0; r < count; r++) line = line (r ? ", " : "") sprintf("%.4ff", ms[k, r] / ms[k, 0])
            print "        [MASU_DEVICE_" constant[k] "] = {" line "},"
        }
    }' "$table"
    echo "    },"
done
printf '};\n\n#endif\n'
