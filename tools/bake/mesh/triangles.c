/* triangles.c: triangles of unknown quality become primitives that the runtime may trust.
 *
 * Per triangle list: drop what cannot be drawn (counted, never silently), make normals where
 * they are missing (creases.c) or unusable, quantise, merge vertices that became equal bit for
 * bit, and cut into primitives of at most MASU_BAKE_PRIMITIVE_VERTICES vertices. The order of
 * triangles and of first use of vertices is kept, so the same input gives the same bytes. */
#include "bake/mesh/triangles.h"

#include "bake/mesh/creases.h"

#include <stdlib.h>
#include <string.h>

/* blob.h's limit; a test may build with a smaller one. */
#ifndef MASU_BAKE_PRIMITIVE_VERTICES
#define MASU_BAKE_PRIMITIVE_VERTICES 16777215u
#endif

#define EMPTY_SLOT 0xFFFFFFFFu

/* ---- octahedral normals ---- */

static masu_bake_vec3 decode_octahedral(double x, double y) {
    masu_bake_vec3 n = masu_bake_v3(x, y, 1.0 - fabs(x) - fabs(y));
    if (n.z < 0.0) {
        n.x = (1.0 - fabs(y)) * (x >= 0.0 ? 1.0 : -1.0);
        n.y = (1.0 - fabs(x)) * (y >= 0.0 ? 1.0 : -1.0);
    }
    masu_bake_normalize(&n);
    return n;
}

masu_bake_vec3 masu_bake_decode_normal(const int16_t normal[2]) {
    return decode_octahedral(normal[0] / 32767.0, normal[1] / 32767.0);
}

void masu_bake_encode_normal(masu_bake_vec3 n, int16_t out[2]) {
    double sum = fabs(n.x) + fabs(n.y) + fabs(n.z);
    double x = n.x / sum, y = n.y / sum;
    if (n.z < 0.0) {
        double folded = (1.0 - fabs(y)) * (x >= 0.0 ? 1.0 : -1.0);
        y = (1.0 - fabs(x)) * (y >= 0.0 ? 1.0 : -1.0);
        x = folded;
    }
    /* The one of the four surrounding grid points with the closest direction: rounding each
     * component separately can have almost twice the error. */
    double best = -2.0;
    for (int corner = 0; corner < 4; corner++) {
        double cx = floor(x * 32767.0) + (corner & 1), cy = floor(y * 32767.0) + (corner >> 1);
        if (fabs(cx) > 32767.0 || fabs(cy) > 32767.0) continue;
        double match = masu_bake_dot(n, decode_octahedral(cx / 32767.0, cy / 32767.0));
        if (match > best) {
            best = match;
            out[0] = (int16_t)cx;
            out[1] = (int16_t)cy;
        }
    }
}

/* ---- filtering and normals ---- */

static masu_bake_vec3 position_of(const masu_bake_triangles *t, uint32_t vertex) {
    return masu_bake_v3f(t->positions + 3 * (size_t)vertex);
}

/* Keeps the triangles worth drawing; returns the number of indices written to `kept`. */
static uint64_t keep_triangles(const masu_bake_triangles *t, uint32_t *kept,
                               masu_bake_losses *losses) {
    uint64_t count = 0;
    for (uint64_t i = 0; i + 3 <= t->index_count; i += 3) {
        const uint32_t *corner = t->indices + i;
        losses->triangles++;
        if (corner[0] >= t->vertex_count || corner[1] >= t->vertex_count ||
            corner[2] >= t->vertex_count) {
            losses->bad_index++;
            continue;
        }
        masu_bake_vec3 p[3];
        bool sane = true;
        for (int k = 0; k < 3; k++) {
            p[k] = position_of(t, corner[k]);
            sane = sane && masu_bake_sane(p[k]);
        }
        if (!sane) {
            losses->bad_position++;
            continue;
        }
        masu_bake_vec3 a = masu_bake_sub(p[1], p[0]), b = masu_bake_sub(p[2], p[0]);
        masu_bake_vec3 c = masu_bake_sub(p[2], p[1]), area = masu_bake_cross(a, b);
        double edge = fmax(masu_bake_dot(a, a), fmax(masu_bake_dot(b, b), masu_bake_dot(c, c)));
        /* Relative, so that the size of the model does not matter: no height over 1e-12 edges. */
        if (!(masu_bake_length(area) > 1e-12 * edge)) {
            losses->degenerate++;
            continue;
        }
        memcpy(kept + count, corner, 3 * sizeof *kept);
        count += 3;
    }
    return count;
}

