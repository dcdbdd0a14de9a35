/* light.h: compares the visibility of point and spot lights in a frame with rays of the reference
 * path tracer.
 *
 * For each light the frame is drawn three times: without lights, with this light, and with this
 * light without shadows. The share of the light that remains at a pixel is compared with the
 * reference: rays from the surface at the pixel's centre to the disc of the source. Only pixels
 * where all these rays agree are compared: the others are penumbra. */
#ifndef LAB_LIGHT_H
#define LAB_LIGHT_H

#include "session.h"

enum { MASU_SEEN_LIGHTS = 64 };

typedef struct masu_seen_desc {
    const char *scene_path, *field_path; /* source of the SDF; NULL: none */
    VkExtent2D size;
    double time;
    uint32_t lights, rays, frames; /* lights that add most to the image; rays to each; frames until
                                    * shadows are complete */
    const char *image_dir;         /* NULL: none; else LIGHT.png of each light */
    masu_headless_desc host;
    void (*progress)(const char *text); /* or NULL */
} masu_seen_desc;

typedef struct masu_seen_row {
    uint32_t light; /* index in the scene */
    bool spot;
    uint64_t lit, compared; /* pixels that it would light by over 1/255 of white; among them, those
                             * outside penumbrae */
    uint64_t bright, dark;  /* compared pixels too bright and too dark by over 0.1 of the light */
    double leak; /* 99th percentile of the distance of light into shadow, in texels of a face of
                  * 512 */
} masu_seen_row;

typedef struct masu_seen {
    char driver[1024];
    masu_seen_row rows[MASU_SEEN_LIGHTS];
    uint32_t row_count;
    uint32_t messages; /* of the validation layer */
} masu_seen;

/* On false `error` holds one line. */
bool masu_seen_run(const masu_seen_desc *desc, masu_seen *out, char *error, size_t error_size);

#endif
