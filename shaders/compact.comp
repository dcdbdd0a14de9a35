/*
 * compact.comp: writes the lists of visible instances and the counts of their draws. The order of
 * stage 1 is preserved: the first of two surfaces at equal depth wins, so the order may not depend
 * on culling or on the order in which invocations run.
 *
 * Placed meshes with few instances have one invocation each. For the others, a group processes 64
 * instances per iteration. Views in y. push.header: the header of src/frame/occlusion.c. push.few:
 * groups of the first kind. push.view: the first view.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#define MASU_DRAWN_ACCESS
#include "push/compact.h"
#include "shared/counters.h"
#include "shared/culling.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/culling.glsl"

layout(local_size_x = 64) in;

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_SEEN, std430) readonly buffer Seen
{
    uint seen[];
};

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_DRAWS, std430) buffer Draws
{
    uint draws[];
};

shared uint group_mask[2];

struct batch {
    uint first, first_draw, draw_count, triangles;
};

batch batch_of(uint number)
{
    uint at = masu_cull_word(MASU_CULL_BATCHES) + 4u * number;
    return batch(drawn[at], drawn[at + 1u], drawn[at + 2u], drawn[at + 3u]);
}

void finish(uint view, batch b, uint count)
{
    masu_count(MASU_COUNTER_VISIBLE + 2u * view, count);
    masu_count(MASU_COUNTER_VISIBLE + 2u * view + 1u, count * b.triangles);
}

void main()
{
    masu_count_begin();
    uint view = gl_WorkGroupID.y + push.view, views = masu_cull_word(MASU_CULL_VIEWS);
    uint instance_count = masu_cull_word(MASU_CULL_INSTANCES);
    uint draw_count = masu_cull_word(MASU_CULL_DRAWS);
    uint marks = view * instance_count;
    uint from = view * masu_cull_word(MASU_CULL_LISTED); /* stage 1's lists, and the output's */
    uint to = masu_cull_word(MASU_CULL_LISTS) + from;
    uint draws_from = view * draw_count, draws_to = (views + view) * draw_count;
    uint lane = gl_LocalInvocationID.x;
    bool small = gl_WorkGroupID.x < push.few;
    uint number = gl_WorkGroupID.x * 64u + lane;
    bool mine = small && number < masu_cull_word(MASU_CULL_BATCH_COUNT);
    if (!small) {
        number = drawn[masu_cull_word(MASU_CULL_LARGE) + gl_WorkGroupID.x - push.few];
    }
    batch b = batch_of(small && !mine ? 0u : number);
    uint kept = draws[5u * (draws_from + b.first_draw) + 1u], count = 0u;
    if (mine && kept <= 64u) {
        for (uint i = 0u; i < 64u; i++) {
            if (i >= kept) {
                break;
            }
            uint id = drawn[from + b.first + i];
            if (seen[marks + id] != 0u) {
                drawn[to + b.first + count] = id;
                count++;
            }
        }
    }
    if (!small && kept > 64u) {
        for (uint i = 0u; i < uint(MASU_CULL_ROUNDS); i++) {
            if (64u * i >= kept) {
                break;
            }
            barrier();
            if (lane < 2u) {
                group_mask[lane] = 0u;
            }
            barrier();
            uint place = 64u * i + lane, id = 0u;
            bool shows = false;
            if (place < kept) {
                id = drawn[from + b.first + place];
                shows = seen[marks + id] != 0u;
            }
            if (shows) {
                atomicOr(group_mask[lane >> 5], 1u << (lane & 31u));
            }
            barrier();
            uint before = bitCount(group_mask[lane >> 5] & ((1u << (lane & 31u)) - 1u)) +
                          (lane >= 32u ? uint(bitCount(group_mask[0])) : 0u);
            if (shows) {
                drawn[to + b.first + count + before] = id;
            }
            count += uint(bitCount(group_mask[0]) + bitCount(group_mask[1]));
        }
    }
    /* A large batch of which stage 1 keeps at most 64 is processed like a small one. */
    bool own = small ? mine && kept <= 64u : kept > 64u && lane == 0u;
    if (own) {
        for (uint i = 0u; i < uint(MASU_CULL_ROUNDS); i++) {
            if (i >= b.draw_count) {
                break;
            }
            draws[5u * (draws_to + b.first_draw + i) + 1u] = count;
        }
        finish(view, b, count);
    }
    masu_count_end();
}
