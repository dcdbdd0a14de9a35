#!/bin/bash
# stored.sh [NAME...]: writes tests/reference/NAME.ref, with which tests/gpu/test_reference.c compares the renderer;
# without names all of them. Needs make, make lab, and the scenes named here (make gpu TESTS=reference
# bakes them). Takes a few minutes on two processors.
set -eu
lab=${BUILD:-build}/lab/bin/masu-lab
scenes=${BUILD:-build}/scenes
wanted=" $* "

# store NAME PATHS [OPTIONS]: of the scene NAME
store() {
    [ "$wanted" = "  " ] || [[ $wanted == *" $1 "* ]] || return 0
    echo "$1"
    "$lab" reference "$scenes/$1.masu" --store "tests/reference/$1.ref" --size 128x72 --paths "$2" "${@:3}"
}

# The test writes the scene and its panorama.
if [ "$wanted" = "  " ] || [[ $wanted == *" reference_sky "* ]]; then
    folder=$(mktemp -d)
    trap 'rm -rf "$folder"' EXIT
    (cd "$folder" && "$OLDPWD/${BUILD:-build}/tests/gpu/test_reference" --sky > sky.json)
    "${BUILD:-build}/bin/masu-bake" "$folder/sky.json" --bare -o "$folder/sky.masu" --quiet
    "$lab" reference "$folder/sky.masu" --sky "$folder/sky.pfm" --store tests/reference/reference_sky.ref --size 128x72 \
        --paths 512
fi
store test_shadows 512
store reference_rows 1024
store reference_emission 512
store reference_masks 512
store reference_lights 512
store reference_air 512
store test_fog 512
store glass 256 --sdf scenes/glass.sdf
store reference_glass 512
store reference_materials 512
store test_pane_maps 128
store test_pane 128 --sdf tests/scenes/test_pane.sdf
store night 256 --sdf scenes/night.sdf
store test_reflections 512 --sdf tests/scenes/test_reflections.sdf
store test_skin 256 --time 0.5
store test_swing 256 --time 0.3
store reference_attributes 512 --time 0.5
store test_foliage 256
store test_texture_mask 256
store test_texture_normals 256
store test_texture_quad 256
store test_town 256
store test_trace 512
store test_lods 128
store mirrors 512
store probe_open 256
store city 128 --sdf scenes/city.sdf
store blobs 128 --sdf scenes/blobs.sdf
store spheres 128 --sdf scenes/spheres.sdf
store rods 128 --sdf scenes/rods.sdf
store tunnel 128 --sdf scenes/tunnel.sdf
store engine 256 --sdf scenes/engine.glsl
store city_shadows 128 --sdf scenes/city.sdf --sun-radius 0.5 --sdf-ambient 1.5
