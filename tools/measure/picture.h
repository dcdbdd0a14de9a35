/* picture.h: renders the ground truth of a frame by supersampling, and loads images to compare.
 *
 * The ground truth is the mean of many full renders at the output size. Each render shifts the
 * projection by a fraction of a pixel, so that a pixel becomes the mean over its square (a box
 * filter). All settings that a rung may trade for time are at their most exact. The renders are
 * read as 16-bit floats, whose rounding of at most 0.05 % averages out. There are two means:
 *
 * LINEAR LIGHT, before exposure, tone curve and clipping: the measurement of a camera sensor, to
 * compare with a linear reference. A lamp that covers a tenth of a pixel can saturate the pixel.
 *
 * DISPLAY LIGHT, after exposure and tone curve, before the sRGB encoding: a display with many times
 * the pixels, seen from a distance. Edges of bright surfaces remain smooth. Temporal anti-aliasing
 * and SDF edge anti-aliasing target this mean, so it is the reference for 8-bit images.
 *
 * Remaining approximations: docs/design/18-error-measurement.md. Nothing here owns the session. */
#ifndef MASU_MEASURE_PICTURE_H
#define MASU_MEASURE_PICTURE_H

#include "session.h"

#define MASU_PICTURE_POSITIONS 64u /* per pixel, by default */
#define MASU_PICTURE_POSITIONS_MAX 4096u
/* Seconds between the frames of one sum of rays. A metered exposure then follows the newest sum,
 * and not the noise of the first ray. */
#define MASU_PICTURE_STEP 1000.0f
#define MASU_PICTURE_RAYS 1024u /* reflection rays per pixel, over all positions */

/* Position i of n, i < n, relative to the centre of the pixel: -0.5..0.5 to the right and down.
 * Hammersley's points: if n is a power of two, each n-th of either axis has one point. With 64
 * points the coverage of an axis-parallel edge differs by at most half a 64th of the pixel. For
 * edges of any direction the RMS error is 0.9 64ths, the maximum 4. */
void masu_picture_place(uint32_t i, uint32_t n, float out[2]);

/* Whether shadows of punctual lights or live light are still converging in a static scene. */
int masu_picture_settles(const masu_stats_info *stats);

/* Copies the frame's camera, or the scene's, to `camera`, whose jitter the caller changes, and sets
 * it in the frame. */
bool masu_picture_camera(masu_session *s, masu_frame_desc *frame, masu_camera *camera, char *error,
                         size_t error_size);

/* Like masu_session_open, with one rung without approximations, and mip levels for `positions`
 * samples per pixel. It overrides the members of d->desc for rungs, anisotropy and debug, except
 * validation and labels. */
bool masu_picture_open(const masu_session_desc *d, uint32_t positions, masu_session *s, char *error,
                       size_t error_size);

/* Frames per position: the rays divided by the positions, rounded up; 1 without reflections. */
uint32_t masu_picture_frames(const masu_session *s, uint32_t positions, uint32_t rays);

/* Results of a ground truth; NULL: not wanted. 8-bit images are sRGB, 4 bytes per pixel. */
typedef struct masu_picture_means {
    float *linear;    /* mean of linear light, 3 floats per pixel */
    uint8_t *display; /* mean of display light */
} masu_picture_means;

/* Renders the ground truth of a frame. `frame` may have no camera (NULL), which selects the
 * scene's; its rung, time step and cut are ignored. progress may be NULL. The session is from
 * masu_picture_open with the same number of positions. */
bool masu_picture_truth(masu_session *s, const masu_frame_desc *frame, uint32_t positions,
                        uint32_t rays, const masu_picture_means *out,
                        void (*progress)(const char *text), char *error, size_t error_size);

/* Describes a session whose images are compared with the ground truth: a storage target, and
 * textures without anisotropic filtering, which costs forty times as much on a CPU driver. */
masu_session_desc masu_picture_session(const char *scene_path, VkExtent2D size,
                                       const masu_headless_desc *host);

/* A ground truth: read from its file if the file exists, otherwise rendered and written there. */
typedef struct masu_picture_want {
    const char *path; /* NULL: no file */
    double time;
    uint32_t positions, rays;
    void (*progress)(const char *text); /* may be NULL */
    uint32_t messages;                            /* out: number of messages of the validation
                                                   * layer */
} masu_picture_want;

/* Opens its own session from `d` by masu_picture_open. rgba: size d->desc.output. */
bool masu_picture_find(const masu_session_desc *d, masu_picture_want *truth, uint8_t *rgba,
                       char *error, size_t error_size);

/* Reads a PNG of that size. rgba: 4 * width * height bytes. */
bool masu_picture_load(const char *path, VkExtent2D size, uint8_t *rgba, char *error,
                       size_t error_size);

#endif
