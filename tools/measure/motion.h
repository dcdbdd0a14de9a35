/* motion.h: a scene in motion up to one moment, as `masu bench` draws what it compares.
 *
 * Nothing here owns the session. Functions that fail write one line to `error`. */
#ifndef MASU_MEASURE_MOTION_H
#define MASU_MEASURE_MOTION_H

#include "session.h"

#define MASU_MOTION_STEP (1.0 / 60.0)

typedef struct masu_motion {
    double time;     /* of the last frame */
    double step;     /* seconds from frame to frame; 0: at rest */
    uint32_t frames; /* up to there; at least 1 */
    bool remembers;  /* frames depend on those before whatever the setting; else one is enough */
} masu_motion;

/* One frame of that time, `step` seconds after the one before, finished on return. */
bool masu_motion_frame(masu_session *s, uint32_t rung, double time, double step, bool cut,
                       masu_commands *commands, char *error, size_t error_size);

/* All of them; the first is a cut. next: number of the session's next frame, kept up to date. Of
 * the first cascade that is slow the last frame is one before it is due, the worst there is. */
bool masu_motion_draw(masu_session *s, const masu_motion *motion, uint32_t rung,
                      const masu_rung *knobs, uint64_t *next, char *error, size_t error_size);

#endif
