/* renderer.h: the renderer's state and its owners. It is at the start of the host block, before the
 * arrays whose size depends on the scene: each module allocates its arrays in one pass of api.c.
 *
 *   plan     sizes, passes and resources of every frame; constant after masu_init, except that the
 *            pointer to the scene's blob is cleared once the scene is loaded
 *   device   Vulkan objects
 *   draws    the draws of the recordings, in their order
 *
 * The other members are host state between frames, one module of src/frame/ each. */
#ifndef MASU_RENDERER_H
#define MASU_RENDERER_H

#include "base/arena.h"
#include "base/error.h"
#include "device/device.h"
#include "frame/bounds.h"
#include "frame/camera.h"
#include "frame/cameras.h"
#include "frame/frame_data.h"
#include "frame/host_matrices.h"
#include "frame/instances.h"
#include "frame/local_shadows.h"
#include "frame/materials.h"
#include "frame/meshes.h"
#include "frame/models.h"
#include "frame/occlusion.h"
#include "frame/picking.h"
#include "frame/post.h"
#include "frame/punctual_lights.h"
#include "frame/bounce.h"
#include "frame/reflections.h"
#include "frame/sdf.h"
#include "frame/shadow.h"
#include "frame/sprites.h"
#include "frame/sun_sky.h"
#include "frame/temporal.h"
#include "frame/textures.h"
#include "frame/timeline.h"
#include "frame/transparents.h"
#include "frame/visible.h"
#include "plan/draws.h"
#include "plan/plan.h"
#include "quality/governor.h"

#define MASU_RENDERER_COOKIE 0x4D415355u

struct masu_renderer {
    uint32_t cookie;
    int loaded;
    int lost, broken; /* a call found the device lost; masu_init_step failed: only masu_destroy is
                         of use */
    uint32_t rung;    /* of the frame that was returned last; 0: there was none */
    masu_arena arena; /* rows for the report; its base is this struct */
    masu_detail error;
    masu_frame_plan plan;
    masu_device device;
    masu_draws draws;

    masu_timeline timeline;
    masu_history history;
    masu_temporal temporal;
    masu_governor *governor; /* NULL if the description has none */
    masu_camera_path camera;
    masu_frame_view view; /* of the frame that was handed out last; all 0: there was none */
    masu_sun_sky sun_sky;
    masu_sdf sdf;
    masu_instances instances;
    masu_bounds bounds;
    masu_models models;
    masu_lights lights;
    masu_materials materials;
    masu_shadow shadow;
    masu_local_shadows local_shadows;
    masu_views views;
    masu_visible visible;
    masu_picking picking;
    masu_occlusion occlusion;
    masu_transparents transparents;
    masu_sprites sprites;
    masu_textures textures;
    masu_reflections reflections;
    masu_bounce bounce;
    masu_meshes meshes;
    masu_post_state post;
};

/* The result of a public function whose error is in m->error: logs it and copies it to `detail`,
 * which may be NULL. */
static inline masu_result masu_finish(const masu_renderer *m, masu_result result,
                                      masu_detail *detail) {
    return masu_finish_desc(&m->plan.desc, result, &m->error, detail);
}

/* The argument `what` is NULL, or the renderer is. */
static inline masu_result masu_finish_null(masu_renderer *m, const char *what,
                                           masu_detail *detail) {
    if (!m) return masu_fail_null(detail, "renderer");
    return masu_finish(m, masu_fail_null(&m->error, what), detail);
}

/* The same for functions that do not change the renderer. */
static inline masu_result masu_finish_null_const(const masu_renderer *m, const char *what,
                                                 masu_detail *detail) {
    masu_detail own;
    if (!m) return masu_fail_null(detail, "renderer");
    return masu_finish_desc(&m->plan.desc, masu_fail_null(&own, what), &own, detail);
}

/* MASU_ERROR_DEVICE_LOST if an earlier call has found that. */
masu_result masu_check_lost(const masu_renderer *m, masu_detail *detail);

/* Copies scene data that frames need from the blob into the host block. */
void masu_copy_scene(masu_renderer *m);
/* Writes the constant data of all slots: draw commands and culling tables. */
void masu_write_scene(masu_renderer *m);
/* The steps of masu_frame that write a scene's frame to its slot. Checks are first: a rejected
 * frame changes nothing. */
masu_result masu_write_frame(masu_renderer *m, masu_frame_data *f);

#endif
