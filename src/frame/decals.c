/* decals.c: writes decals to the slot: the matrix from camera-relative positions to the decal's
 * volume, and the pixel rectangle of the volume, by which decals.comp sorts them into tiles.
 * Invisible decals are culled. The rectangle contains the volume's corners and two more pixels
 * for jitter and rounding; it is the whole image if the volume crosses the near plane. */
#include "frame/sprite_kinds.h"

#include <math.h>
#include <string.h>

static const double most = 1e30; /* bound of the shader's factors */

/* rows of the inverse; 0: there is none that can be used. */
static int invert(const float rows[12], double out[3][3]) {
    double m[3][3], c[3][3], det = 0.0;
    for (uint32_t i = 0; i < 3; i++) {
        for (uint32_t j = 0; j < 3; j++) m[i][j] = (double)rows[4 * i + j];
    }
    for (uint32_t i = 0; i < 3; i++) {
        for (uint32_t j = 0; j < 3; j++) {
            uint32_t a = (i + 1) % 3, b = (i + 2) % 3, p = (j + 1) % 3, q = (j + 2) % 3;
            c[i][j] = m[a][p] * m[b][q] - m[a][q] * m[b][p];
        }
        det += m[0][i] * c[0][i];
    }
    int fine = fabs(det) > 0.0 && isfinite(det);
    for (uint32_t i = 0; i < 3 && fine; i++) {
        for (uint32_t j = 0; j < 3; j++) {
            out[i][j] = c[j][i] / det;
            fine &= fabs(out[i][j]) <= most;
        }
    }
    return fine;
}

static int is_fine(const masu_decal *d) {
    int fine = isfinite(d->opacity) && isfinite(d->roughness) && isfinite(d->metallic) &&
               isfinite(d->edge) && isfinite(d->inner) && isfinite(d->outer) && d->opacity > 0.0f;
    for (uint32_t k = 0; k < 12; k++) fine &= isfinite(d->rows[k]) != 0;
    fine &= isfinite(d->emission) != 0;
    if (d->texture) fine &= masu_is_cell(d->uv);
    for (uint32_t k = 0; k < 3; k++)
        fine &= isfinite(d->color[k]) != 0 && isfinite(d->position[k]) != 0;
    return fine;
}

/* First and last pixel that it may touch; 0: the camera does not see it. */
static int find_pixels(const masu_decal *d, const masu_sprite_eye *eye, const uint32_t size[2],
                       uint32_t low[2], uint32_t high[2]) {
    double least[2] = {HUGE_VAL, HUGE_VAL}, greatest[2] = {-HUGE_VAL, -HUGE_VAL};
    uint32_t before = 0;
    for (uint32_t corner = 0; corner < 8; corner++) {
        double rel[3], seen[3];
        for (uint32_t i = 0; i < 3; i++) {
            rel[i] = (d->position[i] - eye->at[i]) + (double)d->rows[4 * i + 3];
            for (uint32_t j = 0; j < 3; j++)
                rel[i] += (corner >> j & 1u ? 1.0 : -1.0) * (double)d->rows[4 * i + j];
        }
        masu_to_eye(eye, rel, seen);
        if (!(seen[2] > eye->near_distance)) continue;
        before++;
        const double at[2] = {(seen[0] / (seen[2] * eye->tan_x) + 1.0) * 0.5 * size[0],
                              (1.0 - seen[1] / (seen[2] * eye->tan_y)) * 0.5 * size[1]};
        for (uint32_t k = 0; k < 2; k++) {
            least[k] = fmin(least[k], at[k]);
            greatest[k] = fmax(greatest[k], at[k]);
        }
    }
    if (!before) return 0;
    for (uint32_t k = 0; k < 2; k++) {
        double from = before < 8 ? 0.0 : floor(least[k] - 2.0),
               to = before < 8 ? size[k] : ceil(greatest[k] + 2.0);
        if (!(to >= 0.0 && from < size[k])) return 0;
        low[k] = from > 0.0 ? (uint32_t)from : 0;
        high[k] = to < size[k] - 1.0 ? (uint32_t)to : size[k] - 1;
    }
    return 1;
}

