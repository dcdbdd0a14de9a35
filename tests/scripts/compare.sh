#!/bin/bash
# masu compare beside other people's programs: RMSE and PSNR by ImageMagick, SSIM by scikit-image
# (of Debian; without ImageMagick, which makes the pictures, nothing is compared, without scikit-image
# no SSIM; with MASU_REQUIRE_DRIVERS both must be there).
# Known answers, the map, and what is refused.
set -u
masu=${BUILD:-build}/bin/masu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failed=0
required=${MASU_REQUIRE_DRIVERS:-}

fail() {
    echo "$1"
    failed=1
}

# near WHAT OURS THEIRS SLACK
near() {
    awk -v a="$2" -v b="$3" -v slack="$4" 'BEGIN { d = a - b; exit !(a != "" && b != "" &&
        (d < 0 ? -d : d) <= slack) }' || fail "$1: ours $2, theirs $3"
}

value() { sed -n "s/^ *\"$1\": \([^,]*\),*$/\1/p" "$2"; }

# refuses CODE TEXT ARGUMENTS...
refuses() {
    local out code
    out=$("$masu" compare "${@:3}" 2>&1 > /dev/null)
    code=$?
    [ "$code" = "$1" ] && [[ $out == *"$2"* ]] || fail "compare ${*:3}: exit code $code, $out"
}

# A picture with slants, gradients and colour, and changed ones: blurred, brighter, other noise.
# Written here, so that no library that the other side uses has a hand in it.
awk -v w=101 -v h=67 -v out="$folder" 'BEGIN {
    for (k = 0; k < 4; k++) {
        file = out "/" k ".ppm"
        printf "P3\n%d %d\n255\n", w, h > file
        seed = 7
        for (y = 0; y < h; y++) for (x = 0; x < w; x++) {
            seed = (seed * 16807) % 2147483647
            noise = seed / 2147483647 - 0.5
            edge = (3 * x + 2 * y) % 59 < 23
            r = 40 + 150 * edge + 60 * x / w
            g = 200 * y / h + 30 * ((x * y) % 17 < 5)
            b = 120 + 100 * sin(x * y / 90)
            if (k == 1) { r = r * 0.9 + 12; g = g * 0.9 + 20; b = b * 0.95 + 5 }
            if (k == 2) { r += 40 * noise; g -= 60 * noise; b += 25 * noise }
            if (k == 3) { r = 0.5 * r + 0.5 * g; g = 0.5 * g + 0.5 * b }
            printf "%d %d %d\n", c(r), c(g), c(b) > file
        }
        close(file)
    }
}
function c(v) { v = int(v + 0.5); return v < 0 ? 0 : v > 255 ? 255 : v }'

magick=$(command -v convert)
[ -n "$magick" ] || {
    [ -n "$required" ] && fail 'ImageMagick is missing'
    echo 'no ImageMagick: nothing to compare with'
    exit $failed
}
for k in 0 1 2 3; do convert "$folder/$k.ppm" "PNG24:$folder/$k.png"; done

for k in 1 2 3; do
    "$masu" compare "$folder/0.png" "$folder/$k.png" --json "$folder/$k.json" || fail "compare 0 $k"
    near "PSNR of $k" "$(value psnr_db "$folder/$k.json")" \
        "$(compare -metric PSNR "$folder/0.png" "$folder/$k.png" null: 2>&1)" 1e-3
    near "RMSE of $k" "$(value rmse "$folder/$k.json")" \
        "$(compare -metric RMSE "$folder/0.png" "$folder/$k.png" null: 2>&1 |
            sed 's/.*(\(.*\))/\1/' | awk '{ print 255 * $1 }')" 1e-2
done

# scikit-image weighs as the paper does if told so; both leave out windows that reach over the edge.
cat > "$folder/ssim.py" << 'END'
import sys
import numpy
from skimage.io import imread
from skimage.metrics import structural_similarity
luma = [imread(path)[..., :3] @ numpy.array([0.2126, 0.7152, 0.0722]) for path in sys.argv[1:3]]
print(structural_similarity(*luma, data_range=255, gaussian_weights=True, sigma=1.5,
                            use_sample_covariance=False))
END
if /usr/bin/python3 -c 'import skimage' 2> /dev/null; then
    for k in 1 2 3; do
        near "SSIM of $k" "$(value ssim "$folder/$k.json")" \
            "$(/usr/bin/python3 "$folder/ssim.py" "$folder/0.png" "$folder/$k.png")" 1e-6
    done
elif [ -n "$required" ]; then
    fail 'scikit-image is missing'
fi

# Nothing and everything.
"$masu" compare "$folder/0.png" "$folder/0.png" --json "$folder/same.json" --map "$folder/map.png" ||
    fail 'compare 0 0'
