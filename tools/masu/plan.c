/* plan.c: `masu plan`: prints the compiled frame of a scene: passes, resources, bytes, aliasing,
 * and the omitted passes with reasons. */
#include "command/options.h"
#include "masu/cmd.h"
#include "scene/scene.h"

#include "settings/knobs.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *format_name(VkFormat format) {
    switch (format) {
    case VK_FORMAT_R8G8B8A8_UNORM: return "R8G8B8A8_UNORM";
    case VK_FORMAT_A2B10G10R10_UNORM_PACK32: return "A2B10G10R10_UNORM";
    case VK_FORMAT_R32_UINT: return "R32_UINT";
    case VK_FORMAT_R32_SFLOAT: return "R32_SFLOAT";
    case VK_FORMAT_D32_SFLOAT: return "D32_SFLOAT";
    case VK_FORMAT_R16G16B16A16_SFLOAT: return "R16G16B16A16_SFLOAT";
    case VK_FORMAT_R16G16B16A16_UNORM: return "R16G16B16A16_UNORM";
    case VK_FORMAT_R32G32_UINT: return "R32G32_UINT";
    case VK_FORMAT_R32G32B32A32_UINT: return "R32G32B32A32_UINT";
    case VK_FORMAT_R32G32B32A32_SFLOAT: return "R32G32B32A32_SFLOAT";
    default: return "?";
    }
}

static void join(char *out, size_t size, const char *const *names, size_t n) {
    size_t used = 0;
    out[0] = 0;
    for (size_t i = 0; i < n && names[i] && used < size; i++) {
        used += (size_t)snprintf(out + used, size - used, "%s%s", i ? ", " : "", names[i]);
    }
}

static double mib(uint64_t bytes) { return (double)bytes / (1024.0 * 1024.0); }

static void print_passes(const masu_plan_info *p) {
    int width = p->rung_count > 6 ? (int)p->rung_count : 6; /* of the column */
    printf("\npasses\n  %-19s %-*s %-44s %s\n", "", width, "rungs", "reads -> writes", "why");
    for (uint32_t i = 0; i < p->pass_count; i++) {
        const masu_plan_pass *pass = &p->passes[i];
        char reads[128], writes[128], both[300], rungs[16] = "";
        join(reads, sizeof reads, pass->reads, 6);
        join(writes, sizeof writes, pass->writes, 4);
        snprintf(both, sizeof both, "%s%s%s%s", reads, *reads ? " " : "", *writes ? "-> " : "",
                 writes);
        for (uint32_t r = 0; r < p->rung_count; r++)
            rungs[r] = pass->active & 1u << r ? (char)('0' + r) : '-';
        printf("  %-19s %-*s %-44s %s\n", pass->name, width, rungs, pass->active ? both : "omitted",
               pass->why);
    }
}

static void print_images(const masu_plan_info *p) {
    printf("\nimages; images whose ranges overlap share memory\n  %-19s %-20s %-11s %10s  "
           "%-22s %s\n",
           "", "format", "extent", "bytes", "range", "lifetime");
    for (uint32_t i = 0; i < p->image_count; i++) {
        const masu_plan_image *image = &p->images[i];
        if (!image->used) {
            printf("  %-19s %-20s omitted\n", image->name, format_name(image->format));
            continue;
        }
        char extent[32], at[48];
        snprintf(extent, sizeof extent, image->layers > 1 ? "%ux%u x%u" : "%ux%u", image->width,
                 image->height, image->layers);
        snprintf(at, sizeof at, "%llu-%llu", (unsigned long long)image->offset,
                 (unsigned long long)(image->offset + image->bytes));
        printf("  %-19s %-20s %-11s %10llu  %-22s %s..%s\n", image->name,
               format_name(image->format), extent, (unsigned long long)image->bytes, at,
               p->passes[image->first_pass].name, p->passes[image->last_pass].name);
    }
}

static void print_pipelines(const masu_plan_info *p) {
    printf("\npipelines, build time\n");
    for (uint32_t i = 0; i < p->pass_count; i++) {
        if (p->passes[i].pipeline_ns) {
            printf("  %-19s %8.1f ms\n", p->passes[i].name, (double)p->passes[i].pipeline_ns / 1e6);
        }
    }
}

