/* plan_isa.c: `masu plan --isa`: the command line of isa/isa.h.
 *
 * This process asks no driver. For each GPU it starts itself again with the same arguments and that GPU's
 * environment, in which MASU_ISA_CHILD names the GPU; that one compiles, and sends its rows through its standard
 * output. A compiler that crashes or hangs ends its own process alone. */
#include "masu/plan.h"
#include "masu/table.h"

#include "bake/base/file.h"
#include "bake/base/process.h"
#include "image.h"
#include "isa/isa.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SECONDS = 900 };

static const char child_variable[] = "MASU_ISA_CHILD";

/* ---- The child ------------------------------------------------------------------------------- */

bool masu_plan_is_isa_child(void) { return getenv(child_variable) != NULL; }

static void say_pass(const char *pass) {
    printf("at\t%s\n", pass);
    fflush(stdout);
}

static int compile(masu_plan_options *o) {
    static masu_isa_rows rows;
    static masu_scene scene;
    char error[1024];
    uint8_t *bytes;
    size_t count;
    masu_detail detail;
    int code = masu_use_ladder(o->ladder, &o->d.desc);
    if (code) return code;
    if (!masu_file_read(o->d.scene_path, (size_t)2 << 30, &bytes, &count, error, sizeof error))
        return masu_cli_error("%s", error);
    bool good = !masu_scene_bind(bytes, count, &scene, &detail);
    if (!good) snprintf(error, sizeof error, "%s: %s", o->d.scene_path, detail.text);
    o->d.desc.scene = &scene;
    good = good && masu_isa_compile(&o->d.desc, say_pass, &rows, error, sizeof error);
    free(bytes);
    if (!good) return masu_cli_error("%s", error);
    return masu_isa_send(&rows, stdout) ? MASU_CLI_OK : masu_cli_error("cannot write to standard output");
}

/* ---- The parent ------------------------------------------------------------------------------ */

/* The rest of the last line that starts so; NULL: there is none. */
static const char *last_line(const char *text, const char *start, char *out, size_t size) {
    const char *found = NULL;
    for (const char *line = text; line && *line; line = strchr(line, '\n'), line += line != NULL)
        if (!strncmp(line, start, strlen(start))) found = line + strlen(start);
    if (!found) return NULL;
    snprintf(out, size, "%.*s", (int)strcspn(found, "\n"), found);
    return out;
}

bool masu_plan_ask(const masu_isa_gpu *gpu, char **arguments, masu_isa_rows *rows) {
    char error[2048], line[512];
    const char *directory = masu_bake_temporary_directory();
    const char *command[64] = {"/proc/self/exe"};
    if (!directory) return false;
    for (int i = 1; i < 63 && arguments[i]; i++) command[i] = arguments[i];
    char *icd = masu_bake_join(directory, "icd.json");
    if (!masu_isa_gpu_environment(gpu, icd, error, sizeof error)) {
        masu_cli_error("%s", error);
        free(icd);
        return false;
    }
    masu_bake_buffer output = {0};
    setenv(child_variable, gpu->name, 1);
    masu_cli_progress("%s: compiling", gpu->name);
    masu_bake_result r = masu_bake_run(command, SECONDS, &output);
    masu_cli_progress_clear();
    unsetenv(child_variable);
    masu_isa_gpu_leave();
    free(icd);
    masu_bake_append(&output, "", 1);
    const char *text = (const char *)output.data, *pass = last_line(text, "at\t", line, sizeof line);
    bool good = false;
    if (r.end == MASU_BAKE_SIGNALED) {
        masu_cli_error("%s: its compiler crashed (signal %d) at pass %s", gpu->name, r.code, pass ? pass : "none");
    } else if (r.end == MASU_BAKE_TIMEOUT) {
        masu_cli_error("%s: its compiler took more than %d seconds, at pass %s", gpu->name, r.code,
                       pass ? pass : "none");
    } else if (r.end != MASU_BAKE_EXITED || r.code) {
        const char *why = last_line(text, "masu: ", line, sizeof line);
        masu_cli_error("%s: %s", gpu->name, why ? why : "its process failed");
    } else {
        good = masu_isa_receive(text, rows);
        if (!good) masu_cli_error("%s: its rows cannot be read", gpu->name);
    }
    masu_bake_release(&output);
    return good;
}

