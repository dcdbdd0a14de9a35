/* frame_plan.c: the rows of passes.inc and images.inc as constant arrays, and the conditions of
 * passes. */
#include "plan/frame_plan.h"

/* ---- Images ---------------------------------------------------------------------------------- */

#define MASU_READBACK_NONE 0
enum { LIFETIME_FRAME = 0, LIFETIME_KEPT = 1, LIFETIME_PING_PONG = 2, LIFETIME_TEXTURES = 3 };

const masu_image_row masu_images[MASU_IMAGE_COUNT] = {
#define IMAGE(ID, name, format, extent, class_of, readback, lifetime, when, content)               \
    [MASU_IMAGE_##ID] = {#name, VK_FORMAT_##format, MASU_EXTENT_##extent, MASU_CLASS_##class_of,   \
                         MASU_READBACK_##readback, LIFETIME_##lifetime != LIFETIME_FRAME,          \
                         LIFETIME_##lifetime == LIFETIME_PING_PONG ? 2                             \
                         : LIFETIME_##lifetime == LIFETIME_TEXTURES ? 0                            \
                                                                    : 1,                           \
                         content},
#include "plan/images.inc"
#undef IMAGE
};

int masu_has_image(const masu_needs *n, uint32_t image) {
    switch (image) {
#define IMAGE(ID, name, format, extent, class_of, readback, lifetime, when, content)               \
    case MASU_IMAGE_##ID: return (when) != 0;
#include "plan/images.inc"
#undef IMAGE
    default: return 0;
    }
}

/* ---- Reasons for not running a pass, shared by several rows ---------------------------------- */

#define NO_SCENE "no scene: a source image is upscaled"
#define NO_SDF "the scene has no SDF"
#define STATIC_SDF "the SDF is static: only the camera moves it"
#define MOVING_SDF "the SDF may change"
#define NO_SPLIT "desc.split does not request it"
#define NOTHING_KEPT "no history without rung.specular_temporal"

int masu_is_occluded(const masu_needs *n) { return n->sdf_occlusion || n->shadow || n->on.ao; }

#ifdef MASU_LAB
int masu_march_has_tiles(const masu_needs *n) {
    return n->march != MASU_MARCH_PLAIN && n->march != MASU_MARCH_SEED;
}
int masu_march_has_blocks(const masu_needs *n) {
    return masu_march_has_tiles(n) && n->march != MASU_MARCH_CHECKERBOARD;
}
#else
int masu_march_has_tiles(const masu_needs *n) { return n->sdf; }
int masu_march_has_blocks(const masu_needs *n) { return n->sdf; }
#endif

static const char *no_occlusion(const masu_needs *n) {
    return !n->occluders  ? "the scene has no occluders"
           : n->unculled  ? "a mesh has too many primitives or instances"
           : n->dropped & MASU_DROPPED_OCCLUSION
                 ? "rung.occlusion is off, or the device has too few storage buffers"
                            : "rung.occlusion is off";
}

static const char *no_march(const masu_needs *n) {
    return n->sdf ? "rung.march selects another march" : NO_SDF;
}

/* Whether any pass of the rung reads velocities. */
static int wants_velocity(const masu_needs *n) {
    return n->velocity && (n->temporal || n->resolve || (n->readback & MASU_READBACK_VELOCITY) ||
                           (n->split & MASU_SPLIT_VELOCITY));
}

/* Reason if a pass does not write velocities: no reader, or `other`. */
static const char *no_velocity(const masu_needs *n, const char *other) {
    return wants_velocity(n) ? other : "nothing reads velocities";
}

static const char *no_skins(const masu_needs *n) {
    return n->scene ? "the scene has no skinned meshes" : NO_SCENE;
}

static const char *no_meshes(const masu_needs *n) {
    return n->scene ? "desc.reserve.meshes is 0" : NO_SCENE;
}

static int has_skin_trees(const masu_needs *n) {
    return (n->skins || n->meshes) && n->traced && !n->query;
}

static const char *no_shadow_map(const masu_needs *n) {
    return n->raster ? "the scene has no shadow map" : "the scene has no instances";
}

static const char *no_local_shadows(const masu_needs *n) {
    return n->local_shadows ? "rung.local_shadows is off"
           : n->lights      ? "no punctual light casts shadows, or rung.local_shadows is off"
                            : "the scene has no punctual lights";
}

static const char *no_specular(const masu_needs *n) {
    return !n->scene       ? NO_SCENE
           : n->dropped & MASU_DROPPED_SPECULAR
                 ? "rung.specular is off, or the device has too few storage buffers"
                            : "nothing is glossy enough to trace, or rung.specular is off";
}

