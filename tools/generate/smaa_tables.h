/* smaa_tables.h: computes the two tables of SMAA. make_smaa_area.c uses the parts that the shaders
 * read; the tests compare hashes of the complete tables with those of the released tables.
 *
 * J. Jimenez et al., "SMAA: Enhanced Subpixel Morphological Antialiasing" (Eurographics 2012),
 * section 4: an edge of aliased pixels approximates a straight line. The distances to both ends of
 * the edge and the crossing edges there determine this line; the table contains the part of a pixel
 * on its other side. Functions do not fail; the caller owns the memory. */
#ifndef MASU_SMAA_TABLES_H
#define MASU_SMAA_TABLES_H

#include "shared/floats.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

enum {
    MASU_SMAA_AREA_WIDTH = 160,
    MASU_SMAA_AREA_HEIGHT = 560,
    MASU_SMAA_AREA_BYTES = 2 * 160 * 560, /* two channels */
    MASU_SMAA_CELL = 16,                  /* size of a pattern of straight edges, texels */
    MASU_SMAA_DIAGONAL_CELL = 20,         /* and of diagonal ones */
    MASU_SMAA_SEARCH_WIDTH = 64,
    MASU_SMAA_SEARCH_HEIGHT = 16,
    MASU_SMAA_SEARCH_BYTES = 64 * 16
};

typedef struct masu_smaa_point {
    double x, y;
} masu_smaa_point;

/* Areas below and above the axis between it and the line from p to q, within the pixel [at, at +
 * 1]. */
static masu_smaa_point masu_smaa_under(masu_smaa_point p, masu_smaa_point q, double at) {
    masu_smaa_point none = {0, 0};
    if (!((at >= p.x && at < q.x) || (at + 1 > p.x && at + 1 <= q.x))) return none;
    double dx = q.x - p.x, dy = q.y - p.y;
    double a = p.y + dy * (at - p.x) / dx, b = p.y + dy * (at + 1 - p.x) / dx;
    if (signbit(a) == signbit(b) || fabs(a) < 1e-4 || fabs(b) < 1e-4) {
        double mean = (a + b) / 2;
        return mean < 0 ? (masu_smaa_point){-mean, 0} : (masu_smaa_point){0, mean};
    }
    /* The line crosses the axis within the pixel: a triangle on either side. */
    double cross = p.x - p.y * dx / dy, part = cross - floor(cross);
    double first = cross > p.x ? a * part / 2 : 0, second = cross < q.x ? b * (1 - part) / 2 : 0;
    double side = fabs(first) > fabs(second) ? first : -second;
    return side < 0 ? (masu_smaa_point){fabs(first), fabs(second)}
                    : (masu_smaa_point){fabs(second), fabs(first)};
}

static masu_smaa_point masu_smaa_sum(masu_smaa_point a, masu_smaa_point b) {
    return (masu_smaa_point){a.x + b.x, a.y + b.y};
}

/* Short U shapes are smoothed more: they are jaggies of a curve, not separate shapes. */
static double masu_smaa_softer(double area, double length) {
    double t = fmin(length / 32, 1), soft = sqrt(2 * area) / 2;
    return soft + (area - soft) * t;
}

/* Areas of a straight edge. pattern: bits of the crossing edges, 1 left end down, 2 right end down,
 * 4 left end up, 8 right end up; left, right: pixels on both sides of this one; offset: subpixel
 * offset of the line. */
