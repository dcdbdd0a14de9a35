/* hud.c: see hud.h. Letters of 5x7 dots are drawn by vkCmdClearAttachments, a rectangle for each run of
 * dots in a row: no shader, no pipeline, no texture, and whatever is behind them stays. A shadow makes
 * them readable before any sky. */
#include "hud.h"

#include <stdio.h>
#include <string.h>

#define RECTS 4096

/* Of ' ' to 'Z': 7 rows from the top, 5 dots each, the left one is the highest bit. */
static const uint8_t font['Z' - ' ' + 1][7] = {
    ['0' - ' '] = {14, 17, 19, 21, 25, 17, 14}, ['1' - ' '] = {4, 12, 4, 4, 4, 4, 14},
    ['2' - ' '] = {14, 17, 1, 6, 8, 16, 31},    ['3' - ' '] = {14, 17, 1, 6, 1, 17, 14},
    ['4' - ' '] = {2, 6, 10, 18, 31, 2, 2},     ['5' - ' '] = {31, 16, 30, 1, 1, 17, 14},
    ['6' - ' '] = {6, 8, 16, 30, 17, 17, 14},   ['7' - ' '] = {31, 1, 2, 4, 8, 8, 8},
    ['8' - ' '] = {14, 17, 17, 14, 17, 17, 14}, ['9' - ' '] = {14, 17, 17, 15, 1, 2, 12},
    ['A' - ' '] = {14, 17, 17, 31, 17, 17, 17}, ['B' - ' '] = {30, 17, 17, 30, 17, 17, 30},
    ['C' - ' '] = {14, 17, 16, 16, 16, 17, 14}, ['D' - ' '] = {30, 17, 17, 17, 17, 17, 30},
    ['E' - ' '] = {31, 16, 16, 30, 16, 16, 31}, ['G' - ' '] = {14, 17, 16, 23, 17, 17, 15},
    ['H' - ' '] = {17, 17, 17, 31, 17, 17, 17}, ['I' - ' '] = {14, 4, 4, 4, 4, 4, 14},
    ['K' - ' '] = {17, 18, 20, 24, 20, 18, 17}, ['L' - ' '] = {16, 16, 16, 16, 16, 16, 31},
    ['M' - ' '] = {17, 27, 21, 21, 17, 17, 17}, ['N' - ' '] = {17, 25, 21, 19, 17, 17, 17},
    ['O' - ' '] = {14, 17, 17, 17, 17, 17, 14}, ['P' - ' '] = {30, 17, 17, 30, 16, 16, 16},
    ['R' - ' '] = {30, 17, 17, 30, 20, 18, 17}, ['S' - ' '] = {15, 16, 16, 14, 1, 1, 30},
    ['T' - ' '] = {31, 4, 4, 4, 4, 4, 4},       ['U' - ' '] = {17, 17, 17, 17, 17, 17, 14},
    ['-' - ' '] = {0, 0, 0, 31, 0, 0, 0},       ['.' - ' '] = {0, 0, 0, 0, 0, 12, 12},
    ['/' - ' '] = {1, 1, 2, 4, 8, 16, 16},      [':' - ' '] = {0, 12, 12, 0, 12, 12, 0}};

typedef struct page {
    VkClearRect rects[RECTS];
    uint32_t count;
    VkExtent2D size;
} page;

static void fill(page *p, int32_t x, int32_t y, uint32_t width, uint32_t height) {
    if (x < 0 || y < 0 || x + width > p->size.width || y + height > p->size.height || p->count == RECTS) return;
    p->rects[p->count++] = (VkClearRect){{{x, y}, {width, height}}, 0, 1};
}

/* dot: pixels along the edge of one. */
static void print(page *p, const char *text, int32_t x, int32_t y, int32_t dot) {
    for (; *text; text++, x += 6 * dot) {
        if (*text < ' ' || *text > 'Z') continue;
        for (int32_t row = 0; row < 7; row++) {
            for (int32_t from = 0, to; from < 5; from = to + 1) {
                uint8_t bits = font[*text - ' '][row];
                for (to = from; to < 5 && bits >> (4 - to) & 1; to++) continue;
                if (to > from) fill(p, x + from * dot, y + row * dot, (uint32_t)((to - from) * dot), (uint32_t)dot);
            }
        }
    }
}

static void flush(page *p, VkCommandBuffer to, float grey, int32_t moved) {
    VkClearAttachment color = {VK_IMAGE_ASPECT_COLOR_BIT, 0, {.color = {.float32 = {grey, grey, grey, 1}}}};
    for (uint32_t i = 0; i < p->count; i++)
        p->rects[i].rect.offset.x += moved, p->rects[i].rect.offset.y += moved;
    if (p->count) vkCmdClearAttachments(to, 1, &color, p->count, p->rects);
}

static const char *clock_text(double seconds, char text[16]) {
    int hundredths = (int)fmin(seconds * 100, 599999);
    snprintf(text, 16, "%d:%02d.%02d", hundredths / 6000, hundredths / 100 % 60, hundredths % 100);
    return seconds > 0 ? text : "-:--.--";
}

void hud_record(const window *w, VkCommandBuffer to, uint32_t image, const race *r, bool paused, uint32_t rung) {
    static page p;
    char text[64], clock[16], best[16];
    int32_t width = (int32_t)w->size.width, height = (int32_t)w->size.height;
    int32_t dot = height / 240 > 1 ? height / 240 : 1, edge = 6 * dot;
    p.count = 0, p.size = (VkExtent2D){w->size.width - (uint32_t)dot, w->size.height - (uint32_t)dot};
    snprintf(text, sizeof text, "LAP %d  P %d/%d", r->laps + 1, race_position(r), r->track->cars);
    print(&p, text, edge, edge, dot);
    snprintf(text, sizeof text, "TIME %s", clock_text(r->time, clock));
    print(&p, text, width - edge - 12 * 6 * dot, edge, dot);
    snprintf(text, sizeof text, "BEST %s", clock_text(r->best, best));
    print(&p, text, width - edge - 12 * 6 * dot, edge + 10 * dot, dot);
    snprintf(text, sizeof text, "%3.0f", fabs(car_speed(&r->cars[r->player])) * 3.6);
    print(&p, text, edge, height - edge - 21 * dot, 3 * dot);
    print(&p, "KM/H", edge + 57 * dot, height - edge - 7 * dot, dot);
    snprintf(text, sizeof text, "RUNG %u", rung);
    print(&p, text, width - edge - 6 * 6 * dot, height - edge - 7 * dot, dot);
    if (paused) print(&p, "PAUSED", (width - 36 * 3 * dot) / 2, height / 3, 3 * dot);
    VkRenderPassBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                   .renderPass = w->pass,
                                   .framebuffer = w->framebuffers[image],
                                   .renderArea = {{0, 0}, w->size}};
    vkCmdBeginRenderPass(to, &begin, VK_SUBPASS_CONTENTS_INLINE);
    flush(&p, to, 0.02f, dot);
    flush(&p, to, 1.0f, -dot);
    vkCmdEndRenderPass(to);
}
