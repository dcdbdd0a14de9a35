/* pacing.h: selects for how many display refreshes the next frame should be shown, and detects
 * frames that were shown late. A pure function of its state: no clock, no Vulkan, no
 * allocation; accepts any values.
 *
 *   masu_pacing_choose(&p, frame, ms, target, excluded);  for each submitted frame
 *   masu_pacing_shown(&p, frame, ns, refresh_ns);        when the display reports the frame
 *
 * The number of refreshes rises if some consecutive frames are predicted to take longer, or were
 * late. It falls if frames have fitted into one refresh less for a second, or for longer after a
 * failed fall, so that the number does not alternate. Without a refresh interval the result
 * is 0. */
#ifndef MASU_PACING_H
#define MASU_PACING_H

#include "masu.h"

#define MASU_PACING_KEPT 16u /* frames whose number of refreshes is stored */
#define MASU_REFRESHES_MOST 16u

typedef struct masu_pacing {
    double refresh;     /* ms; 0: unknown */
    uint32_t refreshes; /* of the last frame */
    uint32_t least;     /* minimum that the target allows */
    struct {
        uint64_t frame; /* + 1; 0: none */
        uint32_t refreshes, excluded;
    } kept[MASU_PACING_KEPT];
    uint64_t shown_frame, shown_ns; /* the newest report */
    int shown;
    uint32_t late;        /* bit per reported frame, newest in bit 0: it was late */
    uint32_t over, under; /* consecutive frames that need more, fewer */
    uint64_t lowered;     /* frame of the last fall; */
    uint32_t patience;    /* factor on the wait before the next fall */
} masu_pacing;

/* `ms`: predicted time of the frame; `target`: permitted time. `excluded`: ignore the frame.
 * Repeated calls for a frame give the same result. */
void masu_pacing_choose(masu_pacing *p, uint64_t frame, double ms, double target, int excluded);
/* Reports when a frame was shown, by any clock that does not jump, and the refresh interval; 0:
 * unknown from now on, which resets the state. Returns 1 if the frame was shown late. */
int masu_pacing_shown(masu_pacing *p, uint64_t frame, uint64_t ns, uint64_t refresh_ns);
/* If whole refreshes are slightly shorter than the target: their time, so that frames fit. */
double masu_pacing_target(const masu_pacing *p, double target);

#endif
