/* sdf.c: compiling the scene's march shader; see sdf.h. */
#define _POSIX_C_SOURCE 200809L
#include "bake/shader/sdf.h"
#include "bake/base/file.h"
#include "bake/base/process.h"
#include "bake/shader/try.h"
#include "cli/cli.h"
#include "scene/code.h"
#include "scene_sources.h"
#include "sdfc/sdfc.h"
#include "shared/masu_shared.h"
#include "spirv/whole_vectors.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define GLSL_MAX ((size_t)4 << 20)
#define SPIRV_MAX ((size_t)64 << 20)
#define SPIRV_MAGIC 0x07230203u
#define ERRORS_SHOWN 8

/* ---- laying out the sources ---- */

void masu_bake_param_macro(const char *name, char *out, size_t room) {
    snprintf(out, room, "MASU_PARAM_%s", name);
    for (char *c = out; *c; c++) {
        if (*c >= 'a' && *c <= 'z') *c = (char)(*c - 'a' + 'A');
    }
}

static bool write_text(const char *directory, const char *name, const void *text, size_t bytes) {
    char *path = masu_bake_join(directory, name);
    char *slash = path + strlen(directory); /* create the intermediate directories */
    while ((slash = strchr(slash + 1, '/'))) {
        *slash = '\0';
        mkdir(path, 0700);
        *slash = '/';
    }
    FILE *file = fopen(path, "wb");
    bool good = file && fwrite(text, 1, bytes, file) == bytes;
    int cause = errno;
    if (file && fclose(file) != 0 && good) { /* writes a short text; may fail here */
        cause = errno;
        good = false;
    }
    if (!good) masu_cli_error("cannot write %s: %s", path, strerror(cause));
    free(path);
    return good;
}

static void append_scene_header(masu_bake_buffer *text, const masu_bake_content *content,
                                const char *glsl_path) {
    /* docs/scene.md specifies version 450, of which 440 lacks this for fields (shaders/shaders.mk
     * says why 440). */
    masu_bake_append_text(text, "#extension GL_EXT_shader_integer_mix : require\n");
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_SDF_PARAMS); i++) {
        const masu_blob_sdf_param *p =
            &MASU_BAKE_ARRAY(content, MASU_BLOB_SDF_PARAMS, const masu_blob_sdf_param)[i];
        char macro[128], line[160];
        masu_bake_param_macro(masu_bake_name_text(content, p->name), macro, sizeof macro);
        snprintf(line, sizeof line, "#define %s %llu\n", macro, (unsigned long long)i);
        masu_bake_append_text(text, line);
    }
    masu_bake_append_text(text, "#line 1 \"");
    for (const char *c = glsl_path; *c; c++) {
        bool plain = *c != '"' && *c != '\\' && (unsigned char)*c >= 0x20;
        masu_bake_append(text, plain ? c : "?", 1);
    }
    masu_bake_append_text(text, "\"\n");
}

_Static_assert(MASU_SDFC_PART_SLOTS == MASU_BLOB_PART_SLOTS, "the compiler and the reader agree");
_Static_assert(MASU_SDFC_MASKED_MAX == MASU_TILE_MASKED_MAX, "the compiler and the tiles agree");

/* ---- the language of docs/sdf.md ---- */

bool masu_bake_is_sdf(const char *path) {
    size_t length = strlen(path);
    return length > 4 && strcmp(path + length - 4, ".sdf") == 0;
}

/* Reports each line of a message separately: "file:1:2: expected ...", the line, the caret. */
void masu_bake_report_lines(const char *text, bool warnings) {
    while (*text) {
        int length = (int)strcspn(text, "\n");
        if (warnings)
            masu_cli_warn("%.*s", length, text);
        else
            masu_cli_error("%.*s", length, text);
        text += length + (text[length] == '\n');
    }
}

static void take_params(const masu_sdfc_result *scene, masu_bake_content *content) {
    for (uint32_t i = 0; i < scene->param_count; i++) {
        const masu_sdfc_param *p = &scene->params[i];
        masu_blob_sdf_param param = {(float)p->value, (float)p->minimum, (float)p->maximum,
                                     masu_bake_name(content, p->name, strlen(p->name))};
        masu_bake_append(&content->section[MASU_BLOB_SDF_PARAMS], &param, sizeof param);
    }
}

