/* session.c: see session.h. */
#include "session.h"

#include "devices.h"
#include "file_kind.h"

#include "clock.h"
#include "image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SCENE_BYTES_MAX ((size_t)2 << 30)

static bool failed(masu_session *s, const char *subject, char *error, size_t size) {
    if (subject) {
        snprintf(error, size, "%s: %s", subject, s->detail.text);
    } else {
        snprintf(error, size, "%s", s->detail.text);
    }
    return false;
}

static bool open_scene(const masu_session_desc *d, masu_session *s, char *error, size_t size) {
    if (!d->scene_path) return true;
    uint8_t *bytes = NULL;
    size_t count = 0;
    if (!masu_file_read(d->scene_path, SCENE_BYTES_MAX, &bytes, &count, error, size)) return false;
    s->blob = bytes; /* malloc aligns to 16 */
    if (masu_scene_bind(s->blob, count, &s->scene, &s->detail)) {
        snprintf(error, size, "%s: %s%s", d->scene_path, s->detail.text,
                 masu_file_hint(d->scene_path, s->blob, count, MASU_FILE_BLOB));
        return false;
    }
    s->desc.scene = &s->scene;
    return true;
}

static bool open_targets(const masu_session_desc *d, masu_session *s, char *error, size_t size) {
    VkFormat format = d->desc.targets.format ? d->desc.targets.format : VK_FORMAT_R8G8B8A8_UNORM;
    uint32_t count = d->target_count ? d->target_count : 1;
    uint32_t most = s->host.properties.limits.maxImageDimension2D;
    if (s->desc.output.width > most || s->desc.output.height > most) {
        snprintf(error, size,
                 "size: found %ux%u pixels, expected at most %u per side on this device",
                 s->desc.output.width, s->desc.output.height, most);
        return false;
    }
    for (uint32_t i = 0; i < count; i++) {
        if (!masu_headless_target_create(&s->host, s->desc.output.width, s->desc.output.height,
                                         format, d->desc.targets.storage != 0, &s->targets[i],
                                         error, size)) {
            return false;
        }
        s->images[i] = s->targets[i].image;
        s->views[i] = s->targets[i].view;
    }
    s->desc.targets.images = s->images;
    s->desc.targets.views = s->views;
    s->desc.targets.count = count;
    return true;
}

static bool load(masu_session *s, char *error, size_t size) {
    masu_commands commands;
    masu_result result;
    while ((result = masu_load(s->m, &commands, &s->detail)) == MASU_INCOMPLETE) {
        if (!masu_headless_run(&s->host, commands.buffer, error, size)) return false;
    }
    free(s->blob); /* the renderer has its own copy */
    s->blob = NULL;
    return result == MASU_OK || failed(s, NULL, error, size);
}

bool masu_session_start(masu_session *s, char *error, size_t size) {
    if (masu_memory_query(&s->desc, &s->need, &s->detail)) return failed(s, NULL, error, size);
    size_t bytes = (size_t)((s->need.host_bytes + s->need.host_alignment - 1) /
                            s->need.host_alignment * s->need.host_alignment);
    s->block = aligned_alloc((size_t)s->need.host_alignment, bytes);
    if (!s->block) {
        snprintf(error, size, "out of memory for a host block of %zu bytes", bytes);
        return false;
    }
    if (masu_init(&s->desc, s->block, s->need.host_bytes, &s->m, &s->detail))
        return failed(s, NULL, error, size);
    return load(s, error, size);
}

masu_desc masu_session_resolved(const masu_desc *desc) {
    masu_desc d = *desc;
    d.bytes = sizeof d;
    if (masu_desc_resolve(&d, &d, NULL)) return *desc; /* fails only for another struct size */
    return d;
}

bool masu_session_denied(void) {
    const char *what = getenv("MASU_DENY");
    return what && !strcmp(what, "all");
}

/* The row of devices.inc that MASU_DENY names; NULL: none. false: it names nothing. */
static bool find_row(const masu_device_row **row, char *error, size_t size) {
    const char *what = getenv("MASU_DENY");
    *row = what ? masu_device_row_of(what) : NULL;
    if (*row || !what || !*what || masu_session_denied()) return true;
    int n = snprintf(error, size, "MASU_DENY: unknown device '%s', known are all", what);
    for (uint32_t i = 0; masu_device_row_at(i) && n > 0 && (size_t)n < size; i++)
        n += snprintf(error + n, size - (size_t)n, ", %s", masu_device_row_at(i)->name);
    return false;
}