static const char *no_bounce(const masu_needs *n) {
    return n->dropped & MASU_DROPPED_BOUNCE
               ? "rung.bounce is off, or the device has too few storage buffers"
               : "the scene has no live bounce, or rung.bounce is off";
}

static const char *no_filter(const masu_needs *n, const char *off) {
    return !n->specular    ? no_specular(n)
           : n->accumulate ? "debug.reference: nothing is filtered"
                           : off;
}

static const char *no_resolve(const masu_needs *n) {
    return n->scene ? n->accumulate ? "debug.reference: one sample position per pixel"
                                    : "rung.temporal is not on"
                    : NO_SCENE;
}

static const char *no_post(const masu_needs *n) {
    return n->scene ? "desc.post does not have it" : NO_SCENE;
}

static const char *no_upscale(const masu_needs *n) {
    return n->resolve   ? "temporal runs instead"
           : n->upscale ? "rung.easu selects another filter"
                        : "render size is output size";
}

/* ---- Passes ---------------------------------------------------------------------------------- */

#define WHEN(condition, yes, no)                                                                   \
    int runs = (condition) != 0;                                                                   \
    *why = runs ? (yes) : (no);                                                                    \
    return runs;
#define PASS(ID, name, purpose, kind, extent, when, ...)                                           \
    static int decide_##name(const masu_needs *n, const char **why) { when }
#include "plan/passes.inc"
#undef PASS
#undef WHEN

#define IMAGE_ACCESS(id, usage) {MASU_IMAGE_##id, MASU_##usage}
#define READ(id) IMAGE_ACCESS(id, READ)
#define READ_LINEAR(id) IMAGE_ACCESS(id, READ_LINEAR)
#define MAP(id) IMAGE_ACCESS(id, READ_MAP)
#define WRITE(id) IMAGE_ACCESS(id, WRITE)
#define UPDATE(id) IMAGE_ACCESS(id, UPDATE)
#define PING_PONG(id) IMAGE_ACCESS(id, PING_PONG)
#define COLOR(id) IMAGE_ACCESS(id, WRITE_COLOR)
#define COLOR_PART(id) IMAGE_ACCESS(id, UPDATE_COLOR)
#define BLEND(id) IMAGE_ACCESS(id, BLEND_COLOR)
#define DEPTH(id) IMAGE_ACCESS(id, WRITE_DEPTH)
#define DEPTH_PART(id) IMAGE_ACCESS(id, UPDATE_DEPTH)
#define DEPTH_KEPT(id) IMAGE_ACCESS(id, KEEP_DEPTH)
#define COPY_TO(id) IMAGE_ACCESS(id, WRITE_COPY)
#define COPY_BACK(id) IMAGE_ACCESS(id, READ_BACK)
#define READ_LATEST(class_of) {MASU_LATEST(MASU_CLASS_##class_of), MASU_READ}
#define READ_BEFORE(class_of) {MASU_BEFORE(MASU_CLASS_##class_of), MASU_READ}
#define UPDATE_LATEST(class_of) {MASU_LATEST(MASU_CLASS_##class_of), MASU_UPDATE}
#define COPY_LATEST(class_of) {MASU_LATEST(MASU_CLASS_##class_of), MASU_READ_COPY}
#define COPY_BACK_LATEST(class_of) {MASU_LATEST(MASU_CLASS_##class_of), MASU_READ_BACK}
#define HOST_READS(id) IMAGE_ACCESS(id, READ_HOST)
#define HOST_COLOR(id) IMAGE_ACCESS(id, HOST_COLOR)
#define HOST_LATEST(class_of) {MASU_LATEST(MASU_CLASS_##class_of), MASU_HOST_##class_of}
#define READS(id) {MASU_RESOURCE(MASU_BUFFER_##id), MASU_READ_BUFFER}
#define FETCHES(id) {MASU_RESOURCE(MASU_BUFFER_##id), MASU_READ_VERTICES}
#define WRITES(id) {MASU_RESOURCE(MASU_BUFFER_##id), MASU_WRITE_BUFFER}
#define TRACES(id) {MASU_RESOURCE(MASU_BUFFER_##id), MASU_READ_STRUCTURE}
#define BUILDS(id) {MASU_RESOURCE(MASU_BUFFER_##id), MASU_WRITE_STRUCTURE}

#define NONE MASU_GEOMETRY_NONE, 0
#define COMP(file, axes) MASU_GEOMETRY_NONE, 0
#define DRAW(geometry, ...) MASU_GEOMETRY_##geometry, 0
#define SCENE(file, section) MASU_GEOMETRY_NONE, MASU_BLOB_##section##_SPIRV

