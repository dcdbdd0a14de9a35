#!/bin/bash
# masu-bake and pictures: every format that is promised, models that embed them, and pictures that are
# missing, broken, empty, too large or something else. None stops a bake: each is one warning that
# names the file, and its material has its factors alone.
set -u
cd "$(dirname "$0")/../.." || exit 1
bake=$(realpath "${BUILD:-build}/bin/masu-bake")
pictures=$(realpath "${MADE:-build}/textures")
models=/usr/share/assimp/models
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# bakes ARGUMENT...: exit code 0, the blob in $folder/x.masu, statistics in $folder/stats
bakes() {
    "$bake" "$@" --bare -o "$folder/x.masu" --stats "$folder/stats" > "$folder/stdout" 2> "$folder/stderr" ||
        fail "$*: $(cat "$folder/stderr")"
}

# counts SECTION: elements of the last blob
counts() {
    tr -d ' \n' < "$folder/stats" | sed -n "s/.*\"$1\":{\"count\":\([0-9]*\).*/\1/p"
}

# warns COUNT [PATTERN]: that many warnings, one of which matches
warns() {
    [ "$(grep -c 'masu-bake: warning: ' "$folder/stderr")" = "$1" ] ||
        fail "not $1 warnings: $(cat "$folder/stderr")"
    [ -z "${2:-}" ] || grep -q -e "$2" "$folder/stderr" || fail "\"$2\" is not in $(cat "$folder/stderr")"
}

# quad MEMBERS: a scene of one plane with these members of its material
quad() {
    printf '{"models": [{"mesh": {"plane": {}}, "material": {%s}}]}\n' "$1" > "$folder/scene.json"
}

scene=$folder/scene.json

# ---- detail --------------------------------------------------------------------------------------

# With the colour it is the texture coordinates that are scaled: the same blob as of a plane with four times the tiles, also where
# the plane comes a second time with other values.
detail() { # MEMBERS, TILE
    printf '{"models": [{"mesh": {"plane": {"size_x": 8, "size_z": 8, "tile": %s}}, "material": {%s"base_color_map": "%s"}}%s]}\n' \
        "$2" "$1" "$pictures/bricks.png" "${3:-}" > "$scene"
    bakes "$scene"
    warns 0
}
detail '' 8
cp "$folder/x.masu" "$folder/tiles.masu"
detail '"detail": 4, "detail_color": true, ' 2
cmp -s "$folder/x.masu" "$folder/tiles.masu" || fail "detail_color is not four times the tiles"
detail '"detail": 4, "detail_color": false, ' 2
cmp -s "$folder/x.masu" "$folder/tiles.masu" && fail "detail_color is read as true"
detail '"detail": [4, 1], "detail_color": true, ' 2
cmp -s "$folder/x.masu" "$folder/tiles.masu" && fail "detail_color has one factor for both axes"
[ "$(counts vertices)" = 4 ] || fail "$(counts vertices) vertices of one plane"
other=", {\"name\": \"b\", \"mesh\": {\"plane\": {\"size_x\": 8, \"size_z\": 8, \"tile\": 2}}, \"material\": {\"base_color_map\": \"$pictures/bricks.png\"}}"
detail '"detail": 4, "detail_color": true, ' 2 "$other$other"
[ "$(counts vertices)" = 8 ] || fail "$(counts vertices) vertices of a plane with two scales of its coordinates"
detail '"detail": 4, ' 2 "$other$other"
[ "$(counts vertices)" = 4 ] || fail "$(counts vertices) vertices of a plane with one"
for times in 32.768 33; do
    printf '{"models": [{"mesh": {"plane": {"tile": 1000}}, "material": {"detail": %s, "detail_color": true, "base_color_map": "%s"}}]}\n' \
        $times "$pictures/bricks.png" > "$scene"
    if [ $times = 33 ]; then
        "$bake" "$scene" --bare -o "$folder/x.masu" > /dev/null 2> "$folder/stderr" && fail "coordinates of 33000 are baked"
        grep -q 'models\[0\].*texture coordinates beyond 32768, by "detail_color"' "$folder/stderr" || fail "$(cat "$folder/stderr")"
    else
        bakes "$scene"
    fi
