/* content.h: a scene while it is being baked: one growing array per section of the blob.
 *
 * The same structure holds a whole scene, one imported model and one procedural shape. Pieces are
 * built apart (a model even in another process, see bake/import), checked, and appended to the
 * scene with a placement. Elements are the blob's own structs, so writing is copying.
 *
 *   content.c   the arrays, names, materials, bounds, order of instances
 *   piece.c     pieces placed in a scene, with what the scene changes of their materials
 *   check.c     the rules of blob.h, before a piece from another process is trusted
 *   groups.c    what is culled together
 *   camera.c    cameras of model files
 *   sun.c       their directional lights
 *
 * Whoever declares a content owns it, and releases it.
 * Running out of memory ends the program with a message; nothing else here can fail unless it says
 * so. */
#ifndef MASU_BAKE_CONTENT_H
#define MASU_BAKE_CONTENT_H

#include "bake/base/buffer.h"
#include "bake/base/math.h"
#include "scene/blob.h"

typedef struct masu_bake_content {
    masu_bake_buffer section[MASU_BLOB_KIND_COUNT]; /* by masu_blob_kind */
    /* Textures as materials ask for them; bake/texture/texture.c makes sections of them at the
     * end. */
    masu_bake_buffer maps;       /* masu_bake_maps, one per material */
    masu_bake_buffer images;     /* masu_bake_image */
    masu_bake_buffer image_text; /* their names, each with its NUL */
    masu_bake_buffer image_data; /* files that lie inside a model */
    masu_bake_buffer cameras;    /* masu_bake_camera: bake/scene/camera.h */
    masu_bake_buffer suns;       /* masu_bake_sun: bake/scene/sun.h */
    float sdf_glossiest;         /* least roughness of the SDF's surfaces */
    masu_bake_buffer
        traced; /* what the scene says of the first so many instances: bake/mesh/bvh.h */
    /* Small pictures of the textures, where rays are traced: bake/texture/trace_texture.h. */
    masu_bake_buffer pictures;       /* masu_bake_trace_row */
    masu_bake_buffer picture_texels; /* uint32_t */
    uint32_t picture_side;           /* texels along the longer side; 0: of colours none are kept */
    bool pictures_wanted;
    uint32_t names_cut;
} masu_bake_content;

/* A picture: a file, or `data_bytes` of one at `data` of image_data; its name is then made up. */
typedef struct masu_bake_image {
    uint32_t name;                  /* offset into image_text */
    uint32_t raw_width, raw_height; /* the data are BGRA texels; 0: a file's bytes */
    uint32_t outside; /* 1: of a folder that its model may not name; looked for elsewhere alone */
    uint64_t data, data_bytes;
} masu_bake_image;

/* What pictures can stand for. Roughness and metallic are apart here: they may come as one picture
 * or as two. */
enum {
    MASU_BAKE_BASE,
    MASU_BAKE_NORMAL,
    MASU_BAKE_ROUGHNESS,
    MASU_BAKE_METALLIC,
    MASU_BAKE_EMISSIVE,
    /* alpha as a picture of its own; with `transmission` the share that is transmitted */
    MASU_BAKE_OPACITY,
    MASU_BAKE_OCCLUSION,
    MASU_BAKE_COAT, /* apart here, as roughness and metallic are */
    MASU_BAKE_COAT_ROUGHNESS,
    MASU_BAKE_COAT_NORMAL,   /* of a coat whose normals are not those of the base */
    MASU_BAKE_LOBE_COLOR,    /* of a specular colour or a sheen */
    MASU_BAKE_LOBE_STRENGTH, /* of a specular factor or the roughness of a sheen */
    MASU_BAKE_MAPS
};

/* AUTO: the picture decides whether it is a mask. COVERS: the format says that alpha is what is
 * there; it is a mask if anything is below the cut-off. */
enum {
    MASU_BAKE_ALPHA_AUTO,
    MASU_BAKE_ALPHA_OPAQUE,
    MASU_BAKE_ALPHA_MASK,
    MASU_BAKE_ALPHA_BLEND,
    MASU_BAKE_ALPHA_COVERS
};

/* What a model says of its picture of normals. */
enum {
    MASU_BAKE_RELIEF_NORMALS,       /* normals, whatever they look like */
    MASU_BAKE_RELIEF_NAMED_NORMALS, /* normals, unless the picture is grey: then heights */
    MASU_BAKE_RELIEF_NAMED_HEIGHTS  /* heights, unless the picture has normals in it */
};

/* Which of a coat and what lies below it has the relief of the normal map; the other has the
 * mesh's normal. */
enum { MASU_BAKE_RELIEF_OF_BOTH, MASU_BAKE_RELIEF_OF_BASE, MASU_BAKE_RELIEF_OF_COAT };

/* Whether vertices have colours of their own, which the base colour is multiplied by; and alpha
 * below 1. */
enum { MASU_BAKE_COLORED_NOT, MASU_BAKE_COLORED, MASU_BAKE_COLORED_ALPHA };

#define MASU_BAKE_WRAP_REPEAT 3 /* repeats even if coordinates stay in 0..1 */