[ "$(value rmse "$folder/same.json")$(value psnr_db "$folder/same.json")$(value flip "$folder/same.json")" = \
    '0.0null0.0' ] || fail 'equal pictures differ'
[ "$(convert "$folder/map.png" -format '%[fx:maxima]' info:)" = 0 ] || fail 'the map of equal pictures is not black'
convert -size 32x32 xc:black "PNG24:$folder/black.png"
convert -size 32x32 xc:white "PNG24:$folder/white.png"
"$masu" compare "$folder/black.png" "$folder/white.png" --json "$folder/all.json" --map "$folder/map.png"
near 'RMSE of black and white' "$(value rmse "$folder/all.json")" 255 1e-9
[ "$(convert "$folder/map.png" -format '%[fx:minima>0.9]' info:)" = 1 ] || fail 'black and white are alike in the map'

# Linear light: a compressed OpenEXR as ImageMagick reads it; two flat images two hundredths apart, whose numbers are
# known; one spot of another brightness is found where it is.
convert "$folder/0.png" -set colorspace RGB -compress Zip "$folder/0.exr"
convert "$folder/0.exr" "$folder/0.pfm"
"$masu" compare "$folder/0.exr" "$folder/0.pfm" --json "$folder/exr.json" || fail 'compare 0.exr 0.pfm'
near 'an OpenEXR and its PFM' "$(value relative_rmse "$folder/exr.json")" 0 2e-4
near 'their mean ratio' "$(value mean_ratio "$folder/exr.json")" 1 1e-4
convert -size 64x36 xc:'rgb(50%,50%,50%)' -set colorspace RGB "$folder/flat.pfm"
convert -size 64x36 xc:'rgb(51%,51%,51%)' -set colorspace RGB "$folder/more.pfm"
convert -size 64x36 xc:black -set colorspace RGB "$folder/none.pfm"
convert "$folder/flat.pfm" -fill 'rgb(75%,75%,75%)' -draw 'rectangle 8,12 11,15' "$folder/spot.pfm"
"$masu" compare "$folder/flat.pfm" "$folder/more.pfm" --json "$folder/flat.json" || fail 'compare flat more'
[ "$(value patch_z2 "$folder/flat.json")" = null ] || fail 'z without standard errors'
"$masu" compare "$folder/flat.pfm" "$folder/more.pfm" --error "$folder/none.pfm" --json "$folder/flat.json"
near 'mean ratio' "$(value mean_ratio "$folder/flat.json")" 1.02 1e-4
near 'relative RMSE' "$(value relative_rmse "$folder/flat.json")" 0.02 1e-4
near 'relMSE' "$(value relmse "$folder/flat.json")" 0.00038462 1e-6
near '95th percentile of patches' "$(value patch_p95 "$folder/flat.json")" 0.02 1e-4
near 'z^2 of two tolerances' "$(value patch_z2 "$folder/flat.json")" 4 0.02
"$masu" compare "$folder/flat.pfm" "$folder/more.pfm" --error "$folder/flat.pfm" --json "$folder/flat.json"
near 'z^2 of large errors' "$(value patch_z2 "$folder/flat.json")" 0.0064 1e-3 # (.01 / hypot(.5 / sqrt(16), .005))^2
"$masu" compare "$folder/flat.pfm" "$folder/spot.pfm" --json "$folder/spot.json" || fail 'compare flat spot'
near 'the patch of the spot' "$(value patch_worst_index "$folder/spot.json")" $((3 * 16 + 2)) 0
near 'its ratio' "$(value patch_worst "$folder/spot.json")" 0.5 1e-3

refuses 1 'expected linear light' "$folder/0.png" "$folder/0.pfm"
refuses 1 'flat.pfm: found 64x36, expected 101x67' "$folder/0.pfm" "$folder/flat.pfm"
cp "$folder/flat.json" "$folder/flat.ref"
refuses 1 'not a stored reference' "$folder/flat.ref" "$folder/flat.pfm"
refuses 2 'linear light' "$folder/0.png" "$folder/1.png" --error "$folder/0.pfm"
refuses 1 'black.png: found 32x32, expected 101x67' "$folder/0.png" "$folder/black.png"
refuses 1 'none.png' "$folder/0.png" "$folder/none.png"
refuses 1 '0.ppm' "$folder/0.ppm" "$folder/0.png"
refuses 2 'expected a reference' "$folder/0.png"
refuses 2 'expected one reference' "$folder/0.png" "$folder/1.png" "$folder/2.png"
refuses 2 'ppd' "$folder/0.png" "$folder/1.png" --ppd 0
refuses 1 'none' "$folder/0.png" "$folder/1.png" --map "$folder/none/map.png"
exit $failed
