/* description.h: a scene description as plain values. Every member is checked, and defaults are
 * filled in unless they depend on the contents of the files that it names. Nothing has been built:
 * no model has been opened, nothing has an index in the blob. docs/scene.md is the reference of the
 * members.
 *
 *   read.c            the file and its members, in order
 *   read_models.c     models: files, procedural meshes, placements
 *   read_materials.c  changes to a model's materials
 *   read_view.c       camera, sun, sky, fog, exposure, environment map
 *   read_lights.c     punctual lights
 *   read_sdf.c        the SDF and its parameters
 *   read_quality.c    LODs, occluders, probes, reflections
 *
 * The values, arrays and texts are in the description's pool. A model without a scene also has a
 * description: one model, otherwise defaults. Reading can fail: an error is reported in one line
 * with its position in the file, before anything is built. */
#ifndef MASU_BAKE_DESCRIPTION_H
#define MASU_BAKE_DESCRIPTION_H

#include "bake/description/options.h"
#include "bake/light/probes.h"
#include "bake/mesh/bvh.h"
#include "bake/mesh/shape.h"
#include "bake/scene/piece.h"
#include "bake/shader/sdf.h"

#define MASU_BAKE_SPARE_MAX 4096u
#define MASU_BAKE_FOV_Y 40.0        /* degrees, the default */
/* Degrees, for SDF shadows, the default. */
#define MASU_BAKE_SUN_RADIUS 0.27

/* Changes to a model's materials: values, and names that have no index in the scene yet. */
typedef struct masu_bake_material_change {
    masu_bake_override value;            /* map[i]: picture[i] is given */
    const char *picture[MASU_BAKE_MAPS]; /* image files */
    masu_blob_meso meso;                 /* if value.meso */
} masu_bake_material_change;

/* Target length of the longest side of a model's bounds, and their position. */
typedef struct masu_bake_fit {
    bool wanted, center,
        base;    /* the bounds' centre, or the centre of their lower face, is moved to `at` */
    double size; /* metres; 0: unchanged */
    masu_bake_vec3 at;
} masu_bake_fit;

typedef enum masu_bake_hides {
    MASU_BAKE_HIDES_NOTHING,
    MASU_BAKE_HIDES_WHOLE,
    MASU_BAKE_HIDES_BOX
} masu_bake_hides;

typedef struct masu_bake_model {
    const char
        *where; /* position in the description, for errors: "models[3]"; "": the whole file */
    const char *file;  /* NULL: procedural */
    uint32_t shape;    /* index into the description's shapes, if there is no file */
    const char *variant; /* of the file's materials, or NULL */
    const char *name;  /* before the instances' names, or NULL */
    const char *group; /* "outer/inner", or NULL */
    bool moving; /* the host can move it as a model of the scene */
    bool plays;  /* movable if its file has clips; decided during building */
    bool hidden; /* initially; the model is then movable */
    uint32_t spare; /* number of additional hidden copies, if movable */
    double merge;               /* cell size, metres; 0: as in the file */
    double lights;              /* factor of its lights' colours; 0: no lights */
    masu_bake_affine placement; /* scale and rotation, before the fit */
    masu_bake_fit fit;
    masu_bake_vec3 translation;
    bool drop;     /* drop onto earlier models, or onto y = ground */
    double ground; /* metres */
    masu_bake_hides hides;
    masu_bake_box occluder; /* of HIDES_BOX: in object space */
    int traced;             /* MASU_BAKE_TRACED_* */
    int area_light;         /* MASU_BAKE_AREA_* */
    masu_bake_material_change *changes;
    size_t change_count;
} masu_bake_model;

typedef struct masu_bake_light {
    const char *where;     /* as for models */
    masu_blob_light value; /* without name and parent */
    const char *name;      /* or NULL */
    const char *instance;  /* the instance it is attached to, or NULL */
} masu_bake_light;

typedef struct masu_bake_look {
    masu_blob_camera_key *keys; /* none: one that frames the scene */
    size_t key_count;
    const char *camera;           /* of a model, instead of keys; or NULL */
    double fov_y;                 /* degrees, of that camera */
    bool own_fov_y;               /* given by the scene */
    double height;                /* of an orthographic camera, metres; 0: perspective */
    double near;                  /* metres; 0: the default */
    masu_bake_vec3 sun_direction; /* towards the sun */
    masu_bake_vec3 sun_color;
    double sun_intensity;
    bool own_sun, own_sun_color; /* given by the scene */
    bool sun_of_model;           /* it is a directional light of a file */
    bool shadows;
    masu_blob_shadow shadow;
    double shadow_distance; /* metres; 0: by the scene's size */
    masu_bake_vec3 ambient, zenith, horizon, ground;
    double turbidity; /* 0: the sky is two colours */
    double exposure;
    bool metered;
    double brighten, darken; /* of a metered exposure, 1/s; 0: the renderer's default */
    masu_bake_vec3 fog_color;
    double fog_density, fog_height, fog_falloff, fog_start;
    bool occlusion;          /* screen-space, of ambient light */
    double occlusion_radius; /* metres; 0: by the scene's size */
    bool smooth_edges;
} masu_bake_look;

typedef struct masu_bake_environment {
    const char *file; /* NULL: no environment map */
    double rotate;    /* degrees */
    double scale;
    uint32_t size; /* texels along an edge, a power of two */
} masu_bake_environment;

typedef struct masu_bake_sdf_param {
    const char *name;
    float value, low, high;
} masu_bake_sdf_param;

typedef struct masu_bake_sdf {
    masu_bake_box framed; /* bounds for the default camera */
    const char *source; /* NULL: no SDF */
    masu_bake_box bounds;
    double lipschitz /* 0: measured */, max_distance;
    bool anchored;
    bool is_static; /* declared: a field that may change is an error */
    masu_bake_occlusion occlusion;
    masu_bake_sdf_param *params;
    size_t param_count;
} masu_bake_sdf;

typedef struct masu_bake_description {
    const char *file; /* the file that was read */
    /* camera, light, ground and reflections depend on the model's shape (build/first_look.h) */
    bool first_look;
    bool default_reflections; /* not set by the scene: off for very many triangles */
    masu_bake_model *models;
    size_t model_count;
    masu_bake_shape *shapes; /* without duplicates */
    size_t shape_count;
    masu_bake_light *lights;
    size_t light_count;
    masu_bake_look look;
    masu_bake_environment environment;
    masu_bake_sdf sdf;
    uint32_t lods;    /* at most, for each mesh */
    double occluders; /* minimum size in metres; 0: only those of the models */
    masu_bake_probe_settings probes;
    masu_bake_reflections reflections;
    masu_bake_pool pool;
} masu_bake_description;

/* Reads the scene, or makes the description of a model without a scene. Returns false after
 * reporting. The caller releases the result, even after an error. */
bool masu_bake_read(const masu_bake_options *options, masu_bake_description *out);
void masu_bake_description_release(masu_bake_description *description);

masu_bake_look masu_bake_default_look(void);

/* For errors found while building: reports "file: where: message". Always returns false. */
bool masu_bake_wrong(const masu_bake_description *d, const char *where, const char *format, ...);

#endif