done

# ---- formats -------------------------------------------------------------------------------------

for name in bricks.png ground.jpg leaf.tga sign.rgb; do
    quad "\"base_color_map\": \"$pictures/$name\""
    bakes "$scene"
    warns 0
    [ "$(counts textures)" = 1 ] || fail "$name: $(counts textures) textures"
done
# Names are relative to the scene, or found in the texture path by their last part.
cp "$pictures/gradient.png" "$folder/near.png"
quad '"base_color_map": "near.png"'
bakes "$scene"
[ "$(counts textures)" = 1 ] || fail "a picture beside its scene is not found"
quad '"base_color_map": "C/somewhere/else/gradient.png"'
bakes "$scene"
warns 1 'C/somewhere/else/gradient.png: No such file'
bakes "$scene" --texture-path "/nowhere:$pictures"
warns 0
[ "$(counts textures)" = 1 ] || fail "the texture path is not looked at"
quad '"base_color_map": "C/somewhere/else/GRADIENT.PNG"'
bakes "$scene" --texture-path "/nowhere:$pictures"
warns 0

# 64 x 64, 7 mips: 8 bytes a block, 341 + 1 + 1 blocks. With alpha 16 bytes.
quad "\"base_color_map\": \"$pictures/gradient.png\""
bakes "$scene"
[ "$(counts texels)" = 172 ] || fail "gradient: $(counts texels) units of texels"
quad "\"base_color_map\": \"$pictures/disc.png\""
bakes "$scene"
[ "$(counts texels)" = 343 ] || fail "disc: $(counts texels) units of texels"
quad "\"base_color_map\": \"$pictures/disc.png\", \"alpha\": \"opaque\""
bakes "$scene"
[ "$(counts texels)" = 172 ] || fail "an opaque disc: $(counts texels) units of texels"
quad "\"base_color_map\": \"$pictures/disc.png\", \"alpha\": \"blend\""
bakes "$scene"
warns 0
[ "$(counts texels)" = 343 ] || fail "a disc to blend: $(counts texels) units of texels"

# Pictures of one size and format share an array; the same request is made once.
printf '{"models": [%s{"mesh": {"plane": {}}}]}\n' "$(for i in 1 2 3; do
    printf '{"mesh": {"plane": {}}, "name": "a%s", "material": {"base_color": [0, 0, 0.%s],
        "base_color_map": "%s/gradient.png"}},' "$i" "$i" "$pictures"
    printf '{"mesh": {"plane": {}}, "material": {"base_color_map": "%s/checker.png"}},' "$pictures"
done)" > "$scene"
bakes "$scene"
[ "$(counts textures)" = 1 ] || fail "$(counts textures) arrays of two pictures of one size"
[ "$(counts texels)" = 343 ] || fail "two pictures take $(counts texels) units"
[ "$(counts texture_sets)" = 1 ] || fail "$(counts texture_sets) texture sets"
[ "$(counts materials)" = 5 ] || fail "$(counts materials) materials"

# Normals whose variance is lost in mips make a map of roughness, but not of what is fully rough.
quad "\"roughness\": 0.5, \"normal_map\": \"$pictures/bricks_normal.png\""
bakes "$scene"
[ "$(counts textures)" = 2 ] || fail "a normal map: $(counts textures) textures"
quad "\"roughness\": 1, \"normal_map\": \"$pictures/bricks_normal.png\""
bakes "$scene"
[ "$(counts textures)" = 1 ] || fail "a rough normal map: $(counts textures) textures"

