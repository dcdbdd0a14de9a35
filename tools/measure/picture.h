/* picture.h: the truth of a whole picture: what it would be with no shortcut, and a picture
 * to compare.
 *
 * The truth is the mean of many full renders at the output's size, each with the projection moved
 * by a part of a pixel, so that each pixel gets the mean over its square (a box filter). All that
 * a rung may trade for time is at its most exact. The mean is that of display light: after
 * exposure and tone curve, before the sRGB encoding. So does an eye that stands too far from a
 * display of many times the pixels to tell them apart, and that display is what a picture is to
 * look like. In a mean of radiance, before the tone curve, a lamp that covers a tenth of a pixel
 * makes it white: edges of bright things stay jagged whatever the number of renders.
 *
 * The renders are read as 8 bits of sRGB. Where they differ, what each is rounded by averages
 * out: over 64 it is 0.29 / 8 = 0.04 of a step. Where they do not, their mean is that one number,
 * and rounding it again changes nothing: the truth is then the picture's own 8 bits.
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

/* As masu_session_open, with one rung that takes no shortcut, and mips as `positions` of a pixel
 * want them. Of d->desc what concerns rungs, anisotropy and debug is set here, but for validation
 * and labels. */
bool masu_picture_open(const masu_session_desc *d, uint32_t positions, masu_session *s, char *error,
                       size_t error_size);

/* Frames for each position: the rays asked for by all positions, rounded up; 1 without
 * reflections. */
uint32_t masu_picture_frames(const masu_session *s, uint32_t positions, uint32_t rays);

/* Draws the truth of a frame. rgba: width * height * 4 bytes, sRGB-encoded. The camera of `frame`
 * may be NULL, the scene's then; its rung, time step and cut are not looked at. progress may be
 * NULL. The session is one of masu_picture_open for as many positions, with storage targets of 8
 * bits. */
bool masu_picture_truth(masu_session *s, const masu_frame_desc *frame, uint32_t positions,
                        uint32_t rays, uint8_t *rgba, void (*progress)(const char *text),
                        char *error, size_t error_size);

/* The same, and the mean of radiance before exposure and tone curve, 3 floats a pixel, if `radiance`
 * is not NULL. The session reads back MASU_READBACK_HDR then. */
bool masu_picture_truth_hdr(masu_session *s, const masu_frame_desc *frame, uint32_t positions,
                            uint32_t rays, uint8_t *rgba, float *radiance,
                            void (*progress)(const char *text), char *error,
                            size_t error_size);

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

/* Mean of display light, and back: 8 bits of sRGB to 0..1, and to the nearest 8 bits. */
float masu_picture_decoded(uint8_t encoded);
uint8_t masu_picture_encoded(float linear);

#endif
