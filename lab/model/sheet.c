/* sheet.c: see sheet.h. */
#include "lab/model/sheet.h"

#include <math.h>
#include <string.h>

const masu_model_class masu_model_classes[MASU_MODEL_CLASSES] = {
    {"Xe80", "80 EU x 16 x 1.3 GHz, LPDDR4x-4266", "tgl", 1.66, 68.0},
    {"UHD620", "24 EU x 16 x 1.1 GHz, DDR4-2133", "kbl", 0.42, 34.0},
    {"Vega8", "8 CU x 128 x 1.9 GHz, DDR4-3200", "raven", 1.95, 51.0},
    {"Deck", "8 CU x 128 x 1.6 GHz, LPDDR5-5500", "vangogh", 1.64, 88.0},
    {"low mobile", "a phone of 0.15 TFLOPS, 12.8 GB/s", "a630", 0.15, 12.8},
};
const double masu_model_budgets[MASU_MODEL_BUDGETS] = {1000.0 / 60.0, 1000.0 / 30.0};

/* For a texture fetch: mip levels are selected so that a pixel fetches one new texel of its level
 * and a quarter of a texel of the level above. A block-compressed texel has one byte or half a
 * byte. */
static const double texels_a_fetch = 1.25, texel_bytes_blocks = 1.0, texel_bytes = 4.0;
static const double bound_by_bytes = 1.3, bound_by_operations = 2.5, bound_by_instructions = 1.5;
enum { VERTEX_BYTES = 16, TEXCOORD_BYTES = 8, TRIANGLE_BYTES = 12, TILE_PIXELS = 4 };

const char *masu_model_pass_name(uint32_t pass) {
    return masu_is_cascade(pass) ? "cascades" : masu_passes[pass].name;
}

const char *masu_model_sure_name(masu_model_sure sure) {
    static const char *const names[] = {"exact", "measured here", "estimated"};
    return names[sure];
}

double masu_model_floor(const masu_model_row *row, uint32_t k, bool *by_bytes) {
    double b = row->bytes / (masu_model_classes[k].gigabytes * 1e6);
    double f = row->issued[k] > 0.0 ? row->issued[k] / (masu_model_classes[k].tflops * 0.5e9)
                                    : row->weighted / (masu_model_classes[k].tflops * 1e9);
    if (by_bytes) *by_bytes = b >= f;
    return b >= f ? b : f;
}

double masu_model_realistic(const masu_model_row *row, uint32_t k) {
    bool by_bytes;
    double floor = masu_model_floor(row, k, &by_bytes);
    if (by_bytes) return floor * bound_by_bytes;
    return floor *
           (row->issued[k] > 0.0 ? bound_by_instructions * row->waits[k] : bound_by_operations);
}

/* ---- Sizes ----------------------------------------------------------------------------------- */

static double area(const masu_frame_plan *plan, uint32_t rung, masu_image_extent extent) {
    VkExtent2D render = {plan->rungs[rung].render_width, plan->rungs[rung].render_height};
    VkExtent2D size = masu_plan_extent(plan, extent, render);
    return (double)size.width * size.height;
}

/* Ratio of the pass's pixels on the sheet to those rendered; 1 if the pass does not depend on the
 * image size. */
static double growth(const masu_count *c, uint32_t rung, uint32_t pass) {
    masu_image_extent extent = masu_passes[pass].extent;
    return area(&c->sheet, rung, extent) / fmax(area(&c->drawn, rung, extent), 1.0);
}

/* For a pass over listed tiles, their fraction of the image; otherwise 1. In march and smaa_blend a
 * group of 8x8 belongs to a tile of 16x16. */
static double coverage(const masu_count *c, uint32_t rung, uint32_t pass) {
    double n = c->passes[rung][pass].invocations;
    switch (masu_passes[pass].extent) {
    case MASU_EXTENT_TILES:
    case MASU_EXTENT_EDGED:
        return fmin(1.0, n * TILE_PIXELS / fmax(area(&c->drawn, rung, MASU_EXTENT_RENDER), 1.0));
    case MASU_EXTENT_GLOSSY:
        return fmin(1.0, n / fmax(area(&c->drawn, rung, MASU_EXTENT_TRACED), 1.0));
    default: return 1.0;
    }
}

/* ---- Bytes ----------------------------------------------------------------------------------- */

static double number(const masu_pass_count *c, masu_tally_kind kind, uint32_t set,
                     uint32_t binding) {
    for (uint32_t i = 0; i < c->number_count; i++) {
        const masu_count_number *n = &c->numbers[i];
        if (n->kind == kind && n->set == set && n->binding == binding) return n->amount;
    }
    return 0.0;
}

