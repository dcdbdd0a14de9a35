/* motion.h: renders a sequence of frames up to one moment, as `masu bench` does for comparisons.
 *
 * Nothing here owns the session. Functions that fail write one line to `error`. */
#ifndef MASU_MEASURE_MOTION_H
#define MASU_MEASURE_MOTION_H

#include "session.h"

#define MASU_MOTION_STEP (1.0 / 60.0)

typedef struct masu_motion {
    double time;     /* of the last frame */
    double step;     /* seconds between frames; 0: no motion */
    uint32_t frames; /* number of frames up to `time`; at least 1 */
    bool remembers;  /* all frames are needed for any setting; otherwise settings without history
                      * render one */
} masu_motion;

/* Renders one frame, `step` seconds after the previous one, and waits for it. */
bool masu_motion_frame(masu_session *s, uint32_t rung, double time, double step, bool cut,
                       masu_commands *commands, char *error, size_t error_size);

/* Renders all frames; the first is a cut. next: number of the session's next frame, kept up to
 * date. The last frame is the one before the first slow cascade is updated, which is the worst
 * case. */
bool masu_motion_draw(masu_session *s, const masu_motion *motion, uint32_t rung,
                      const masu_rung *knobs, uint64_t *next, char *error, size_t error_size);

#endif