# The same bytes twice.
cp "$folder/x.masu" "$folder/first.masu"
bakes "$scene"
cmp "$folder/x.masu" "$folder/first.masu" || fail "not the same bytes twice"

# ---- models --------------------------------------------------------------------------------------

for model in glTF2/BoxTextured-glTF-Binary/BoxTextured.glb \
    glTF2/BoxTextured-glTF-Embedded/BoxTextured.gltf glTF2/BoxTextured-glTF/BoxTextured.gltf; do
    bakes "$models/$model"
    warns 0
    [ "$(counts textures)" = 1 ] || fail "$model: $(counts textures) textures"
    [ "$(counts texcoords)" = "$(counts vertices)" ] || fail "$model: texture coordinates"
    bakes "$models/$model" --no-textures
    [ "$(counts textures)" = 0 ] && [ "$(counts texcoords)" = 0 ] || fail "$model: textures all the same"
done
bakes "$models/OBJ/spider.obj"
[ "$(counts materials)" = 4 ] || fail "spider: $(counts materials) materials"
grep -q 'texture' "$folder/stderr" && fail "spider: $(cat "$folder/stderr")"

# TORCS's dialect of AC3D: of several textures the one that is the base, wherever it stands. Emission
# that is no more than what is reflected brightens and does not glow.
cat > "$folder/quad.acc" << END
AC3Db
MATERIAL "" rgb 0.40 0.40 0.40 amb 0.80 0.80 0.80 emis 0.40 0.40 0.40 spec 0.50 0.50 0.50 shi 50 trans 0
OBJECT world
kids 1
OBJECT poly
name "quad"
texture "gone.png" tiled
texture "near.png" base
texture empty_texture_no_mapping skids
numvert 4
0 0 0 0 0 1
1 0 0 0 0 1
1 1 0 0 0 1
0 1 0 0 0 1
numsurf 1
SURF 0x14
mat 0
refs 4
0 0 0 0.5 0.5
1 1 0 0.5 0.5
2 1 1 0.5 0.5
3 0 1 0.5 0.5
kids 0
END
bakes "$folder/quad.acc"
warns 0
[ "$(counts textures)" = 1 ] || fail "quad.acc: $(counts textures) textures"
grep -aq near.png "$folder/x.masu" || fail "quad.acc: another texture"

# What a material of an OBJ calls a bump map: heights become normals, normals stay. The strength is -bm.
printf 'mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3 4/4\n' > "$folder/quad.obj"
material() { printf 'newmtl m\nKd 1 1 1\nNs 0\n%s\n' "$1" > "$folder/m.mtl"; }
# texels_of NAME: what NAME is drawn with, as text
texels_of() { bakes "$folder/quad.obj" && cp "$folder/x.masu" "$folder/$1.masu"; }
convert "$pictures/bricks.png" -colorspace gray "$folder/heights.png"
cp "$pictures/bricks_normal.png" "$folder/normals.png"
for line in 'bump heights.png' 'bump -bm 4 heights.png' 'map_bump normals.png' 'norm normals.png' 'norm heights.png'; do
    material "$line"
    texels_of "${line// /_}"
    warns 0
    [ "$(counts textures)" = 1 ] || fail "$line: $(counts textures) textures"
done
differ() { ! cmp -s "$folder/$1.masu" "$folder/$2.masu" || fail "$1 is as $2"; }
differ bump_heights.png bump_-bm_4_heights.png
cmp "$folder/map_bump_normals.png.masu" "$folder/norm_normals.png.masu" || fail "normals called bump are something else"
cmp "$folder/bump_heights.png.masu" "$folder/norm_heights.png.masu" || fail "heights called normals are something else"
# Heights in a normal map's place would be one slope; a plane of them none at all.
convert -size 64x64 xc:'gray(30%)' "$folder/heights.png"
material 'bump heights.png'
texels_of flat
convert -size 64x64 xc:'rgb(128,128,255)' "$folder/heights.png"
material 'norm heights.png'
texels_of up
cmp "$folder/flat.masu" "$folder/up.masu" || fail "a level of heights is no plane"
# Beside normals heights are of no use, which is said.
material "$(printf 'norm normals.png\nbump heights.png')"
bakes "$folder/quad.obj"
warns 1 'unsupported textures: heights.png'