static const masu_column columns[] = {
    {"gpu", NULL, NULL, NULL},
    {"pipeline", "\"", "pipeline", NULL},
    {"stage", "\"", "stage", NULL},
    {"lanes", "%.0f", "lanes", "%.0f"},
#define MASU_ISA_COLUMN(ID, name, ...) {name, "%.9g", name, "%.9g"},
    MASU_ISA_FIELDS(MASU_ISA_COLUMN)
#undef MASU_ISA_COLUMN
    {0}};

static void add_rows(masu_table *t, const masu_isa_gpu *gpu, const masu_isa_rows *rows) {
    for (uint32_t i = 0; i < rows->count; i++) {
        masu_table_text(t, gpu->name);
        masu_table_text(t, rows->row[i].pipeline);
        masu_table_text(t, rows->row[i].stage);
        masu_table_number(t, rows->row[i].lanes ? (double)rows->row[i].lanes : (double)NAN);
        masu_table_numbers(t, rows->row[i].value, MASU_ISA_FIELD_COUNT);
    }
}

static json_t *rows_json(const masu_isa_rows *rows) {
    json_t *list = json_array();
    for (uint32_t i = 0; i < rows->count; i++) {
        const masu_isa_row *r = &rows->row[i];
        json_t *o = json_pack("{s:s, s:s, s:i}", "pipeline", r->pipeline, "stage", r->stage, "lanes", (int)r->lanes);
        for (int k = 0; k < MASU_ISA_FIELD_COUNT; k++)
            json_object_set_new(o, masu_isa_field_names[k], isnan(r->value[k]) ? json_null() : json_real(r->value[k]));
        json_array_append_new(list, o);
    }
    return list;
}

static int list_gpus(void) {
    for (uint32_t i = 0; i < masu_isa_gpu_count; i++) {
        const masu_isa_gpu *g = &masu_isa_gpus[i];
        printf("  %-10s %-30s %s\n", g->name, g->what, g->driver == MASU_ISA_RADV ? "RADV" : "MASU_ISA_DRIVERS");
    }
    return MASU_CLI_OK;
}

uint32_t masu_plan_gpus(const char *list, const masu_isa_gpu *out[MASU_PLAN_GPUS]) {
    uint32_t n = 0;
    for (const char *at = list;; at++) {
        char name[32];
        size_t length = strcspn(at, ",");
        snprintf(name, sizeof name, "%.*s", (int)(length < 31 ? length : 31), at);
        const masu_isa_gpu *gpu = masu_isa_gpu_find(name);
        if (!gpu) {
            masu_cli_usage_error("--isa: there is no GPU '%s'; --isa=help lists them", name);
            return 0;
        }
        if (n == MASU_PLAN_GPUS) {
            masu_cli_usage_error("--isa: at most %d GPUs", MASU_PLAN_GPUS);
            return 0;
        }
        out[n++] = gpu;
        at += length;
        if (!*at) return n;
    }
}

int masu_plan_isa(masu_plan_options *o, char **arguments) {
    static masu_isa_rows rows;
    const masu_isa_gpu *gpus[MASU_PLAN_GPUS];
    if (!arguments) return list_gpus();
    uint32_t n = masu_plan_gpus(o->isa, gpus);
    if (!n) return MASU_CLI_USAGE;
    if (masu_plan_is_isa_child()) return compile(o);
    masu_table table;
    json_t *all = json_object();
    int code = MASU_CLI_OK;
    masu_table_open(&table, columns, "");
    for (uint32_t i = 0; i < n; i++) {
        if (!masu_plan_ask(gpus[i], arguments, &rows)) {
            code = MASU_CLI_FAILURE;
            continue;
        }
        add_rows(&table, gpus[i], &rows);
        json_object_set_new(all, gpus[i]->name, rows_json(&rows));
        if (o->json || o->csv) continue;
        printf("%s%s (%s)\n", i ? "\n" : "", gpus[i]->name, gpus[i]->what);
        masu_table_print(&table, stdout);
    }
    int written = masu_table_close(&table, o->csv);
    if (o->json) {
        written = masu_json_write(all, "-");
    } else {
        json_decref(all);
    }
    return code ? code : written;
}