static void worsen(masu_model_sure *to, masu_model_sure sure) {
    if (*to < sure) *to = sure;
}

/* Texels that are moved: each covered texel once, but not more than were requested. */
static double once(double texels, double covered, double asked, masu_model_row *row) {
    if (asked >= 0.999 * texels && covered >= 1.0) return texels; /* growth rounds */
    worsen(&row->bytes_sure, MASU_MODEL_MEASURED);
    return fmin(texels * covered, asked);
}

static double cascade_texels(const masu_frame_plan *plan, uint32_t rung, uint32_t cascade) {
    const masu_rung_plan *rp = &plan->rungs[rung];
    uint32_t every = plan->desc.rungs[rung].shadow_refresh[cascade];
    return (double)rp->cascade_size * rp->cascade_size / (every > 1 ? every : 1);
}

/* Texels of an attachment, or of a copied image. */
static double attached(const masu_count *c, uint32_t rung, uint32_t pass, masu_usage usage,
                       double texels, masu_model_row *row) {
    if (usage == MASU_BLEND_COLOR || usage == MASU_KEEP_DEPTH) { /* read and written */
        worsen(&row->bytes_sure, MASU_MODEL_MEASURED);
        return 2.0 * fmin(texels, growth(c, rung, pass) * c->passes[rung][pass].invocations);
    }
    if (usage == MASU_UPDATE_DEPTH)
        return cascade_texels(&c->sheet, rung, pass - MASU_PASS_CASCADE_0);
    return texels; /* attachments and copies are complete */
}

/* Images of the row: bindings in set 1, attachments, or copies. */
static void add_images(const masu_count *c, uint32_t rung, uint32_t pass, masu_model_row *row) {
    const masu_rung_plan *rp = &c->sheet.rungs[rung];
    const masu_pass_count *counted = &c->passes[rung][pass];
    double grown = growth(c, rung, pass), covered = coverage(c, rung, pass);
    uint32_t reads = 0, at_read = 0, at_write = 0;
    for (uint32_t a = 0; a < rp->access_count[pass]; a++)
        reads += masu_access_binds(rp->access[pass][a], 0) != 0;
    for (uint32_t a = 0; a < rp->access_count[pass]; a++) {
        masu_access access = rp->access[pass][a];
        if (access.image >= MASU_IMAGE_COUNT) continue; /* buffers */
        double texels = area(&c->sheet, rung, masu_images[access.image].extent), moved = 0.0;
        int read = masu_has_set(pass) && masu_access_binds(access, 0);
        int write = masu_has_set(pass) && masu_access_binds(access, 1);
        if (read) {
            double asked = grown * number(counted, MASU_TALLY_FETCHED, MASU_SET_PASS, at_read++);
            moved = once(texels, covered, asked, row);
        }
        if (write) {
            uint32_t binding = reads + at_write++;
            double in = grown * number(counted, MASU_TALLY_FETCHED, MASU_SET_PASS, binding);
            double out = grown * number(counted, MASU_TALLY_WRITTEN, MASU_SET_PASS, binding);
            if (in > 0.0) moved += once(texels, covered, in, row);
            moved += once(texels, 1.0, out, row);
        }
        if (!read && !write) moved = attached(c, rung, pass, (masu_usage)access.usage, texels, row);
        row->bytes += moved * masu_format_bytes(masu_plan_format(&c->sheet, access.image));
    }
}

