/* shadow_choice.c: see shadow_choice.h. */
#include "frame/shadow_choice.h"

#include "shared/masu_shared.h"

#include <math.h>
#include <string.h>

double masu_shadow_score(double intensity, double radius, double distance) {
    double apart = radius / fmax(distance, 0.5 * radius);
    return intensity * apart * apart;
}

void masu_shadow_wish_add(masu_shadow_wish *wish, uint32_t most, uint32_t light, double score) {
    uint32_t at = wish->count;
    if (!(score > 0.0) || !most) return;
    while (at > 0 && score > wish->score[at - 1]) at--; /* equal scores: stable order */
    if (at >= most) return;
    if (wish->count < most) wish->count++;
    for (uint32_t i = wish->count - 1; i > at; i--) {
        wish->light[i] = wish->light[i - 1];
        wish->score[i] = wish->score[i - 1];
    }
    wish->light[at] = light;
    wish->score[at] = score;
}

static int is_wanted(const masu_shadow_wish *wish, uint32_t light) {
    for (uint32_t i = 0; i < wish->count; i++) {
        if (wish->light[i] == light) return 1;
    }
    return 0;
}

static uint32_t slot_of(const masu_shadow_slot *slots, uint32_t count, uint32_t light) {
    uint32_t slot = 0;
    while (slot < count && slots[slot].light != light) slot++;
    return slot;
}

/* The unwanted light of the lowest score that may be removed. */
static uint32_t victim_of(const masu_shadow_slot *slots, uint32_t count,
                          const masu_shadow_wish *wish, int cut) {
    uint32_t victim = count;
    for (uint32_t s = 0; s < count; s++) {
        if (!slots[s].light || slots[s].leaves || is_wanted(wish, slots[s].light)) continue;
        if (!cut && slots[s].age < MASU_SHADOW_HOLD) continue;
        if (victim == count || slots[s].score < slots[victim].score) victim = s;
    }
    return victim;
}

void masu_shadow_choose(masu_shadow_slot *slots, uint32_t count, uint32_t most,
                        const masu_shadow_wish *wish, uint32_t since,
                        void (*left)(void *user, uint32_t slot), void *user) {
    uint32_t waiting = 0, used = 0, leaving = 0;
    int cut = since == 0;
    for (uint32_t i = 0; i < wish->count; i++)
        waiting += slot_of(slots, count, wish->light[i]) == count;
    for (uint32_t s = 0; s < count; s++) {
        masu_shadow_slot *slot = &slots[s];
        if (!slot->light) continue;
        slot->age++;
        if (!slot->offered) slot->leaves = 1;
        if (slot->leaves && slot->offered && is_wanted(wish, slot->light)) slot->leaves = 0;
        used++;
        leaving += slot->leaves != 0;
    }
    /* So many have to leave that all that are wanted find a slot. */
    while (used - leaving + waiting > most) {
        uint32_t victim = victim_of(slots, count, wish, cut);
        if (victim == count) break;
        slots[victim].leaves = 1;
        leaving++;
    }
    for (uint32_t s = 0; s < count; s++) {
        masu_shadow_slot *slot = &slots[s];
        if (!slot->light) continue;
        if (!slot->leaves) {
            if (slot->ready && slot->fade < MASU_LOCAL_FADE)
                slot->fade = since < MASU_SHADOW_CUT ? MASU_LOCAL_FADE : slot->fade + 1;
            continue;
        }
        slot->fade = cut || !slot->fade ? 0 : slot->fade - 1;
        if (slot->fade) continue;
        left(user, s);
        memset(slot, 0, sizeof *slot);
        used--;
    }
    for (uint32_t i = 0; i < wish->count && used < most; i++) {
        if (slot_of(slots, count, wish->light[i]) < count) continue;
        uint32_t s = slot_of(slots, count, 0);
        if (s == count) break;
        slots[s] =
            (masu_shadow_slot){.light = wish->light[i], .score = wish->score[i], .offered = 1};
        used++;
    }
}