static bool given_normal(const masu_bake_triangles *t, uint32_t vertex, masu_bake_vec3 *normal) {
    *normal = masu_bake_v3f(t->normals + 3 * (size_t)vertex);
    return masu_bake_normalize(normal);
}

/* Area-weighted sums of the faces around every vertex; only made when a normal is not usable. */
static masu_bake_vec3 *sum_face_normals(const masu_bake_triangles *t, const uint32_t *kept,
                                        uint64_t count) {
    masu_bake_vec3 *sums = masu_bake_allocate((size_t)t->vertex_count * sizeof *sums);
    memset(sums, 0, (size_t)t->vertex_count * sizeof *sums);
    for (uint64_t i = 0; i < count; i += 3) {
        masu_bake_vec3 p = position_of(t, kept[i]);
        masu_bake_vec3 face = masu_bake_cross(masu_bake_sub(position_of(t, kept[i + 1]), p),
                                              masu_bake_sub(position_of(t, kept[i + 2]), p));
        for (int k = 0; k < 3; k++) sums[kept[i + k]] = masu_bake_mad(sums[kept[i + k]], face, 1.0);
    }
    return sums;
}

/* The quantised normal of every used vertex, of triangles that have normals. */
static void mend_normals(const masu_bake_triangles *t, const uint32_t *kept, uint64_t count,
                         int16_t (*out)[2], masu_bake_losses *losses) {
    unsigned char *done = masu_bake_allocate(t->vertex_count);
    memset(done, 0, t->vertex_count);
    masu_bake_vec3 *sums = NULL;
    for (uint64_t i = 0; i < count; i++) {
        uint32_t vertex = kept[i];
        if (done[vertex]) continue;
        done[vertex] = 1;
        masu_bake_vec3 normal;
        if (!given_normal(t, vertex, &normal)) {
            losses->bad_normals++;
            if (!sums) sums = sum_face_normals(t, kept, count);
            normal = sums[vertex];
            /* Faces that cancel out leave no direction: any unit vector will do. */
            if (!masu_bake_normalize(&normal)) normal = masu_bake_v3(0, 1, 0);
        }
        masu_bake_encode_normal(normal, out[vertex]);
    }
    free(sums);
    free(done);
}

/* ---- welding ---- */

typedef struct welder {
    masu_bake_content *content;
    uint32_t *slots; /* open addressing; vertex number in the primitive, or EMPTY_SLOT */
    size_t slot_count;
    masu_blob_primitive primitive; /* being built; its vertices are the last of the content */
    masu_bake_buffer *bent; /* influences of its vertices, behind those of others; or NULL */
    size_t bent_first;
    float shift[2]; /* whole periods subtracted from texture coordinates, so that they are small */
} welder;

/* A vertex with its texture coordinates, which are in a separate section. */
typedef struct corner {
    masu_blob_vertex vertex;
    float texcoord[2];
    masu_bake_attributes more;
    masu_bake_influence influence; /* zero without a skin */
} corner;
_Static_assert(sizeof(corner) == 56, "compared and hashed as bytes");