/* The buffer of a binding of set 0; MASU_BUFFER_COUNT: none with large reads. */
static masu_buffer_id buffer_of(uint32_t binding) {
    static const struct {
        uint32_t binding;
        masu_buffer_id buffer;
    } list[] = {{MASU_BIND_INSTANCES, MASU_BUFFER_INSTANCES},
                {MASU_BIND_MATERIALS, MASU_BUFFER_MATERIALS},
                {MASU_BIND_COUNTERS, MASU_BUFFER_COUNTERS},
                {MASU_BIND_TILES, MASU_BUFFER_TILES},
                {MASU_BIND_SLOTS, MASU_BUFFER_SLOTS},
                {MASU_BIND_PREVIOUS_INSTANCES, MASU_BUFFER_INSTANCES},
                {MASU_BIND_DRAWN, MASU_BUFFER_DRAWN},
                {MASU_BIND_DRAWS, MASU_BUFFER_DRAWS},
                {MASU_BIND_SEEN, MASU_BUFFER_SEEN},
                {MASU_BIND_TABLES, MASU_BUFFER_TABLES},
                {MASU_BIND_LIGHTS, MASU_BUFFER_LIGHTS},
                {MASU_BIND_LIGHT_TILES, MASU_BUFFER_LIGHT_TILES},
                {MASU_BIND_PROBES, MASU_BUFFER_PROBES},
                {MASU_BIND_TRACE, MASU_BUFFER_TRACE},
                {MASU_BIND_TRACE_FRAME, MASU_BUFFER_TRACE_FRAME},
                {MASU_BIND_TRACE_VERTICES, MASU_BUFFER_VERTICES},
                {MASU_BIND_TRACE_TEXCOORDS, MASU_BUFFER_TEXCOORDS},
                {MASU_BIND_SPECULAR_TILES, MASU_BUFFER_SPECULAR_TILES},
                {MASU_BIND_SMAA_AREA, MASU_BUFFER_SMAA_AREA},
                {MASU_BIND_SMAA_TILES, MASU_BUFFER_SMAA_TILES},
                {MASU_BIND_EXPOSURE, MASU_BUFFER_EXPOSURE}};
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        if (list[i].binding == binding) return list[i].buffer;
    }
    return MASU_BUFFER_COUNT;
}

static double buffer_bytes(const masu_frame_plan *plan, masu_buffer_id id) {
    const masu_buffer_plan *b = &plan->buffers[id];
    return (double)(b->stride ? b->stride : b->bytes); /* of one frame */
}

static void add_buffers(const masu_count *c, uint32_t rung, uint32_t pass, masu_model_row *row) {
    const masu_pass_count *counted = &c->passes[rung][pass];
    double grown = growth(c, rung, pass);
    for (uint32_t i = 0; i < counted->number_count; i++) {
        const masu_count_number *n = &counted->numbers[i];
        bool bytes = n->kind == MASU_TALLY_LOADED || n->kind == MASU_TALLY_STORED;
        if (!bytes || n->set != MASU_SET_GLOBAL || !(n->amount > 0.0)) continue;
        masu_buffer_id id = buffer_of(n->binding);
        double asked = grown * n->amount;
        row->asked += asked;
        if (id == MASU_BUFFER_COUNT) continue;
        row->bytes += fmin(asked, buffer_bytes(&c->sheet, id));
        worsen(&row->bytes_sure, MASU_MODEL_MEASURED);
    }
}

/* Reads by the input assembler, and textures of materials. */
static void add_geometry(const masu_count *c, uint32_t rung, uint32_t pass, masu_model_row *row) {
    const masu_pass_count *counted = &c->passes[rung][pass];
    bool cascade = masu_is_cascade(pass);
    double fetches = 0.0, grown = growth(c, rung, pass);
    bool draws = pass == MASU_PASS_GBUFFER || cascade || pass == MASU_PASS_TRANSPARENTS;
    if (draws && counted->vertices > 0.0) {
        bool textured = c->texture_bytes > 0.0;
        row->bytes +=
            fmin(counted->vertices * VERTEX_BYTES, buffer_bytes(&c->sheet, MASU_BUFFER_VERTICES));
        if (textured && !cascade)
            row->bytes += fmin(counted->vertices * TEXCOORD_BYTES,
                               buffer_bytes(&c->sheet, MASU_BUFFER_TEXCOORDS));
        if (pass != MASU_PASS_TRANSPARENTS)
            row->bytes += fmin(c->triangles[rung][cascade] * TRIANGLE_BYTES,
                               buffer_bytes(&c->sheet, MASU_BUFFER_INDICES));
        worsen(&row->bytes_sure, MASU_MODEL_MEASURED);
    }
    for (uint32_t i = 0; i < counted->number_count; i++) {
        if (counted->numbers[i].kind == MASU_TALLY_FETCHED && counted->numbers[i].set == 2)
            fetches += counted->numbers[i].amount;
    }
    if (fetches > 0.0) {
        double each = c->sheet.compressed ? texel_bytes_blocks : texel_bytes;
        row->bytes += fmin(grown * fetches * texels_a_fetch * each, c->texture_bytes);
        worsen(&row->bytes_sure, MASU_MODEL_ESTIMATED);
    }
}

/* ---- Operations ------------------------------------------------------------------------------ */

