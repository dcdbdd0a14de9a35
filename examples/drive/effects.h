/* effects.h: what tyres and weather leave behind: skid marks, which are meshes of the host; smoke,
 * spray and rain, which are particles and trails with an atlas painted in code. */
#ifndef DRIVE_EFFECTS_H
#define DRIVE_EFFECTS_H

#include "masu.h"
#include "race.h"

#define MARK_CHUNKS 8 /* meshes; the oldest one makes room for new marks */
#define MARK_QUADS 128 /* per mesh */
#define PUFFS 320
#define DROPS 700
#define ATLAS 256 /* texels along an edge; 4x4 cells */

typedef struct mark_chunk {
    float positions[4 * MARK_QUADS][3], normals[4 * MARK_QUADS][3];
    uint32_t quads;
    bool dirty; /* changed since its last upload */
    masu_model model; /* id 0: not created yet */
} mark_chunk;

typedef struct mark_wheel {
    bool on; /* it leaves a mark, whose end is at: */
    vec left, right, up;
} mark_wheel;

typedef struct puff {
    vec at, velocity;
    float age, life; /* seconds; dead when age >= life */
    float size, turn, gray, opacity;
    int cell; /* of the atlas */
} puff;

typedef struct effects {
    mark_chunk marks[MARK_CHUNKS];
    mark_wheel wheels[TRACK_CARS][TRACK_WHEELS];
    uint32_t indices[MARK_QUADS][6];
    uint32_t chunk, random, next_puff;
    double due[TRACK_CARS]; /* puffs that a car owes, the fraction of the next one included */
    puff puffs[PUFFS];
    bool has_marks, atlas_written;
    uint8_t atlas[ATLAS * ATLAS * 4];
    masu_particle particles[PUFFS];
    masu_trail_point points[DROPS][2];
    masu_trail trails[DROPS];
} effects;

/* Fills the atlas and the indices. */
void effects_open(effects *e);
/* The capacities that the effects need. A scene without a material "skid" gets no marks. */
void effects_reserve(const masu_scene *scene, masu_reserve *reserve);
/* A new renderer has nothing yet: the next frames upload everything again. */
void effects_reset(effects *e, const masu_scene *scene);
void effects_step(effects *e, const race *race, double dt, bool rain);
/* Uploads changed marks, and adds particles and trails to the frame. */
masu_result effects_frame(effects *e, masu_renderer *masu, const race *race, bool rain,
                          masu_frame_desc *frame, masu_detail *detail);

#endif