static void welder_begin(welder *w, uint32_t material) {
    memset(w->slots, 0xFF, w->slot_count * sizeof *w->slots);
    w->primitive = (masu_blob_primitive){
        .first_index = (uint32_t)masu_bake_count(w->content, MASU_BLOB_INDICES),
        .first_vertex = (uint32_t)masu_bake_count(w->content, MASU_BLOB_VERTICES),
        .material = material,
    };
    w->bent_first = w->bent ? w->bent->bytes : 0;
}

static void welder_end(welder *w) {
    if (w->primitive.index_count == 0) return;
    masu_bake_append(&w->content->section[MASU_BLOB_PRIMITIVES], &w->primitive,
                     sizeof w->primitive);
}

static bool same_influence(const welder *w, uint32_t there, const corner *c) {
    if (!w->bent) return true;
    const unsigned char *other = w->bent->data + w->bent_first + there * sizeof c->influence;
    return memcmp(other, &c->influence, sizeof c->influence) == 0;
}

static bool same_attributes(const welder *w, uint32_t there, const corner *c) {
    masu_bake_attributes other =
        masu_bake_attributes_of(w->content, (uint64_t)w->primitive.first_vertex + there);
    return memcmp(&other, &c->more, sizeof other) == 0;
}

static uint32_t weld(welder *w, const corner *c) {
    masu_blob_primitive *p = &w->primitive;
    const masu_blob_vertex *vertex = &c->vertex;
    size_t slot = (size_t)masu_fnv1a64(c, sizeof *c) & (w->slot_count - 1);
    for (;; slot = (slot + 1) & (w->slot_count - 1)) {
        uint32_t there = w->slots[slot];
        if (there == EMPTY_SLOT) break;
        const masu_blob_vertex *other = &MASU_BAKE_VERTICES(w->content)[p->first_vertex + there];
        const float *texcoord = MASU_BAKE_ARRAY(w->content, MASU_BLOB_TEXCOORDS, const float) +
                                2 * ((size_t)p->first_vertex + there);
        if (memcmp(other, vertex, sizeof *vertex) == 0 &&
            memcmp(texcoord, c->texcoord, sizeof c->texcoord) == 0 &&
            same_attributes(w, there, c) && same_influence(w, there, c)) {
            return there;
        }
    }
    w->slots[slot] = p->vertex_count;
    masu_bake_append(&w->content->section[MASU_BLOB_VERTICES], vertex, sizeof *vertex);
    masu_bake_append(&w->content->section[MASU_BLOB_TEXCOORDS], c->texcoord, sizeof c->texcoord);
    masu_bake_add_attributes(w->content, &c->more);
    if (w->bent) masu_bake_append(w->bent, &c->influence, sizeof c->influence);
    for (int k = 0; k < 3; k++) {
        float v = vertex->position[k];
        if (p->vertex_count == 0 || v < p->aabb_min[k]) p->aabb_min[k] = v;
        if (p->vertex_count == 0 || v > p->aabb_max[k]) p->aabb_max[k] = v;
    }
    return p->vertex_count++;
}

/* Twice as many as the vertices that can come: a free slot is always near. */
static size_t slots_for(uint64_t index_count, uint32_t vertex_count) {
    uint64_t most = index_count < vertex_count ? index_count : vertex_count;
    if (most > MASU_BAKE_PRIMITIVE_VERTICES) most = MASU_BAKE_PRIMITIVE_VERTICES;
    size_t slots = 16;
    while (slots < 2 * most) slots *= 2;
    return slots;
}

static bool usable(float texcoord) {
    return texcoord >= -MASU_TEXCOORD_MAX / 2 && texcoord <= MASU_TEXCOORD_MAX / 2;
}

