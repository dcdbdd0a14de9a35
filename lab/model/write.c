/* write.c: see write.h. */
#include "lab/model/write.h"

#include "settings/ladder_file.h"
#include "cli/markup.h"
#include "image.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Ladder ---------------------------------------------------------------------------------- */

static bool read_ladder(const char *path, masu_count_desc *count, masu_model_sheet *out,
                        char *error, size_t error_size) {
    static masu_ladder_file ladder;
    if (!masu_ladder_read(path, &ladder, error, error_size)) return false;
    count->rung_count = ladder.count;
    for (uint32_t i = 0; i < ladder.count; i++) {
        count->rungs[i] = ladder.rungs[i];
        snprintf(out->rungs[i].name, MASU_MODEL_NAME, "%s", ladder.settings[i]);
        out->rungs[i].measured = ladder.ratios[i];
    }
    return true;
}

/* ---- Making ---------------------------------------------------------------------------------- */

VkExtent2D masu_model_drawn(VkExtent2D size) {
    return masu_count_size((VkExtent2D){(size.width + 1) / 2, (size.height + 1) / 2});
}

bool masu_model_run(const masu_model_desc *d, masu_model_sheet *out, uint32_t *messages,
                    char *error, size_t error_size) {
    masu_count_desc desc = {.scene_path = d->scene_path,
                            .size = d->drawn,
                            .sheet = d->size,
                            .time = d->time,
                            .host = d->host};
    memset(out, 0, sizeof *out);
    for (uint32_t r = 0; r < MASU_MAX_RUNGS; r++) {
        out->rungs[r].measured = (double)NAN;
        snprintf(out->rungs[r].name, MASU_MODEL_NAME, "default %u", r);
    }
    if (d->ladder_path && !read_ladder(d->ladder_path, &desc, out, error, error_size)) return false;
    masu_count *count = malloc(sizeof *count);
    if (!count) {
        snprintf(error, error_size, "out of memory");
        return false;
    }
    bool good = masu_count_run(&desc, d->progress, count, error, error_size);
    if (good) {
        const char *last = strrchr(d->scene_path, '/');
        snprintf(out->scene, sizeof out->scene, "%s", last ? last + 1 : d->scene_path);
        snprintf(out->driver, sizeof out->driver, "%s", count->driver);
        out->drawn = d->drawn;
        out->sheet = d->size;
        masu_model_make(count, d->issued, out);
        if (messages) *messages = count->messages;
    }
    free(count);
    return good;
}

/* ---- Text ------------------------------------------------------------------------------------ */

/* "1.23b": bytes dominate; "1.23f": operations do. */
static void floor_text(const masu_model_row *row, uint32_t k, char out[24]) {
    bool by_bytes;
    double ms = masu_model_floor(row, k, &by_bytes);
    snprintf(out, 24, "%.3f%c", ms, by_bytes ? 'b' : 'f');
}

static void chosen_text(const masu_model_sheet *m, uint32_t k, uint32_t budget, char out[16]) {
    if (m->chosen[k][budget] < 0) {
        snprintf(out, 16, "none");
    } else {
        snprintf(out, 16, "%d", m->chosen[k][budget]);
    }
}

static const char *const notes[] = {
    "Floor: the longer of compulsory bytes at the class's bandwidth (b) and operations at its peak "
    "(f). Realistic: 1.3 times if bytes dominate, 2.5 times if operations do.",
    "Compulsory: each image and buffer read once and written once, but only the part that shaders "
    "read; caches are assumed to hold the rest. Vertices, tiles and trees are the scene's.",
    "Operations: all operations of each invocation, an addition as 1, a reciprocal, root or sine "
    "as 4. "
    "Idle lanes of a wave, fetches and branches are not included.",
    "With --isa operations are instructions of the class's compiler, one per lane and clock: each "
    "operation "
    "counts as the mean number of instructions per operation in the pass's pipelines. Realistic is "
    "then 1.5 "
    "times the floor, times the ratio of RADV's latency to the latency that its waves hide, if "
    "above 1.",
    "exact: every pixel takes the same branches; measured here: counted while the scene was drawn; "
    "estimated: textures at 1.25 new texels a fetch, or fragments behind a discard.",
    "Nothing here was measured on a GPU of these classes. A measured ratio is for the driver that "
    "ladder.json names; a CPU's ratio predicts little about a GPU.",
};