static void add_operations(const masu_count *c, uint32_t rung, uint32_t pass, masu_model_row *row) {
    const masu_pass_count *counted = &c->passes[rung][pass];
    double grown = growth(c, rung, pass);
    double pixels = area(&c->drawn, rung, masu_passes[pass].extent);
    row->invocations = grown * counted->invocations;
    row->plain = counted->vertex_plain + grown * counted->plain;
    row->weighted = counted->vertex_weighted + grown * counted->weighted;
    /* All invocations take the same path if each has as many operations as the busiest. Those
     * beyond the image's edge have fewer. */
    bool same = masu_passes[pass].kind == MASU_PASS_COMPUTE &&
                fabs(counted->plain - counted->most * pixels) <= 1e-3 * counted->plain;
    if (!same && row->plain > 0.0) worsen(&row->weighted_sure, MASU_MODEL_MEASURED);
    if (counted->late) worsen(&row->weighted_sure, MASU_MODEL_ESTIMATED);
}

/* A shader may have no counted operations, such as a copy: then each invocation executes all
 * instructions. */
static double instructions(double plain, double invocations, double straight,
                           double instructions_once) {
    return straight > 0.0 ? plain * instructions_once / straight : invocations * instructions_once;
}

static void add_instructions(const masu_count *c, const masu_issued *issued, uint32_t rung,
                             uint32_t pass, masu_model_row *row) {
    const masu_pass_count *counted = &c->passes[rung][pass];
    for (uint32_t k = 0; k < MASU_MODEL_CLASSES && issued; k++) {
        if (!issued[k].known) continue;
        const double *once = issued[k].pass[pass].instructions;
        row->issued[k] =
            instructions(growth(c, rung, pass) * counted->plain, row->invocations,
                         c->straight[pass][0], once[0]) +
            instructions(counted->vertex_plain, counted->vertices, c->straight[pass][1], once[1]);
        row->waits[k] = issued[k].pass[pass].waits;
    }
}

/* ---- Sums ------------------------------------------------------------------------------------ */

static void make_rung(const masu_count *c, const masu_issued *issued, uint32_t rung,
                      masu_model_rung *out) {
    const masu_rung_plan *rp = &c->sheet.rungs[rung];
    out->width = rp->render_width;
    out->height = rp->render_height;
    memset(out->rows, 0, sizeof out->rows);
    memset(&out->sum, 0, sizeof out->sum);
    for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
        if (!(masu_has_pass(&rp->active, p))) continue;
        masu_model_row *row = &out->rows[masu_is_cascade(p) ? MASU_PASS_CASCADE_0 : p];
        row->runs = true;
        add_images(c, rung, p, row);
        if (masu_is_cascade(p) && p != MASU_PASS_CASCADE_0) continue; /* the first counts all */
        add_buffers(c, rung, p, row);
        add_geometry(c, rung, p, row);
        add_operations(c, rung, p, row);
        add_instructions(c, issued, rung, p, row);
    }
    memset(out->floor, 0, sizeof out->floor);
    memset(out->realistic, 0, sizeof out->realistic);
    out->sum.runs = true;
    for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
        const masu_model_row *row = &out->rows[p];
        if (!row->runs) continue;
        out->sum.bytes += row->bytes;
        out->sum.asked += row->asked;
        out->sum.plain += row->plain;
        out->sum.weighted += row->weighted;
        out->sum.invocations += row->invocations;
        worsen(&out->sum.bytes_sure, row->bytes_sure);
        worsen(&out->sum.weighted_sure, row->weighted_sure);
        for (uint32_t k = 0; k < MASU_MODEL_CLASSES; k++) {
            out->sum.issued[k] += row->issued[k];
            out->floor[k] += masu_model_floor(row, k, NULL);
            out->realistic[k] += masu_model_realistic(row, k);
        }
    }
}

void masu_model_make(const masu_count *count, const masu_issued *issued, masu_model_sheet *out) {
    out->rung_count = count->rung_count;
    for (uint32_t k = 0; k < MASU_MODEL_CLASSES; k++) out->issued[k] = issued && issued[k].known;
    for (uint32_t r = 0; r < count->rung_count; r++) make_rung(count, issued, r, &out->rungs[r]);
    for (uint32_t k = 0; k < MASU_MODEL_CLASSES; k++) {
        for (uint32_t b = 0; b < MASU_MODEL_BUDGETS; b++) {
            out->chosen[k][b] = -1;
            for (uint32_t r = out->rung_count; r-- > 0;) {
                if (out->rungs[r].realistic[k] <= masu_model_budgets[b]) out->chosen[k][b] = (int)r;
            }
        }
    }
}