/* All rows of the memory report, and their number; the caller frees them. NULL: out of memory. */
static masu_memory_row *memory_rows(const masu_session *s, uint32_t *count) {
    *count = masu_memory_report(s->m, NULL, 0);
    masu_memory_row *rows = calloc(*count, sizeof *rows);
    if (rows) masu_memory_report(s->m, rows, *count);
    else *count = 0;
    return rows;
}

static void print_memory(const masu_session *s, const masu_plan_info *p) {
    static const char *const names[MASU_ROLE_COUNT] = {"device", "upload", "readback"};
    const masu_memory *m = &p->memory;
    printf("\nmemory\n  host block          %12llu bytes\n", (unsigned long long)m->host_bytes);
    printf("  device, all roles   %12llu bytes  (%.1f MiB)%s\n",
           (unsigned long long)m->device_bytes, mib(m->device_bytes),
           m->unified ? "  one block (unified memory)" : "");
    for (uint32_t r = 0; r < MASU_ROLE_COUNT && !m->unified; r++) {
        if (m->roles[r].bytes)
            printf("    %-17s %12llu bytes\n", names[r], (unsigned long long)m->roles[r].bytes);
    }
    printf("  transient images: unaliased %llu, aliased %llu, lower bound %llu bytes\n",
           (unsigned long long)m->transient_unaliased, (unsigned long long)m->transient_aliased,
           (unsigned long long)m->transient_lower_bound);
    printf("  omitted images: %llu bytes\n", (unsigned long long)p->saved_bytes);
    uint32_t n;
    masu_memory_row *rows = memory_rows(s, &n);
    printf("\n  %-22s %-7s %10s %12s %12s\n", "row", "kind", "count", "bytes", "offset");
    for (uint32_t i = 0; i < n; i++) {
        printf("  %-22s %-7s %10llu %12llu %12llu\n", rows[i].name, rows[i].kind,
               (unsigned long long)rows[i].count, (unsigned long long)rows[i].bytes,
               (unsigned long long)rows[i].offset);
    }
    free(rows);
}

static int print_text(const masu_session *s, const masu_plan_info *p, const char *scene) {
    printf("%s on %s\n", scene, s->host.driver);
    const masu_scene_data *content = masu_scene_data_of(&s->scene);
    printf("scene: %u instances of %u meshes, %u draws, %llu triangles, %s\n", content->instances,
           content->meshes, content->draws, (unsigned long long)content->triangles,
           content->sdf ? "an SDF" : "no SDF");
    if (content->textures) {
        printf("textures: %u in %u arrays, %llu bytes as blocks, %llu decoded\n", content->textures,
               content->texture_arrays, (unsigned long long)content->texture_bytes,
               (unsigned long long)content->texture_bytes_decoded);
    }
    if (content->environment_size) {
        printf("sky: image, %u texels per edge, %u mips\n", content->environment_size,
               content->environment_mips);
    } else {
        printf("sky: %s\n", content->analytic_sky ? "analytic" : "two colours");
    }
    printf("class: %s", masu_scene_class_name(masu_scene_class_of(&s->scene)));
    masu_desc ladder = {MASU_DESC};
    const char *from;
    if (s->desc.ladder == MASU_ON && !masu_ladder_of(&s->scene, &ladder, &from, NULL))
        printf("; ladder: %s%s%s", from, *p->computed_for ? ", times computed for " : "",
               p->computed_for);
    printf("\noutput %ux%u\n\nrungs\n", s->desc.output.width, s->desc.output.height);
    for (uint32_t r = 0; r < p->rung_count; r++) {
        const masu_plan_rung *rung = &p->rungs[r];
        printf("  %u  renders %ux%u, %u passes, %u barriers", r, rung->render_width,
               rung->render_height, rung->dispatches, rung->barriers);
        if (rung->ratio > 0.0f) printf(", time %.3f", (double)rung->ratio);
        if (rung->flip > 0.0f) printf(", FLIP %.4f", (double)rung->flip);
        printf("\n");
    }
    print_passes(p);
    print_images(p);
    print_pipelines(p);
    print_memory(s, p);
    return MASU_CLI_OK;
}

