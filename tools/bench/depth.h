/* depth.h: the depth error of a setting: the distance of rendered surfaces from their reference.
 *
 * A separate session renders one static frame and reads its depth back, because timed sessions have
 * no readback. Only the knobs that affect surfaces are used (scale, march, march_steps, frustum,
 * occlusion, lod_error); each combination is rendered once.
 *
 * The reference is the scene's SDF in double precision (truth.h) if NAME.truth.so is next to the
 * scene and the scene has no polygons. Otherwise it is a frame of the same size with the most
 * steps, without culling and LODs. That frame does not reveal errors of its own march: `masu-lab
 * study march` does.
 *
 * masu_depth_open allocates a masu_depth_bench. Functions that fail write one line to `error`. */
#ifndef MASU_BENCH_DEPTH_H
#define MASU_BENCH_DEPTH_H

#include "session.h"

typedef struct masu_depth_bench masu_depth_bench;

typedef struct masu_depth_error {
    double hitmiss_pct;     /* of all pixels: a surface in only one of both images */
    double mean_px, p99_px; /* |distance - reference| if both have a surface, in pixel widths */
} masu_depth_error;

/* Whether the scene has a double-precision ground truth for its image. */
bool masu_depth_has_truth(const char *scene_path, const masu_scene *scene);

/* d: scene, host, output and targets. truth: use it as reference. NULL: failed. */
masu_depth_bench *masu_depth_open(const masu_session_desc *d, double time, bool truth, char *error,
                                  size_t error_size);

bool masu_depth_measure(masu_depth_bench *b, const masu_rung *rungs, uint32_t count,
                        masu_depth_error *out, char *error, size_t error_size);

/* Messages of the validation layer in all sessions so far. */
uint32_t masu_depth_messages(const masu_depth_bench *b);
void masu_depth_close(masu_depth_bench *b); /* ignores NULL */

#endif