bool masu_model_print(const masu_model_sheet *m, FILE *f) {
    const masu_model_rung *first = &m->rungs[0];
    fprintf(f, "%s, %ux%u: the model sheet. COMPUTED, not measured on these GPUs.\n", m->scene,
            m->sheet.width, m->sheet.height);
    fprintf(f, "counted at %ux%u on %s\n", m->drawn.width, m->drawn.height, m->driver);
    if (m->drawn.width != m->sheet.width || m->drawn.height != m->sheet.height)
        fprintf(f, "counts per pixel are scaled to the sheet's pixels\n");
    for (uint32_t k = 0; k < MASU_MODEL_CLASSES; k++) {
        if (m->issued[k])
            fprintf(f, "%s: instructions by the compiler of %s\n", masu_model_classes[k].name,
                    masu_model_classes[k].gpu);
    }
    fprintf(f, "\nCOMPUTED: rung 0, %s, %ux%u rendered; floor in ms\n", first->name, first->width,
            first->height);
    fprintf(f, "  %-40s %12s\n", "", "COMPUTED ms");
    fprintf(f, "  %-20s %9s %9s", "pass", "MB", "Mop");
    for (uint32_t k = 0; k < MASU_MODEL_CLASSES; k++)
        fprintf(f, " %11s", masu_model_classes[k].name);
    fprintf(f, "  bytes, operations are\n");
    for (uint32_t p = 0; p <= MASU_PASS_COUNT; p++) {
        const masu_model_row *row = p < MASU_PASS_COUNT ? &first->rows[p] : &first->sum;
        if (!row->runs) continue;
        fprintf(f, "  %-20s %9.2f %9.1f", p < MASU_PASS_COUNT ? masu_model_pass_name(p) : "sum",
                row->bytes * 1e-6, row->weighted * 1e-6);
        for (uint32_t k = 0; k < MASU_MODEL_CLASSES; k++) {
            char text[24];
            floor_text(row, k, text);
            if (p == MASU_PASS_COUNT) snprintf(text, sizeof text, "%.2f ", first->floor[k]);
            fprintf(f, " %11s", text);
        }
        fprintf(f, "  %s, %s\n", masu_model_sure_name(row->bytes_sure),
                masu_model_sure_name(row->weighted_sure));
    }
    fprintf(f,
            "\nCOMPUTED: each rung; floor / realistic in ms, part of rung 0's realistic on Xe80\n");
    for (uint32_t r = 0; r < m->rung_count; r++) {
        const masu_model_rung *one = &m->rungs[r];
        fprintf(f, "  %u %-34s %4ux%-4u %8.1f MB %9.1f Mop", r, one->name, one->width, one->height,
                one->sum.bytes * 1e-6, one->sum.weighted * 1e-6);
        for (uint32_t k = 0; k < MASU_MODEL_CLASSES; k++)
            fprintf(f, "  %6.2f /%6.2f", one->floor[k], one->realistic[k]);
        fprintf(f, "  %.3f", one->realistic[0] / first->realistic[0]);
        if (!isnan(one->measured)) fprintf(f, " (measured %.3f)", one->measured);
        fprintf(f, "\n");
    }
    fprintf(f, "\nCOMPUTED: the first rung whose realistic time fits\n");
    for (uint32_t k = 0; k < MASU_MODEL_CLASSES; k++) {
        char a[16], b[16];
        chosen_text(m, k, 0, a);
        chosen_text(m, k, 1, b);
        fprintf(f, "  %-11s %5.2f TFLOPS %5.1f GB/s   60 fps: %-5s 30 fps: %s\n",
                masu_model_classes[k].name, masu_model_classes[k].tflops,
                masu_model_classes[k].gigabytes, a, b);
    }
    fprintf(f, "\n");
    for (size_t i = 0; i < sizeof notes / sizeof *notes; i++) fprintf(f, "%s\n", notes[i]);
    return !ferror(f);
}