typedef struct masu_bake_maps {
    uint32_t image[MASU_BAKE_MAPS];  /* MASU_BLOB_NONE: no such map */
    uint8_t channel[MASU_BAKE_MAPS]; /* 0..3: of the picture, for maps of one channel */
    uint8_t gloss;                   /* roughness is 1 minus the picture */
    uint8_t alpha;                   /* MASU_BAKE_ALPHA_* */
    uint8_t additive;                /* with ALPHA_BLEND: adds its light, hides nothing */
    uint8_t single;                  /* 1: not seen from behind */
    uint8_t wrap[2]; /* as in masu_blob_texture_set; or MASU_BAKE_WRAP_REPEAT */
    uint8_t relief;                  /* MASU_BAKE_RELIEF_* */
    uint8_t relief_of;               /* MASU_BAKE_RELIEF_OF_* */
    uint8_t tinted;                  /* with ALPHA_BLEND: what shines through has the base colour */
    /* Emission is the base colour: without its picture, the factor. */
    uint8_t unlit;
    uint8_t dark;                    /* emission was meant for a map that the importer left out */
    uint8_t shadowless;              /* 1: casts no shadows */
    uint8_t colored;                 /* MASU_BAKE_COLORED_* */
    uint8_t second; /* bit of a slot of a texture set: its map is of the second coordinates */
    uint8_t nearest;                 /* 1: magnified without interpolation */
    uint8_t transmission;            /* with `tinted`: what the map of opacity is */
    float cutoff, normal_scale;      /* normal_scale: of heights their strength */
    float occlusion;                 /* strength of the occlusion map, 0..1 */
    float coat_scale;                /* as normal_scale, of the coat's map */
    /* no padding: it is compared as bytes */
} masu_bake_maps;

uint32_t masu_bake_stride(uint32_t kind); /* sizeof the section's element; 1 for NAMES */
uint64_t masu_bake_count(const masu_bake_content *content, uint32_t kind);
void masu_bake_content_release(masu_bake_content *content);

/* Typed views of a section. */
#define MASU_BAKE_ARRAY(content, kind, type) ((type *)(void *)(content)->section[kind].data)
#define MASU_BAKE_VERTICES(c) MASU_BAKE_ARRAY(c, MASU_BLOB_VERTICES, masu_blob_vertex)
#define MASU_BAKE_INDICES(c) MASU_BAKE_ARRAY(c, MASU_BLOB_INDICES, uint32_t)
#define MASU_BAKE_PRIMITIVES(c) MASU_BAKE_ARRAY(c, MASU_BLOB_PRIMITIVES, masu_blob_primitive)
#define MASU_BAKE_MESHES(c) MASU_BAKE_ARRAY(c, MASU_BLOB_MESHES, masu_blob_mesh)
#define MASU_BAKE_INSTANCES(c) MASU_BAKE_ARRAY(c, MASU_BLOB_INSTANCES, masu_blob_instance)
#define MASU_BAKE_LIGHTS(c) MASU_BAKE_ARRAY(c, MASU_BLOB_LIGHTS, masu_blob_light)
#define MASU_BAKE_MATERIALS(c) MASU_BAKE_ARRAY(c, MASU_BLOB_MATERIALS, masu_blob_material)

/* COLORS and TEXCOORDS_1 end with the last vertex that has other than white and 0:
 * masu_bake_pad_attributes makes them as many as vertices, where there are any. */
typedef struct masu_bake_attributes {
    uint32_t color; /* as masu_blob_color has it: MASU_BLOB_WHITE */
    float texcoord[2];
} masu_bake_attributes;
/* Those of the vertex that was added last. */
void masu_bake_add_attributes(masu_bake_content *content, const masu_bake_attributes *attributes);
masu_bake_attributes masu_bake_attributes_of(const masu_bake_content *content, uint64_t vertex);
/* Of `count` vertices from `first` on to as many that were added last. */
void masu_bake_copy_attributes(masu_bake_content *to, const masu_bake_content *from, uint64_t first, uint64_t count);
void masu_bake_pad_attributes(masu_bake_content *content);
/* Linear, with alpha. */
uint32_t masu_bake_encode_color(const float color[4]);

/* A name's offset. Control characters and broken UTF-8 become '?'; an empty name is NONE; one
 * that is longer than a blob takes is cut, and counted. */
uint32_t masu_bake_name(masu_bake_content *content, const char *name, size_t length);
const char *masu_bake_name_text(const masu_bake_content *content, uint32_t name); /* "" for NONE */

/* The index of a material with these values and this name, added if there is none yet. */
uint32_t masu_bake_material(masu_bake_content *content, const masu_blob_material *material,
                            const char *name);
uint32_t masu_bake_mapped_material(masu_bake_content *content, const masu_blob_material *material,
                                   const masu_bake_maps *maps, const char *name);
masu_blob_material masu_bake_default_material(void);
masu_bake_maps masu_bake_no_maps(void);
bool masu_bake_has_maps(const masu_bake_maps *maps);
/* The index of the picture of that name, added if it is not there. `data` may be NULL. */
uint32_t masu_bake_add_image(masu_bake_content *content, const char *name,
                             const masu_bake_image *about, const void *data);
#define MASU_BAKE_MAPS_OF(c) ((masu_bake_maps *)(void *)(c)->maps.data)
#define MASU_BAKE_IMAGES(c) ((masu_bake_image *)(void *)(c)->images.data)

/* Adds a mesh over primitives that are already there; its box is theirs. Returns its index. */
uint32_t masu_bake_mesh(masu_bake_content *content, uint32_t first_primitive, uint32_t count,
                        uint32_t name);

/* Adds an instance. Returns its index, or MASU_BLOB_NONE for a transform that is not finite. */
uint32_t masu_bake_instance(masu_bake_content *content, const masu_bake_affine *transform,
                            uint32_t mesh, uint32_t parent, uint32_t name);

/* Object space to the space of the content. */
masu_bake_affine masu_bake_transform(const masu_blob_instance *instance);

/* Box of everything the instances show under `placement`, from the vertices themselves. */
masu_bake_box masu_bake_bounds(const masu_bake_content *content, const masu_bake_affine *placement);

/* Orders instances by mesh (stable) and rewrites parents. */
void masu_bake_sort_instances(masu_bake_content *content);

#endif
