/* try.c: see try.h. The points come from a fixed seed: the same scene is always judged
 * alike. Runs in double precision, but literals and slots are floats: what differs by less than a
 * hundred-thousandth is no violation. */
#include "bake/shader/try.h"

#include "bake/base/process.h"
#include "bake/shader/spirv.h"
#include "cli/cli.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    PAIRS = 4000,
    ENVIRONMENTS = 8,
    SECONDS = 60,
    HALVINGS = 20,
    BIND_SLOTS = 0,
    BIND_INPUT = 1,
    BIND_RESULT = 2
};
#define FAR_AWAY 40.0 /* what stands for the size of something endless */
#define SLACK 1e-5

/* MASU_SDFC_SLOTS_MAX, MASU_SDFC_PARAMS_MAX. */
const char masu_bake_try_source[] =
    "#version 440\n"
    "#extension GL_GOOGLE_include_directive : require\n"
    "#define MASU_SDF_SETUP 1\n"
    "#include \"shared/guard.glsl\"\n"
    "struct masu_surface { vec3 albedo; float roughness; vec3 emissive; float metallic; };\n"
    "layout(local_size_x = 1) in;\n"
    "layout(set = 0, binding = 0, std430) buffer Slots { float slots[65536]; };\n"
    "layout(set = 0, binding = 1, std430) buffer Input {\n"
    "    uint part; float time; float point[3]; float params[256]; };\n"
    "layout(set = 0, binding = 2, std430) buffer Result { float result; };\n"
    "float masu_param(int i) { return params[i]; }\n"
    "float masu_time() { return time; }\n"
    "float masu_slot(uint i) { return slots[i]; }\n"
    "void masu_slot_write(uint i, float v) { slots[i] = v; }\n"
    "uint masu_part_count() { return 1u; }\n"
    "uint masu_part_at(uint i) { return i; }\n"
    "#include \"sdf_scene.glsl\"\n"
    "void main() {\n"
    "    masu_sdf_update();\n"
    "    result = masu_sdf_part(part, vec3(point[0], point[1], point[2]));\n"
    "}\n";

typedef struct trial {
    const masu_sdfc_result *scene;
    const uint32_t *words;
    size_t count;
    const masu_sdfc_part *part;
    masu_bake_machine *machine;
    masu_bake_cell *slots, *input, *result;
    uint64_t random;
    double center[3], half[3], size;
    char text[1024]; /* 'E' or 'W', then the message; "": nothing to say */
} trial;

static double unit(trial *t) {
    uint64_t z = t->random += 0x9E3779B97F4A7C15u;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return (double)((z ^ z >> 31) >> 11) / 9007199254740992.0;
}

static void any_point(trial *t, double out[3]) {
    static const double scales[] = {0.3, 1, 1.2, 4};
    double scale = scales[(int)(unit(t) * 4)];
    for (int i = 0; i < 3; i++)
        out[i] = t->center[i] + (2 * unit(t) - 1) * scale * (t->half[i] + 0.1 * t->size);
}

static void set_part(trial *t, uint32_t part) {
    t->part = &t->scene->parts[part];
    t->size = 1e-6;
    for (int i = 0; i < 3; i++) {
        double from = t->part->low[i], to = t->part->high[i];
        bool ends = isfinite(from) && isfinite(to);
        t->center[i] = ends ? (from + to) / 2 : isfinite(from) ? from : isfinite(to) ? to : 0;
        t->half[i] = ends ? (to - from) / 2 : FAR_AWAY;
        t->size = fmax(t->size, t->half[i]);
    }
    if (t->input) t->input[0].u = part;
}

static void set_environment(trial *t, int environment) {
    if (!t->input) return;
    t->input[1].f = environment == 0 ? 0 : 100 * unit(t);
    for (uint32_t i = 0; i < t->scene->param_count; i++) {
        const masu_sdfc_param *p = &t->scene->params[i];
        double k = unit(t);
        t->input[5 + i].f = environment == 0   ? p->value
                            : environment == 1 ? p->minimum
                            : environment == 2 ? p->maximum
                                               : p->minimum * (1 - k) + p->maximum * k;
    }
}

/* False: it cannot be run, and the text says why. */
static bool field(trial *t, const double p[3], double *f) {
    char error[256];
    for (int i = 0; i < 3 && t->input; i++) t->input[2 + i].f = p[i];
    if (!masu_bake_machine_run(t->machine, error, sizeof error)) {
        snprintf(t->text, sizeof t->text,
                 "Wpart %s: its glsl was not tested, since it cannot run on the CPU: %s",
                 t->part->name, error);
        return false;
    }
    *f = t->result->f * t->part->lipschitz;
    return true;
}

static double distance(const double p[3], const double q[3]) {
    return sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) +
                (p[2] - q[2]) * (p[2] - q[2]));
}

