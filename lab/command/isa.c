/* isa.c: `masu-lab isa`: the command line of lab/isa/ask.h, and its table. */
#include "lab/command/commands.h"
#include "lab/isa/ask.h"
#include "lab/study/table.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct options {
    masu_desc desc;
    const char *ladder, *gpus, *csv;
    bool json, extras;
} options;

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
        json_t *o = json_pack("{s:s, s:s, s:i}", "pipeline", r->pipeline, "stage", r->stage,
                              "lanes", (int)r->lanes);
        for (int k = 0; k < MASU_ISA_FIELD_COUNT; k++)
            json_object_set_new(o, masu_isa_field_names[k],
                                isnan(r->value[k]) ? json_null() : json_real(r->value[k]));
        json_array_append_new(list, o);
    }
    return list;
}

static int list_gpus(void) {
    for (uint32_t i = 0; i < masu_isa_gpu_count; i++) {
        const masu_isa_gpu *g = &masu_isa_gpus[i];
        printf("  %-10s %-30s %s\n", g->name, g->what,
               g->driver == MASU_ISA_RADV ? "RADV" : "MASU_ISA_DRIVERS");
    }
    return MASU_CLI_OK;
}

static int ask_all(const options *o, const masu_isa_gpu *const *gpus, uint32_t count,
                   const char *const *arguments) {
    static masu_isa_rows rows;
    masu_table table;
    json_t *all = json_object();
    int code = MASU_CLI_OK;
    masu_table_open(&table, columns, "");
    for (uint32_t i = 0; i < count; i++) {
        if (!masu_isa_ask(gpus[i], arguments, &rows)) {
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

static const masu_option rows[] = {
    MASU_TEXT(options, gpus, "gpu", "GPU[,GPU...]",
              "the GPUs whose compilers to use; --gpu=help lists them"),
    MASU_OUTPUT_SIZE_ROW(options, desc.output),
    MASU_LADDER_ROW(options, ladder, "1, 0.8 and 0.4 of the size (default off)"),
    MASU_UINT(options, desc.frames_in_flight, "frames-in-flight", 1, MASU_MAX_FLIGHT,
              "1 to 3 (default 2)"),
    MASU_UINT(options, desc.reserve.particles, "particles", 0, 65536,
              "reserve room for that many particles of each frame (default 0)"),
    MASU_UINT(options, desc.reserve.decals, "decals", 0, 1024, "the same for decals"),
    MASU_UINT(options, desc.reserve.lines, "lines", 0, 65536, "the same for debug lines"),
    MASU_FLAG(options, extras, "extras",
              "reserve a mesh, textured particles, trails and decals, looks and all post effects"),
    MASU_FLAG(options, json, "json", "print JSON"),
    MASU_FILE(options, csv, "csv", "FILE",
              "write every stage of every pipeline as CSV; - is standard output"),
    {.name = NULL}};

/* Reserves one object of each kind that a host can add at run time. */
static void reserve_extras(masu_desc *desc) {
    masu_reserve *r = &desc->reserve;
    r->particles = r->decals = r->textures = 1;
    r->trail_points = 2;
    r->meshes[0] = (masu_mesh_kind){.meshes = 1, .vertices = 300, .triangles = 100};
    desc->instance_looks = 1;
    desc->post = MASU_POST_ALL;
}

static int run(masu_cli *cli) {
    options o = {.desc = {.output = {1920, 1080}, .targets = {.storage = 1}}};
    masu_given given = {.most = 1, .excess = "expected one scene"};
    const masu_isa_gpu *gpus[MASU_ISA_GPUS];
    int code;
    char **argv = cli->argv;
    if (!masu_options_read(cli, rows, &o, &given, &code)) return code;
    if (o.gpus && !strcmp(o.gpus, "help")) return list_gpus();
    if (!given.count) return masu_cli_usage_error("no scene given: expected SCENE.masu");
    if (o.extras) reserve_extras(&o.desc);
    if (masu_isa_is_child()) return masu_isa_child(given.arguments[0], o.ladder, &o.desc);
    if (!o.gpus) return masu_cli_usage_error("no GPU is given: --gpu GPU[,GPU...]");
    uint32_t count = masu_isa_list("--gpu", o.gpus, gpus);
    if (!count) return MASU_CLI_USAGE;
    return ask_all(&o, gpus, count, (const char *const *)argv + 1);
}

const masu_cli_command lab_isa = {
    .name = "isa",
    .arguments = "SCENE.masu --gpu GPU[,GPU...] [options]",
    .summary =
        "compile every pipeline with GPUs' own compilers: registers, waves, instructions, spills",
    .details = "Starts a process for each GPU, in which the GPU's driver compiles all pipelines of "
               "the frame plan\n"
               "and runs nothing. RADV's GPUs need Mesa only. The others need the folder of "
               "drivers that `make\n"
               "isa-drivers` builds, named by the environment variable MASU_ISA_DRIVERS.\n",
    .run = run};