/* low, high: its pixels. */
static void write_decal(const masu_decal *d, const masu_sprite_eye *eye, double into[3][3],
                        const uint32_t low[2], const uint32_t high[2], uint32_t bytes,
                        unsigned char *to) {
    float v[4 * MASU_TEXTURED_DECAL_VEC4S] = {0};
    float inner = d->inner, outer = d->outer;
    uint32_t flags = d->flags & (MASU_DECAL_ROUND | MASU_DECAL_KEEP_COLOR), ends[2];
    double length = 0.0;
    if (inner == 0.0f && outer == 0.0f) inner = 1.05f, outer = 1.4f;
    outer = masu_clamped(outer, 0.0f, 3.14159265f);
    inner = masu_clamped(inner, 0.0f, outer);
    for (uint32_t i = 0; i < 3; i++) {
        double moved = 0.0;
        for (uint32_t j = 0; j < 3; j++) {
            v[4 * i + j] = (float)into[i][j];
            moved += into[i][j] * ((eye->at[j] - d->position[j]) - (double)d->rows[4 * j + 3]);
        }
        v[4 * i + 3] = (float)fmax(fmin(moved, most), -most);
        v[12 + i] = masu_clamped(d->color[i], 0.0f, 1.0f);
        length += (double)d->rows[4 * i + 2] * (double)d->rows[4 * i + 2];
    }
    v[15] = masu_clamped(d->opacity, 0.0f, 1.0f);
    v[16] = d->roughness > 0.0f ? masu_clamped(d->roughness, 0.0f, 1.0f) : -1.0f;
    v[17] = d->metallic >= 0.0f ? masu_clamped(d->metallic, 0.0f, 1.0f) : -1.0f;
    v[18] = masu_clamped(d->edge, 0.0f, 1.0f);
    memcpy(&v[19], &flags, sizeof flags);
    for (uint32_t i = 0; i < 3; i++) v[20 + i] = (float)((double)d->rows[4 * i + 2] / sqrt(length));
    ends[0] = low[0] | low[1] << 16;
    ends[1] = high[0] | high[1] << 16;
    memcpy(&v[24], ends, sizeof ends);
    v[26] = (float)cos((double)outer);
    v[27] = (float)(1.0 / fmax(cos((double)inner) - (double)v[26], 1e-4));
    if (d->texture) {
        masu_cell_write(d->uv, &v[28]);
        memcpy(&v[32], &d->texture, sizeof d->texture);
    }
    v[33] = masu_clamped(d->emission, 0.0f, 1e6f);
    memcpy(to, v, bytes);
}

uint32_t masu_decals_write(const masu_frame_data *f, const masu_sprite_eye *eye, unsigned char *to,
                           uint32_t part[4]) {
    const masu_rung_plan *rp = masu_frame_rung_plan(f);
    const uint32_t size[2] = {rp->render_width, rp->render_height};
    const uint32_t bytes = f->plan->sprites.decal * (uint32_t)sizeof(masu_vec4);
    uint32_t count = 0, least[2] = {size[0], size[1]}, greatest[2] = {0, 0};
    for (uint32_t i = 0; i < f->desc.decal_count; i++) {
        const masu_decal *d = &f->desc.decals[i];
        uint32_t low[2], high[2];
        double into[3][3];
        if (!is_fine(d) || !invert(d->rows, into) || !find_pixels(d, eye, size, low, high))
            continue;
        write_decal(d, eye, into, low, high, bytes, to + (size_t)count++ * bytes);
        for (uint32_t k = 0; k < 2; k++) {
            if (least[k] > low[k]) least[k] = low[k];
            if (greatest[k] < high[k]) greatest[k] = high[k];
        }
    }
    for (uint32_t k = 0; k < 2 && count; k++) {
        part[k] = least[k];
        part[2 + k] = greatest[k] - least[k] + 1;
    }
    return count;
}