# More than 8 bits of a channel, if a value needs them, and highlights of old formats.
printf 'P5\n2 1\n65535\n\x12\x34\xff\xff' > "$folder/deep.pgm"
printf 'P5\n2 1\n65535\n\x12\x12\xff\xff' > "$folder/plain.pgm"
material 'map_Kd deep.pgm'
bakes "$folder/quad.obj"
warns 1 'texture .*deep.pgm: 16 bits per channel, reduced to 8'
material 'map_Kd plain.pgm'
bakes "$folder/quad.obj"
warns 0
material 'Ks 0.4 0.4 0.4'
bakes "$folder/quad.obj"
warns 1 '1 materials have Phong highlights: .* the specular colour is ignored'

# Alpha: a mask where the picture looks like one, or has been given for it; of gloss nothing is a hole.
convert -size 64x64 gradient:'gray(10%)-gray(70%)' "$folder/gloss.png"
convert "$pictures/checker.png" -resize 64x64! "$folder/gloss.png" -alpha off -compose CopyOpacity -composite "$folder/shiny.png"
material 'map_Kd shiny.png'
bakes "$folder/quad.obj"
warns 1 'shiny.png: its alpha is not a mask (.* % of it is below the cut-off): treated as opaque'
[ "$(counts texels)" = 172 ] || fail "a gloss in alpha: $(counts texels) units of texels"
"$bake" "$folder/quad.obj" --strict -o "$folder/y.masu" > /dev/null 2>&1 && fail "--strict takes a gloss for opaque"
material "$(printf 'map_Kd shiny.png\nmap_d shiny.png')"
bakes "$folder/quad.obj"
warns 0
[ "$(counts texels)" = 343 ] || fail "an opacity map: $(counts texels) units of texels"
cp "$pictures/disc.png" "$folder/disc.png"
material 'map_Kd disc.png'
bakes "$folder/quad.obj"
warns 0
[ "$(counts texels)" = 343 ] || fail "a disc in alpha: $(counts texels) units of texels"
# AC3D says that alpha is what is there.
sed -i 's/near.png/shiny.png/' "$folder/quad.acc"
bakes "$folder/quad.acc"
warns 0
[ "$(counts texels)" = 343 ] || fail "alpha of AC3D: $(counts texels) units of texels"

# Names with spaces, as URIs have them; of a track's textures those of its installation.
cp "$pictures/gradient.png" "$folder/a picture.png"
material 'map_Kd a%20picture.png'
bakes "$folder/quad.obj"
warns 0
[ "$(counts textures)" = 1 ] || fail "a name with %20 is not found"
mkdir -p "$folder/torcs/tracks/road/short" "$folder/torcs/data/textures"
cp "$pictures/gradient.png" "$folder/torcs/data/textures/shared.png"
sed 's/shiny.png/shared.png/' "$folder/quad.acc" > "$folder/torcs/tracks/road/short/short.acc"
bakes "$folder/torcs/tracks/road/short/short.acc"
warns 0
[ "$(counts textures)" = 1 ] || fail "a texture that tracks share is not found"

# Larger pictures are reduced, which is said once.
convert -size 5000x3 xc:red "$folder/wide.png"
quad '"base_color_map": "wide.png", "roughness_map": "wide.png"'
bakes "$scene"
warns 1 'wide.png: 5000 x 3 texels, reduced to 4096 x 2'

