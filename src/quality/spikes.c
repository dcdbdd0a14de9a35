/* spikes.c: see spikes.h. */
#include "quality/spikes.h"

#include <string.h>

#define PERIOD_MOST 320u /* maximum frames between spikes; rarer ones are handled one by one */
#define ALIKE 1.4        /* factor within which peaks are similar */
#define ENOUGH 3u        /* spikes that are remembered */
#define PERIODS_KEPT 2u  /* the memory ends after this many periods without a spike, */
#define PERIODS_MOST 32u /* after twice as many each time that the spikes return at once */

static int is_high(const masu_spikes *s, double load) {
    return load > 0.5 * (s->calm + s->peak) && s->peak > s->calm;
}

static void forget(masu_spikes *s, double load) {
    memset(s, 0, sizeof *s);
    s->calm = load;
}

static void add(masu_spikes *s) {
    uint64_t period = s->fell - s->last;
    int alike =
        s->count && period <= PERIOD_MOST && s->top < ALIKE * s->peak && s->peak < ALIKE * s->top;
    if (!alike) {
        s->count = s->period = s->kept = 0;
        s->peak = 0.0;
    } else if (period > s->period) {
        s->period = (uint32_t)period;
    }
    s->count++;
    if (s->count == ENOUGH && s->kept < PERIODS_MOST)
        s->kept = s->kept ? 2 * s->kept : PERIODS_KEPT;
    if (s->top > s->peak) s->peak = s->top;
    s->last = s->fell;
}

void masu_spikes_fell(masu_spikes *s, uint64_t frame, double load) {
    if (s->open || s->calm <= 0.0) return;
    s->open = 1;
    s->fell = frame;
    s->top = load;
}

void masu_spikes_follow(masu_spikes *s, uint64_t frame, double load, int over) {
    if (s->open) {
        if (load > s->top) s->top = load;
        if (load < 0.5 * (s->calm + s->top)) {
            s->open = 0;
            add(s);
        } else if (frame - s->fell > MASU_SPIKE_FRAMES) {
            forget(s, load);
        }
        return;
    }
    int high = s->count && is_high(s, load);
    if (high && !s->high) s->rose = frame;
    s->high = high;
    if (high && frame - s->rose > MASU_SPIKE_FRAMES) {
        forget(s, load);
    } else if (high && s->count >= ENOUGH) {
        s->last = frame;
        if (load > s->peak && load < ALIKE * s->peak) s->peak = load;
    } else if (s->count >= ENOUGH && frame - s->last > (uint64_t)s->kept * s->period) {
        s->count = ENOUGH - 1; /* one more spike restores the memory */
        s->last = frame;
    } else if (s->count && s->count < ENOUGH && frame - s->last > PERIOD_MOST) {
        forget(s, load);
    } else if (!high && !over) {
        s->calm = load;
    }
}

double masu_spikes_peak(const masu_spikes *s) { return s->count >= ENOUGH ? s->peak : 0.0; }

int masu_spikes_now(const masu_spikes *s, uint64_t frame, double load) {
    return s->count >= ENOUGH && s->high && load < ALIKE * s->peak &&
           frame - s->rose <= MASU_SPIKE_FRAMES;
}
