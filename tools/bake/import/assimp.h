/* assimp.h: converts an aiScene to a piece; runs in a child process (import.h). For glTF, Masu's
 * reader makes the aiScene (gltf.h).
 *
 *   assimp.c            calls the library and reports what the import lost
 *   assimp_material.c   aiMaterial  -> factors, and names of images that bake/texture reads
 *   assimp_mesh.c       aiMesh      -> primitives (bake/mesh/triangles.c filters, welds)
 *   assimp_nodes.c      aiNode with meshes -> an instance; nodes that show the same set of meshes
 *                       share one mesh; aiLight -> a light of the nearest instance above
 *   vertex_color.c      vertex colours -> materials
 *   assimp_skin.c       aiNode, aiBone, aiAnimation of animated models: nodes, skins, clips
 *   assimp_text.c       its strings, and lines of text
 *
 * Nothing that Assimp returns is trusted: indices, face counts, strings and transforms are checked
 * here. Objects that cannot be shown are counted and named in a warning. The process ends after the
 * piece has been sent, so little is released. */
#ifndef MASU_BAKE_ASSIMP_H
#define MASU_BAKE_ASSIMP_H

#include "bake/import/model.h"
#include "bake/mesh/triangles.h"

#include <assimp/scene.h>

#define MASU_IMPORT_NAMES_MAX 4 /* in one warning; the others are only counted */

typedef struct masu_import_range {
    uint32_t first, count;
} masu_import_range;

/* A set of aiMeshes that some node shows, and its masu mesh. */
typedef struct masu_import_set {
    const unsigned *meshes;
    unsigned count;
    uint32_t mesh;
    struct masu_import_set *next; /* another set with the same first mesh */
} masu_import_set;

/* Reasons for which mesh/triangles.c drops triangles, over all meshes. */
enum {
    MASU_LOST_INDEX,
    MASU_LOST_POSITION,
    MASU_LOST_AREA,
    MASU_LOST_NORMAL,
    MASU_LOST_TEXCOORD,
    MASU_LOST_FACE,
    MASU_LOSSES
};

typedef struct masu_import_loss {
    uint64_t count;
    uint32_t meshes;
    masu_bake_buffer names; /* of the first few */
} masu_import_loss;

/* A node of a file whose nodes are kept. */
typedef struct masu_import_node {
    const struct aiNode *node;
    masu_bake_affine local, world;
    uint32_t parent;   /* index among these nodes, or MASU_BLOB_NONE */
    uint32_t instance; /* or MASU_BLOB_NONE */
    bool needed;
    uint32_t number; /* index among the piece's nodes, assigned on demand */
} masu_import_node;

/* A material from gltf.h, which does not use aiMaterial. */
typedef struct masu_import_given {
    masu_blob_material material;
    masu_bake_maps maps;
    const char *name;
} masu_import_given;

typedef struct masu_import {
    const struct aiScene *source;
    /* Set by Masu's glTF reader, else NULL: texture coordinates then already have their
     * transforms. */
    const masu_import_given *given; /* by aiMesh.mMaterialIndex */
    const float *ranges;            /* by aiLight */
    const char *path;
    masu_bake_textures wanted;
    masu_bake_content *piece;
    masu_bake_buffer *warnings;
    masu_blob_primitive *parts;    /* primitives as converted, before meshes group them */
    masu_import_range *mesh_parts; /* by aiMesh: its range of parts */
    bool *mesh_done, *mesh_used;
    masu_import_set **sets; /* by aiMesh: sets that begin with it */
    /* By aiMaterial, then the default one; NULL: not read yet. */
    masu_import_given **material;
    masu_bake_buffer textures;
    masu_import_loss losses[MASU_LOSSES];
    uint64_t triangles;
    uint32_t texture_count, bad_nodes, skins, unmapped, turned;
    uint64_t clamped; /* triangles, by vertex colours out of range: vertex_color.h */
    uint32_t phong;          /* materials with a specular exponent or colour */
    uint32_t translucent;    /* meshes whose vertex colours have an alpha */
    uint32_t invisible;    /* materials with an opacity of 0 */
    uint32_t other_lights; /* lights without a usable position or direction */
    bool full, moving;
    bool plays; /* animated only if there are clips */
    /* For a model that has skins, or that is animated and has clips: */
    bool live;
    uint32_t crowded, unbound; /* vertices with more than four joints, with none */
    uint32_t unordered;        /* keys before the previous one */
    uint32_t lost_joints;      /* that are not nodes */
    masu_bake_buffer nodes; /* masu_import_node */
    masu_bake_buffer skin_nodes; /* uint32_t: for each skin the node that shows it */
    masu_bake_content bent; /* meshes with bones in the bind pose; their mesh_parts index it */
    /* masu_bake_influence of each of its vertices; joints are bones, or the number of bones:
     * none */
    masu_bake_buffer influences;
} masu_import;

/* ---- assimp_text.c ---- */

void masu_import_format(masu_bake_buffer *buffer, const char *format, ...);
int masu_import_length(const struct aiString *s);
/* Names are written to lines of text: a line break in a name must not start another line. */
void masu_import_name(masu_bake_buffer *buffer, const char *text, int length);
/* NaN becomes `low`. */
float masu_import_clamped(double value, double low, double high);

/* ---- the other files ---- */

/* A material, read once; the default material if the index is out of range. */
const masu_import_given *masu_import_read_material(masu_import *m, unsigned index);
/* The piece's index for a material times a colour (linear, or NULL). colored: its vertices have
 * colours. */
uint32_t masu_import_material(masu_import *m, unsigned index, const double *color, bool colored);
/* Decodes an sRGB component to linear. */
double masu_import_decode_srgb(double c);
/* Converts an aiMesh, once. */
void masu_import_mesh(masu_import *m, unsigned index);
void masu_import_report_losses(masu_import *m);
/* Visits all nodes. With `convert`, converts their meshes; without it, which comes second, makes
 * instances and lights. False: the nodes form a cycle, or are too many. */
bool masu_import_walk(masu_import *m, bool convert);
/* ---- assimp_skin.c ---- */

/* True if the nodes are kept: for skins, whose rest pose needs them, and for clips if `moving`. */
bool masu_import_is_live(const struct aiScene *scene, bool moving);
/* Drops the animation data of a static model and keeps its vertices. */
void masu_import_forget(masu_import *m);
/* True if a mesh is kept in `bent`. */
bool masu_import_bends(const masu_import *m, unsigned mesh);
/* Converts the triangles of a mesh into `bent`. */
void masu_import_bent_mesh(masu_import *m, const struct aiMesh *mesh,
                           masu_bake_triangles *triangles, masu_bake_losses *lost);
/* Called after the walk that made instances. Meshes with bones become separate instances in their
 * rest pose; the nodes that anything uses, skins and clips become sections of the piece. */
void masu_import_live(masu_import *m);

/* A file may have meshes and no nodes: each mesh is then shown once, without a transform. */
void masu_import_show_all(masu_import *m);

#endif