# A picture that is not read is named, with what would be.
printf '\253KTX 20\273\r\n\032\n0123456789' > "$folder/basis.ktx2"
quad '"base_color_map": "basis.ktx2"'
bakes "$scene"
warns 1 'basis.ktx2: a KTX2 (Basis) image, which is not supported: use PNG, JPEG or WebP; ignored'

# ---- pictures that are none ----------------------------------------------------------------------

# broken NAME REASON [TYPE]: one warning, no texture, a blob all the same
broken() {
    quad "\"base_color_map\": \"$1\""
    bakes "$scene"
    warns 1 "texture .*$(basename "$1"): .*$2.*ignored"
    [ "$(counts textures)" = 0 ] && [ "$(counts texcoords)" = 0 ] || fail "$1: has become a texture"
    [ "$(counts vertices)" = 4 ] || fail "$1: the quad is gone"
}

broken "$folder/none.png" 'No such file'
broken "$folder" 'not a regular file'
broken /dev/zero 'not a regular file'
: > "$folder/empty.png"
broken "$folder/empty.png" 'empty'
head -c 5000 /dev/urandom > "$folder/noise.png"
broken "$folder/noise.png" 'not an image in a supported format'
echo 'push graphic-context' > "$folder/script.mvg"
broken "$folder/script.mvg" 'not an image in a supported format'
printf '<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"/>' > "$folder/drawing.svg"
broken "$folder/drawing.svg" 'not an image in a supported format'
for name in bricks.png ground.jpg leaf.tga sign.rgb; do
    # Cut short. Readers that fill up what is missing are welcome to.
    head -c 300 "$pictures/$name" > "$folder/cut.${name##*.}"
    quad "\"base_color_map\": \"$folder/cut.${name##*.}\""
    bakes "$scene"
    # Every byte of the head wrong in turn, in a scene of all of them.
    for at in 0 1 2 3 4 5 6 7 8 12 13 16 17 18 19 20 21 22 23 24 25 28; do
        cp "$pictures/$name" "$folder/bad$at.${name##*.}"
        printf '\377' | dd of="$folder/bad$at.${name##*.}" bs=1 seek=$at conv=notrunc 2> /dev/null
        printf '%s{"mesh": {"plane": {}}, "material": {"base_color_map": "%s"}}' "${planes:+, }" "bad$at.${name##*.}"
        planes=1
    done > "$folder/planes"
    printf '{"models": [%s]}\n' "$(< "$folder/planes")" > "$scene"
    planes= && rm -f "$folder/x.masu"
    bakes "$scene"
    [ -s "$folder/x.masu" ] || fail "$name with wrong bytes: no blob"
    [ "$(counts materials)" = 22 ] || fail "$name with wrong bytes: $(counts materials) materials"
done
# A PNG that says it is 65,535 x 65,535, one that says it has no width, an SGI of 65,535 x 65,535.
head -c 16 "$pictures/bricks.png" > "$folder/huge.png"
printf '\000\000\377\377\000\000\377\377\010\006\000\000\000\000\000\000\000' >> "$folder/huge.png"
broken "$folder/huge.png" '.'
head -c 16 "$pictures/bricks.png" > "$folder/flat.png"
printf '\000\000\000\000\000\000\000\010\010\006\000\000\000\000\000\000\000' >> "$folder/flat.png"
broken "$folder/flat.png" '.'
printf '\001\332\000\001\000\003\377\377\377\377\000\004' > "$folder/huge.rgb"
head -c 500 /dev/zero >> "$folder/huge.rgb"
broken "$folder/huge.rgb" '.'
truncate -s 300M "$folder/long.png"
broken "$folder/long.png" 'larger than 256 MiB'

# A missing picture is warned of once, however many ask for it; a lamp without its map is dark.
printf '{"models": [%s{"mesh": {"plane": {}}}]}\n' "$(for i in 1 2 3; do
    printf '{"mesh": {"plane": {}}, "material": {"base_color": [0, 0, 0.%s], "emissive": [9, 9, 9],
        "emissive_map": "gone.png", "normal_map": "gone.png"}},' "$i"
