/* skin.h: validation rules of clips and skins, shared by the blob reader and by the baker, which
 * gets the data from another process. Pure functions. They return NULL, or a short error text. */
#ifndef MASU_SCENE_SKIN_H
#define MASU_SCENE_SKIN_H

#include "scene/blob.h"

#define MASU_CLIP_SECONDS_MAX 1e9f

/* Validates a channel of a model with `nodes` nodes. `keys`: all keys; `next`: the first key that
 * no earlier channel uses. */
const char *masu_wrong_channel(const masu_blob_channel *channel, uint32_t nodes,
                               const masu_blob_key *keys, uint64_t key_count, uint64_t next);
const char *masu_wrong_joint(const masu_blob_joint *joint, uint32_t nodes);
/* joints: of the vertex's skin. Their bounds must contain the vertex. */
const char *masu_wrong_skin_vertex(const masu_blob_skin_vertex *vertex,
                                   const masu_blob_joint *joints, uint32_t joint_count);

/* Validates a target and its deltas, one per vertex of its skin. */
const char *masu_wrong_morph_target(const masu_blob_morph_target *target,
                                    const masu_blob_morph_delta *deltas, uint32_t vertices);

#endif
