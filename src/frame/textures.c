/* textures.c: see textures.h. Layout of the slot: shared/sprites.h. */
#include "frame/textures.h"

#include "base/error.h"
#include "device/bind.h"

#include <string.h>

_Static_assert(MASU_MAX_TEXTURE_WRITES == MASU_TEXTURE_WRITES, "a slot has room for as many");

static masu_result check_rect(const VkRect2D *r, VkExtent2D size, masu_detail *detail) {
    int64_t x = r->offset.x, y = r->offset.y;
    if (x >= 0 && y >= 0 && r->extent.width && r->extent.height &&
        x + r->extent.width <= size.width && y + r->extent.height <= size.height)
        return MASU_OK;
    return masu_fail(detail, MASU_ERROR_ARGUMENT, "rect", size.width, r->extent.width,
                     "rect is %ux%u at %d, %d: not within a texture of %ux%u", r->extent.width,
                     r->extent.height, r->offset.x, r->offset.y, size.width, size.height);
}

masu_result masu_textures_add(masu_textures *t, const masu_device *device,
                              const masu_timeline *timeline, uint32_t texture, const VkRect2D *rect,
                              const void *texels, uint32_t row_bytes, masu_detail *detail) {
    const masu_desc *d = &device->plan->desc;
    const VkExtent2D size = d->reserve.texture_size;
    const VkRect2D whole = {{0, 0}, size}, r = rect ? *rect : whole;
    if (!texture || texture > d->reserve.textures) {
        return masu_fail(detail, MASU_ERROR_LIMIT, "reserve.textures", texture, d->reserve.textures,
                         "reserve.textures: texture %u does not exist, the last one is %u", texture,
                         d->reserve.textures);
    }
    masu_result result = check_rect(&r, size, detail);
    if (result) return result;
    if (!row_bytes) row_bytes = 4 * r.extent.width;
    if (row_bytes % 4 || row_bytes < 4 * r.extent.width) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "row_bytes", 4 * r.extent.width, row_bytes,
                         "row_bytes is %u, allowed are 0 and multiples of 4 from %u on", row_bytes,
                         4 * r.extent.width);
    }
    if (t->count >= MASU_TEXTURE_WRITES) {
        return masu_fail(detail, MASU_ERROR_LIMIT, "masu_texture_write", t->count + 1,
                         MASU_TEXTURE_WRITES,
                         "masu_texture_write: this is call %u since the last frame, the limit is "
                         "%u",
                         t->count + 1, MASU_TEXTURE_WRITES);
    }
    uint64_t words = t->words + (uint64_t)r.extent.width * r.extent.height;
    if (4 * words > d->reserve.texture_bytes) {
        return masu_fail(detail, MASU_ERROR_LIMIT, "reserve.texture_bytes", 4 * words,
                         d->reserve.texture_bytes,
                         "reserve.texture_bytes: the next frame would write %llu bytes, the limit "
                         "is %u",
                         (unsigned long long)(4 * words), d->reserve.texture_bytes);
    }
    uint32_t slot = (uint32_t)(timeline->frame % d->frames_in_flight);
    unsigned char *to = masu_buffer_pointer(device, MASU_BUFFER_TEXELS, slot);
    const uint32_t write[MASU_TEXTURE_WRITE_WORDS] = {
        (uint32_t)r.offset.x, (uint32_t)r.offset.y, r.extent.width,
        r.extent.height,      texture - 1,          MASU_TEXELS_FIRST + t->words};
    memcpy(to + 4 * (MASU_TEXELS_HEAD + MASU_TEXTURE_WRITE_WORDS * t->count), write, sizeof write);
    to += 4 * (uint64_t)(MASU_TEXELS_FIRST + t->words);
    for (uint32_t y = 0; y < r.extent.height; y++) {
        memcpy(to + (uint64_t)y * 4 * r.extent.width,
               (const unsigned char *)texels + (uint64_t)y * row_bytes, 4 * r.extent.width);
    }
    t->count++;
    t->words = (uint32_t)words;
    if (t->width < r.extent.width) t->width = r.extent.width;
    if (t->height < r.extent.height) t->height = r.extent.height;
    return MASU_OK;
}

void masu_textures_write_frame(masu_textures *t, const masu_frame_data *f) {
    if (!f->plan->needs.texture_writes) return;
    const uint32_t head[MASU_TEXELS_HEAD] = {(t->width + MASU_GROUP - 1) / MASU_GROUP,
                                             (t->height + MASU_GROUP - 1) / MASU_GROUP, t->count,
                                             t->count};
    memcpy(masu_frame_slot(f, MASU_BUFFER_TEXELS), head, sizeof head);
    *t = (masu_textures){0};
}
