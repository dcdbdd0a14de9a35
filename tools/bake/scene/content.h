/* content.h: a scene during baking: one growing array per section of the blob.
 *
 * The same structure holds a whole scene, one imported model or one procedural shape. Pieces are
 * built separately (a model even in another process, see bake/import), checked, and appended to the
 * scene with a placement. Elements are the blob's own structs, so writing is copying.
 *
 *   content.c   the arrays, names, materials, bounds, order of instances
 *   piece.c     adds pieces to a scene, with the scene's changes to their materials
 *   check.c     checks a piece from another process by the rules of blob.h
 *   groups.c    the tree of groups for culling
 *   camera.c    cameras of model files
 *   sun.c       directional lights of model files
 *
 * The function that declares a content owns it and releases it. Running out of memory ends the
 * program with a message; otherwise functions fail only if their comment says so. */
#ifndef MASU_BAKE_CONTENT_H
#define MASU_BAKE_CONTENT_H

#include "bake/base/buffer.h"
#include "bake/base/math.h"
#include "scene/blob.h"

typedef struct masu_bake_content {
    masu_bake_buffer section[MASU_BLOB_KIND_COUNT]; /* by masu_blob_kind */
    /* The textures that materials request; bake/texture/texture.c makes sections from them at the
     * end. */
    masu_bake_buffer maps;       /* masu_bake_maps, one per material */
    masu_bake_buffer images;     /* masu_bake_image */
    masu_bake_buffer image_text; /* their names, each with its NUL */
    masu_bake_buffer image_data; /* files embedded in a model */
    masu_bake_buffer cameras;    /* masu_bake_camera: bake/scene/camera.h */
    masu_bake_buffer suns;       /* masu_bake_sun: bake/scene/sun.h */
    float sdf_glossiest;         /* least roughness of the SDF's surfaces */
    masu_bake_buffer
        traced; /* for the first instances, the scene's tracing setting: bake/mesh/bvh.h */
    /* Small copies of the textures for traced rays: bake/texture/trace_texture.h. */
    masu_bake_buffer pictures;       /* masu_bake_trace_row */
    masu_bake_buffer picture_texels; /* uint32_t */
    uint32_t picture_side;           /* texels along the longer side; 0: no colours are kept */
    bool pictures_wanted;
    uint32_t names_cut;
} masu_bake_content;

/* An image: a file, or `data_bytes` of an embedded one at `data` of image_data; the name of an
 * embedded image is generated. */
typedef struct masu_bake_image {
    uint32_t name;                  /* offset into image_text */
    uint32_t raw_width, raw_height; /* size of raw BGRA texels; 0: the data are a file */
    /* 1: in a folder that its model may not name; only the texture paths are searched */
    uint32_t outside;
    uint64_t data, data_bytes;
} masu_bake_image;

/* The uses of images. Roughness and metallic are separate here, because they may be one image or
 * two. */
enum {
    MASU_BAKE_BASE,
    MASU_BAKE_NORMAL,
    MASU_BAKE_ROUGHNESS,
    MASU_BAKE_METALLIC,
    MASU_BAKE_EMISSIVE,
    /* alpha as a separate image; with `transmission` the share that is transmitted */
    MASU_BAKE_OPACITY,
    MASU_BAKE_OCCLUSION,
    MASU_BAKE_COAT, /* separate, as roughness and metallic are */
    MASU_BAKE_COAT_ROUGHNESS,
    MASU_BAKE_COAT_NORMAL,   /* of a coat with other normals than the base */
    MASU_BAKE_LOBE_COLOR,    /* of a specular colour or a sheen */
    MASU_BAKE_LOBE_STRENGTH, /* of a specular factor or the roughness of a sheen */
    MASU_BAKE_MAPS
};

/* AUTO: the image decides whether it is a mask. COVERS: the format defines alpha as coverage; it is
 * a mask if any alpha is below the cut-off. */
enum {
    MASU_BAKE_ALPHA_AUTO,
    MASU_BAKE_ALPHA_OPAQUE,
    MASU_BAKE_ALPHA_MASK,
    MASU_BAKE_ALPHA_BLEND,
    MASU_BAKE_ALPHA_COVERS
};

/* The format of a normal map, as the model specifies it. */
enum {
    MASU_BAKE_RELIEF_NORMALS,       /* normals, unconditionally */
    MASU_BAKE_RELIEF_NAMED_NORMALS, /* normals, unless the image is grey: then heights */
    MASU_BAKE_RELIEF_NAMED_HEIGHTS  /* heights, unless the image contains normals */
};

/* The layers that use the normal map: a coat, its base, or both; the other one has the mesh's
 * normal. */