done)" > "$scene"
bakes "$scene"
warns 1 'gone.png: No such file'

# ---- mistakes in the scene -----------------------------------------------------------------------

# refuses PATTERN MEMBERS
refuses() {
    quad "$2"
    "$bake" "$scene" --bare -o "$folder/y.masu" > /dev/null 2> "$folder/stderr" && fail "$2: accepted"
    grep -q -e "models\[0\]\.material.*$1" "$folder/stderr" || fail "$2: $(cat "$folder/stderr")"
    [ "$(wc -l < "$folder/stderr")" = 1 ] || fail "$2: not one line"
}

refuses 'expected a string' '"normal_map": 3'
refuses 'expected "opaque"' '"alpha": "see-through"'
refuses 'from 0 to 1' '"alpha_cutoff": 2'
refuses 'another member sets the same map' '"surface_map": "a.png", "roughness_map": "b.png"'
refuses 'unknown key' '"colour_map": "a.png"'
refuses 'from 0 to 1' '"opacity": 1.5'
refuses 'from 0 to 65504' '"thickness": 65505'
refuses 'from 1 to 1000' '"ior": 0.99'
refuses 'expected "alpha", "additive" or "tinted"' '"blend": "multiply"'
refuses 'needs "alpha": "blend"' '"alpha": "mask", "opacity": 0.5'
refuses 'needs "alpha": "blend"' '"alpha": "opaque", "blend": "additive"'

# A coat may have maps, one picture for both or two; of what is blended it has none, which is said.
quad "\"coat\": 1, \"coat_map\": \"$pictures/gradient.png\", \"coat_roughness_map\": \"$pictures/checker.png\", \"coat_smooth\": true"
bakes "$scene"
warns 0
[ "$(counts textures)" = 1 ] || fail "maps of a coat: $(counts textures) textures"
quad "\"coat_map\": \"$pictures/gradient.png\"" # and without one there is none
bakes "$scene"
[ "$(counts textures)" = 0 ] || fail "a map of no coat: $(counts textures) textures"
quad "\"coat\": 1, \"coat_map\": \"$pictures/gradient.png\", \"blend\": \"tinted\", \"opacity\": 0.25"
bakes "$scene"
warns 1 'transparent materials have no maps of coat, specular or sheen: ignored'
refuses 'expected' '"coat_smooth": 1'
quad '"thickness": 65504, "ior": 1000, "blend": "tinted", "opacity": 0, "metallic": 0'
bakes "$scene"
warns 0
quad '"thickness": 0.1, "opacity": 0.5'
bakes "$scene"
warns 1 'its thickness is ignored: it is metallic, or not blended as "tinted"'

# As many blended things as a renderer draws, and one more.
pane='{"mesh": {"plane": {}}, "material": {"opacity": 0.5}}'
panes=$pane
for ((i = 0; i < 12; i++)); do panes="$panes, $panes"; done
printf '{"models": [%s]}' "$panes" > "$scene"
"$bake" "$scene" --bare -o "$folder/y.masu" --quiet 2> "$folder/stderr" ||
    fail "4096 panes: $(cat "$folder/stderr")"
printf '{"models": [%s, %s]}' "$panes" "$pane" > "$scene"
rm -f "$folder/y.masu"
"$bake" "$scene" --bare -o "$folder/y.masu" --quiet 2> "$folder/stderr" && fail "4097 panes: accepted"
grep -q 'found 4097 transparent draws, expected at most 4096' "$folder/stderr" || fail "$(cat "$folder/stderr")"
[ "$(wc -l < "$folder/stderr")" = 1 ] || fail "4097 panes: not one line"
[ ! -e "$folder/y.masu" ] || fail "4097 panes: wrote its output"

[ $failures = 0 ] && echo "masu-bake: pictures as expected"
[ $failures = 0 ]
