# outcome.sh: which files are models, and what came of a bake, in a few words; for lab/gallery/gallery.sh and for the
# test that counts them. Sourced.

# Pictures, texts, materials and data beside models: no models.
others='png jpg jpeg tga dds bmp gif tif tiff webp ktx2 rgb rgba hdr txt md mtl bin vert frag glsl html htm material
    skeleton source lic license pdf gitignore xcf psd java py rb shader sh anim md5anim cfg skin'

is_model() {
    local extension=${1##*.}
    [[ ${1##*/} == *.* ]] || return 1
    case " $(echo $others) " in *" ${extension,,} "*) return 1 ;; esac
}

# outcome CODE STDERR: of an exit code of masu-bake and the file with what it said
outcome() {
    case $1 in
    0) grep -q 'warning: ' "$2" && echo "bakes, with warnings" || echo "bakes" ;;
    1)
        case $(grep -v 'warning: ' "$2") in
        *'importer crashed'*) echo "refused: the importing library crashes" ;;
        *'importer took'*) echo "refused: the importing library takes too long" ;;
        *'no triangles'*) echo "refused: no triangles" ;;
        *) echo "refused: not readable" ;;
        esac
        ;;
    *) echo "WRONG: exit code $1" ;;
    esac
}