/* Adds the parts' data, and sets the flags that depend on them. */
static void take_parts(const masu_sdfc_result *scene, masu_bake_content *content, bool *dynamic) {
    static const float no_slot = 0.0f;
    masu_blob_sdf *sdf = MASU_BAKE_ARRAY(content, MASU_BLOB_SDF, masu_blob_sdf);
    sdf->part_count = scene->part_count;
    sdf->block_words = scene->block_words;
    /* no part depends on its position */
    if (!scene->anchored) sdf->flags &= ~MASU_SDF_ANCHORED;
    if (scene->timeless) sdf->flags |= MASU_SDF_TIMELESS;
    masu_bake_append(&content->section[MASU_BLOB_SLOTS],
                     scene->slot_count ? scene->slots : &no_slot,
                     (scene->slot_count ? scene->slot_count : 1) * sizeof(float));
    *dynamic = scene->dynamic;
    content->sdf_glossiest = (float)scene->glossiest;
}

/* True if a hand-written field declares, with a line of its text, that it has terms
 * (shaders/sdf/terms.glsl). */
static bool has_terms(const masu_bake_buffer *text) {
    static const char line[] = "#define MASU_SDF_TERMS";
    const char *data = (const char *)text->data;
    for (size_t i = 0; i + sizeof line <= text->bytes; i++) {
        if (memcmp(data + i, line, sizeof line - 1) == 0 && (i == 0 || data[i - 1] == '\n'))
            return true;
    }
    return false;
}

#define PATH_STEPS 4u /* from key to key */

/* Points of the camera's path inside the SDF's bounds; the caller frees them. */
static masu_sdfc_camera *path_of(const masu_bake_content *content, uint32_t *count) {
    const masu_blob_sdf *sdf = MASU_BAKE_ARRAY(content, MASU_BLOB_SDF, const masu_blob_sdf);
    const masu_blob_camera_key *keys =
        MASU_BAKE_ARRAY(content, MASU_BLOB_CAMERA_KEYS, const masu_blob_camera_key);
    uint32_t key_count = (uint32_t)masu_bake_count(content, MASU_BLOB_CAMERA_KEYS);
    masu_sdfc_camera *out = masu_bake_allocate((size_t)key_count * PATH_STEPS * sizeof *out);
    *count = 0;
    for (uint32_t i = 0; i < key_count; i++) {
        const masu_blob_camera_key *a = &keys[i], *b = &keys[i + 1 < key_count ? i + 1 : i];
        for (uint32_t step = 0; step < (a == b ? 1 : PATH_STEPS); step++) {
            double t = (double)step / PATH_STEPS;
            masu_sdfc_camera *c = &out[*count];
            bool inside = true;
            for (int k = 0; k < 3; k++) {
                c->position[k] = (double)a->position[k] * (1 - t) + (double)b->position[k] * t;
                inside = inside && c->position[k] >= (double)sdf->bounds_min[k] &&
                         c->position[k] <= (double)sdf->bounds_max[k];
            }
            c->time = (double)a->time * (1 - t) + (double)b->time * t;
            *count += inside;
        }
    }
    return out;
}

/* The caller releases `scene`, also after a failure. */
static bool compile_scene(const char *path, masu_bake_content *content, masu_bake_buffer *out,
                          bool *dynamic, masu_sdfc_result *scene) {
    masu_bake_buffer own = {0};
    char error[2048];
    if (!masu_bake_read_file(path, MASU_SDFC_SOURCE_MAX, &own)) return false;
    masu_cli_progress("compiling %s", path);
    bool good = masu_bake_count(content, MASU_BLOB_SDF_PARAMS) == 0;
    if (!good) {
        masu_cli_error(
            "%s: a .sdf file declares its own parameters: remove \"params\" from the scene", path);
        masu_bake_release(&own);
        return false;
    }
    masu_sdfc_options options = {.anchored =
                                     MASU_BAKE_ARRAY(content, MASU_BLOB_SDF, masu_blob_sdf)->flags &
                                     MASU_SDF_ANCHORED};
    masu_sdfc_camera *cameras = path_of(content, &options.camera_count);
    options.cameras = cameras;
    good = masu_sdfc_compile_with((const char *)own.data, own.bytes, path, &options, scene, error,
                                  sizeof error);
    free(cameras);
    if (good) {
        masu_bake_report_lines(scene->warnings, true);
        take_params(scene, content);
        take_parts(scene, content, dynamic);
        masu_bake_append_text(out, scene->glsl);
    } else {
        masu_bake_report_lines(error, false);
    }
    masu_bake_release(&own);
    return good;
}

