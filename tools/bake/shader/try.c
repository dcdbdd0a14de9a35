/* try.c: see try.h. The points use a fixed seed, so the same scene always gets the same result.
 * Runs are in double precision, but literals and slots are floats: an excess below 1e-5 is not a
 * violation. */
#include "bake/shader/try.h"

#include "bake/base/buffer.h"
#include "bake/base/process.h"
#include "bake/shader/spirv.h"
#include "cli/cli.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    PAIRS = 4000,
    ENVIRONMENTS = 8,
    SECONDS = 600,
    RUNS = 60000,   /* total limit of field evaluations for all of the below */
    HALVINGS = 20,
    BEST = 8,       /* pairs of an environment from which climbing starts */
    CLIMBS = 30,    /* steps from each pair */
    SITES = 64,     /* decisions whose opposite side is searched for */
    SEARCHES = 120, /* steps for each decision */
    BIND_SLOTS = 0,
    BIND_INPUT = 1,
    BIND_RESULT = 2
};
/* Instructions for all forms of parts together, in equal shares: some seconds. Counts instructions,
 * not time, so that a scene always gets the same result. */
#define WORK_MAX 5e8
#define FAR_AWAY 40.0 /* the assumed size of endless parts */
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
    "float masu_param(int i) { return uint(i) < 256u ? params[i] : 0.0; }\n"
    "float masu_time() { return time; }\n"
    "float masu_slot(uint i) { return slots[i]; }\n"
    "vec3 masu_normal = vec3(0.0);\n"
    "#include \"shared/counters.h\"\n"
    "void masu_count(uint counter, uint n) {}\n"
    "uint masu_part_bits(int word) { return 0xFFFFFFFFu; }\n"
    "#define MASU_LOOP\n"
    "#include \"sdf/terms.glsl\"\n"
    "void masu_slot_write(uint i, float v) { slots[i] = v; }\n"
    "uint masu_part_count() { return 1u; }\n"
    "uint masu_part_at(uint i) { return i; }\n"
    "#include \"sdf_scene.glsl\"\n"
    "void main() {\n"
    "#if defined(MASU_TRY_SURFACE)\n"
    "    masu_surface s = masu_surface(vec3(0.5), 0.5, vec3(0.0), 0.0);\n"
    "    masu_sdf_surface(vec3(point[0], point[1], point[2]), s);\n"
    "    result = dot(s.albedo + s.emissive, vec3(1.0)) + s.roughness + s.metallic;\n"
    "#elif defined(MASU_TRY_FIELD)\n"
    "    result = masu_sdf(vec3(point[0], point[1], point[2]));\n"
    "#else\n"
    "    masu_sdf_update();\n"
    "    result = masu_sdf_part(part, vec3(point[0], point[1], point[2]));\n"
    "#endif\n"
    "}\n";

typedef struct start {
    double p[3], slope;
} start;

/* A minimum, comparison, ... of the code with the same decision at all points: the point that was
 * closest to the opposite decision. */
typedef struct site {
    bool below, above;
    double nearest, p[3];
} site;

typedef struct trial {
    const masu_sdfc_result *scene;
    const masu_sdfc_options *cameras;
    const uint32_t *words;
    size_t count;
    const masu_sdfc_part *part;
    masu_bake_machine *machine;
    masu_bake_cell *slots, *input, *result;
    const double *decisions;
    site *sites;
    size_t site_count;
    uint64_t random;
    double center[3], half[3], size;
    start best[BEST];
    /* Share of the pairs, climbs and searches: 1, or less if the form would exceed its budget. */
    double portion;
    double least_portion;
    bool measures;
    double steepest;
    double jump[3], jumps_by; /* the position and size of a jump */
    /* 'E' or 'W', then the message; 'S', then the steepest slope; "": no message. */
    char text[1024];
} trial;

static double unit(trial *t) {
    uint64_t z = t->random += 0x9E3779B97F4A7C15u;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return (double)((z ^ z >> 31) >> 11) / 9007199254740992.0;
}

static bool is_source(const trial *t) { return !t->part->name[0]; }

/* "part a: its glsl" */
static const char *subject(const trial *t, char text[128]) {
    if (is_source(t))
        snprintf(text, 128, "the field");
    else
        snprintf(text, 128, "part %s: its glsl", t->part->name);
    return text;
}

static bool is_inside(const trial *t, const double p[3]) {
    for (int i = 0; i < 3; i++)
        if (!(fabs(p[i] - t->center[i]) <= t->half[i])) return false;
    return true;
}

