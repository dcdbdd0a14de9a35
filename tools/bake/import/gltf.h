/* gltf.h: Masu's reader for glTF 2.0, .gltf and .glb; runs in a child process (import.h).
 *
 * It fills an aiScene, as Assimp does (assimp.h), so that one converter makes the pieces of both.
 * Materials have a separate form, because Assimp's lose too much of glTF's. Reasons for a separate
 * reader: Assimp 5.2 supports the glTF of 2019 and silently drops unknown features. Debian's
 * tinygltf is C++, includes a JSON parser and an image decoder, and supports neither quantization
 * nor meshopt. The tools already use jansson for JSON and meshoptimizer for LODs.
 *
 *   gltf.c            a file: its two containers, buffers, extensions that it requires, notes
 *   gltf_json.c       members of its JSON, each of a type
 *   gltf_access.c     views and accessors to numbers; EXT_meshopt_compression
 *   gltf_material.c   materials and the names of their images
 *   gltf_mesh.c       primitives: triangles, morph weights, vertex colours
 *   gltf_nodes.c      nodes, instances, skins, lights, cameras
 *   gltf_clip.c       animations
 *   gltf_draco.cpp    KHR_draco_mesh_compression, by libdraco
 *
 * Files are untrusted: every index, view and accessor is checked before use. The first error ends
 * the reading, with a message that names its position. Well-formed features that are not supported
 * are counted in a note, one for each kind with the first name; each note becomes one warning.
 *
 * All memory is in one pool, which masu_gltf_release frees. */
#ifndef MASU_BAKE_GLTF_H
#define MASU_BAKE_GLTF_H

#include "bake/import/assimp.h"

#include <jansson.h>

typedef struct masu_gltf_bytes {
    const unsigned char *data; /* NULL: none, or not read yet */
    size_t bytes;
} masu_gltf_bytes;

typedef struct masu_gltf_note {
    struct masu_gltf_note *next;
    const char *what, *first;
    uint64_t count;
} masu_gltf_note;

/* A material, with the vertex data that it needs. */
typedef struct masu_gltf_material {
    masu_import_given given;
    int set;         /* of the texture coordinates: TEXCOORD_n */
    double uv[6];    /* rows of the transform from them to texture coordinates */
    int second_set;      /* the same for the maps of given.maps.second */
    double second_uv[6];
    double alpha;    /* of the base colour */
    bool blends, unlit;
} masu_gltf_material;

/* A primitive with one skin and one set of morph weights: one aiMesh, or several if it has several
 * colours. */
typedef struct masu_gltf_made {
    struct masu_gltf_made *next;
    json_int_t skin;       /* -1: none */
    const json_t *weights; /* the weights of the node itself, or NULL */
    const unsigned *meshes;
    unsigned count;
} masu_gltf_made;

typedef struct masu_gltf {
    const char *path;        /* NULL: only bytes, with no external files */
    const char *variant;     /* of KHR_materials_variants, or NULL */
    masu_bake_textures wanted;
    bool moving, plays;      /* morph targets are kept: always, or if there are animations */
    masu_bake_content *piece; /* receives the images */
    masu_bake_buffer *warnings, *error;
    json_t *root;
    masu_bake_pool pool;
    masu_gltf_bytes file, chunk; /* chunk: the binary chunk of a .glb */
    masu_gltf_bytes *buffers, *views; /* views: only those that have been decompressed */
    size_t buffer_count, view_count;
    char where[192]; /* the current object, for errors */
    masu_gltf_note *notes;
    json_int_t variant_index; /* -1: none */
    masu_gltf_material *materials; /* of the file, then the default one */
    size_t material_count;
    masu_bake_buffer given;  /* masu_import_given: by aiMesh.mMaterialIndex */
    masu_bake_buffer meshes; /* struct aiMesh * */
    masu_gltf_made **made;   /* by mesh of the file */
    size_t mesh_count;
    struct aiNode *nodes; /* by node of the file; then instances, then a root */
    size_t node_count;
    masu_bake_buffer lights; /* struct aiLight * */
    masu_bake_buffer ranges; /* float, one of each light */
    masu_bake_buffer cameras; /* struct aiCamera * */
    struct aiScene scene;
} masu_gltf;

/* True if a file is glTF, by its name or its first bytes (.vrm, ...). */
bool masu_gltf_is_file(const char *path);
/* Reads the whole file; set path, variant, wanted, piece, warnings and error of g first. False: one
 * line in error. */
bool masu_gltf_read(masu_gltf *g);
/* The same for a file in memory. */
bool masu_gltf_read_bytes(masu_gltf *g, const unsigned char *data, size_t bytes);
void masu_gltf_release(masu_gltf *g);

/* ---- gltf.c ---- */