/* Written as constants, not data: unused features then cost no code. */
static bool write_occlusion(const char *directory, const masu_bake_occlusion *o) {
    char text[512];
    int n =
        snprintf(text, sizeof text, "#define MASU_SHADOWS %d\n#define MASU_AMBIENT_OCCLUSION %d\n",
                 o->shadows, o->ambient);
    n +=
        snprintf(text + n, sizeof text - (size_t)n,
                 "#define MASU_SUN_TANGENT float(%.9g)\n#define MASU_SHADOW_DISTANCE float(%.9g)\n",
                 tan(o->sun_radius), o->distance);
    n += snprintf(text + n, sizeof text - (size_t)n,
                  "#define MASU_AO_RADIUS float(%.9g)\n#define MASU_AO_STRENGTH float(%.9g)\n",
                  o->radius, o->strength);
    return write_text(directory, "sdf_options.glsl", text, (size_t)n);
}

static bool lay_out(const char *directory, masu_bake_content *content, const char *glsl_path,
                    bool *dynamic, masu_sdfc_result *scene) {
    for (size_t i = 0; i < sizeof masu_scene_sources / sizeof masu_scene_sources[0]; i++) {
        const char *name = masu_scene_sources[i].name, *text = masu_scene_sources[i].text;
        if (name && !write_text(directory, name, text, strlen(text))) return false;
    }
    masu_bake_buffer text = {0}, own = {0};
    bool good;
    if (masu_bake_is_sdf(glsl_path)) {
        good = compile_scene(glsl_path, content, &text, dynamic, scene);
    } else {
        good = masu_bake_read_file(glsl_path, GLSL_MAX, &own);
        if (good) {
            bool terms = has_terms(&own);
            MASU_BAKE_ARRAY(content, MASU_BLOB_SDF, masu_blob_sdf)->block_words = terms;
            append_scene_header(&text, content, glsl_path);
            masu_bake_append(&text, own.data, own.bytes);
            masu_bake_append_text(&text, "\n");
            masu_bake_append_text(&text, terms ? "#define MASU_SDF_TERMS_FOUND 1\n"
                                               : "#define MASU_SDF_TERMS_FOUND 0\n");
            masu_bake_append_text(&text, "#include \"sdf/hand_written.glsl\"\n");
            static const float no_slot = 0.0f;
            masu_bake_append(&content->section[MASU_BLOB_SLOTS], &no_slot, sizeof no_slot);
        }
    }
    good = good && write_text(directory, "sdf_scene.glsl", text.data, text.bytes) &&
           write_text(directory, "try.comp", masu_bake_try_source, strlen(masu_bake_try_source));
    masu_bake_release(&own);
    masu_bake_release(&text);
    return good;
}

/* ---- running the tools ---- */

/* Removes the temporary directory from a line: "/tmp/masu-bake-x/march.comp" -> "march.comp". */
static void hide_directory(char *line, const char *directory) {
    size_t length = strlen(directory);
    for (char *at = line; (at = strstr(at, directory));) {
        size_t skip = at[length] == '/' ? length + 1 : length;
        memmove(at, at + skip, strlen(at + skip) + 1);
    }
}

/* glslang prints "ERROR: FILE:LINE: message" and a count at the end. */
static void report_compiler(char *text, const char *directory, const char *glsl_path) {
    bool about_contract = false, scene_blamed = false;
    int shown = 0;
    char *save = NULL;
    for (char *line = strtok_r(text, "\n", &save); line; line = strtok_r(NULL, "\n", &save)) {
        hide_directory(line, directory);
        bool error = strncmp(line, "ERROR: ", 7) == 0, warning = strncmp(line, "WARNING: ", 9) == 0;
        if (warning) masu_cli_warn("%s", line + 9);
        if (!error || strstr(line, "compilation errors.  No code") || shown >= ERRORS_SHOWN) {
            continue;
        }
        /* After an error in the scene's own file, glslang loses the following definitions: more
         * errors in the library's headers give no new information. */
        bool own = strncmp(line + 7, glsl_path, strlen(glsl_path)) == 0;
        if (scene_blamed && !own) continue;
        scene_blamed = scene_blamed || own;
        masu_cli_error("%s", line + 7);
        about_contract = about_contract || strstr(line, "'masu_sdf");
        shown++;
    }
    if (about_contract) {
        masu_cli_error("the scene's GLSL must define float masu_sdf(vec3) and "
                       "void masu_sdf_surface(vec3, inout masu_surface)");
    }
}

