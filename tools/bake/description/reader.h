/* reader.h: the parts of reading a scene description; see description.h. Each reads members of an
 * object and returns false after reporting. Only read.c calls them. */
#ifndef MASU_BAKE_READER_H
#define MASU_BAKE_READER_H

#include "bake/base/json.h"
#include "bake/description/description.h"

typedef struct masu_bake_reader {
    const char *directory;        /* of the scene's file: relative names start there */
    const char *models_directory; /* what "@assimp/" stands for */
    /* Shadows, occlusion and reflections only if requested. */
    bool bare;
    masu_bake_description *out;
} masu_bake_reader;

/* The path of a file that the scene names, allocated in the description's pool. Only models and
 * images may begin with "@assimp/". */
const char *masu_bake_path(const masu_bake_reader *r, const char *name);
const char *masu_bake_model_path(const masu_bake_reader *r, const char *name);

/* Members of the scene. */
bool masu_bake_read_models(const masu_bake_json *scene, masu_bake_reader *r);
bool masu_bake_read_lights(const masu_bake_json *scene, masu_bake_reader *r);
bool masu_bake_read_sdf(const masu_bake_json *scene, masu_bake_reader *r);
bool masu_bake_read_look(const masu_bake_json *scene, masu_bake_reader *r);
bool masu_bake_read_environment(const masu_bake_json *scene, masu_bake_reader *r);
bool masu_bake_read_detail(const masu_bake_json *scene, masu_bake_reader *r);
bool masu_bake_read_probes(const masu_bake_json *scene, masu_bake_reader *r);
bool masu_bake_read_bounce(const masu_bake_json *scene, masu_bake_reader *r);
bool masu_bake_read_reflections(const masu_bake_json *scene, masu_bake_reader *r);

/* A .sdf without a scene: bounds of its parts give the drawn area and the camera. */
bool masu_bake_describe_sdf(const masu_bake_options *options, masu_bake_description *out);

/* A model's "material" and "materials". */
bool masu_bake_read_materials(const masu_bake_json *model, masu_bake_reader *r,
                              masu_bake_model *out);

#endif
