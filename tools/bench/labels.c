/* labels.c: see labels.h. */
#include "bench/labels.h"

#include <math.h>
#include <string.h>

static double pixel(const masu_labels *l, int axis, double value) {
    return l->size[axis] * log(value / l->low[axis]) / log(l->high[axis] / l->low[axis]);
}

static bool add(masu_labels *l, const struct masu_label_box *box) {
    if (l->count == MASU_LABELS_MAX) return false;
    l->boxes[l->count++] = *box;
    return true;
}

void masu_labels_mark(masu_labels *l, const double at[2], double radius) {
    struct masu_label_box box;
    for (int k = 0; k < 2; k++) {
        box.low[k] = pixel(l, k, at[k]) - radius;
        box.high[k] = pixel(l, k, at[k]) + radius;
    }
    (void)add(l, &box);
}

void masu_labels_line(masu_labels *l, const double from[2], const double to[2]) {
    if (l->line_count == MASU_LABELS_MAX) return;
    for (int k = 0; k < 2; k++) {
        l->lines[l->line_count][0][k] = pixel(l, k, from[k]);
        l->lines[l->line_count][1][k] = pixel(l, k, to[k]);
    }
    l->line_count++;
}

/* Whether a line comes nearer than LINE_GAP to a box: its part between both pairs of sides. */
#define LINE_GAP 2.0
static bool crosses(const double line[2][2], const struct masu_label_box *box) {
    double enter = 0, leave = 1;
    for (int k = 0; k < 2; k++) {
        const double low = box->low[k] - LINE_GAP - line[0][k],
                     high = box->high[k] + LINE_GAP - line[0][k], along = line[1][k] - line[0][k];
        if (fabs(along) < 1e-9) {
            if (low > 0 || high < 0) return false;
            continue;
        }
        enter = fmax(enter, fmin(low / along, high / along));
        leave = fmin(leave, fmax(low / along, high / along));
    }
    return enter <= leave;
}

static bool is_free(const masu_labels *l, const struct masu_label_box *box) {
    for (int k = 0; k < 2; k++)
        if (!(box->low[k] >= 0) || !(box->high[k] <= l->size[k])) return false;
    for (uint32_t i = 0; i < l->count; i++) {
        const struct masu_label_box *b = &l->boxes[i];
        if (box->low[0] < b->high[0] && b->low[0] < box->high[0] && box->low[1] < b->high[1] &&
            b->low[1] < box->high[1])
            return false;
    }
    for (uint32_t i = 0; i < l->line_count; i++)
        if (crosses(l->lines[i], box)) return false;
    return true;
}

bool masu_labels_place(masu_labels *l, const double at[2], const char *text, double font,
                       double out[2]) {
    /* Letters of a sans-serif font are 0.6 of its height wide on average. */
    const double width = 0.6 * font * (double)strlen(text), gap = 0.7 * font;
    /* Lower left corners relative to the point: right, above, below and left of it. */
    const double corners[][2] = {{gap, -font / 2},           {gap, gap},         {gap, -gap - font},
                                 {-width / 2, gap},          {-width / 2, -gap - font},
                                 {-gap - width, -font / 2},  {-gap - width, gap},
                                 {-gap - width, -gap - font}};
    for (size_t c = 0; c < sizeof corners / sizeof *corners; c++) {
        struct masu_label_box box;
        const double extent[2] = {width, font};
        for (int k = 0; k < 2; k++) {
            box.low[k] = pixel(l, k, at[k]) + corners[c][k];
            box.high[k] = box.low[k] + extent[k];
        }
        if (!is_free(l, &box)) continue;
        const double middle[2] = {box.low[0], box.low[1] + font / 2};
        for (int k = 0; k < 2; k++)
            out[k] = l->low[k] * pow(l->high[k] / l->low[k], middle[k] / l->size[k]);
        return add(l, &box);
    }
    return false;
}
