/* labels.h: positions of the labels of a chart with two logarithmic axes, so that no label covers
 * another. */
#ifndef MASU_BENCH_LABELS_H
#define MASU_BENCH_LABELS_H

#include <stdbool.h>
#include <stdint.h>

enum { MASU_LABELS_MAX = 512 };

typedef struct masu_labels {
    double low[2], high[2]; /* ranges of the axes, above 0 */
    double size[2];         /* of the area between the axes, pixels */
    uint32_t count;
    struct masu_label_box {
        double low[2], high[2]; /* pixels from the lower left corner */
    } boxes[MASU_LABELS_MAX];
    uint32_t line_count;
    double lines[MASU_LABELS_MAX][2][2]; /* from and to, pixels */
} masu_labels;

/* Keeps labels away from a mark at a point of the chart. radius: pixels. */
void masu_labels_mark(masu_labels *l, const double at[2], double radius);

/* Keeps labels away from a straight line between two points of the chart. */
void masu_labels_line(masu_labels *l, const double from[2], const double to[2]);

/* Finds room for a line of text next to a point; font: its height in pixels. out: the middle of the
 * text's left edge, in the units of the axes. Returns false if every position beside the point is
 * taken or outside the chart. */
bool masu_labels_place(masu_labels *l, const double at[2], const char *text, double font,
                       double out[2]);

#endif