/* The host enables no feature that the device of the row lacks. */
static void impose_row(const masu_device_row *row, masu_session *s) {
    masu_headless *host = &s->host;
    if (!row->compressed) host->compressed = false, s->desc.deny.compressed_textures = 1;
    if (!row->anisotropic) host->most_anisotropy = host->usual_anisotropy = 0.0f;
    if (!row->timestamps) s->desc.debug.timestamps = 0, s->desc.governor.wall_only = 1;
    host->ray_query = host->float16 = false;
}

bool masu_session_open(const masu_session_desc *d, masu_session *s, char *error,
                       size_t error_size) {
    memset(s, 0, sizeof *s);
    s->desc = d->desc;
    if (!s->desc.bytes) s->desc.bytes = sizeof s->desc;
    masu_headless_desc host = d->host;
    host.labels = host.labels || d->desc.debug.labels;
    host.deny = host.deny || masu_session_denied();
    if (host.deny) {
        s->desc.deny = (masu_deny){
            .unified_memory = 1, .compressed_textures = 1, .unorm16 = 1, .image_size = 4096};
        s->desc.debug.timestamps = 0;
        s->desc.governor.wall_only = 1;
    }
    const masu_device_row *row;
    if (!find_row(&row, error, error_size)) return false;
    masu_device_row_impose(row);
    if (row && !host.get_instance_proc_addr)
        host.get_instance_proc_addr = masu_device_row_proc_addr;
    host.vulkan_1_0 = host.vulkan_1_0 || (row && !row->minor);
    if (!open_scene(d, s, error, error_size) ||
        !masu_headless_open(&host, &s->host, error, error_size)) {
        masu_session_close(s);
        return false;
    }
    if (row) impose_row(row, s);
    float anisotropy = d->desc.vulkan.max_anisotropy, most = s->host.most_anisotropy;
    if (anisotropy < 0.0f) anisotropy = s->host.usual_anisotropy;
    if (anisotropy > most) anisotropy = most;
    s->desc.vulkan = (masu_vulkan){s->host.desc.get_instance_proc_addr,
                                   s->host.instance,
                                   s->host.physical,
                                   s->host.device,
                                   s->host.family,
                                   s->host.desc.allocator,
                                   VK_NULL_HANDLE,
                                   s->host.compressed,
                                   anisotropy,
                                   s->host.ray_query,
                                   s->host.float16,
                                   d->desc.vulkan.pipelines};
    s->desc.debug.labels = s->host.labels;
    if (!s->desc.clock_ns) s->desc.clock_ns = masu_clock_ns;
    if (!open_targets(d, s, error, error_size) ||
        (!d->no_renderer && !masu_session_start(s, error, error_size))) {
        masu_session_close(s);
        return false;
    }
    return true;
}

void masu_session_close(masu_session *s) {
    masu_headless_settle(&s->host);
    if (s->host.device) masu_destroy(s->m);
    s->m = NULL;
    for (uint32_t i = 0; i < MASU_MAX_TARGETS; i++)
        masu_headless_target_destroy(&s->host, &s->targets[i]);
    masu_headless_close(&s->host);
    free(s->block);
    free(s->blob);
    s->block = s->blob = NULL;
}

bool masu_session_frame(masu_session *s, const masu_frame_desc *frame, bool wait,
                        masu_commands *commands, char *error, size_t error_size) {
    /* The next slot must be free before masu_frame writes to it. */
    if (!masu_headless_wait(&s->host, s->next_slot, error, error_size)) return false;
    masu_frame_desc f = *frame;
    if (!f.bytes) f.bytes = sizeof f;
    if (masu_frame(s->m, &f, commands, &s->detail)) {
        snprintf(error, error_size, "%s", s->detail.text);
        return false;
    }
    s->next_slot = (commands->slot + 1) % masu_session_resolved(&s->desc).frames_in_flight;
    if (!masu_headless_submit(&s->host, commands->buffer, commands->slot, error, error_size))
        return false;
    return !wait || masu_headless_wait(&s->host, commands->slot, error, error_size);
}