/* A random point; for a GLSL source within its bounds. */
static void any_point(trial *t, double out[3]) {
    static const double scales[] = {0.3, 1, 1.2, 4};
    double scale = scales[(int)(unit(t) * 4)], more = is_source(t) ? 0 : 0.1 * t->size;
    if (is_source(t)) scale = fmin(scale, 1);
    for (int i = 0; i < 3; i++)
        out[i] = t->center[i] + (2 * unit(t) - 1) * scale * (t->half[i] + more);
}

/* A random point around p, up to `length` along each axis, within the bounds. */
static void near_point(trial *t, const double p[3], double length, double out[3]) {
    for (int i = 0; i < 3; i++) {
        out[i] = p[i] + (2 * unit(t) - 1) * length;
        out[i] = fmin(fmax(out[i], t->center[i] - t->half[i]), t->center[i] + t->half[i]);
    }
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
    memset(t->best, 0, sizeof t->best);
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

static void note_decisions(trial *t, const double p[3]) {
    size_t count;
    const uint32_t *ids = masu_bake_machine_decided(t->machine, &count);
    for (size_t i = 0; i < count; i++) {
        site *s = &t->sites[ids[i]];
        double by = t->decisions[ids[i]];
        if (!isfinite(by) || (s->below && s->above)) continue;
        if ((!s->below && !s->above) || fabs(by) < s->nearest) {
            s->nearest = fabs(by);
            memcpy(s->p, p, sizeof s->p);
        }
        *(by < 0 ? &s->below : &s->above) = true;
    }
}

/* False: the field cannot be run, and the text has the reason. */
static bool field(trial *t, const double p[3], double *f) {
    char error[256], what[128];
    for (int i = 0; i < 3 && t->input; i++) t->input[2 + i].f = p[i];
    if (!masu_bake_machine_run(t->machine, error, sizeof error)) {
        snprintf(t->text, sizeof t->text, "W%s was not tested, since it cannot run on the CPU: %s",
                 subject(t, what), error);
        return false;
    }
    note_decisions(t, p);
    *f = is_source(t) ? t->result->f : t->result->f * t->part->lipschitz;
    return true;
}

static double distance(const double p[3], const double q[3]) {
    return sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) +
                (p[2] - q[2]) * (p[2] - q[2]));
}

static double slope(const double p[3], double fp, const double q[3], double fq) {
    double apart = distance(p, q);
    return isfinite(fp) && isfinite(fq) && apart > 0 ? fabs(fp - fq) / apart : 0;
}

static bool keeps(trial *t, const double p[3], double fp, const double q[3], double fq) {
    double apart = distance(p, q), L = t->part->lipschitz;
    char what[128];
    if (!isfinite(fp) || !isfinite(fq)) return true; /* a miss there */
    double rounding = 1e-2 * SLACK * SLACK * (t->size + fabs(fp) + fabs(fq));
    if (t->measures) {
        if (apart > 1e4 * rounding) t->steepest = fmax(t->steepest, fabs(fp - fq) / apart);
        return true;
    }
    if (fabs(fp - fq) <= L * apart * (1 + SLACK) + rounding * fmax(L, 1)) return true;
    snprintf(t->text, sizeof t->text,
             "E%s is steeper than its lipschitz constant %.9g: f(%.9g, %.9g, %.9g) "
             "= %.9g, f(%.9g, %.9g, %.9g) = %.9g, %.9g apart, at time %.9g",
             subject(t, what), L, p[0], p[1], p[2], fp, q[0], q[1], q[2], fq, apart,
             t->input ? t->input[1].f : 0.0);
    return false;
}

/* One half of a pair is at least as steep as the whole. Repeated bisection thus finds a jump that
 * no random pair is close enough to. The slope of a jump doubles with each bisection. */
static bool narrow(trial *t, double p[3], double fp, double q[3], double fq) {
    double early = 0;
    for (int i = 0; i < HALVINGS; i++) {
        double m[3], fm;
        for (int k = 0; k < 3; k++) m[k] = 0.5 * (p[k] + q[k]);
        if (!field(t, m, &fm) || !keeps(t, p, fp, m, fm) || !keeps(t, m, fm, q, fq)) return false;
        bool first = fabs(fp - fm) > fabs(fm - fq);
        memcpy(first ? q : p, m, sizeof m);
        *(first ? &fq : &fp) = fm;
        if (i == HALVINGS - 5) early = slope(p, fp, q, fq);
    }
    if (early > 0 && slope(p, fp, q, fq) > 8 * early && fabs(fp - fq) > 1e-3 * t->size) {
        t->jumps_by = fabs(fp - fq);
        memcpy(t->jump, p, sizeof t->jump);
    }
    return true;
}

