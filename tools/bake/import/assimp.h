/* assimp.h: Assimp's picture of a model becomes ours; runs in a child process (import.h). Of glTF that picture is
 * by our own reader (gltf.h).
 *
 *   assimp.c            the library is called; what it lost is told
 *   assimp_material.c   aiMaterial  -> factors, and names of pictures that bake/texture reads
 *   assimp_mesh.c       aiMesh      -> one or more primitives (bake/mesh/triangles.c filters and welds)
 *   assimp_nodes.c      aiNode with meshes -> an instance; nodes that show the same set of meshes share
 *                       one mesh; aiLight -> a light of the nearest node above that is an instance
 *   vertex_color.c      colours of vertices -> materials
 *   assimp_skin.c       aiNode, aiBone, aiAnimation of models that move: nodes, skins, clips
 *   assimp_text.c       its strings, and lines of text
 *
 * Nothing that Assimp returns is believed: indices, counts of faces, strings and transforms are
 * checked here, and what cannot be shown is counted and named in a warning. The process ends when the
 * piece has been sent: little is released. */
#ifndef MASU_BAKE_ASSIMP_H
#define MASU_BAKE_ASSIMP_H

#include "bake/import/model.h"
#include "bake/mesh/triangles.h"

#include <assimp/scene.h>

#define MASU_IMPORT_NAMES_MAX 4 /* in one warning; the rest is counted */

typedef struct masu_import_range {
    uint32_t first, count;
} masu_import_range;

/* A set of aiMeshes that some node shows, and the masu mesh made for it. */
typedef struct masu_import_set {
    const unsigned *meshes;
    unsigned count;
    uint32_t mesh;
    struct masu_import_set *next; /* another set with the same first mesh */
} masu_import_set;

/* What mesh/triangles.c could not use, over all meshes. */
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
    uint32_t parent;   /* of these, or MASU_BLOB_NONE */
    uint32_t instance; /* or MASU_BLOB_NONE */
    bool needed;
    uint32_t number; /* of the piece's nodes, once it is needed */
} masu_import_node;

/* A material as gltf.h makes it: nothing of it is an aiMaterial's. */
typedef struct masu_import_given {
    masu_blob_material material;
    masu_bake_maps maps;
    const char *name;
} masu_import_given;

typedef struct masu_import {
    const struct aiScene *source;
    /* Of our own reader, else NULL: then texture coordinates are as the pictures want them. */
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
    /* By aiMaterial, and behind them the default one; NULL: not read. */
    masu_import_given **material;
    masu_bake_buffer textures;
    masu_import_loss losses[MASU_LOSSES];
    uint64_t triangles;
    uint32_t texture_count, bad_nodes, skins, unmapped, turned;
    uint64_t clamped; /* triangles, of vertex colours: vertex_color.h */
    uint32_t phong;          /* materials with a specular exponent or colour */
    uint32_t translucent;    /* meshes whose vertex colours have an alpha */
    uint32_t invisible;    /* materials with an opacity of 0 */
    uint32_t other_lights; /* that shine from or to nowhere */
    bool full, moving;
    bool plays; /* moving only if there are clips */
    /* Of a model that has skins, or that moves and has clips: */
    bool live;
    uint32_t crowded, unbound; /* vertices of more than four joints, of none */
    uint32_t unordered;        /* keys before the previous one */
    uint32_t lost_joints;      /* that are no nodes */
    masu_bake_buffer nodes; /* masu_import_node */
    masu_bake_buffer skin_nodes; /* uint32_t: of each skin the node that shows it */
    masu_bake_content bent; /* meshes with bones, as they are bound: their mesh_parts are of it */
    /* masu_bake_influence of each of its vertices; joints are bones, */
    masu_bake_buffer influences;
                                 /* or their count: none */
} masu_import;

/* ---- assimp_text.c ---- */

void masu_import_format(masu_bake_buffer *buffer, const char *format, ...);
int masu_import_length(const struct aiString *s);
/* Names end up in lines of text: a line break in one must not start another. */
void masu_import_name(masu_bake_buffer *buffer, const char *text, int length);
/* NaN becomes `low`. */
float masu_import_clamped(double value, double low, double high);

/* ---- the others ---- */

/* A material, read once; one that there is not is the default one. */
const masu_import_given *masu_import_read_material(masu_import *m, unsigned index);
/* The piece's number of it, times a colour (linear, or NULL). colored: its vertices have
 * colours. */
uint32_t masu_import_material(masu_import *m, unsigned index, const double *color, bool colored);
/* Of a colour that was chosen on a screen, the linear one. */
double masu_import_decode_srgb(double c);
/* Converts an aiMesh, once. */
void masu_import_mesh(masu_import *m, unsigned index);
void masu_import_report_losses(masu_import *m);
/* Over all nodes. With `convert` their meshes are converted; without, then, instances and lights
 * are made. False: the nodes form a cycle, or are too many. */
bool masu_import_walk(masu_import *m, bool convert);
/* ---- assimp_skin.c ---- */

/* Whether its nodes are kept: for skins, which need them to rest, and for clips if it is moving. */
bool masu_import_is_live(const struct aiScene *scene, bool moving);
/* Of a model that does not move its vertices are enough: what would move them goes. */
void masu_import_forget(masu_import *m);
/* Whether a mesh is kept in `bent`. */
bool masu_import_bends(const masu_import *m, unsigned mesh);
/* Converts its triangles into `bent`. */
void masu_import_bent_mesh(masu_import *m, const struct aiMesh *mesh, masu_bake_triangles *triangles,
                           masu_bake_losses *lost);
/* After the walk that made instances: meshes with bones become instances of their own, in their
 * rest pose; nodes that anything needs, skins and clips become sections of the piece. */
void masu_import_live(masu_import *m);

/* A file may hold meshes and no nodes: each is then shown once, where it is. */
void masu_import_show_all(masu_import *m);

#endif
