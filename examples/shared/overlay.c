/* overlay.c: see overlay.h. Text is written as pixels on a dark background, which are copied into
 * the image: no shader, no pipeline, no texture. */
#include "overlay.h"

#include <stdio.h>

#define WORDS_BYTES (2u << 20)
#define COPY_BYTES (2560u * 1440 * 4)
static const VkImageSubresourceLayers color = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};

static bool take_buffer(window *w, VkDeviceSize bytes, overlay_buffer *b) {
    VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                               .size = bytes,
                               .usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                                        VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    VkPhysicalDeviceMemoryProperties has;
    VkMemoryRequirements need;
    VkMemoryPropertyFlags wanted =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    uint32_t type = 0; /* Vulkan guarantees such a type */
    vkGetPhysicalDeviceMemoryProperties(w->gpu, &has);
    if (vkCreateBuffer(w->device, &info, NULL, &b->buffer))
        return fprintf(stderr, "cannot create the overlay's buffer\n"), false;
    vkGetBufferMemoryRequirements(w->device, b->buffer, &need);
    while (!(need.memoryTypeBits >> type & 1) ||
           (has.memoryTypes[type].propertyFlags & wanted) != wanted)
        type++;
    return window_memory(w, type, need.size, &b->memory, &b->mapped) &&
           vkBindBufferMemory(w->device, b->buffer, b->memory, 0) == VK_SUCCESS;
}

bool overlay_open(overlay *o, window *w) {
    o->window = w;
    return take_buffer(w, WORDS_BYTES, &o->words[0]) && take_buffer(w, WORDS_BYTES, &o->words[1]) &&
           take_buffer(w, COPY_BYTES, &o->copy);
}

void overlay_close(overlay *o) {
    for (int i = 0; o->window && i <= WINDOW_SLOTS; i++) {
        overlay_buffer *b = i < WINDOW_SLOTS ? &o->words[i] : &o->copy;
        vkDestroyBuffer(o->window->device, b->buffer, NULL);
        vkFreeMemory(o->window->device, b->memory, NULL);
    }
}

/* ---- text ------------------------------------------------------------------------------------ */

/* A font of 3x5 dots from '-' on: each octal digit is a row, from the top, with the left dot in its
 * highest bit. */
static const uint16_t font[] = {
    /* - . / 0 ... 6 */
    000700, 000002, 011244, 075557, 026227, 071747, 071717, 055711, 074717, 074757,
    071111, 075757, 075717, 002020, 000000, 000000, 000000, 000000, 000000, 000000, /* 7 8 9 : */
    025755, 065656, 034443, 065556, 074647, 074644, 034553, 055755, 072227, 011152, /* A ... J */
    055655, 044447, 057755, 065555, 025552, 065644, 025573, 065655, 034216, 072222, /* K ... T */
    055557, 055552, 055775, 055255, 055222, 071247};                                /* U ... Z */

static bool is_lit(char sign, int x, int y) {
    if (sign < '-' || sign > 'Z' || x < 0 || x > 2 || y < 0 || y > 4) return false;
    return font[sign - '-'] >> (14 - 3 * y - x) & 1;
}

/* Writes the line's pixels at `used`, and their destination to *to. Returns 0 if the line does not
 * fit. */
static VkDeviceSize write_line(const overlay_line *l, VkExtent2D screen, void *mapped,
                               VkDeviceSize used, VkBufferImageCopy *to) {
    int signs = 0;
    while (l->text[signs]) signs++;
    int width = (4 * signs + 1) * l->dot, height = 7 * l->dot;
    VkDeviceSize bytes = (VkDeviceSize)width * (VkDeviceSize)height * 4;
    uint32_t *pixel = (uint32_t *)((char *)mapped + used);
    *to = (VkBufferImageCopy){.bufferOffset = used,
                              .imageSubresource = color,
                              .imageOffset = {l->x, l->y, 0},
                              .imageExtent = {(uint32_t)width, (uint32_t)height, 1}};
    if (!signs || l->x < 0 || l->y < 0 || l->x + width > (int)screen.width ||
        l->y + height > (int)screen.height || used + bytes > WORDS_BYTES)
        return 0;
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++) {
            int sign = x / l->dot / 4, across = x / l->dot % 4 - 1;
            bool lit = sign < signs && is_lit(l->text[sign], across, y / l->dot - 1);
            *pixel++ = lit ? 0xFFFFFFFFu : 0xFF202020u;
        }
    }
    return bytes;
}