/* A slope equal to the constant comes from the box that a block is combined with: nothing to
 * climb from. */
static bool is_flat(const trial *t, double steep) {
    return !t->measures && fabs(steep / t->part->lipschitz - 1) < 1e-6;
}

static void keep_start(trial *t, const double p[3], double steep) {
    int least = 0;
    if (is_flat(t, steep) || !is_inside(t, p)) return;
    for (int i = 1; i < BEST; i++)
        if (t->best[i].slope < t->best[least].slope) least = i;
    if (!(steep > t->best[least].slope)) return;
    t->best[least].slope = steep;
    memcpy(t->best[least].p, p, 3 * sizeof *p);
}

static bool try_pair(trial *t) {
    double p[3], q[3], fp, fq, length = t->size * pow(10, -6 * unit(t)), how = unit(t);
    any_point(t, p);
    any_point(t, q);
    if (how < 0.6) {
        double n = fmax(distance(p, q), length);
        for (int i = 0; i < 3; i++) q[i] = p[i] + (q[i] - p[i]) / n * length;
    }
    if (!field(t, p, &fp) || !field(t, q, &fq) || !keeps(t, p, fp, q, fq)) return false;
    if (how < 0.6) keep_start(t, p, slope(p, fp, q, fq));
    return how < 0.75 || narrow(t, p, fp, q, fq);
}

/* The slope at p, from the pair along the gradient. */
static bool slope_at(trial *t, const double p[3], double *steep) {
    double f, h = 1e-4 * t->size, way[3], n = 0, q[3], fq;
    *steep = 0;
    if (!field(t, p, &f)) return false;
    for (int i = 0; i < 3; i++) {
        memcpy(q, p, sizeof q);
        q[i] += p[i] > t->center[i] ? -h : h;
        if (!field(t, q, &fq)) return false;
        way[i] = (fq - f) / (q[i] - p[i]);
        n += way[i] * way[i];
    }
    if (!isfinite(n) || !(n > 0)) return true;
    for (int i = 0; i < 3; i++) q[i] = p[i] + way[i] / sqrt(n) * h;
    for (int i = 0; i < 3 && is_source(t) && !is_inside(t, q); i++) q[i] = 2 * p[i] - q[i];
    if (is_source(t) && !is_inside(t, q)) return true;
    if (!field(t, q, &fq)) return false;
    *steep = slope(p, f, q, fq);
    if (is_flat(t, *steep)) *steep = 0;
    return keeps(t, p, f, q, fq);
}

static bool climb(trial *t, const double from[3], double step) {
    double p[3], q[3], best, steep;
    memcpy(p, from, sizeof p);
    if (!slope_at(t, p, &best)) return false;
    for (int i = 0; i < CLIMBS; i++) {
        near_point(t, p, step, q);
        if (!slope_at(t, q, &steep)) return false;
        if (steep > best) {
            best = steep;
            memcpy(p, q, sizeof p);
        } else {
            step *= 0.85;
        }
    }
    return true;
}

/* Searches for the opposite side of a decision, which may contain a part of the field that no
 * random point has reached. */
static bool search(trial *t, const site *s, size_t id) {
    const bool above = s->above;
    double p[3], q[3], f, best = (double)INFINITY, step = 0.25 * t->size;
    memcpy(p, s->p, sizeof p);
    for (int i = 0; i < SEARCHES; i++) {
        near_point(t, p, step, q);
        if (!field(t, q, &f)) return false;
        double by = t->decisions[id];
        if (!isfinite(by)) continue;
        if ((by >= 0) != above) { /* found: a pair across, and the slope there */
            double fp;
            if (!field(t, p, &fp) || !keeps(t, p, fp, q, f) ||
                !narrow(t, p, fp, (double[3]){q[0], q[1], q[2]}, f))
                return false;
            return climb(t, q, fmin(step, 0.02 * t->size));
        }
        if (fabs(by) < best) {
            best = fabs(by);
            memcpy(p, q, sizeof p);
        } else {
            step *= 0.9;
        }
    }
    return true;
}

/* The share of `n` for part number k of `alike` equal parts; `n` is for the whole form. */
static uint32_t part_of(const trial *t, double n, uint32_t k, uint32_t alike) {
    uint32_t all = (uint32_t)ceil(n * t->portion);
    return all / alike + (k < all % alike);
}

