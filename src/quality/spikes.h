/* spikes.h: periodic spikes of the load, of a few frames each: garbage collection, streaming, work
 * of the operating system. Without this module each spike causes a fall, and a rise before the next
 * spike. After three similar spikes, the rung that is fast enough during a spike is kept in
 * between.
 *
 * A pure function of its state. docs/design/19-governor.md, "Periodic spikes". */
#ifndef MASU_SPIKES_H
#define MASU_SPIKES_H

#include <stdint.h>

/* Longest spike. A longer rise of load or time is a separate load. */
#define MASU_SPIKE_FRAMES 16u

typedef struct masu_spikes {
    double calm;     /* load between the spikes */
    double top;      /* highest load since the fall that a rise of the load has caused */
    int open;        /* after such a fall: the load has not returned yet */
    uint64_t fell;   /* frame of the fall */
    uint32_t count;  /* similar spikes in a row */
    double peak;     /* their load */
    uint64_t last;   /* frame of the last one */
    uint32_t period; /* most frames between two spikes */
    uint32_t kept;   /* periods without a spike after which the memory ends */
    int high;        /* a spike is in progress, */
    uint64_t rose;   /* since this frame */
} masu_spikes;

/* Each frame. over: the present rung is predicted to miss the target. */
void masu_spikes_follow(masu_spikes *s, uint64_t frame, double load, int over);
/* The governor falls because of the load. */
void masu_spikes_fell(masu_spikes *s, uint64_t frame, double load);
/* The load of the remembered spikes, for which the rung must be fast enough; 0: none. */
double masu_spikes_peak(const masu_spikes *s);
/* Whether the present load is a remembered spike. */
int masu_spikes_now(const masu_spikes *s, uint64_t frame, double load);

#endif
