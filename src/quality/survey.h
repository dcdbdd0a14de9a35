/* survey.h: compares measured times of rungs with each other. From only the costs of the ladder, a
 * load that no rung changes (CPU time, the display, a pass that all rungs share) looks like one
 * that has just grown. A survey therefore measures: the cheapest rung first, then better ones,
 * until the best rung is found that takes at most MASU_SURVEY_GAIN times as long. It is kept until
 * the load changes.
 *
 * A pure function of its state. docs/design/19-governor.md, "Survey". */
#ifndef MASU_SURVEY_H
#define MASU_SURVEY_H

#include <stdint.h>

#define MASU_SURVEY_RUNGS 16u
/* Ratio: times, costs and loads within it are equal. A rung that saves less is not worth its loss
 * of quality. */
#define MASU_SURVEY_GAIN 1.05
/* Ratio: a result of measurements holds while times stay within it. Three times the change that
 * counts as equal, so that drift and noise do not end it. */
#define MASU_SURVEY_RANGE 1.15

typedef enum masu_survey_verdict {
    MASU_SURVEY_UNKNOWN, /* too few times */
    MASU_SURVEY_SAME,
    MASU_SURVEY_LONGER
} masu_survey_verdict;

typedef struct masu_survey {
    /* Per rung: mean of the last times, their number, frame of the last one. */
    double mean[MASU_SURVEY_RUNGS];
    uint32_t count[MASU_SURVEY_RUNGS];
    uint64_t last[MASU_SURVEY_RUNGS];

    /* The survey. */
    int active;
    uint32_t cheapest; /* the rung that the others are compared with */
    uint32_t low;      /* the best rung found to be as cheap; the answer at the end */
    uint32_t high;     /* 1 + the last rung found to take longer; 0: none */
    int any; /* the model was wrong: rungs that it expects to take longer are measured too */

    /* Its answer. */
    int found;         /* it holds */
    double ms;         /* time of the rung */
    uint64_t near;     /* last frame within the range */
    uint64_t answered; /* frame of the answer */
    uint32_t answer;   /* the rung, remembered after it has ceased to hold */
    uint32_t wait;     /* frames that it holds at least; doubles with each equal answer */

    uint32_t left; /* 1 + the rung that the last fall left; 0: none, or compared already */

    /* Failed rises: undone although the rung below takes as long as before. Their rung takes longer
     * than the costs of the ladder predict. */
    double before;              /* time of the rung below before the last rise; 0: unknown */
    uint32_t below, tried;      /* the two rungs of that rise */
    int undone;                 /* it has been undone; not compared yet */
    uint32_t failures, barrier; /* in a row; 1 + the best rung that is excluded, 0: none */
    double barrier_ms;          /* time of the rung below; another time ends the barrier */
    uint64_t barrier_near, barrier_made;
} masu_survey;

/* Forgets all times, because the load has changed. */
void masu_survey_forget(masu_survey *s);
void masu_survey_sample(masu_survey *s, uint64_t frame, uint32_t rung, double ms);
/* Starts a survey. */
void masu_survey_begin(masu_survey *s, uint64_t frame, uint32_t cheapest);
/* Ends it with the answer `low`. */
void masu_survey_answer(masu_survey *s, uint64_t frame);
/* Number of times with this relative noise that resolve MASU_SURVEY_GAIN. */
uint32_t masu_survey_enough(double noise);
/* Whether a rung takes longer than the cheapest. */
masu_survey_verdict masu_survey_compare(const masu_survey *s, uint32_t rung, double noise);
/* Whether two rungs can take equally long, as far as the few times of the first one show. */
int masu_survey_may_be_same(const masu_survey *s, uint32_t rung, uint32_t other, double noise);
/* Whether the answer holds in this frame. ms: predicted time at `rung`. */
int masu_survey_holds(masu_survey *s, uint64_t frame, uint32_t rung, double ms);
/* A rise has been decided; a fall to rung `to` has been decided. */
void masu_survey_rise(masu_survey *s, uint32_t from, uint32_t to);
void masu_survey_undo(masu_survey *s, uint32_t to);
/* The best rung that may be risen to. ms: predicted time of the rung `below`. */
uint32_t masu_survey_barrier(masu_survey *s, uint64_t frame, double ms, double noise);

#endif