static masu_smaa_point masu_smaa_straight(int pattern, double left, double right, double offset) {
    int l = (pattern & 1 ? 1 : 0) + (pattern & 4 ? 2 : 0); /* 1 down, 2 up, 3 both */
    int r = (pattern & 2 ? 1 : 0) + (pattern & 8 ? 2 : 0);
    double d = left + right + 1, up = 0.5 + offset, down = offset - 0.5;
    masu_smaa_point none = {0, 0}, middle = {d / 2, 0};
    if (l == r && (l == 0 || l == 3)) return none;
    if ((l == 0 && r == 3) || (l == 3 && r == 0)) return none;
    if (r == 0 && left > right) return none;
    if (l == 0 && left < right) return none;
    /* If one end has both edges, its line goes to the side where the other end has none. */
    double start = l == 3 ? (r == 1 ? up : down) : l == 2 ? up : down;
    double stop = r == 3 ? (l == 1 ? up : down) : r == 2 ? up : down;
    masu_smaa_point p = {0, start}, q = {d, stop};
    masu_smaa_point first = l ? masu_smaa_under(p, middle, left) : none;
    masu_smaa_point second = r ? masu_smaa_under(middle, q, left) : none;
    if (l == 0 || r == 0) return masu_smaa_sum(first, second);
    if (l == r) {
        return (masu_smaa_point){masu_smaa_softer(first.x, d) + masu_smaa_softer(second.x, d),
                                 masu_smaa_softer(first.y, d) + masu_smaa_softer(second.y, d)};
    }
    masu_smaa_point whole = masu_smaa_under(p, q, left);
    if (offset == 0 || l == 3 || r == 3) return whole;
    masu_smaa_point halves = masu_smaa_sum(first, second);
    return (masu_smaa_point){(whole.x + halves.x) / 2, (whole.y + halves.y) / 2};
}

/* Part of the pixel at (x, y) beyond the line from p to q; 1 if p equals q. */
static double masu_smaa_beyond(masu_smaa_point p, masu_smaa_point q, double x, double y) {
    enum { SIDE = 30 };
    int inside = 0;
    if (p.x == q.x && p.y == q.y) return 1;
    for (int i = 0; i < SIDE; i++) {
        for (int j = 0; j < SIDE; j++) {
            double u = x + (double)i / (SIDE - 1) - (p.x + q.x) / 2;
            double v = y + (double)j / (SIDE - 1) - (p.y + q.y) / 2;
            inside += (q.y - p.y) * u + (p.x - q.x) * v > 0;
        }
    }
    return (double)inside / (SIDE * SIDE);
}

/* Areas of a diagonal edge: bits 1 and 4 add 1 and 2 to the code of the left end, 8 and 2 to the
 * code of the right end. */
static masu_smaa_point masu_smaa_diagonal(int pattern, double left, double right, double ox,
                                          double oy) {
    /* Per pattern the offsets of the starts and ends of one or two lines, as bits: p.x, p.y, q.x,
     * q.y. */
    static const char lines[16][2][5] = {
        {"1111", "1010"}, {"1000", "1010"}, {"0010", "1010"}, {"1010", ""},
        {"1100", "1110"}, {"1100", "1010"}, {"1110", ""},     {"1110", "1010"},
        {"0011", "1011"}, {"1011", ""},     {"0011", "1010"}, {"1011", "1010"},
        {"1111", ""},     {"1111", "1011"}, {"1111", "1110"}, {"1111", "1010"}};
    int starts = (pattern & 5) != 0, stops = (pattern & 10) != 0, count = 0;
    double d = left + right + 1;
    masu_smaa_point sum = {0, 0};
    for (; count < 2 && lines[pattern][count][0]; count++) {
        const char *at = lines[pattern][count];
        masu_smaa_point p = {at[0] - '0' + (starts ? ox : 0), at[1] - '0' + (starts ? oy : 0)};
        masu_smaa_point q = {at[2] - '0' + d + (stops ? ox : 0),
                             at[3] - '0' + d + (stops ? oy : 0)};
        sum.x += 1 - masu_smaa_beyond(p, q, 1 + left, left);
        sum.y += masu_smaa_beyond(p, q, 1 + left, 1 + left);
    }
    return (masu_smaa_point){sum.x / count, sum.y / count};
}

/* The area table, both halves, with a block of 80 rows for each subsample of the multisampled
 * modes; only the first `blocks`. */