static json_t *names_json(const char *const *names, size_t n) {
    json_t *list = json_array();
    for (size_t i = 0; i < n && names[i]; i++) json_array_append_new(list, json_string(names[i]));
    return list;
}

static json_t *rows_json(const masu_session *s) {
    uint32_t n;
    masu_memory_row *rows = memory_rows(s, &n);
    json_t *list = json_array();
    for (uint32_t i = 0; i < n; i++) {
        json_array_append_new(
            list, json_pack("{s:s, s:s, s:i, s:I, s:I, s:I, s:b}", "name", rows[i].name, "kind",
                            rows[i].kind, "role", (int)rows[i].role, "count",
                            (json_int_t)rows[i].count, "bytes", (json_int_t)rows[i].bytes, "offset",
                            (json_int_t)rows[i].offset, "transient", rows[i].transient != 0));
    }
    free(rows);
    return list;
}

static int print_json(const masu_session *s, const masu_plan_info *p, const char *scene) {
    json_t *passes = json_array(), *images = json_array(), *rungs = json_array();
    for (uint32_t i = 0; i < p->pass_count; i++) {
        const masu_plan_pass *pass = &p->passes[i];
        json_t *active = json_array();
        for (uint32_t r = 0; r < p->rung_count; r++) {
            if (pass->active & 1u << r) json_array_append_new(active, json_integer((json_int_t)r));
        }
        json_array_append_new(passes, json_pack("{s:s, s:o, s:s, s:o, s:o, s:f}", "name",
                                                pass->name, "rungs", active, "why", pass->why,
                                                "reads", names_json(pass->reads, 6), "writes",
                                                names_json(pass->writes, 4), "pipeline_ms",
                                                (double)pass->pipeline_ns / 1e6));
    }
    for (uint32_t i = 0; i < p->image_count; i++) {
        const masu_plan_image *image = &p->images[i];
        json_t *o = json_pack("{s:s, s:s, s:b}", "name", image->name, "format",
                              format_name(image->format), "used", image->used != 0);
        if (image->used) {
            json_t *more = json_pack(
                "{s:i, s:i, s:i, s:I, s:I, s:s, s:s}", "width", (int)image->width, "height",
                (int)image->height, "layers", (int)image->layers, "bytes", (json_int_t)image->bytes,
                "offset", (json_int_t)image->offset, "first_pass",
                p->passes[image->first_pass].name, "last_pass", p->passes[image->last_pass].name);
            json_object_update(o, more);
            json_decref(more);
        }
        json_array_append_new(images, o);
    }
    for (uint32_t r = 0; r < p->rung_count; r++) {
        json_array_append_new(
            rungs, json_pack("{s:i, s:i, s:i, s:i, s:f, s:f}", "render_width",
                             (int)p->rungs[r].render_width, "render_height",
                             (int)p->rungs[r].render_height, "passes", (int)p->rungs[r].dispatches,
                             "barriers", (int)p->rungs[r].barriers, "ratio",
                             (double)p->rungs[r].ratio, "flip", (double)p->rungs[r].flip));
    }
    json_t *root = json_pack("{s:s, s:s, s:o, s:o, s:o, s:o, s:o, s:I, s:o}", "scene", scene,
                             "class", masu_scene_class_name(masu_scene_class_of(&s->scene)),
                             "device", masu_json_device(&s->host), "rungs", rungs, "passes", passes,
                             "images", images, "memory", masu_json_memory(&p->memory),
                             "left_out_bytes", (json_int_t)p->saved_bytes, "rows", rows_json(s));
    return masu_json_write(root, "-");
}

typedef struct plan_options {
    masu_session_desc d;
    const char *ladder; /* as given; NULL: not given */
    uint32_t rays;
    bool json;
} plan_options;