static bool run_tool(const char *const *arguments, const char *package, const char *directory,
                     const char *glsl_path) {
    masu_bake_buffer output = {0};
    masu_bake_result result = masu_bake_run(arguments, MASU_BAKE_TOOL_SECONDS, &output);
    masu_bake_append(&output, "", 1);
    char *text = (char *)output.data;
    bool good = result.end == MASU_BAKE_EXITED && result.code == 0;
    bool compiler = strcmp(arguments[0], "glslangValidator") == 0;
    if (good && compiler) {
        report_compiler(text, directory, glsl_path);
    } else if (result.end == MASU_BAKE_EXITED && result.code == MASU_BAKE_CANNOT_START) {
        masu_cli_error("cannot run %s; is it installed? (package %s)", arguments[0], package);
    } else if (result.end == MASU_BAKE_SIGNALED) {
        masu_cli_error("%s: %s was ended by %s", glsl_path, arguments[0],
                       masu_cli_signal(result.code));
    } else if (result.end == MASU_BAKE_TIMEOUT) {
        masu_cli_error("%s: %s took more than %d seconds", glsl_path, arguments[0], result.code);
    } else if (result.end == MASU_BAKE_NO_CHILD) {
        masu_cli_error("cannot start %s: %s", arguments[0], strerror(result.code));
    } else if (!good && compiler && strstr(text, "ERROR: ")) {
        report_compiler(text, directory, glsl_path);
    } else if (!good) {
        hide_directory(text, directory);
        text[strcspn(text, "\n")] = '\0';
        masu_cli_error("%s: %s failed (exit code %d): %s", glsl_path, arguments[0], result.code,
                       text);
    }
    masu_bake_release(&output);
    return good;
}

typedef struct paths {
    char *source, *raw, *optimised, *include_here, *include_scene;
    const char *define, *stage;
} paths;

static bool load_whole_vectors(const char *path, const char *glsl_path) {
    switch (masu_whole_vectors_file(path, path)) {
        case MASU_WHOLE_VECTORS_OK: return true;
        case MASU_WHOLE_VECTORS_NO_MODULE:
            masu_cli_error("%s: spirv-opt wrote no SPIR-V", glsl_path);
            return false;
        default: masu_cli_error("%s: cannot be written", path); return false;
    }
}

/* Writes the parameters of the compilation into the module; masu_scene_bind compares them with the
 * blob's values. */
static bool put_record(const char *path, const masu_module_counts *counts, const char *glsl_path) {
    masu_bake_buffer words = {0};
    uint32_t record[MASU_MODULE_RECORD_WORDS] = {MASU_MODULE_RECORD_FIRST};
    char text[MASU_MODULE_RECORD_BYTES];
    bool good = masu_bake_read_file(path, SPIRV_MAX, &words);
    if (good) {
        size_t place = 4 * (size_t)masu_module_record_place(
                               (const uint32_t *)(const void *)words.data, words.bytes / 4);
        masu_module_record(counts, text);
        memcpy(record + 1, text, sizeof text);
        masu_bake_append(&words, NULL, sizeof record);
        memmove(words.data + place + sizeof record, words.data + place,
                words.bytes - sizeof record - place);
        memcpy(words.data + place, record, sizeof record);
        FILE *file = fopen(path, "wb");
        good = file && fwrite(words.data, 1, words.bytes, file) == words.bytes;
        if (file && fclose(file) != 0) good = false;
        if (!good) masu_cli_error("%s: %s cannot be written", glsl_path, path);
    }
    masu_bake_release(&words);
    return good;
}