static inline void masu_smaa_area_texture(uint8_t texels[MASU_SMAA_AREA_BYTES], int blocks) {
    static const double straight[7] = {0, -0.25, 0.25, -0.125, 0.125, -0.375, 0.375};
    static const double diagonal[5][2] = {
        {0, 0}, {0.25, -0.25}, {-0.25, 0.25}, {0.125, -0.125}, {-0.125, 0.125}};
    static const int code[4] = {0, 3, 1, 4}; /* none, down, up, both */
    memset(texels, 0, MASU_SMAA_AREA_BYTES);
    for (int b = 0; b < blocks && b < 7; b++) {
        for (int pattern = 0; pattern < 16; pattern++) {
            int column = code[(pattern & 1 ? 1 : 0) + (pattern & 4 ? 2 : 0)];
            int row = code[(pattern & 2 ? 1 : 0) + (pattern & 8 ? 2 : 0)];
            for (int i = 0; i < MASU_SMAA_CELL * MASU_SMAA_CELL; i++) {
                int l = i % MASU_SMAA_CELL, r = i / MASU_SMAA_CELL;
                int x = MASU_SMAA_CELL * column + l, y = 80 * b + MASU_SMAA_CELL * row + r;
                masu_smaa_point a = masu_smaa_straight(pattern, l * l, r * r, straight[b]);
                texels[2 * (y * MASU_SMAA_AREA_WIDTH + x)] = (uint8_t)(255 * a.x);
                texels[2 * (y * MASU_SMAA_AREA_WIDTH + x) + 1] = (uint8_t)(255 * a.y);
            }
        }
    }
    for (int b = 0; b < blocks && b < 5; b++) {
        for (int pattern = 0; pattern < 16; pattern++) {
            int column = (pattern & 1 ? 1 : 0) + (pattern & 4 ? 2 : 0);
            int row = (pattern & 8 ? 1 : 0) + (pattern & 2 ? 2 : 0);
            for (int i = 0; i < MASU_SMAA_DIAGONAL_CELL * MASU_SMAA_DIAGONAL_CELL; i++) {
                int l = i % MASU_SMAA_DIAGONAL_CELL, r = i / MASU_SMAA_DIAGONAL_CELL;
                int x = 80 + MASU_SMAA_DIAGONAL_CELL * column + l;
                int y = 80 * b + MASU_SMAA_DIAGONAL_CELL * row + r;
                masu_smaa_point a =
                    masu_smaa_diagonal(pattern, l, r, diagonal[b][0], diagonal[b][1]);
                texels[2 * (y * MASU_SMAA_AREA_WIDTH + x)] = (uint8_t)(255 * a.x);
                texels[2 * (y * MASU_SMAA_AREA_WIDTH + x) + 1] = (uint8_t)(255 * a.y);
            }
        }
    }
}

/* Decodes the result of a bilinear fetch, in 1/32, into its four edges of one kind; 0: not a valid
 * result. */
static inline int masu_smaa_fetched(int code, int e[4]) {
    for (int k = 0; k < 16; k++) {
        for (int i = 0; i < 4; i++) e[i] = k >> i & 1;
        if (e[0] + 3 * e[1] + 7 * e[2] + 21 * e[3] == code) return 1;
    }
    return 0;
}

/* The search table: how many of the last two pixels of a search, times 127, still belong to the
 * edge. */
static inline void masu_smaa_search_texture(uint8_t texels[MASU_SMAA_SEARCH_BYTES]) {
    memset(texels, 0, MASU_SMAA_SEARCH_BYTES);
    for (int y = 17; y < 33; y++) {
        for (int x = 0; x < 33; x++) {
            int left[4], top[4];
            if (!masu_smaa_fetched(x, left) || !masu_smaa_fetched(y, top)) continue;
            uint8_t *row = texels + (32 - y) * MASU_SMAA_SEARCH_WIDTH;
            int back = top[3] ? 1 + (top[2] && !left[1] && !left[3]) : 0;
            int ahead = top[3] && !left[1] && !left[3] ? 1 : 0;
            if (ahead && top[2] && !left[0] && !left[2]) ahead = 2;
            row[x] = (uint8_t)(127 * back);
            if (33 + x < MASU_SMAA_SEARCH_WIDTH) row[33 + x] = (uint8_t)(127 * ahead);
        }
    }
}

#endif
