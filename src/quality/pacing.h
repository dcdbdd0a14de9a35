/* pacing.h: for how many refreshes of the display the next frame should be shown, and which frames were
 * shown later than that. A pure function of its own state: no clock, no Vulkan, no allocation; any values
 * may be given.
 *
 *   masu_pacing_choose(&p, frame, ms, target, excluded);  for each frame that is handed out
 *   masu_pacing_shown(&p, frame, ns, refresh_ns);        once the display has told
 *
 * It rises when frames are expected to take longer for some frames in a row, or were late; it falls when
 * they have fitted into one less for a second, and later if that was a mistake before: so that it does not
 * alternate. Without a refresh it says 0. */
#ifndef MASU_PACING_H
#define MASU_PACING_H

#include "masu.h"

#define MASU_PACING_KEPT 16u /* frames whose number of refreshes is remembered */
#define MASU_REFRESHES_MOST 16u

typedef struct masu_pacing {
    double refresh;     /* ms; 0: not known */
    uint32_t refreshes; /* of the frame that was chosen for last */
    uint32_t least;     /* that the target fits into */
    struct {
        uint64_t frame; /* + 1; 0: none */
        uint32_t refreshes, excluded;
    } kept[MASU_PACING_KEPT];
    uint64_t shown_frame, shown_ns; /* the newest that was told */
    int shown;
    uint32_t late; /* bit per frame told, the newest lowest: it was late */
    uint32_t over, under; /* frames in a row that want more, fewer */
    uint64_t lowered;     /* frame of the last fall; */
    uint32_t patience;    /* the next waits so many times as long */
} masu_pacing;

/* `ms`: what the frame is expected to take; `target`: what frames are allowed to. `excluded`: it
 * says nothing. Asked again for a frame, it says the same. */
void masu_pacing_choose(masu_pacing *p, uint64_t frame, double ms, double target, int excluded);
/* When a frame was shown, by any clock that does not jump, and how long a refresh lasts; 0: it is no
 * longer known, and all that was is forgotten. 1: it was shown later than it should have been. */
int masu_pacing_shown(masu_pacing *p, uint64_t frame, uint64_t ns, uint64_t refresh_ns);
/* Where refreshes are a little shorter than the target: their time, so that frames fit into them. */
double masu_pacing_target(const masu_pacing *p, double target);

#endif