static int plan(plan_options *o) {
    static masu_session s;
    char error[1024];
    int code = masu_use_ladder(o->ladder, &o->d.desc);
    if (code) return code;
    masu_use_rays(o->rays, &o->d.desc.ray_query, &o->d.host);
    if (!masu_session_open(&o->d, &s, error, sizeof error)) return masu_cli_error("%s", error);
    masu_plan_info info;
    masu_plan_of(s.m, &info);
    code =
        o->json ? print_json(&s, &info, o->d.scene_path) : print_text(&s, &info, o->d.scene_path);
    code = masu_finish_validation(&s.host, code);
    masu_session_close(&s);
    return code;
}

/* Prints the knobs and ends the command. */
static bool print_knobs(masu_cli *cli, void *to) {
    (void)to;
    if (cli->value && strcmp(cli->value, "md") != 0) {
        masu_cli_usage_error("--knobs: expected no value or md, found '%s'", cli->value);
        return false;
    }
    (cli->value ? masu_knobs_document : masu_knobs_print)(stdout);
    cli->exit_code = MASU_CLI_OK;
    return false;
}

/* Sets the only rung of the plan. */
static bool read_setting(masu_cli *cli, void *to) {
    return masu_read_setting(cli, &((plan_options *)to)->d.desc);
}

static bool read_split(masu_cli *cli, void *to) {
    (void)cli;
    ((plan_options *)to)->d.desc.deny.unified_memory = 1;
    return true;
}

static const masu_option rows[] = {
    MASU_HEADING("Output"),
    MASU_FLAG(plan_options, json, "json", "print JSON"),
    MASU_OWN("knobs", "[=md]", print_knobs,
             "print all knobs of a rung and all limits, as text or as docs/knobs.md, and\n"
             "exit"),
    MASU_HEADING("Frame"),
    MASU_OUTPUT_SIZE_ROW(plan_options, d.desc.output),
    MASU_LADDER_ROW(plan_options, ladder, "scales 1, 0.8, 0.4 (default off)"),
    MASU_HEADING("Memory"),
    MASU_OWN("setting", "NAME", read_setting,
             "one rung instead of a ladder: scale=0.5+aa=fxaa; --knobs lists the knobs"),
    MASU_UINT(plan_options, d.desc.frames_in_flight, "frames-in-flight", 1, MASU_MAX_FLIGHT,
              "frames recorded ahead of the GPU: 1 to 3 (default 2)"),
    MASU_OWN("split-memory", NULL, read_split,
             "use one memory block per role, even on unified memory"),
    MASU_UINT(plan_options, d.desc.reserve.particles, "particles", 0, 65536,
              "reserve memory for N particles per frame (default 0)"),
    MASU_UINT(plan_options, d.desc.reserve.decals, "decals", 0, 1024,
              "reserve memory for N decals per frame (default 0)"),
    MASU_UINT(plan_options, d.desc.reserve.lines, "lines", 0, 65536,
              "reserve memory for N debug lines per frame (default 0)"),
    MASU_HEADING("Device"),
    MASU_RAYS_ROW(plan_options, rays),
    MASU_DEVICE_ROWS(plan_options, d.host),
    {.name = NULL}};

static int run(masu_cli *cli) {
    plan_options o = {.d = {.desc = {.output = {1920, 1080}, .targets = {.storage = 1}},
                            .host = {.message = masu_print_message}}};
    masu_given given = {.most = 1, .excess = "expected one scene"};
    int code;
    if (!masu_options_read(cli, rows, &o, &given, &code)) return code;
    if (!given.count) return masu_cli_usage_error("no scene given: expected SCENE.masu");
    if (o.ladder && masu_is_given(&given, rows, "setting"))
        return masu_cli_usage_error("--setting plans one rung: no --ladder");
    o.d.scene_path = given.arguments[0];
    return plan(&o);
}

const masu_cli_command masu_cmd_plan = {
    .name = "plan",
    .arguments = "SCENE.masu [options]",
    .summary = "print the passes, images and memory of a scene's frame plan",
    .details = "Opens the device and builds all pipelines, but renders nothing.\n\n"
               "Exit codes:\n"
               "  0  success\n"
               "  1  the plan cannot be made, or --validate reported a message\n"
               "  2  the command line is wrong\n\n"
               "Examples:\n"
               "  masu plan engine.masu --ladder auto\n"
               "  masu plan engine.masu --size 1280x720 --json\n",
    .run = run};