static bool try_environment(trial *t, uint32_t pairs, uint32_t climbs) {
    for (uint32_t n = 0; n <= pairs; n++)
        if (!try_pair(t)) return false;
    for (uint32_t i = 0; i < climbs; i++) {
        int steepest = 0;
        for (int k = 1; k < BEST; k++)
            if (t->best[k].slope > t->best[steepest].slope) steepest = k;
        if (!(t->best[steepest].slope > 0)) break;
        t->best[steepest].slope = 0;
        if (!climb(t, t->best[steepest].p, 0.05 * t->size)) return false;
    }
    return true;
}

/* Parts of a form have the same decisions: part number k of `alike` ones searches every
 * alike-th. */
static bool search_all(trial *t, uint32_t k, uint32_t alike) {
    uint32_t found = 0, most = (uint32_t)ceil(SITES * t->portion);
    for (size_t i = 0; i < t->site_count && found < most; i++) {
        site s = t->sites[i];
        if (s.below == s.above) continue;
        if (found++ % alike == k && !search(t, &s, i)) return false;
    }
    return true;
}

/* Sets the share of RUNS that the budget of a form allows. */
static bool set_portion(trial *t, uint32_t forms) {
    double f, before = (double)masu_bake_machine_steps(t->machine);
    t->portion = 1;
    set_environment(t, 0);
    if (t->measures) return true;
    if (!field(t, t->center, &f)) return false;
    double cost = (double)masu_bake_machine_steps(t->machine) - before;
    t->portion = fmin(WORK_MAX / forms / (cost * RUNS), 1);
    t->least_portion = fmin(t->least_portion, t->portion);
    return true;
}

/* Tests part number k of `alike` ones of a form. */
static bool try_part(trial *t, uint32_t part, uint32_t k, uint32_t alike) {
    uint32_t pairs = (uint32_t)(PAIRS * t->portion / ENVIRONMENTS / alike);
    uint32_t climbs = part_of(t, BEST * ENVIRONMENTS, k, alike);
    set_part(t, part);
    memset(t->sites, 0, t->site_count * sizeof *t->sites);
    for (uint32_t e = 0; e < ENVIRONMENTS; e++) {
        uint32_t turn = (e + k) % ENVIRONMENTS;
        set_environment(t, (int)e);
        if (!try_environment(t, pairs, climbs / ENVIRONMENTS + (turn < climbs % ENVIRONMENTS)))
            return false;
    }
    set_environment(t, 0);
    return search_all(t, k, alike);
}

/* True if a part is the first of its form; alike: the number of parts of the form. */
static bool is_first(const masu_sdfc_result *s, uint32_t part, uint32_t *alike) {
    *alike = 0;
    for (uint32_t i = 0; i < s->part_count; i++) {
        if (s->parts[i].shape != s->parts[part].shape) continue;
        if (i < part) return false;
        ++*alike;
    }
    return true;
}

/* "W", then a message that a camera of the path is inside one of the parts, which masu-sdfc cannot
 * detect. */
static bool try_cameras(trial *t) {
    const masu_sdfc_result *s = t->scene;
    char what[128];
    for (uint32_t i = 0; i < s->part_count; i++) {
        if (!s->parts[i].user) continue;
        set_part(t, i);
        set_environment(t, 0);
        for (uint32_t k = 0; k < t->cameras->camera_count; k++) {
            const masu_sdfc_camera *c = &t->cameras->cameras[k];
            double f;
            if (t->input) t->input[1].f = c->time;
            if (!field(t, c->position, &f)) return false;
            if (!(f < -1e-6) || t->text[0]) continue;
            snprintf(t->text, sizeof t->text, "Wthe camera at (%g, %g, %g), %g s, is inside %s",
                     c->position[0], c->position[1], c->position[2], c->time,
                     is_source(t)
                         ? "the field"
                         : (snprintf(what, sizeof what, "part \"%s\"", t->part->name), what));
        }
    }
    return true;
}

