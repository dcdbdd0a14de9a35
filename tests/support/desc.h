/* desc.h: descriptions for tests without a device: fake non-null handles, and scenes that consist
 * of their counts only. */
#ifndef SUPPORT_DESC_H
#define SUPPORT_DESC_H

#include <stdint.h>

#include "scene/scene.h"

#define FAKE(type, n) ((type)(uintptr_t)(0x1000 + (n)))

/* Data that the descriptions below point to. Each call writes it again, so a test may damage it. */
extern VkImage support_images[MASU_MAX_TARGETS];
extern VkImageView support_views[MASU_MAX_TARGETS];
extern masu_scene_data support_scene;

enum { RASTER = 1, SDF = 2 };

/* Two storage targets, default rungs. Geometry is 11 vertices, 15 indices, 2 materials, 3
 * instances; an SDF has 2 parameters, 5 parts, 7 constant slots and no code for variants. */
masu_desc scene_desc(uint32_t parts, uint32_t width, uint32_t height);

/* One rung that scales a source image of this size to 1920x1080. */
masu_desc source_desc(uint32_t width, uint32_t height);

/* A scene of this masu_scene_class. */
masu_scene_data scene_of_class(uint32_t c);

#endif