/* ---- CSV ------------------------------------------------------------------------------------- */

bool masu_model_csv(const masu_model_sheet *m, FILE *f) {
    fprintf(f, "kind,scene,width,height,rung,setting,render_width,render_height,pass,bytes,"
               "bytes_are,asked_bytes,operations,plain_operations,operations_are,invocations");
    for (uint32_t k = 0; k < MASU_MODEL_CLASSES; k++)
        fprintf(f, ",COMPUTED floor_ms %s,COMPUTED realistic_ms %s", masu_model_classes[k].name,
                masu_model_classes[k].name);
    for (uint32_t k = 0; k < MASU_MODEL_CLASSES; k++)
        if (m->issued[k]) fprintf(f, ",COMPUTED instructions %s", masu_model_classes[k].gpu);
    fprintf(f, "\n");
    for (uint32_t r = 0; r < m->rung_count; r++) {
        const masu_model_rung *one = &m->rungs[r];
        for (uint32_t p = 0; p <= MASU_PASS_COUNT; p++) {
            bool sum = p == MASU_PASS_COUNT;
            const masu_model_row *row = sum ? &one->sum : &one->rows[p];
            if (!row->runs) continue;
            fprintf(f, "COMPUTED,%s,%u,%u,%u,%s,%u,%u,%s,%.0f,%s,%.0f,%.0f,%.0f,%s,%.0f", m->scene,
                    m->sheet.width, m->sheet.height, r, one->name, one->width, one->height,
                    sum ? "sum" : masu_model_pass_name(p), row->bytes,
                    masu_model_sure_name(row->bytes_sure), row->asked, row->weighted, row->plain,
                    masu_model_sure_name(row->weighted_sure), row->invocations);
            for (uint32_t k = 0; k < MASU_MODEL_CLASSES; k++) {
                fprintf(f, ",%.6g,%.6g", sum ? one->floor[k] : masu_model_floor(row, k, NULL),
                        sum ? one->realistic[k] : masu_model_realistic(row, k));
            }
            for (uint32_t k = 0; k < MASU_MODEL_CLASSES; k++)
                if (m->issued[k]) fprintf(f, ",%.0f", row->issued[k]);
            fprintf(f, "\n");
        }
    }
    return !ferror(f);
}

/* ---- XHTML ----------------------------------------------------------------------------------- */

/* columns: markup from this file. */
static void put_head(FILE *f, const char *caption, const char *columns) {
    masu_markup(f,
                "<div class=\"wide\"><table>\n<caption>COMPUTED, not measured: %s</caption>\n<tr>",
                caption);
    fputs(columns, f);
    for (uint32_t k = 0; k < MASU_MODEL_CLASSES; k++)
        masu_markup(f, "<th title=\"%s\">%s</th>", masu_model_classes[k].what,
                masu_model_classes[k].name);
}

static void put_passes(const masu_model_sheet *m, uint32_t r, FILE *f) {
    const masu_model_rung *one = &m->rungs[r];
    put_head(f, "floor of each pass of rung 0, ms", "<th>pass</th><th>MB</th><th>Mop</th>");
    fputs("<th>bytes are</th><th>operations are</th></tr>\n", f);
    for (uint32_t p = 0; p <= MASU_PASS_COUNT; p++) {
        bool sum = p == MASU_PASS_COUNT;
        const masu_model_row *row = sum ? &one->sum : &one->rows[p];
        if (!row->runs) continue;
        masu_markup(f, "<tr><td>%s</td><td>%.2f</td><td>%.1f</td>",
                sum ? "sum" : masu_model_pass_name(p), row->bytes * 1e-6, row->weighted * 1e-6);
        for (uint32_t k = 0; k < MASU_MODEL_CLASSES; k++) {
            char text[24];
            floor_text(row, k, text);
            if (sum) snprintf(text, sizeof text, "%.2f", one->floor[k]);
            masu_markup(f, "<td>%s</td>", text);
        }
        masu_markup(f, "<td>%s</td><td>%s</td></tr>\n", masu_model_sure_name(row->bytes_sure),
                masu_model_sure_name(row->weighted_sure));
    }
    fputs("</table></div>\n", f);
}

