/* bounce.h: chooses the live probes that trace rays in a frame. In a round every probe traces one
 * set of rays, visible probes first. A change of lights or geometry restarts the sets of all
 * probes, so that no probe averages old and new light; while changes follow each other within FIRST
 * rounds, a sliding window of FIRST sets is used instead. After REST rounds without a change no
 * probe traces, and the probes keep their values.
 *
 * The state depends on the host's calls only: nothing is read back. */
#ifndef MASU_BOUNCE_H
#define MASU_BOUNCE_H

#include "frame/frame_data.h"
#include "frame/instances.h"
#include "frame/materials.h"
#include "frame/punctual_lights.h"
#include "scene/blob_section.h"

enum {
    MASU_BOUNCE_FIRST = 4,   /* sets of a probe that are shown soon after a change */
    MASU_BOUNCE_WINDOW = 16, /* all sets of a probe */
    MASU_BOUNCE_REST = 256,  /* rounds */
    /* after the first frame, or a cut: most of what bounces has come by then */
    MASU_BOUNCE_BURST_ROUNDS = 16,
    /* after a change that follows no other */
    MASU_BOUNCE_SWIFT_ROUNDS = MASU_BOUNCE_FIRST + MASU_BOUNCE_WINDOW,
    MASU_BOUNCE_OFF = 0xFF  /* `sets` of a probe that is inside of something */
};

/* Inputs of the light that the host can change. */
typedef struct masu_bounce_cause {
    uint32_t lights, instances, materials;
    float sun[2][3], sky[15][4], params[MASU_SDF_PARAM_VEC4S][4], time;
} masu_bounce_cause;

typedef struct masu_bounce {
    struct masu_bounce_probe {
        uint8_t sets;  /* traced since the last restart; from FIRST + WINDOW on around, by WINDOW */
        uint8_t round; /* the last that it took part in */
    } *probes;
    uint32_t count, valid; /* all, and those that are not off */
    uint32_t counts[3];
    float origin[3], spacing[3];
    int lit;        /* the probes have baked light: sun and sky are no cause */
    uint32_t round; /* the present one; its low byte distinguishes rounds */
    uint32_t left;  /* probes that it lacks */
    uint32_t quiet; /* whole rounds since the last change */
    uint32_t burst, swift; /* rounds that still have four times, twice the rays */
    masu_bounce_cause cause;
    uint32_t slot_left[MASU_MAX_FLIGHT]; /* masu_stats_info.bounce_rounds_left */
} masu_bounce;

/* Which probes are to be first: NULL: none. */
typedef struct masu_bounce_view {
    const float *clip_from_rel; /* 16 */
    double eye[3];
} masu_bounce_view;

void masu_bounce_alloc(masu_bounce *b, masu_arena *arena, const masu_frame_plan *plan);
void masu_bounce_copy_scene(masu_bounce *b, const masu_frame_plan *plan, const masu_scene_view *v);

/* Something has changed. */
void masu_bounce_restart(masu_bounce *b);
/* Probes of the next frame, of `most` in a burst. */
uint32_t masu_bounce_pace(const masu_bounce *b, uint32_t most);
/* Chooses at most `most` probes, encoded as in shared/bounce.h; returns their number. */
uint32_t masu_bounce_choose(masu_bounce *b, const masu_bounce_view *view, uint32_t most,
                            uint32_t *words);

/* Restarts if the inputs of light differ from the previous frame. */
void masu_bounce_follow(masu_bounce *b, const masu_lights *lights, const masu_instances *in,
                        const masu_materials *materials, const masu_frame_data *f);
/* masu_bounce_follow, then writes the frame's slot. */
void masu_bounce_write(masu_bounce *b, const masu_lights *lights, const masu_instances *in,
                       const masu_materials *materials, const masu_frame_data *f);

#endif