/* counts: NULL for modules that are not part of a blob. */
static bool run_tools(const paths *p, bool has_raster, const char *directory,
                      const char *glsl_path, const masu_module_counts *counts) {
    const char *const compile[] = {"glslangValidator",
                                   "-V",
                                   "--target-env",
                                   "vulkan1.1",
                                   p->include_here,
                                   p->include_scene,
                                   has_raster ? "-DMASU_HAS_RASTER=1" : "-DMASU_HAS_RASTER=0",
                                   "-S",
                                   p->stage,
                                   "-o",
                                   p->raw,
                                   p->source,
                                   p->define, /* NULL ends the list */
                                   NULL};
    const char *const optimise[] = {"spirv-opt",
                                    "--target-env=vulkan1.1",
                                    "-O",
                                    "--strip-debug",
                                    "--compact-ids",
                                    p->raw,
                                    "-o",
                                    p->optimised,
                                    NULL};
    const char *const check[] = {"spirv-val", "--target-env", "vulkan1.0", p->optimised, NULL};
    const struct {
        const char *const *arguments;
        const char *package;
    } steps[] = {
        {compile, "glslang-tools"}, {optimise, "spirv-tools"}, {check, "spirv-tools"}};
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
        masu_cli_progress("%s %s", steps[i].arguments[0], glsl_path);
        if (!run_tool(steps[i].arguments, steps[i].package, directory, glsl_path)) return false;
        if (steps[i].arguments != optimise) continue;
        if (!load_whole_vectors(p->optimised, glsl_path)) return false;
        if (counts && !put_record(p->optimised, counts, glsl_path)) return false;
    }
    return true;
}

static bool take_spirv(masu_bake_content *content, uint32_t kind, const char *path,
                       const char *glsl_path) {
    masu_bake_buffer *spirv = &content->section[kind];
    if (!masu_bake_read_file(path, SPIRV_MAX, spirv)) return false;
    uint32_t magic = 0;
    if (spirv->bytes >= 20) memcpy(&magic, spirv->data, sizeof magic);
    if (magic == SPIRV_MAGIC && spirv->bytes % 4 == 0) return true;
    masu_cli_error("%s: spirv-opt wrote no SPIR-V", glsl_path);
    return false;
}

static char *include_option(const char *directory) {
    size_t bytes = strlen(directory) + 3;
    char *option = masu_bake_allocate(bytes);
    snprintf(option, bytes, "-I%s", directory);
    return option;
}

enum {
    ALWAYS,
    MOVES,
    UPDATED,
    DYNAMIC,
    VARIANT,
    OCCLUSION,
    LOCAL_SHADOWS,
    REFLECTED_STILL,
    REFLECTED_DYNAMIC,
    BOUNCED
};

/* The shaders that are compiled together with the scene's field, and their sections. The march is
 * first, so compile errors are reported under its name. */
static const struct {
    const char *source, *define /* or NULL */, *raw, *optimised;
    uint32_t kind;
    /* In the order of the enum: always; with a field that may change; with slots that change or an
     * anchored field; with slots that change; with --variants; with shadows or ambient occlusion;
     * with punctual lights that cast shadows; with reflections and slots that are constant; with
     * reflections and slots that change; with a live bounce. */
    int when;
} scene_shaders[] = {
    {"march.comp", NULL, "march.raw", "march.spv", MASU_BLOB_MARCH_SPIRV, ALWAYS},
    {"update.comp", NULL, "update.raw", "update.spv", MASU_BLOB_UPDATE_SPIRV, UPDATED},
    {"update.comp", "-DMASU_MOTION=1", "before.raw", "before.spv", MASU_BLOB_UPDATE_PREVIOUS_SPIRV,
     DYNAMIC},
    {"sdf_velocity.comp", NULL, "motion.raw", "motion.spv", MASU_BLOB_VELOCITY_SPIRV, MOVES},
    {"silhouettes.comp", NULL, "edges.raw", "edges.spv", MASU_BLOB_SILHOUETTES_SPIRV, ALWAYS},
    {"classify.comp", NULL, "class.raw", "class.spv", MASU_BLOB_CLASSIFY_SPIRV, ALWAYS},
    {"cone.comp", "-DMASU_CONE_BLOCK=8", "cone8.raw", "cone8.spv", MASU_BLOB_CONE8_SPIRV, ALWAYS},
    {"cone.comp", "-DMASU_CONE_BLOCK=4", "cone4.raw", "cone4.spv", MASU_BLOB_CONE4_SPIRV, ALWAYS},
#ifdef MASU_LAB
    {"march_plain.comp", "-DMASU_LAB", "plain.raw", "plain.spv", MASU_BLOB_PLAIN_SPIRV, VARIANT},
    {"march_seed.comp", "-DMASU_LAB", "seed.raw", "seed.spv", MASU_BLOB_SEED_SPIRV, VARIANT},
    {"march_checkerboard.comp", "-DMASU_LAB", "check.raw", "check.spv",
     MASU_BLOB_CHECKERBOARD_SPIRV, VARIANT},
#endif
    {"sdf_occlusion.comp", NULL, "occl.raw", "occl.spv", MASU_BLOB_OCCLUSION_SPIRV, OCCLUSION},
    {"local_shadow_sdf.comp", NULL, "faces.raw", "faces.spv", MASU_BLOB_LOCAL_SHADOW_SPIRV,
     LOCAL_SHADOWS},
    {"specular_trace_sdf.comp", NULL, "mirror.raw", "mirror.spv", MASU_BLOB_TRACE_SDF_SPIRV,
     REFLECTED_STILL},
    {"specular_trace_sdf.comp", "-DMASU_MOTION=1", "mirror.raw", "mirror.spv",
     MASU_BLOB_TRACE_SDF_SPIRV, REFLECTED_DYNAMIC},
    {"bounce_sdf.comp", NULL, "bounce.raw", "bounce.spv", MASU_BLOB_BOUNCE_SDF_SPIRV, BOUNCED}};