const masu_pass_row masu_passes[MASU_PASS_COUNT] = {
#define PASS(ID, name, purpose, kind, extent, when, push, shader, ...)                             \
    [MASU_PASS_##ID] = {#name, purpose, MASU_PASS_##kind, MASU_EXTENT_##extent, decide_##name,     \
                        shader, {__VA_ARGS__}},
#include "plan/passes.inc"
#undef PASS
};

int masu_usage_writes(masu_usage usage) { return usage >= MASU_WRITE; }

int masu_is_cascade(uint32_t pass) {
    return masu_passes[pass].geometry == MASU_GEOMETRY_CASCADE;
}

int masu_is_of_faces(uint32_t pass) {
    masu_image_extent extent = masu_passes[pass].extent;
    return extent == MASU_EXTENT_LOCAL_FACES || extent == MASU_EXTENT_LOCAL_SDF ||
           extent == MASU_EXTENT_LOCAL_ATLAS;
}

int masu_has_set(uint32_t pass) {
    masu_geometry geometry = masu_passes[pass].geometry;
    return masu_passes[pass].kind == MASU_PASS_COMPUTE || geometry == MASU_GEOMETRY_BLENDED ||
           geometry == MASU_GEOMETRY_SPRITES || geometry == MASU_GEOMETRY_DEPTHS ||
           geometry == MASU_GEOMETRY_TILES;
}

int masu_access_binds(masu_access access, int writes) {
    if (access.usage == MASU_PING_PONG) return 1;
    if (!writes) return access.usage == MASU_READ || access.usage == MASU_READ_LINEAR;
    return access.usage == MASU_WRITE || access.usage == MASU_UPDATE;
}

/* Levels of `size` one below the other, from 1 / `block` of it on, each half the one above. */
static VkExtent2D stacked(VkExtent2D size, uint32_t block, uint32_t levels) {
    VkExtent2D out = {(size.width + block - 1) / block, 0};
    for (; levels; levels--, block *= 2) out.height += (size.height + block - 1) / block;
    return out;
}

VkExtent2D masu_extent_of(masu_image_extent extent, VkExtent2D render, VkExtent2D output) {
    uint32_t block = extent == MASU_EXTENT_HALF || extent == MASU_EXTENT_TRACED ||
                             extent == MASU_EXTENT_GLOSSY || extent == MASU_EXTENT_FOCUS
                         ? 2
                     : extent == MASU_EXTENT_BLOCK8 ? 8
                     : extent == MASU_EXTENT_BLOCK4 ? 4
                     : extent == MASU_EXTENT_TILE || extent == MASU_EXTENT_EDGED ? MASU_TILE
                                                    : 1;
    if (extent == MASU_EXTENT_ATLAS)
        return (VkExtent2D){MASU_ATLAS_WIDTH, MASU_ATLAS_HEIGHT};
    if (extent == MASU_EXTENT_ONE || extent == MASU_EXTENT_KEPT || extent == MASU_EXTENT_BATCHES ||
        extent == MASU_EXTENT_PROBES || extent == MASU_EXTENT_RAYS ||
        extent == MASU_EXTENT_TRACED_PROBES || extent == MASU_EXTENT_SKINS ||
        extent == MASU_EXTENT_SKIN_TREES || extent == MASU_EXTENT_TEXTURES ||
        extent == MASU_EXTENT_MESHES)
        return (VkExtent2D){1, 1};
    if (extent == MASU_EXTENT_LEVELS)
        return (VkExtent2D){(render.width + 63) / 64 * 32, (render.height + 63) / 64 * 48};
    if (extent == MASU_EXTENT_ALL_LEVELS)
        return (VkExtent2D){(render.width + 63) / 64 * 64, (render.height + 63) / 64 * 96};
    if (extent == MASU_EXTENT_BLOOM_16) return stacked(render, 8, 2);
    if (extent == MASU_EXTENT_BLOOM_128) return stacked(render, 32, 3);
    if (extent == MASU_EXTENT_PICK) return (VkExtent2D){2, 2};
    if (extent == MASU_EXTENT_SHADOW || extent == MASU_EXTENT_LOCAL_FACES ||
        extent == MASU_EXTENT_LOCAL_ATLAS || extent == MASU_EXTENT_LOCAL_PAIRS)
        return (VkExtent2D){0, 0};
    int shown = extent == MASU_EXTENT_OUTPUT || extent == MASU_EXTENT_OUTPUT_PAIRS ||
                extent == MASU_EXTENT_OUTPUT_ODD;
    VkExtent2D size = shown ? output : render;
    return (VkExtent2D){(size.width + block - 1) / block, (size.height + block - 1) / block};
}