/* ---- into the image, and out of it ----------------------------------------------------------- */

static void barrier(VkCommandBuffer to, VkImage image, VkImageLayout before, VkImageLayout after) {
    VkPipelineStageFlags all = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_HOST_BIT;
    VkImageMemoryBarrier b = {VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                              NULL,
                              VK_ACCESS_MEMORY_WRITE_BIT,
                              VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
                              before,
                              after,
                              VK_QUEUE_FAMILY_IGNORED,
                              VK_QUEUE_FAMILY_IGNORED,
                              image,
                              {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    vkCmdPipelineBarrier(to, all, all, 0, 0, NULL, 0, NULL, 1, &b);
}

bool overlay_record(overlay *o, uint32_t slot, uint32_t image, const overlay_line *lines, int count,
                    bool copy) {
    const VkImageLayout write = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                        read = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    window *w = o->window;
    VkImage picture = w->images[image];
    VkCommandBuffer own = w->commands[slot];
    VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                      .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    VkBufferImageCopy all = {.imageSubresource = color,
                             .imageExtent = {w->size.width, w->size.height, 1}},
                      to;
    VkDeviceSize used = 0, bytes;
    const VkClearColorValue dark = {.float32 = {0.03f, 0.03f, 0.03f, 1}};
    const VkImageSubresourceRange whole = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    copy = copy && (VkDeviceSize)w->size.width * w->size.height * 4 <= COPY_BYTES;
    if (vkBeginCommandBuffer(own, &begin)) return false;
    barrier(own, picture, o->blank ? VK_IMAGE_LAYOUT_UNDEFINED : read, write);
    if (o->blank) vkCmdClearColorImage(own, picture, write, &dark, 1, &whole);
    for (int i = 0; i < count; i++) {
        if (!(bytes = write_line(&lines[i], w->size, o->words[slot].mapped, used, &to))) continue;
        barrier(own, picture, write, write); /* lines may overlap */
        vkCmdCopyBufferToImage(own, o->words[slot].buffer, picture, write, 1, &to);
        used += bytes;
    }
    if (copy) {
        barrier(own, picture, write, read);
        vkCmdCopyImageToBuffer(own, picture, read, o->copy.buffer, 1, &all);
    }
    barrier(own, picture, copy ? read : write, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR);
    return vkEndCommandBuffer(own) == VK_SUCCESS;
}

bool overlay_save(overlay *o, const char *file) {
    window *w = o->window;
    int width = (int)w->size.width, height = (int)w->size.height;
    bool is_bgr = w->format == VK_FORMAT_B8G8R8A8_UNORM || w->format == VK_FORMAT_B8G8R8A8_SRGB;
    bool fits = (unsigned)width * (unsigned)height * 4 <= COPY_BYTES;
    if (vkDeviceWaitIdle(w->device)) return false;
    /* SDL names channels from the highest byte of a number: in memory this is B, G, R, unused. */
    SDL_Surface *s = !fits ? NULL
                           : SDL_CreateRGBSurfaceWithFormatFrom(
                                 o->copy.mapped, width, height, 32, 4 * width,
                                 is_bgr ? SDL_PIXELFORMAT_XRGB8888 : SDL_PIXELFORMAT_XBGR8888);
    bool good = s && SDL_SaveBMP(s, file) == 0;
    SDL_FreeSurface(s);
    if (!good)
        fprintf(stderr, "cannot write %s: %s\n", file,
                fits ? SDL_GetError() : "the window is too large");
    return good;
}