static void put_rungs(const masu_model_sheet *m, FILE *f) {
    put_head(f, "each rung, realistic ms (floor)",
             "<th>rung</th><th>rendered</th><th>MB</th><th>Mop</th>");
    fputs("<th>part of rung 0, Xe80</th><th>measured ratio</th></tr>\n", f);
    for (uint32_t r = 0; r < m->rung_count; r++) {
        const masu_model_rung *one = &m->rungs[r];
        masu_markup(f, "<tr><td>%u: %s</td>", r, one->name);
        masu_markup(f, "<td>%ux%u</td><td>%.1f</td><td>%.1f</td>", one->width, one->height,
                one->sum.bytes * 1e-6, one->sum.weighted * 1e-6);
        for (uint32_t k = 0; k < MASU_MODEL_CLASSES; k++)
            masu_markup(f, "<td>%.2f (%.2f)</td>", one->realistic[k], one->floor[k]);
        masu_markup(f, "<td>%.3f</td>", one->realistic[0] / m->rungs[0].realistic[0]);
        if (isnan(one->measured)) {
            fputs("<td></td></tr>\n", f);
        } else {
            masu_markup(f, "<td>%.3f</td></tr>\n", one->measured);
        }
    }
    fputs("</table></div>\n", f);
}

static void put_chosen(const masu_model_sheet *m, FILE *f) {
    static const char *const names[] = {"60 fps", "30 fps"};
    put_head(f, "the first rung whose realistic time fits", "<th></th>");
    fputs("</tr>\n", f);
    for (uint32_t b = 0; b < MASU_MODEL_BUDGETS; b++) {
        masu_markup(f, "<tr><td>%s</td>", names[b]);
        for (uint32_t k = 0; k < MASU_MODEL_CLASSES; k++) {
            char text[16];
            chosen_text(m, k, b, text);
            masu_markup(f, "<td>%s</td>", text);
        }
        fputs("</tr>\n", f);
    }
    fputs("</table></div>\n", f);
}

bool masu_model_xhtml(const masu_model_sheet *m, FILE *f) {
    masu_markup(
        f,
        "<section id=\"model\">\n<h2>Model sheet: computed, not measured</h2>\n"
        "<p>Computed times of each pass on five classes of GPU, at %ux%u. Counted at %ux%u on %s",
        m->sheet.width, m->sheet.height, m->drawn.width, m->drawn.height, m->driver);
    fputs("; counts per pixel are scaled to the sheet's pixels.</p>\n", f);
    put_chosen(m, f);
    put_rungs(m, f);
    put_passes(m, 0, f);
    for (size_t i = 0; i < sizeof notes / sizeof *notes; i++)
        masu_markup(f, "<p>%s</p>\n", notes[i]);
    fputs("</section>\n", f);
    return !ferror(f);
}

/* ---- Files ----------------------------------------------------------------------------------- */

bool masu_model_save(const masu_model_sheet *m, bool (*write)(const masu_model_sheet *, FILE *),
                     const char *path, char *error, size_t error_size) {
    char *text = NULL;
    size_t bytes = 0;
    FILE *f = open_memstream(&text, &bytes);
    bool good = f && write(m, f);
    if (f && fclose(f)) good = false;
    if (!good) snprintf(error, error_size, "out of memory");
    good = good && masu_file_write(path, text, bytes, error, error_size);
    free(text);
    return good;
}
