/* local_shadows.h: shadows of punctual lights: which lights have them (shadow_choice.h), where
 * their faces are in the atlas (shadow_tiles.h), and which faces a frame renders.
 *
 * FACES. A spot of up to MASU_LOCAL_ANGLE_MOST has one face, any other light up to six, of a cube
 * along the world's axes: those that its cone touches. Each is a separate cache entry. Its content
 * does not depend on the camera: every caster in the light's range is drawn in full detail. A face
 * is due when its light has moved or rotated, when an instance inside it has moved, appeared or
 * disappeared, and when its size changes. A face without possible casters has no tile.
 *
 * SIZES follow the screen. A moving light renders all its faces in each frame, so they have 256
 * texels at most. If the atlas cannot hold all faces, the largest are halved, the least important
 * first. A face keeps its tile until it is rendered into another one. If no free square of its size
 * exists, it has a smaller tile; as soon as no face is due, tiles are compacted until one is free.
 *
 * BUDGET. At most rung.local_shadow_faces are rendered per frame: first those that have waited
 * longest, then visible ones, then those of the most important light. A waiting face keeps its old
 * content.
 *
 * A MOVING LIGHT with several faces may need more faces in a frame than the budget. All faces of a
 * set are rendered from one position, the light's position in the frame in which the set was begun.
 * Until the set is complete, the previous set is shown, from its own position
 * (masu_punctual_light_data.shadow_origin): a shadow is complete and late. With F faces of moving
 * lights and a budget of B, the delay is at most 2 ceil(F / B) - 2 frames: 2 for a point light.
 *
 * The frame's slot receives the faces to render and their draws. Shadow data of each light is
 * written to masu_punctual_light_data.shadow. All decisions are made here, from numbers that do
 * not depend on the GPU. */
#ifndef MASU_LOCAL_SHADOWS_H
#define MASU_LOCAL_SHADOWS_H

#include "frame/bounds.h"
#include "frame/instances.h"
#include "frame/shadow_choice.h"
#include "frame/shadow_tiles.h"

#define MASU_LOCAL_FACES 6u
#define MASU_LOCAL_STILL 8u /* frames from which on a light does not move */
#define MASU_LOCAL_TILE_MOVES 256u

typedef struct masu_local_face {
    masu_cull_view view;
    double axis[3][3]; /* its third is where it looks */
    masu_shadow_tile tile;
    uint64_t since;  /* frame that made it due */
    uint8_t used;    /* the light reaches into it */
    uint8_t due;     /* it is not as it would be rendered now */
    uint8_t drawn;   /* it is rendered, or nothing is in it; else nothing is to be read */
    uint8_t seen;    /* part of the face's range may be in this frame's view */
    uint8_t moves;   /* it is due for another tile of its size */
    uint8_t marched; /* local_shadow_sdf has rendered the SDF into its tile */
} masu_local_face;

/* The light in a slot of the choice. */
typedef struct masu_local_light {
    double position[3], axis[3]; /* of its set of faces */
    double range, near_distance;
    double tangent; /* of half the angle of the only face; 0: cube */
    double angle;   /* half angle of the cone; pi: all directions */
    uint32_t size;  /* texels that its faces are to have */
    uint32_t wish;  /* texels for the light when stationary, in an unlimited atlas */
    uint32_t still; /* frames since it has moved, up to MASU_LOCAL_STILL */
    uint8_t behind; /* it has moved on since its set of faces was begun */
    uint8_t shown;  /* the set before is shown: its tiles, and where the light was */
    double shown_position[3];
    masu_shadow_tile shown_tiles[MASU_LOCAL_FACES];
    masu_local_face faces[MASU_LOCAL_FACES];
} masu_local_light;

typedef struct masu_local_slot {
    uint32_t lights, faces, waiting;
} masu_local_slot;

typedef struct masu_local_shadows {
    uint32_t capacity;         /* lights with shadows at a time */
    masu_shadow_slot *choice;  /* [capacity] */
    masu_local_light *lights;  /* [capacity] */
    uint32_t *slot_of_light;   /* [light]: 1 + its slot, 0: none */
    float (*boxes)[6]; /* [instance]: as of the last frame; half sizes below 0: it was hidden */
    uint8_t *group_states, *marks;
    float sdf_box[6];          /* bounds of the SDF casters; negative half sizes: there are none */
    uint64_t sdf_hash;         /* hash of the SDF's inputs in the last frame */
    masu_shadow_tiles tiles;
    masu_shadow_wish *wish; /* where capacity is not 0 */
    uint32_t most; /* lights that may have shadows in this frame */
    uint32_t since; /* frames since the last cut */
    int empty;     /* slots and boxes are cleared */
    masu_local_slot slots[MASU_MAX_FLIGHT];
} masu_local_shadows;

void masu_local_shadows_alloc(masu_local_shadows *s, masu_arena *arena,
                              const masu_frame_plan *plan);
/* Writes the constant part of the faces' draw commands to all slots. */
void masu_local_shadows_write_scene(const masu_device *device, const masu_draws *draws,
                                    const masu_scene_view *v);

/* A frame: begin, offer each light that may cast shadows, in their order, then write. */
void masu_local_shadows_begin(masu_local_shadows *s, const masu_frame_data *f);
void masu_local_shadows_offer(masu_local_shadows *s, const masu_frame_data *f, uint32_t light,
                              const masu_punctual_light_state *state, const double position[3],
                              const double direction[3]);
/* Before masu_instances_write. Returns whether a shadow may look other than in the last frame. */
int masu_local_shadows_write(masu_local_shadows *s, const masu_instances *in,
                             const masu_bounds *bounds, masu_frame_data *f);

/* masu_punctual_light_data.shadow and shadow_origin of a light. */
void masu_local_shadows_of(const masu_local_shadows *s, uint32_t light, const double eye[3],
                           struct masu_punctual_light_data *out);

/* Texels along the edge of a face: a texel at a third of the range takes three quarters of a
 * pixel, but no fewer than 256. pixels: of a length of one at distance one. */
double masu_local_face_wish(double range, double tangent, double distance, double pixels);
/* The size for a wish, with hysteresis; now: the size that it has, 0: none. */
uint32_t masu_local_face_size(double wish, uint32_t now, uint32_t most);
/* Whether a light with this axis and half angle reaches into a cube face. */
int masu_local_face_is_lit(const double axis[3], double angle, uint32_t face);

#endif
