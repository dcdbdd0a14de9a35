/* picture.h: the truth of a whole picture: what it would be with no shortcut, and a picture
 * to compare.
 *
 * The ground truth is the mean of many full renders at the output's size, each with the projection
 * moved by a part of a pixel, so that each pixel gets the mean over its square (a box filter). All
 * that a rung may trade for time is at its most exact. The renders are read as 16-bit floats, whose
 * rounding, at most 0.05 %, averages out. There are two means:
 *
 * LINEAR LIGHT, before exposure, tone curve and clipping: what a camera's sensor measures, and what
 * a reference of linear light is compared with. A lamp that covers a tenth of a pixel can make it
 * white.
 *
 * DISPLAY LIGHT, after exposure and tone curve, before the sRGB encoding: a display of many times
 * the pixels, seen from afar. Edges of bright surfaces stay smooth. Temporal anti-aliasing and the
 * SDF's edges aim at this mean, so 8-bit images are judged by it.
 *
 * What stays approximate: docs/design/18-error-measurement.md. Nothing here
 * owns the session. */
#ifndef MASU_MEASURE_PICTURE_H
#define MASU_MEASURE_PICTURE_H

#include "session.h"

#define MASU_PICTURE_POSITIONS 64u /* of a pixel, unless said otherwise */
#define MASU_PICTURE_POSITIONS_MAX 4096u
/* Seconds between frames that sum up rays at one moment: a metered exposure is then that of the last sum, and
 * not of the first ray's noise. */
#define MASU_PICTURE_STEP 1000.0f
#define MASU_PICTURE_RAYS 1024u /* of reflections from a pixel, all positions together */

/* Position i of n, i < n, from the middle of the pixel: -0.5..0.5 to the right and down.
 * Hammersley's points: along either axis one in each n-th, if n is a power of two. Of 64 an edge
 * along an axis is off by at most half a 64th of the pixel, one of any direction by 0.9 of them
 * (root mean square), at worst 4. */
void masu_picture_place(uint32_t i, uint32_t n, float out[2]);

/* Whether shadows of punctual lights or live light are still on their way in a frame at rest. */
int masu_picture_settles(const masu_stats_info *stats);

/* Makes `camera`, whose jitter changes, the frame's: a copy of its own, or the scene's. */
bool masu_picture_camera(masu_session *s, masu_frame_desc *frame, masu_camera *camera, char *error,
                         size_t error_size);

/* As masu_session_open, with one rung that takes no shortcut, and mips as `positions` of a pixel
 * want them. Of d->desc what concerns rungs, anisotropy and debug is set here, but for validation
 * and labels. */
bool masu_picture_open(const masu_session_desc *d, uint32_t positions, masu_session *s, char *error,
                       size_t error_size);

/* Frames for each position: the rays asked for by all positions, rounded up; 1 without
 * reflections. */
uint32_t masu_picture_frames(const masu_session *s, uint32_t positions, uint32_t rays);

/* Results of a ground truth; NULL: not wanted. Images of 8 bits are sRGB, 4 bytes a pixel. */
typedef struct masu_picture_means {
    float *linear;    /* mean of linear light, 3 floats a pixel */
    uint8_t *display; /* mean of display light */
} masu_picture_means;

/* Draws the ground truth of a frame. The camera of `frame` may be NULL, the scene's then; its rung,
 * time step and cut are ignored. progress may be NULL. The session is one of masu_picture_open for
 * as many positions. */
bool masu_picture_truth(masu_session *s, const masu_frame_desc *frame, uint32_t positions,
                        uint32_t rays, const masu_picture_means *out,
                        void (*progress)(const char *text), char *error, size_t error_size);

/* A session of a scene whose pictures are compared with the truth: a storage target, textures without
 * anisotropy, which a CPU driver has at forty times the price. */
masu_session_desc masu_picture_session(const char *scene_path, VkExtent2D size,
                                       const masu_headless_desc *host);

/* A truth that is read from a file, if there is one, else drawn, and written there. */
typedef struct masu_picture_want {
    const char *path; /* NULL: none */
    double time;
    uint32_t positions, rays;
    void (*progress)(const char *text); /* or NULL */
    uint32_t messages;                            /* out: of the validation layer */
} masu_picture_want;

/* With a session of its own, as masu_picture_open makes it of `d`. rgba: of d->desc.output. */
bool masu_picture_find(const masu_session_desc *d, masu_picture_want *truth, uint8_t *rgba,
                       char *error, size_t error_size);

/* A PNG of that size. rgba: 4 * width * height bytes. */
bool masu_picture_load(const char *path, VkExtent2D size, uint8_t *rgba, char *error,
                       size_t error_size);

#endif