static bool wanted(int when, bool moves, bool dynamic, bool anchored, bool occlusion, bool casts,
                   bool reflected, bool bounced, bool variants) {
    if (when == MOVES) return moves;
    if (when == UPDATED) return dynamic || anchored;
    if (when == DYNAMIC) return dynamic;
    if (when == OCCLUSION) return occlusion;
    if (when == LOCAL_SHADOWS) return casts;
    if (when == REFLECTED_STILL) return reflected && !dynamic;
    if (when == REFLECTED_DYNAMIC) return reflected && dynamic;
    if (when == BOUNCED) return bounced;
    return when == ALWAYS || variants;
}

/* Makes a GLSL source a single part. A parameter without a range has only its value. */
static void source_as_part(const masu_bake_content *content, masu_sdfc_result *scene) {
    const masu_blob_sdf *sdf = MASU_BAKE_ARRAY(content, MASU_BLOB_SDF, const masu_blob_sdf);
    masu_sdfc_part *part = scene->parts = masu_bake_allocate(sizeof *scene->parts);
    memset(part, 0, sizeof *part);
    part->user = true;
    part->lipschitz = (double)sdf->lipschitz;
    for (int i = 0; i < 3; i++) {
        part->low[i] = (double)sdf->bounds_min[i];
        part->high[i] = (double)sdf->bounds_max[i];
    }
    scene->part_count = 1;
    scene->param_count = (uint32_t)masu_bake_count(content, MASU_BLOB_SDF_PARAMS);
    scene->params = masu_bake_allocate((scene->param_count + 1) * sizeof *scene->params);
    for (uint32_t i = 0; i < scene->param_count; i++) {
        const masu_blob_sdf_param *p =
            &MASU_BAKE_ARRAY(content, MASU_BLOB_SDF_PARAMS, const masu_blob_sdf_param)[i];
        bool ranges = p->minimum > -1e30f && p->maximum < 1e30f;
        memset(&scene->params[i], 0, sizeof scene->params[i]);
        scene->params[i].value = (double)p->value;
        scene->params[i].minimum = (double)(ranges ? p->minimum : p->value);
        scene->params[i].maximum = (double)(ranges ? p->maximum : p->value);
    }
}

/* The least constant that masu-bake accepts, and the margin above the steepest slope found. */
#define LEAST_LIPSCHITZ 1e-3
#define AUTO_MARGIN 1.05

static bool take_steepest(masu_bake_content *content, double steepest, const char *path) {
    double lipschitz = fmax(steepest * AUTO_MARGIN, LEAST_LIPSCHITZ);
    if (!(lipschitz <= 1e6)) {
        masu_cli_error("%s: the steepest slope found is %.4g: expected at most 1e6", path,
                       steepest);
        return false;
    }
    MASU_BAKE_ARRAY(content, MASU_BLOB_SDF, masu_blob_sdf)->lipschitz = (float)lipschitz;
    if (!masu_cli_quiet())
        printf("%s: lipschitz %.4g (steepest slope found: %.4g)\n", path, lipschitz, steepest);
    return true;
}

