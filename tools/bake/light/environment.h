/* environment.h: a sky from an image: a panorama in latitude and longitude becomes an octahedral
 * radiance map, with mips for increasing roughness, and spherical harmonics of its irradiance
 * (src/scene/blob.h: masu_blob_environment_map).
 *
 * Files: Radiance .hdr (RGBE, with or without run lengths) and .pfm; rows from the zenith down. */
#ifndef MASU_BAKE_ENVIRONMENT_H
#define MASU_BAKE_ENVIRONMENT_H

#include "bake/scene/content.h"

typedef struct masu_bake_panorama {
    uint32_t width, height;
    float *rgb;    /* finite, >= 0 */
    double turn;   /* radians: azimuth of the image's centre, from +Z towards +X */
    double factor; /* on radiance */
    const char *name; /* for warnings, or NULL */
} masu_bake_panorama;

/* On false the error has been reported. free() rgb. */
bool masu_bake_load_panorama(const char *path, masu_bake_panorama *out);

/* Largest radiance of a texel of the blob. */
#define MASU_BAKE_RADIANCE_MAX 65408.0

/* Direction of the centre of a pixel, and the solid angle that it covers. */
void masu_bake_panorama_pixel(const masu_bake_panorama *p, uint32_t x, uint32_t y,
                              double direction[3], double *solid_angle);

/* Radiance in a unit direction, bilinear between the image's pixels. */
void masu_bake_panorama_at(const masu_bake_panorama *p, const double direction[3], double out[3]);

/* Adds both sections. size: as in the blob. A warning counts the pixels above the maximum of a
 * texel. */
void masu_bake_add_environment(const masu_bake_panorama *p, uint32_t size,
                               masu_bake_content *content);

/* The direction at the centre of a texel of the octahedral square; the value of a texel; the blob's
 * mips sampled for a direction and a roughness, with the lookup of
 * shaders/light/environment.glsl. */
void masu_bake_octahedral(double x, double y, double out[3]);
uint32_t masu_bake_pack_9995(const double rgb[3]);
void masu_bake_unpack_9995(uint32_t texel, double out[3]);
void masu_bake_environment_at(const masu_blob_environment_map *map, const uint32_t *texels,
                              const double direction[3], double roughness, double out[3]);

#endif
