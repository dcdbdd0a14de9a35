/* page.h: the parts that the pages of `masu bench` share: head, verdict, images, script. A page is
 * one file of at most MASU_PAGE_BYTES that loads nothing. It is XHTML, so that a program can
 * validate it. Without its script tables are not sortable, and the slider is hidden. */
#ifndef MASU_BENCH_PAGE_H
#define MASU_BENCH_PAGE_H

#include "bench/table.h"

#define MASU_PAGE_BYTES 1500000u
#define MASU_PAGE_BUDGET_MS (1000.0 / 60.0) /* of the verdict: a frame at 60 Hz */

typedef struct masu_verdict {
    bool holds;    /* false: no rung does, and the members describe the fastest rung */
    uint32_t rung; /* the first, so the best, that holds the budget */
    double ms, error;
} masu_verdict;

/* Median time of a frame: of timestamps if these are plausible, else wall time. */
double masu_row_ms(const masu_row *row);

/* rungs: in falling quality. False: there is none, and *out is unchanged. */
bool masu_verdict_find(const masu_row *const *rungs, uint32_t count, masu_verdict *out);

/* Head and heading; the body is open until masu_page_end. `what` is plain text. */
void masu_page_begin(FILE *f, const char *what, const char *scene);
void masu_page_verdict(FILE *f, const masu_row *const *rungs, uint32_t count);
void masu_page_end(FILE *f);

/* The hidden section in which the script compares two images of class "shot". */
void masu_page_slider(FILE *f);

void masu_page_base64(FILE *f, const uint8_t *bytes, size_t count);

/* page_image.c: the image as JPEG of at most `bytes`: first its quality is reduced (97 to 37), then
 * its size is halved until it fits or has a side below 16 pixels. `kind`: the class of the element.
 * False: out of memory. */
bool masu_page_image(FILE *f, const uint8_t *rgba, uint32_t width, uint32_t height, size_t bytes,
                     const char *kind, const char *text);

#endif
