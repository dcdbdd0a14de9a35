/* shadow_choice.h: which punctual lights have a shadow, and how far it is faded in. Deterministic;
 * pure functions over the caller's memory.
 *
 * The lights of the highest scores are wanted. One that has a shadow counts
 * MASU_SHADOW_HYSTERESIS times. One that is no longer wanted keeps its shadow until another one
 * needs the slot, and MASU_SHADOW_HOLD frames in any case; then it fades out before the other
 * one fades in. */
#ifndef MASU_SHADOW_CHOICE_H
#define MASU_SHADOW_CHOICE_H

#include <stdint.h>

#define MASU_SHADOW_HYSTERESIS 1.5
#define MASU_SHADOW_UNSEEN 0.3 /* score factor of lights outside the view */
#define MASU_SHADOW_HOLD 30u   /* frames */
#define MASU_SHADOW_CUT 16u    /* frames after a cut in which shadows appear without a fade */
#define MASU_SHADOW_LIGHTS_MAX 256u /* with shadows at a time, in all viewports */

/* A light with a shadow. */
typedef struct masu_shadow_slot {
    uint32_t light; /* 1 + its number; 0: the slot is free */
    uint32_t age;   /* frames since it has the slot */
    uint32_t fade;  /* 0 to MASU_LOCAL_FADE: how much of its shadow is shown */
    int leaves;     /* it fades out, and then loses the slot */
    int ready;      /* its faces are rendered: it may fade in */
    int offered;    /* in this frame: it is still there and may cast shadows */
    double score;   /* of this frame */
} masu_shadow_slot;

/* Lights in the order of their scores, the highest first. */
typedef struct masu_shadow_wish {
    uint32_t count, light[MASU_SHADOW_LIGHTS_MAX];
    double score[MASU_SHADOW_LIGHTS_MAX];
} masu_shadow_wish;

/* Intensity times the solid angle, up to a factor, of the sphere that a light reaches: its
 * radius, and how far away its centre is. */
double masu_shadow_score(double intensity, double radius, double distance);

/* Adds a light (1 + its number) if it is among the `most` of the highest scores. */
void masu_shadow_wish_add(masu_shadow_wish *wish, uint32_t most, uint32_t light, double score);

/* The next frame: lights fade, leave slots and take slots. `most`: slots that may be used.
 * since: frames since the last cut, 0: in this one nobody sees what pops. `left` is called for
 * each slot whose light has lost it. */
void masu_shadow_choose(masu_shadow_slot *slots, uint32_t count, uint32_t most,
                        const masu_shadow_wish *wish, uint32_t since,
                        void (*left)(void *user, uint32_t slot), void *user);

#endif
