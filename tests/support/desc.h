/* desc.h: descriptions for tests that have no device: handles that are nothing but not
 * null, and a scene that is nothing but its numbers. */
#ifndef SUPPORT_DESC_H
#define SUPPORT_DESC_H

#include <stdint.h>

#include "scene/scene.h"

#define FAKE(type, n) ((type)(uintptr_t)(0x1000 + (n)))

/* What the descriptions below point to; written anew by each call, for a test to spoil. */
extern VkImage support_images[MASU_MAX_TARGETS];
extern VkImageView support_views[MASU_MAX_TARGETS];
extern masu_scene_data support_scene;

enum { RASTER = 1, SDF = 2 };

/* Two storage targets, default rungs. Geometry is 11 vertices, 15 indices, 2 materials, 3
 * instances; an SDF has 2 parameters, 5 parts, 7 constant slots and no code for variants. */
masu_desc scene_desc(uint32_t parts, uint32_t width, uint32_t height);

/* One rung that brings a source image of that size to 1920x1080. */
masu_desc source_desc(uint32_t width, uint32_t height);

/* A scene of that masu_scene_class. */
masu_scene_data scene_of_class(uint32_t c);

#endif