static bool try_parts(trial *t) {
    const masu_sdfc_result *s = t->scene;
    uint32_t forms = 0, alike;
    for (uint32_t i = 0; i < s->part_count; i++)
        forms += s->parts[i].user && is_first(s, i, &alike);
    t->least_portion = 1;
    for (uint32_t i = 0; i < s->part_count; i++) {
        if (!s->parts[i].user || !is_first(s, i, &alike)) continue;
        set_part(t, i);
        if (!set_portion(t, forms)) return false;
        for (uint32_t k = i, n = 0; k < s->part_count; k++)
            if (s->parts[k].shape == s->parts[i].shape && !try_part(t, k, n++, alike)) return false;
    }
    if (!try_cameras(t)) return false;
    if (t->least_portion < 1 && !t->text[0]) {
        snprintf(t->text, sizeof t->text,
                 "W%u forms of parts with glsl share a limit of %.0e instructions: some were "
                 "tested at %.2g %% of "
                 "the points",
                 forms, WORK_MAX, 100 * t->least_portion);
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
        t->decisions = masu_bake_machine_decisions(t->machine, &t->site_count);
        t->sites = masu_bake_allocate(t->site_count * sizeof *t->sites);
        memset(t->sites, 0, t->site_count * sizeof *t->sites);
        for (uint32_t i = 0; t->slots && i < t->scene->slot_count; i++)
            t->slots[i].f = (double)t->scene->slots[i];
        if (try_parts(t) && t->measures && t->jumps_by > 0)
            snprintf(t->text, sizeof t->text,
                     "Ethe field jumps by %.3g at (%.6g, %.6g, %.6g): \"lipschitz\": \"auto\" "
                     "needs a continuous field",
                     t->jumps_by, t->jump[0], t->jump[1], t->jump[2]);
        else if (t->measures && !t->text[0])
            snprintf(t->text, sizeof t->text, "S%.17g", t->steepest);
        free(t->sites);
        masu_bake_machine_free(t->machine);
    }
    masu_bake_send(fd, t->text, strlen(t->text));
}

bool masu_bake_try_needed(const masu_sdfc_result *scene) {
    for (uint32_t i = 0; i < scene->part_count; i++)
        if (scene->parts[i].user) return true;
    return false;
}

#define MEMBER_TIME 1 /* of Input */
#define MEMBER_PARAMS 3

masu_bake_reads masu_bake_try_reads(const uint32_t *words, size_t count) {
    enum { DECORATE = 71, BINDING = 33, CONSTANT = 43, ACCESS_CHAIN = 65, IN_BOUNDS = 66 };
    masu_bake_reads reads = {false, false};
    uint32_t bound = count > 5 ? words[3] : 0, input = 0;
    uint32_t *values = masu_bake_allocate(((size_t)bound + 1) * sizeof *values);
    memset(values, 0, ((size_t)bound + 1) * sizeof *values);
    for (size_t at = 5; at < count && words[at] >> 16; at += words[at] >> 16) {
        const uint32_t *w = &words[at];
        uint32_t length = w[0] >> 16, op = w[0] & 0xFFFFu;
        if (at + length > count) break;
        if (op == DECORATE && length == 4 && w[2] == BINDING && w[3] == BIND_INPUT) input = w[1];
        if (op == CONSTANT && length == 4 && w[2] < bound) values[w[2]] = w[3];
        if ((op != ACCESS_CHAIN && op != IN_BOUNDS) || length < 5 || w[3] != input) continue;
        uint32_t member = w[4] < bound ? values[w[4]] : 0;
        reads.time = reads.time || member == MEMBER_TIME;
        reads.params = reads.params || member == MEMBER_PARAMS;
    }
    free(values);
    return reads;
}

bool masu_bake_try(const masu_sdfc_result *scene, const uint32_t *words, size_t count,
                   const masu_sdfc_options *cameras, const char *path, double *steepest) {
    static trial t;
    masu_bake_buffer said = {0};
    memset(&t, 0, sizeof t);
    t.scene = scene;
    t.cameras = cameras;
    t.words = words;
    t.count = count;
    t.measures = steepest != NULL;
    t.random = 0x6D617375;
    masu_bake_result result = masu_bake_fork(body, &t, SECONDS, &said);
    masu_bake_append(&said, "", 1);
    const char *text = (const char *)said.data;
    bool ended = result.end == MASU_BAKE_EXITED && result.code == 0,
         measured = ended && text[0] == 'S';
    if (!ended) masu_cli_warn("%s: its glsl was not tested, since the test did not finish", path);
    if (ended && text[0] == 'W') masu_cli_warn("%s: %s", path, text + 1);
    if (ended && text[0] == 'E') masu_cli_error("%s: %s", path, text + 1);
    if (measured) *steepest = strtod(text + 1, NULL);
    if (steepest && !measured && !(ended && text[0] == 'E'))
        masu_cli_error(
            "%s: \"lipschitz\": \"auto\" needs a field that runs on the CPU: state a number", path);
    bool good = !(ended && text[0] == 'E') && (!steepest || measured);
    masu_bake_release(&said);
    return good;
}
