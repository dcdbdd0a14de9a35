/* skin.h: the rules of clips and skins that both the reader of blobs and the baker, which gets them from
 * another process, hold them to. Pure functions: what is wrong, in a few words, or NULL. */
#ifndef MASU_SCENE_SKIN_H
#define MASU_SCENE_SKIN_H

#include "scene/blob.h"

#define MASU_CLIP_SECONDS_MAX 1e9f

/* Of a model with so many nodes. `keys` are all there are, `next` the first that no channel before has. */
const char *masu_wrong_channel(const masu_blob_channel *channel, uint32_t nodes,
                               const masu_blob_key *keys, uint64_t key_count, uint64_t next);
const char *masu_wrong_joint(const masu_blob_joint *joint, uint32_t nodes);
/* joints: those of its skin. Their boxes hold it, too. */
const char *masu_wrong_skin_vertex(const masu_blob_skin_vertex *vertex,
                                   const masu_blob_joint *joints, uint32_t joint_count);

/* With its deltas, one for each of its skin's vertices. */
const char *masu_wrong_morph_target(const masu_blob_morph_target *target,
                                    const masu_blob_morph_delta *deltas, uint32_t vertices);

#endif