enum { MASU_BAKE_RELIEF_OF_BOTH, MASU_BAKE_RELIEF_OF_BASE, MASU_BAKE_RELIEF_OF_COAT };

/* Whether vertices have colours, which multiply the base colour, and alpha below 1. */
enum { MASU_BAKE_COLORED_NOT, MASU_BAKE_COLORED, MASU_BAKE_COLORED_ALPHA };

#define MASU_BAKE_WRAP_REPEAT 3 /* repeats even if coordinates are within 0..1 */

typedef struct masu_bake_maps {
    uint32_t image[MASU_BAKE_MAPS];  /* MASU_BLOB_NONE: no such map */
    uint8_t channel[MASU_BAKE_MAPS]; /* 0..3: the image's channel, for maps of one channel */
    uint8_t gloss;                   /* roughness is 1 minus the image */
    uint8_t alpha;                   /* MASU_BAKE_ALPHA_* */
    uint8_t additive;                /* with ALPHA_BLEND: adds its light, occludes nothing */
    uint8_t single;                  /* 1: invisible from behind */
    uint8_t wrap[2]; /* as in masu_blob_texture_set; or MASU_BAKE_WRAP_REPEAT */
    uint8_t relief;                  /* MASU_BAKE_RELIEF_* */
    uint8_t relief_of;               /* MASU_BAKE_RELIEF_OF_* */
    /* with ALPHA_BLEND: transmitted light is tinted by the base colour */
    uint8_t tinted;
    /* Emission is the base colour: the factor, if there is no image. */
    uint8_t unlit;
    uint8_t dark;                    /* emission was meant for a map that the importer dropped */
    uint8_t shadowless;              /* 1: casts no shadows */
    uint8_t colored;                 /* MASU_BAKE_COLORED_* */
    uint8_t second; /* bit of a slot of a texture set: its map uses the second coordinates */
    uint8_t nearest;                 /* 1: magnified without interpolation */
    uint8_t transmission;            /* with `tinted`: the opacity map is the transmission */
    float cutoff, normal_scale;      /* normal_scale: for height maps their strength */
    float occlusion;                 /* strength of the occlusion map, 0..1 */
    float coat_scale;                /* as normal_scale, for the coat's map */
    /* no padding: compared as bytes */
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

/* COLORS and TEXCOORDS_1 end with the last vertex whose values differ from white and 0.
 * masu_bake_pad_attributes makes them as long as the vertices, unless they are empty. */
typedef struct masu_bake_attributes {
    uint32_t color; /* encoded as masu_blob_color: MASU_BLOB_WHITE */
    float texcoord[2];
} masu_bake_attributes;
/* Adds the attributes of the last added vertex. */
void masu_bake_add_attributes(masu_bake_content *content, const masu_bake_attributes *attributes);
masu_bake_attributes masu_bake_attributes_of(const masu_bake_content *content, uint64_t vertex);
/* Copies the attributes of `count` vertices from `first` on to the last `count` added vertices. */
void masu_bake_copy_attributes(masu_bake_content *to, const masu_bake_content *from, uint64_t first,
                               uint64_t count);
void masu_bake_pad_attributes(masu_bake_content *content);
/* `color` is linear, with alpha. */
uint32_t masu_bake_encode_color(const float color[4]);

/* A name's offset. Control characters and broken UTF-8 become '?'; an empty name is NONE; a name
 * longer than the blob's limit is cut, and counted. */
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
/* The index of the image of that name, added if it is missing. `data` may be NULL. */
uint32_t masu_bake_add_image(masu_bake_content *content, const char *name,
                             const masu_bake_image *about, const void *data);
#define MASU_BAKE_MAPS_OF(c) ((masu_bake_maps *)(void *)(c)->maps.data)
#define MASU_BAKE_IMAGES(c) ((masu_bake_image *)(void *)(c)->images.data)

/* Adds a mesh with existing primitives; its bounds are theirs. Returns its index. */
uint32_t masu_bake_mesh(masu_bake_content *content, uint32_t first_primitive, uint32_t count,
                        uint32_t name);

/* Adds an instance. Returns its index, or MASU_BLOB_NONE for a transform that is not finite. */
uint32_t masu_bake_instance(masu_bake_content *content, const masu_bake_affine *transform,
                            uint32_t mesh, uint32_t parent, uint32_t name);

/* Object space to the space of the content. */
masu_bake_affine masu_bake_transform(const masu_blob_instance *instance);

/* Bounds of all instances under `placement`, from the vertices themselves. */
masu_bake_box masu_bake_bounds(const masu_bake_content *content, const masu_bake_affine *placement);

/* Orders instances by mesh (stable) and rewrites parents. */
void masu_bake_sort_instances(masu_bake_content *content);

#endif
