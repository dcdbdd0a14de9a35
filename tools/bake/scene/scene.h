/* scene.h: what masu-bake is asked to bake, a scene description or a bare model, read into
 * content that only lacks the order of its instances and the check.
 *
 *   scene.c    the scene's JSON (docs/scene.md)
 *   place.c    models and procedural meshes: import, fit, placement, material override
 *   bake/light/lights.c   points and spots
 *   look.c     camera, sun, sky, and their defaults */
#ifndef MASU_BAKE_SCENE_H
#define MASU_BAKE_SCENE_H

#include "bake/mesh/bvh.h"
#include "bake/scene/content.h"
#include "bake/scene/import.h"
#include "bake/mesh/detail.h"
#include "bake/scene/json.h"
#include "bake/mesh/occluders.h"
#include "bake/light/probes.h"

/* What a scene asks to be made of its meshes, and what came of it. */
typedef struct masu_bake_detail {
    uint32_t levels; /* LODs per mesh, 0: none */
    double least;    /* occluders for what is this large, metres; 0: none */
    masu_bake_lod_report lods;
    masu_bake_occluder_report occluders;
} masu_bake_detail;

typedef struct masu_bake_request {
    const char *input;
    masu_bake_textures textures; /* WANTED or OFF */
    const char *texture_path;     /* folders with ':' between, or NULL */
    bool variants;                /* with the marching variants for comparisons */
    const char *models_directory; /* what "@assimp/" stands for */
    masu_bake_detail *detail;     /* filled */
    masu_bake_reflections *reflections; /* filled in */
    masu_bake_probe_settings *probes; /* what the scene says of them is filled in */
} masu_bake_request;

/* Every function here reports its own errors and returns false after one. */
bool masu_bake_read_scene(const masu_bake_request *request, masu_bake_content *content);
bool masu_bake_bare_model(const masu_bake_request *request, masu_bake_content *content);

/* The scene's "models" array. `directory`: of the scene file, for relative names. */
bool masu_bake_read_models(const masu_bake_json *scene, const char *directory,
                           const masu_bake_request *request, masu_bake_content *content);

/* The scene's "lights" array, behind those that models have brought along. */
bool masu_bake_read_lights(const masu_bake_json *scene, masu_bake_content *content);

/* Camera keys and environment; defaults frame `bounds`, which may be empty. */
bool masu_bake_read_look(const masu_bake_json *scene, const masu_bake_box *bounds,
                         masu_bake_content *content);
void masu_bake_default_look(const masu_bake_box *bounds, masu_bake_content *content);

#endif
