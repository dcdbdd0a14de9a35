/* pacing.c: see pacing.h. */
#include "quality/pacing.h"

#include <string.h>

#define REFRESH_LEAST 1e6 /* ns */
#define REFRESH_MOST 1e9
#define SAME_REFRESH 0.01 /* smaller differences are jitter of the reporting side */
#define TOLERANCE 0.05    /* of a refresh: tolerated excess over whole refreshes */
#define OVER_FRAMES 4u    /* consecutive frames that need more refreshes */
#define LATE_FRAMES 4u    /* of the last 16 shown */
#define LATE_WINDOW 0xFFFFu
#define UNDER_FRAMES 60u    /* consecutive frames that need fewer, times the back-off factor */
#define UNDER_ROOM 1.1      /* headroom that their predicted time must leave */
#define MISTAKE_FRAMES 240u /* a rise this soon after a fall: the fall has failed */
#define PATIENCE_MOST 16u

static uint32_t whole(double ms, double refresh, double tolerance) {
    double n = ms / refresh - tolerance;
    if (!(n > 1.0)) return 1; /* NaN too */
    if (n > MASU_REFRESHES_MOST - 1.0) return MASU_REFRESHES_MOST;
    uint32_t k = (uint32_t)n;
    return (double)k < n ? k + 1 : k;
}

static uint32_t bits(uint32_t x) {
    uint32_t n = 0;
    for (; x; x &= x - 1) n++;
    return n;
}

static void raise(masu_pacing *p, uint64_t frame, uint32_t refreshes) {
    int mistake = p->lowered && frame - p->lowered < MISTAKE_FRAMES;
    p->patience = !mistake ? 1 : p->patience < PATIENCE_MOST ? p->patience * 2 : PATIENCE_MOST;
    p->refreshes = refreshes < MASU_REFRESHES_MOST ? refreshes : MASU_REFRESHES_MOST;
    p->over = p->under = p->late = 0;
}

static void follow(masu_pacing *p, uint64_t frame, double ms, double target) {
    uint32_t least = whole(target, p->refresh, TOLERANCE), fits = whole(ms, p->refresh, 1e-3);
    uint32_t roomy = whole(UNDER_ROOM * ms, p->refresh, 1e-3);
    if (!p->refreshes || least != p->least) { /* the host's target has changed */
        p->least = least;
        p->refreshes = fits > least ? fits : least;
        p->over = p->under = p->late = 0;
        p->patience = 1;
        return;
    }
    p->over = fits > p->refreshes ? p->over + 1 : 0;
    p->under =
        roomy < p->refreshes && least < p->refreshes && !(p->late & LATE_WINDOW) ? p->under + 1 : 0;
    if (p->over >= OVER_FRAMES) {
        raise(p, frame, fits);
    } else if (bits(p->late & LATE_WINDOW) >= LATE_FRAMES) {
        raise(p, frame, p->refreshes + 1);
    } else if (p->under >= UNDER_FRAMES * p->patience) {
        p->refreshes--;
        p->lowered = frame;
        p->under = 0;
    }
}

void masu_pacing_choose(masu_pacing *p, uint64_t frame, double ms, double target, int excluded) {
    uint32_t at = (uint32_t)(frame % MASU_PACING_KEPT);
    if (p->refresh == 0.0 || p->kept[at].frame == frame + 1) return;
    if (!excluded || !p->refreshes) follow(p, frame, ms, target);
    p->kept[at].frame = frame + 1;
    p->kept[at].refreshes = p->refreshes;
    p->kept[at].excluded = excluded != 0;
}

/* Planned refreshes from the frame shown last to this frame; 0: unknown. Frames in between without
 * a choice are of other viewports and need no refresh. */
static uint32_t planned(const masu_pacing *p, uint64_t frame) {
    uint32_t sum = 0;
    if (!p->shown || frame - p->shown_frame > MASU_PACING_KEPT) return 0;
    for (uint64_t f = p->shown_frame; f < frame; f++) {
        uint32_t at = (uint32_t)(f % MASU_PACING_KEPT);
        if (p->kept[at].frame == f + 1) sum += p->kept[at].refreshes;
        else if (f == p->shown_frame) return 0;
    }
    return sum;
}

int masu_pacing_shown(masu_pacing *p, uint64_t frame, uint64_t ns, uint64_t refresh_ns) {
    double refresh = (double)refresh_ns * 1e-6;
    if (!((double)refresh_ns >= REFRESH_LEAST && (double)refresh_ns <= REFRESH_MOST)) {
        memset(p, 0, sizeof *p);
        return 0;
    }
    if (!(refresh < (1.0 + SAME_REFRESH) * p->refresh &&
          p->refresh < (1.0 + SAME_REFRESH) * refresh)) {
        memset(p, 0, sizeof *p);
        p->refresh = refresh;
    }
    if (p->shown && (frame <= p->shown_frame || ns <= p->shown_ns)) return 0;
    uint32_t at = (uint32_t)(frame % MASU_PACING_KEPT), refreshes = planned(p, frame);
    double ms = (double)(ns - p->shown_ns) * 1e-6;
    int known = refreshes && p->kept[at].frame == frame + 1 && !p->kept[at].excluded;
    int late = known && ms > ((double)refreshes + 0.5) * p->refresh;
    if (known) p->late = p->late << 1 | (uint32_t)late;
    p->shown = 1;
    p->shown_frame = frame;
    p->shown_ns = ns;
    return late;
}

double masu_pacing_target(const masu_pacing *p, double target) {
    if (p->refresh == 0.0) return target;
    double fits = whole(target, p->refresh, TOLERANCE) * p->refresh;
    return fits < target ? fits : target;
}
