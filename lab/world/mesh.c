/* mesh.c: see mesh.h. */
#include "lab/world/mesh.h"

#include <math.h>
#include <string.h>

#define TAU 6.28318530717958647692

static uint32_t vertex(masu_world_mesh *m, double x, double y, double z) {
    /* + 0 changes a rounded -0 to 0 if the sum is exact; "-0.0000" still reads as zero. */
    fprintf(m->out, "v %.4f %.4f %.4f\n", x + 0, y + 0, z + 0);
    return ++m->vertices; /* OBJ counts from one */
}

static void triangle(masu_world_mesh *m, uint32_t a, uint32_t b, uint32_t c) {
    const uint32_t face[3] = {a, b, c};
    masu_bake_append(&m->faces[m->material], face, sizeof face);
    m->triangles++;
}

static void quad(masu_world_mesh *m, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    triangle(m, a, b, c);
    triangle(m, a, c, d);
}

void masu_world_material(masu_world_mesh *m, const char *name) {
    m->material = 0;
    while (m->names[m->material] && strcmp(m->names[m->material], name) != 0) m->material++;
    m->names[m->material] = name;
}

void masu_world_finish(masu_world_mesh *m) {
    for (uint32_t i = 0; i < MASU_WORLD_MATERIALS && m->names[i]; i++) {
        const uint32_t *f = (const uint32_t *)(void *)m->faces[i].data;
        fprintf(m->out, "usemtl %s\n", m->names[i]);
        for (size_t k = 0; k < m->faces[i].bytes / sizeof *f; k += 3) {
            fprintf(m->out, "f %u %u %u\n", f[k], f[k + 1], f[k + 2]);
        }
        masu_bake_release(&m->faces[i]);
    }
}

void masu_world_box(masu_world_mesh *m, double x, double y, double z, double sx, double sy,
                    double sz) {
    uint32_t v[8];
    for (int i = 0; i < 8; i++) {
        v[i] = vertex(m, x + (i & 1 ? sx : -sx) / 2, y + (i & 2 ? sy : -sy) / 2,
                      z + (i & 4 ? sz : -sz) / 2);
    }
    quad(m, v[0], v[2], v[3], v[1]);
    quad(m, v[4], v[5], v[7], v[6]);
    quad(m, v[0], v[1], v[5], v[4]);
    quad(m, v[2], v[6], v[7], v[3]);
    quad(m, v[0], v[4], v[6], v[2]);
    quad(m, v[1], v[3], v[7], v[5]);
}

/* A point at distance `along` on the axis, offset by (u, v) across it; u x v points along the
 * axis. */
static uint32_t around(masu_world_mesh *m, int axis, double x, double y, double z, double along,
                       double u, double v) {
    if (axis == 0) return vertex(m, x + along, y + u, z + v);
    if (axis == 1) return vertex(m, x + v, y + along, z + u);
    return vertex(m, x + u, y + v, z + along);
}

void masu_world_tube(masu_world_mesh *m, int axis, double x, double y, double z, double length,
                     double radius0, double radius1, int n) {
    uint32_t low = around(m, axis, x, y, z, 0, 0, 0), high = around(m, axis, x, y, z, length, 0, 0);
    uint32_t first = m->vertices + 1;
    for (int i = 0; i < n; i++) {
        double a = TAU * i / n, c = cos(a), s = sin(a);
        around(m, axis, x, y, z, 0, radius0 * c, radius0 * s);
        around(m, axis, x, y, z, length, radius1 * c, radius1 * s);
    }
    for (int i = 0; i < n; i++) {
        uint32_t a = first + 2 * (uint32_t)i, b = first + 2 * (uint32_t)((i + 1) % n);
        if (radius0 > 0) triangle(m, low, b, a);
        if (radius1 > 0) triangle(m, high, a + 1, b + 1);
        if (radius0 > 0) triangle(m, a, b, b + 1);
        if (radius1 > 0) triangle(m, a, b + 1, a + 1);
    }
}

void masu_world_ball(masu_world_mesh *m, double x, double y, double z, double rx, double ry,
                     double rz, int rings, int sides, int half) {
    uint32_t top = vertex(m, x, y + ry, z), bottom = vertex(m, x, half ? y : y - ry, z);
    uint32_t first = m->vertices + 1;
    int rows = half ? rings : rings - 1;
    for (int r = 1; r <= rows; r++) {
        double p = TAU / (half ? 4 : 2) * r / rings;
        for (int i = 0; i < sides; i++) {
            double a = TAU * i / sides;
            vertex(m, x + rx * sin(p) * sin(a), y + ry * cos(p), z + rz * sin(p) * cos(a));
        }
    }
    uint32_t n = (uint32_t)sides, last = first + (uint32_t)(rows - 1) * n;
    for (uint32_t i = 0; i < n; i++) {
        uint32_t j = (i + 1) % n;
        triangle(m, top, first + i, first + j);
        triangle(m, bottom, last + j, last + i);
        for (int r = 1; r < rows; r++) {
            uint32_t above = first + (uint32_t)(r - 1) * n, below = above + n;
            quad(m, above + i, below + i, below + j, above + j);
        }
    }
}

void masu_world_prism(masu_world_mesh *m, const double (*outline)[2], int n, double z0, double z1) {
    uint32_t first = m->vertices + 1;
    for (int i = 0; i < n; i++) {
        vertex(m, outline[i][0], outline[i][1], z0);
        vertex(m, outline[i][0], outline[i][1], z1);
    }
    for (int i = 0; i < n; i++) {
        uint32_t a = first + 2 * (uint32_t)i, b = first + 2 * (uint32_t)((i + 1) % n);
        quad(m, a, b, b + 1, a + 1);
        if (i < 1 || i + 1 >= n) continue;
        triangle(m, first, b, a);
        triangle(m, first + 1, a + 1, b + 1);
    }
}