/* Writes one line, prefixed by g->where, unless there already is an error. Always returns false. */
bool masu_gltf_fail(masu_gltf *g, const char *format, ...);
bool masu_gltf_failed(const masu_gltf *g);
/* Counts an object with an unsupported feature; first: the object's name. */
void masu_gltf_note_one(masu_gltf *g, const char *what, const char *first);
void masu_gltf_note_many(masu_gltf *g, uint64_t count, const char *what, const char *first);
/* "meshes", 3: sets g->where to the current object, with its name if it has one. */
void masu_gltf_at(masu_gltf *g, const char *array, size_t index, const json_t *object);
/* The object's name, or "meshes[3]"; allocated in the pool. */
const char *masu_gltf_name_of(masu_gltf *g, const char *array, size_t index, const json_t *object);
/* The bytes of a URI: `data:`, or a file next to the model. False: not available. */
bool masu_gltf_fetch(masu_gltf *g, const char *uri, masu_gltf_bytes *out);
/* The path of a URI, by the search of picture_path.h; allocated in the pool. NULL: the URI names no
 * file. outside: the file must not be read. */
const char *masu_gltf_path(masu_gltf *g, const char *uri, bool *outside);
bool masu_gltf_is_data(const char *uri);
void *masu_gltf_take(masu_gltf *g, size_t count, size_t size);

/* ---- gltf_json.c: absent members do not change the output; a wrong type fails ---- */

const json_t *masu_gltf_object(masu_gltf *g, const json_t *of, const char *name);
const json_t *masu_gltf_array(masu_gltf *g, const json_t *of, const char *name);
const char *masu_gltf_string(masu_gltf *g, const json_t *of, const char *name);
bool masu_gltf_number(masu_gltf *g, const json_t *of, const char *name, double *out);
bool masu_gltf_numbers(masu_gltf *g, const json_t *of, const char *name, size_t count, double *out);
bool masu_gltf_flag(masu_gltf *g, const json_t *of, const char *name, bool *out);
/* An unsigned number of at most 2^53. */
bool masu_gltf_size(masu_gltf *g, const json_t *of, const char *name, uint64_t *out);
/* An index below `count`; -1: absent. False: failed. */
bool masu_gltf_index(masu_gltf *g, const json_t *of, const char *name, size_t count,
                     json_int_t *out);
const json_t *masu_gltf_extension(masu_gltf *g, const json_t *of, const char *name);
/* An element of an array of the file; masu_gltf_index has checked the index. NULL and failed: not
 * an object. */
const json_t *masu_gltf_element(masu_gltf *g, const char *array, json_int_t index);
size_t masu_gltf_count(const masu_gltf *g, const char *array);

/* ---- gltf_access.c ---- */

/* The numbers of an accessor; normalised integers become fractions. components: the required
 * number, or 0. NULL: failed. */
float *masu_gltf_floats(masu_gltf *g, json_int_t accessor, unsigned components, uint32_t *count,
                        unsigned *found);
/* Accepts only unsigned integers. */
uint32_t *masu_gltf_integers(masu_gltf *g, json_int_t accessor, unsigned components,
                             uint32_t *count);
/* The bytes of a view, decompressed if necessary. */
bool masu_gltf_view(masu_gltf *g, json_int_t view, masu_gltf_bytes *out, size_t *stride);

/* ---- gltf_draco.cpp ---- */

/* A decompressed primitive. All attributes are floats, including joints. */
typedef struct masu_gltf_draco {
    void *mesh;
    uint32_t points, faces;
} masu_gltf_draco;

#ifdef __cplusplus
extern "C" {
#endif
bool masu_gltf_draco_open(const unsigned char *data, size_t bytes, masu_gltf_draco *out);
void masu_gltf_draco_indices(const masu_gltf_draco *draco, uint32_t *out); /* 3 * faces */
/* Components of an attribute, at most 4; 0: absent. */
unsigned masu_gltf_draco_components(const masu_gltf_draco *draco, uint32_t id);
bool masu_gltf_draco_floats(const masu_gltf_draco *draco, uint32_t id, unsigned components,
                            float *out);
void masu_gltf_draco_close(masu_gltf_draco *draco);
#ifdef __cplusplus
}
#endif

/* ---- the other files; false: failed ---- */

bool masu_gltf_read_materials(masu_gltf *g);
/* The aiMesh material number for a material of the file with a colour factor (linear, with alpha);
 * -1: the default material. colored: MASU_BAKE_COLORED_*, of its vertices. */
unsigned masu_gltf_given(masu_gltf *g, json_int_t material, const double color[4], int colored);
/* The aiMeshes of a mesh of the file with a skin and a node's morph weights. */
bool masu_gltf_make_mesh(masu_gltf *g, json_int_t mesh, json_int_t skin, const json_t *weights,
                         const masu_gltf_made **out);
bool masu_gltf_read_nodes(masu_gltf *g);
bool masu_gltf_read_clips(masu_gltf *g);
void masu_gltf_set_string(struct aiString *to, const char *text);

#endif