/* Whole periods that centre the texture coordinates around 0, where floats are most precise. */
static void find_shift(const masu_bake_triangles *t, const uint32_t *kept, uint64_t count,
                       float shift[2]) {
    for (int k = 0; k < 2; k++) {
        float low = MASU_TEXCOORD_MAX, high = -MASU_TEXCOORD_MAX;
        for (uint64_t i = 0; i < count && t->texcoords; i++) {
            float v = t->texcoords[2 * (size_t)kept[i] + k];
            if (!usable(v)) continue;
            if (v < low) low = v;
            if (v > high) high = v;
        }
        /* Coordinates in 0..1 are unchanged, and so are those with another wrap mode than
         * repeating. */
        shift[k] = low <= high && (low < -2 || high > 3) ? roundf(low + (high - low) / 2) : 0;
    }
}

static void find_texcoord(const masu_bake_triangles *t, uint32_t vertex, const float shift[2],
                          float out[2], masu_bake_losses *losses) {
    out[0] = out[1] = 0;
    if (!t->texcoords) return;
    const float *from = t->texcoords + 2 * (size_t)vertex;
    if (!usable(from[0]) || !usable(from[1])) {
        losses->bad_texcoords++;
        return;
    }
    for (int k = 0; k < 2; k++) out[k] = from[k] - shift[k] + 0.0f;
}

bool masu_bake_add_triangles(masu_bake_content *content, const masu_bake_triangles *t,
                             masu_bake_losses *losses) {
    if (t->vertex_count == 0 || t->index_count < 3) return true;
    uint32_t *kept = masu_bake_allocate((size_t)t->index_count * sizeof *kept);
    uint64_t count = keep_triangles(t, kept, losses);
    /* In the worst case, every index becomes a separate vertex. */
    if (masu_bake_count(content, MASU_BLOB_INDICES) + count > INT32_MAX ||
        masu_bake_count(content, MASU_BLOB_VERTICES) + count > INT32_MAX) {
        free(kept);
        return false;
    }
    int16_t(*normals)[2] =
        masu_bake_allocate((size_t)(t->normals ? t->vertex_count : count) * sizeof *normals);
    if (t->normals)
        mend_normals(t, kept, count, normals, losses);
    else
        masu_bake_creased_normals(t, kept, count, normals);
    welder w = {.content = content,
                .slot_count = slots_for(count, t->normals ? t->vertex_count : UINT32_MAX),
                .bent = t->influences ? t->bent : NULL};
    w.slots = masu_bake_allocate(w.slot_count * sizeof *w.slots);
    if (t->repeats) find_shift(t, kept, count, w.shift);
    welder_begin(&w, t->material);
    for (uint64_t i = 0; i < count; i += 3) {
        if (w.primitive.vertex_count > MASU_BAKE_PRIMITIVE_VERTICES - 3) {
            welder_end(&w);
            welder_begin(&w, t->material);
        }
        for (int k = 0; k < 3; k++) {
            uint32_t from = kept[i + k];
            corner made = {.more = {MASU_BLOB_WHITE, {0, 0}}, .influence = {{0}, {0}, 0}};
            if (t->colors) made.more.color = masu_bake_encode_color(t->colors + 4 * (size_t)from);
            for (int c = 0; c < 2 && t->second; c++) {
                float second = t->second[2 * (size_t)from + (size_t)c] + 0.0f;
                made.more.texcoord[c] = usable(second) ? second : 0;
                losses->bad_texcoords += !usable(second);
            }
            if (w.bent) made.influence = t->influences[from];
            memcpy(made.vertex.normal, normals[t->normals ? from : i + (uint64_t)k],
                   sizeof made.vertex.normal);
            /* + 0 converts -0 to 0: equal positions have equal bits. */
            for (int c = 0; c < 3; c++) {
                made.vertex.position[c] = t->positions[3 * (size_t)from + c] + 0;
            }
            find_texcoord(t, from, w.shift, made.texcoord, losses);
            uint32_t index = weld(&w, &made);
            masu_bake_append(&content->section[MASU_BLOB_INDICES], &index, sizeof index);
        }
        w.primitive.index_count += 3;
    }
    welder_end(&w);
    free(w.slots);
    free(normals);
    free(kept);
    return true;
}
