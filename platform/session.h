/* session.h: a scene file (or none), a headless host, targets and a renderer in one block: the
 * setup that tools and most tests need before the first frame. A real port has its own device and
 * memory instead.
 *
 * With MASU_DENY=all in the environment a session behaves like a device without optional features:
 * no compressed textures, anisotropy, ray queries, 16-bit floats, unified memory or timestamps.
 * With MASU_DENY=pi5, or another row of devices.inc, it has the limits and the optional features of
 * that device, and no ray queries or 16-bit floats. */
#ifndef MASU_SESSION_H
#define MASU_SESSION_H

#include "headless.h"
#include "masu.h"

typedef struct masu_session_desc {
    const char *scene_path; /* NULL: no scene */
    masu_desc
        desc; /* masu_session_open fills in bytes, vulkan (except its pipelines), scene,
               * targets.images and .views; the rest is as given. vulkan.max_anisotropy: limited to
               * the device's; below 0: the host's usual_anisotropy */
    masu_headless_desc host;
    uint32_t target_count; /* 0: 1 */
    bool no_renderer;      /* stop before masu_init; masu_session_start continues */
} masu_session_desc;

typedef struct masu_session {
    masu_headless host;
    masu_desc desc; /* as passed to masu_init */
    masu_memory need;
    masu_detail detail; /* of the masu_* call that failed */
    masu_scene scene;
    void *blob;
    void *block;
    masu_renderer *m;
    uint32_t next_slot;
    masu_headless_target targets[MASU_MAX_TARGETS];
    VkImage images[MASU_MAX_TARGETS];
    VkImageView views[MASU_MAX_TARGETS];
} masu_session;

bool masu_session_denied(void); /* MASU_DENY=all */

/* On false `error` has one line and everything is closed. The session must not be moved
 * afterwards. */
bool masu_session_open(const masu_session_desc *desc, masu_session *s, char *error,
                       size_t error_size);
void masu_session_close(masu_session *s);

/* After no_renderer: queries the memory, creates the renderer from s->desc and loads the scene. The
 * session stays open on failure. */
bool masu_session_start(masu_session *s, char *error, size_t error_size);

/* masu_desc_resolve for a description whose `bytes` may be 0. */
masu_desc masu_session_resolved(const masu_desc *desc);

/* Renders one frame: waits for its slot, writes and submits it. With `wait` it has finished on
 * return. frame->bytes may be 0. */
bool masu_session_frame(masu_session *s, const masu_frame_desc *frame, bool wait,
                        masu_commands *commands, char *error, size_t error_size);

#endif
