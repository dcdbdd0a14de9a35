/* depth.h: how far the surfaces that a setting draws are from where they should be.
 *
 * One frame at rest of a session of its own, whose depth is read back: what is timed reads nothing
 * back. Only the knobs that touch surfaces are taken from a setting (scale, march, march_steps,
 * frustum, occlusion, lod_error), and each combination of them is drawn once.
 *
 * The reference is the scene's field in double precision (truth.h), where NAME.truth.so lies
 * beside the scene and it has no polygons; else the frame of the same size with the most steps, no
 * culling and no LODs. The latter cannot see what that march gets wrong itself: `masu-lab study
 * march` can.
 *
 * A masu_depth_bench is allocated by masu_depth_open. Functions that fail write one line to
 * `error`. */
#ifndef MASU_BENCH_DEPTH_H
#define MASU_BENCH_DEPTH_H

#include "session.h"

typedef struct masu_depth_bench masu_depth_bench;

typedef struct masu_depth_error {
    double hitmiss_pct;     /* of all pixels: a surface in one of the two, none in the other */
    double mean_px, p99_px; /* |distance - reference| where both have one, in widths of the pixel */
} masu_depth_error;

/* The scene has a double-precision truth that its picture can be compared with. */
bool masu_depth_has_truth(const char *scene_path, const masu_scene *scene);

/* d: scene, host, output and targets. truth: compare with it. NULL: failed. */
masu_depth_bench *masu_depth_open(const masu_session_desc *d, double time, bool truth, char *error,
                                  size_t error_size);

bool masu_depth_measure(masu_depth_bench *b, const masu_rung *rungs, uint32_t count,
                        masu_depth_error *out, char *error, size_t error_size);

/* Of the validation layer, in all sessions so far. */
uint32_t masu_depth_messages(const masu_depth_bench *b);
void masu_depth_close(masu_depth_bench *b); /* NULL is nothing */

#endif