/* ---- static fields ---- */

static bool run_quietly(const char *const *arguments) {
    masu_bake_buffer said = {0};
    masu_bake_result result = masu_bake_run(arguments, MASU_BAKE_TOOL_SECONDS, &said);
    masu_bake_release(&said);
    return result.end == MASU_BAKE_EXITED && result.code == 0;
}

/* True if the surface of a GLSL source may depend on time. A surface that uses undocumented
 * functions does not compile here, and is assumed to depend on time. */
static bool surface_reads_time(const paths *p) {
    const char *const compile[] = {"glslangValidator", "-V", "--target-env", "vulkan1.1",
                                   p->include_here, p->include_scene, "-DMASU_TRY_SURFACE", "-S",
                                   p->stage, "-o", p->raw, p->source, NULL};
    const char *const optimise[] = {"spirv-opt", "--target-env=vulkan1.1", "-O", p->raw, "-o",
                                    p->optimised, NULL};
    masu_bake_buffer spirv = {0};
    bool time = true;
    if (run_quietly(compile) && run_quietly(optimise) &&
        masu_bake_read_file(p->optimised, SPIRV_MAX, &spirv))
        time =
            masu_bake_try_reads((const uint32_t *)(const void *)spirv.data, spirv.bytes / 4).time;
    masu_bake_release(&spirv);
    return time;
}

/* The first parameter that a host can change, or NULL. */
static const char *changing_param(const masu_bake_content *content) {
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_SDF_PARAMS); i++) {
        const masu_blob_sdf_param *p =
            &MASU_BAKE_ARRAY(content, MASU_BLOB_SDF_PARAMS, const masu_blob_sdf_param)[i];
        if (p->minimum < p->maximum) return masu_bake_name_text(content, p->name);
    }
    return NULL;
}

/* Decides whether the field may change from frame to frame. reads: the inputs that GLSL reads, in a
 * source or in blocks. False: the scene declares a static field, but the field may change. */
static bool decide_moves(const masu_bake_content *content, const masu_sdfc_result *scene,
                         masu_bake_reads reads, bool is_static, const char *path, bool *moves) {
    const char *param = reads.params ? changing_param(content) : NULL;
    const masu_sdfc_part *part = NULL;
    for (uint32_t i = 0; i < scene->part_count && !part; i++)
        if (scene->parts[i].dynamic) part = &scene->parts[i];
    *moves = reads.time || param || part;
    if (!is_static || !*moves) return true;
    if (part)
        masu_cli_error("%s: declared \"static\", but part %s depends on time or on a parameter",
                       path, part->name);
    else if (reads.time)
        masu_cli_error("%s: declared \"static\", but the field reads masu_time()", path);
    else
        masu_cli_error(
            "%s: declared \"static\", but the field reads the parameter \"%s\" or another "
            "that may change (min < max)",
            path, param);
    return false;
}

/* Called directly after the march has compiled: a field that is too steep is rejected before the
 * other shaders are compiled. */
static bool try_blocks(masu_bake_content *content, masu_sdfc_result *scene, const char *directory,
                       char *include_here, char *include_scene, const char *path,
                       masu_bake_reads *reads) {
    masu_bake_buffer spirv = {0};
    bool source = !masu_bake_is_sdf(path);
    bool measures = MASU_BAKE_ARRAY(content, MASU_BLOB_SDF, const masu_blob_sdf)->lipschitz == 0;
    double steepest = 0;
    if (source) source_as_part(content, scene);
    if (!source && measures) {
        MASU_BAKE_ARRAY(content, MASU_BLOB_SDF, masu_blob_sdf)->lipschitz = 1;
        if (!masu_cli_quiet())
            printf("%s: lipschitz 1: each part is divided by its own constant\n", path);
    }
    if (!masu_bake_try_needed(scene)) return true;
    paths p = {masu_bake_join(directory, "try.comp"),
               masu_bake_join(directory, "try.raw"),
               masu_bake_join(directory, "try.spv"),
               include_here,
               include_scene,
               source ? "-DMASU_TRY_FIELD" : NULL,
               "comp"};
    masu_cli_progress("trying %s", path);
    masu_sdfc_options options = {0};
    masu_sdfc_camera *cameras = path_of(content, &options.camera_count);
    options.cameras = cameras;
    bool good = run_tools(&p, false, directory, path, NULL) &&
                masu_bake_read_file(p.optimised, SPIRV_MAX, &spirv) &&
                masu_bake_try(scene, (const uint32_t *)(const void *)spirv.data, spirv.bytes / 4,
                              &options, path, source && measures ? &steepest : NULL) &&
                (!source || !measures || take_steepest(content, steepest, path));
    if (good) {
        *reads = masu_bake_try_reads((const uint32_t *)(const void *)spirv.data, spirv.bytes / 4);
        masu_blob_sdf *sdf = MASU_BAKE_ARRAY(content, MASU_BLOB_SDF, masu_blob_sdf);
        if (reads->time)
            sdf->flags &= ~MASU_SDF_TIMELESS;
        else if (source && !surface_reads_time(&p))
            sdf->flags |= MASU_SDF_TIMELESS;
    }
    masu_bake_release(&spirv);
    free(cameras);
    free(p.source);
    free(p.raw);
    free(p.optimised);
    return good;
}

