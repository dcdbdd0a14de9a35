/* desc.c: see desc.h. */
#include "support/desc.h"

#include <string.h>

VkImage support_images[MASU_MAX_TARGETS];
VkImageView support_views[MASU_MAX_TARGETS];
masu_scene_data support_scene;

static masu_desc desc_of(uint32_t width, uint32_t height) {
    masu_desc d;
    memset(&d, 0, sizeof d);
    d.bytes = sizeof d;
    for (uint32_t i = 0; i < MASU_MAX_TARGETS; i++) {
        support_images[i] = FAKE(VkImage, i);
        support_views[i] = FAKE(VkImageView, 16 + i);
    }
    d.output = (VkExtent2D){width, height};
    d.targets =
        (masu_targets){.images = support_images, .views = support_views, .count = 2, .storage = 1};
    return d;
}

masu_desc scene_desc(uint32_t parts, uint32_t width, uint32_t height) {
    masu_desc d = desc_of(width, height);
    masu_scene_data *s = &support_scene;
    memset(s, 0, sizeof *s);
    s->blob = s;
    if (parts & RASTER) {
        s->vertices = 11, s->indices = 15, s->primitives = 3, s->meshes = 2;
        s->instances = 3, s->materials = 2, s->draws = 3, s->triangles = 8;
        /* Counts for the limits, without arrays, so that nothing looks for them in a blob. */
        s->textures = 4, s->texture_bytes = 200, s->texture_bytes_decoded = 1000;
    }
    if (parts & SDF) {
        s->sdf = 1, s->sdf_params = 2, s->sdf_parts = 5, s->sdf_slots = 7;
#ifdef MASU_LAB
        s->sdf_march = 1u << MASU_MARCH_AUTO;
#endif
    }
    d.scene = masu_scene_of(s);
    return d;
}

masu_desc source_desc(uint32_t width, uint32_t height) {
    masu_desc d = desc_of(1920, 1080);
    d.source = (masu_source){FAKE(VkImageView, 64), width, height, VK_FORMAT_UNDEFINED};
    d.rung_count = 1;
    return d;
}

masu_scene_data scene_of_class(uint32_t c) {
    uint32_t kind = c % 4;
    (void)scene_desc(kind == MASU_SCENE_SDF    ? SDF
                     : kind == MASU_SCENE_BOTH ? RASTER | SDF
                                               : RASTER,
                     64, 48);
    masu_scene_data s = support_scene;
    if (kind == MASU_SCENE_WORLD) s.lods = 2, s.placed_occluders = 3;
    if (c >= 4) s.reflections = 1, s.glossiest = 0.1f, s.specular_cutoff = 0.4f;
    return s;
}