static bool keeps(trial *t, const double p[3], double fp, const double q[3], double fq) {
    if (!isfinite(fp) || !isfinite(fq)) return true; /* a miss there */
    double allowed = t->part->lipschitz * distance(p, q) * (1 + SLACK);
    allowed += 1e-2 * SLACK * SLACK * (t->size + fabs(fp) + fabs(fq)) * fmax(t->part->lipschitz, 1);
    if (fabs(fp - fq) <= allowed) return true;
    snprintf(t->text, sizeof t->text,
             "Epart %s: its glsl is steeper than its lipschitz constant %.9g: f(%.9g, %.9g, %.9g) "
             "= %.9g, f(%.9g, %.9g, %.9g) = %.9g, %.9g apart, at time %.9g",
             t->part->name, t->part->lipschitz, p[0], p[1], p[2], fp, q[0], q[1], q[2], fq,
             distance(p, q), t->input ? t->input[1].f : 0.0);
    return false;
}

/* Of the halves of a pair one is as steep as the whole or steeper: going there again and again finds
 * a jump that no random pair is near enough to. */
static bool narrow(trial *t, double p[3], double fp, double q[3], double fq) {
    for (int i = 0; i < HALVINGS; i++) {
        double m[3], fm;
        for (int k = 0; k < 3; k++) m[k] = 0.5 * (p[k] + q[k]);
        if (!field(t, m, &fm) || !keeps(t, p, fp, m, fm) || !keeps(t, m, fm, q, fq)) return false;
        bool first = fabs(fp - fm) > fabs(fm - fq);
        memcpy(first ? q : p, m, sizeof m);
        *(first ? &fq : &fp) = fm;
    }
    return true;
}

static bool try_pair(trial *t) {
    double p[3], q[3], fp, fq, length = t->size * pow(10, -6 * unit(t)), how = unit(t);
    any_point(t, p);
    any_point(t, q);
    if (how < 0.6) {
        double n = fmax(distance(p, q), 1e-30);
        for (int i = 0; i < 3; i++) q[i] = p[i] + (q[i] - p[i]) / n * length;
    }
    if (!field(t, p, &fp) || !field(t, q, &fq) || !keeps(t, p, fp, q, fq)) return false;
    return how < 0.9 || narrow(t, p, fp, q, fq);
}

static bool try_parts(trial *t) {
    const masu_sdfc_result *s = t->scene;
    for (uint32_t i = 0; i < s->part_count; i++) {
        if (!s->parts[i].user) continue;
        uint32_t alike = 0;
        for (uint32_t k = 0; k < s->part_count; k++)
            alike += s->parts[k].shape == s->parts[i].shape;
        set_part(t, i);
        for (int e = 0; e < ENVIRONMENTS; e++) {
            set_environment(t, e);
            for (uint32_t n = 0; n <= PAIRS / ENVIRONMENTS / alike; n++)
                if (!try_pair(t)) return false;
        }
    }
    return true;
}

static void body(void *argument, int fd) {
    trial *t = argument;
    char error[256];
    size_t count;
    t->machine = masu_bake_machine_make(t->words, t->count, error, sizeof error);
    if (!t->machine) {
        snprintf(t->text, sizeof t->text,
                 "Wits glsl was not tested, since it cannot run on the CPU: %s", error);
    } else {
        t->slots = masu_bake_machine_buffer(t->machine, BIND_SLOTS, &count);
        t->input = masu_bake_machine_buffer(t->machine, BIND_INPUT, &count);
        t->result = masu_bake_machine_buffer(t->machine, BIND_RESULT, &count);
        for (uint32_t i = 0; t->slots && i < t->scene->slot_count; i++)
            t->slots[i].f = (double)t->scene->slots[i];
        (void)try_parts(t);
        masu_bake_machine_free(t->machine);
    }
    masu_bake_send(fd, t->text, strlen(t->text));
}

bool masu_bake_try_needed(const masu_sdfc_result *scene) {
    for (uint32_t i = 0; i < scene->part_count; i++)
        if (scene->parts[i].user) return true;
    return false;
}

bool masu_bake_try(const masu_sdfc_result *scene, const uint32_t *words, size_t count,
                   const char *path) {
    static trial t;
    masu_bake_buffer said = {0};
    memset(&t, 0, sizeof t);
    t.scene = scene;
    t.words = words;
    t.count = count;
    t.random = 0x6D617375;
    masu_bake_result result = masu_bake_fork(body, &t, SECONDS, &said);
    masu_bake_append(&said, "", 1);
    const char *text = (const char *)said.data;
    bool ended = result.end == MASU_BAKE_EXITED && result.code == 0;
    if (!ended) masu_cli_warn("%s: its glsl was not tested, since the test did not finish", path);
    if (ended && text[0] == 'W') masu_cli_warn("%s: %s", path, text + 1);
    if (ended && text[0] == 'E') masu_cli_error("%s: %s", path, text + 1);
    bool good = !(ended && text[0] == 'E');
    masu_bake_release(&said);
    return good;
}