/* Lights that a program adds to other scenes have no SDF shadows: these are not compiled for
 * them. */
static bool any_light_casts(const masu_bake_content *content) {
    const masu_blob_light *lights =
        MASU_BAKE_ARRAY(content, MASU_BLOB_LIGHTS, const masu_blob_light);
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_LIGHTS); i++) {
        if (!(lights[i].type & MASU_LIGHT_NO_SHADOW)) return true;
    }
    return false;
}

bool masu_bake_compile_march(masu_bake_content *content, const char *glsl_path,
                             const masu_bake_occlusion *occlusion, bool is_static, bool reflected,
                             bool bounced, bool variants) {
    const char *directory = masu_bake_temporary_directory();
    if (!directory) return false;
    char *scene_directory = masu_bake_directory_of(glsl_path);
    char *include_here = include_option(directory),
         *include_scene = include_option(scene_directory);
    bool has_raster = masu_bake_count(content, MASU_BLOB_INSTANCES) > 0;
    bool dynamic = false, moves = true;
    masu_sdfc_result scene = {0};
    masu_bake_reads reads = {false, false};
    bool darkens = occlusion->shadows || occlusion->ambient;
    bool casts = any_light_casts(content);
    bool good = lay_out(directory, content, glsl_path, &dynamic, &scene) &&
                (!darkens || write_occlusion(directory, occlusion));
    for (size_t i = 0; i < sizeof scene_shaders / sizeof *scene_shaders && good; i++) {
        bool anchored =
            MASU_BAKE_ARRAY(content, MASU_BLOB_SDF, masu_blob_sdf)->flags & MASU_SDF_ANCHORED;
        if (!wanted(scene_shaders[i].when, moves, dynamic, anchored, darkens, casts, reflected,
                    bounced, variants))
            continue;
        paths p = {masu_bake_join(directory, scene_shaders[i].source),
                   masu_bake_join(directory, scene_shaders[i].raw),
                   masu_bake_join(directory, scene_shaders[i].optimised),
                   include_here,
                   include_scene,
                   scene_shaders[i].define,
                   strrchr(scene_shaders[i].source, '.') + 1};
        const masu_blob_sdf *sdf = MASU_BAKE_ARRAY(content, MASU_BLOB_SDF, const masu_blob_sdf);
        const masu_module_counts counts = {.kind = scene_shaders[i].kind,
                                           .parts = sdf->part_count,
                                           .slots =
                                               (uint32_t)masu_bake_count(content, MASU_BLOB_SLOTS),
                                           .block_words = sdf->block_words,
                                           .raster = has_raster,
                                           .anchored = sdf->flags & MASU_SDF_ANCHORED,
                                           .moves = dynamic};
        good = run_tools(&p, has_raster, directory, glsl_path, &counts) &&
               take_spirv(content, scene_shaders[i].kind, p.optimised, glsl_path) &&
               (i > 0 ||
                (try_blocks(content, &scene, directory, include_here, include_scene, glsl_path,
                            &reads) &&
                 decide_moves(content, &scene, reads, is_static, glsl_path, &moves)));
        free(p.source);
        free(p.raw);
        free(p.optimised);
    }
    masu_sdfc_release(&scene);
    free(include_here);
    free(include_scene);
    free(scene_directory);
    return good;
}
