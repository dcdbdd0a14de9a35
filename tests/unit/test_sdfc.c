/* test_sdfc.c: the SDF compiler. features.sdf has a part for each feature of the language: its GLSL
 * must compile, its C must give the numbers of the formulas below, which are written independently,
 * and both must keep the Lipschitz constants and bounds of the table. Mistakes in the text have
 * exact messages; mistakes in the analysis, planted here, are found by the compiler's own check. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <dlfcn.h>
#include <glob.h>
#include <math.h>
#include <unistd.h>

#include "sdfc/sdfc.h"
#include "sdfc/internal.h"
#include "support/field.h"
#include "support/files.h"
#include "support/random.h"

#define FEATURES "tests/unit/features.sdf"
#define POINTS 2000
#define PI 3.14159265358979323846

/* ---- compiling and loading ---- */

typedef struct scene {
    masu_sdfc_result result;
    void *library;
    double (*distance)(const double *, double, const double *);
    double (*step)(const double *, double, const double *);
    double (*part_distance)(const double *, double, const double *, int);
    int (*part)(const double *, double, const double *);
    void (*material)(int, double *);
} scene;

static scene features;

static void assert_compiles(const char *text, size_t bytes, masu_sdfc_result *result) {
    char error[2048];
    if (!masu_sdfc_compile(text, bytes, "x.sdf", result, error, sizeof error))
        fail_msg("%s", error);
}

static void *symbol(void *library, const char *name) {
    void *found = dlsym(library, name);
    assert_non_null(found);
    return found;
}

/* dlsym's object pointer becomes a function pointer, which ISO C has no cast for. */
#define LOAD(s, member, name)                                                                      \
    do {                                                                                           \
        void *found = symbol((s)->library, name);                                                  \
        memcpy(&(s)->member, &found, sizeof found);                                                \
    } while (0)

static int load_features(void **state) {
    size_t bytes;
    if (make_scratch(state)) return 1;
    char *text = read_file(FEATURES, &bytes);
    assert_compiles(text, bytes, &features.result);
    free(text);
    write_text("truth.c", features.result.c);
    assert_int_equal(
        shell(
            "%s -std=c11 -Wall -Wextra -Werror -Wno-unused-function -O1 -shared -fPIC %s -o %s -lm",
            c_compiler(), in_scratch("truth.c"), in_scratch("truth.so")),
        0);
    features.library = dlopen(in_scratch("truth.so"), RTLD_NOW);
    assert_non_null(features.library);
    LOAD(&features, distance, "masu_truth_distance");
    LOAD(&features, step, "masu_truth_step");
    LOAD(&features, part_distance, "masu_truth_part_distance");
    LOAD(&features, part, "masu_truth_part");
    LOAD(&features, material, "masu_truth_material");
    return 0;
}

static int unload_features(void **state) {
    (void)state;
    masu_sdfc_release(&features.result);
    if (features.library) dlclose(features.library);
    return remove_scratch(state);
}

static int part_named(const char *name) {
    for (uint32_t i = 0; i < features.result.part_count; i++) {
        if (!strcmp(features.result.parts[i].name, name)) return (int)i;
    }
    fail_msg("no part %s", name);
    return -1;
}

/* ---- independent formulas ------ */

#define R 0.5 /* the parameters' defaults */

static double len(double x, double y, double z) { return sqrt(x * x + y * y + z * z); }

static double ref_box(double x, double y, double z, double a, double b, double c) {
    double u = fabs(x) - a, v = fabs(y) - b, w = fabs(z) - c;
    double inside = fmin(fmax(u, fmax(v, w)), 0);
    return len(fmax(u, 0), fmax(v, 0), fmax(w, 0)) + inside;
}

static double f_sphere(double x, double y, double z) { return len(x, y - 1, z) - R; }
static double f_moving(double x, double y, double z) { return len(x - 3, y - R, z) - 0.5; }
static double f_box(double x, double y, double z) { return ref_box(x, y, z, 1, 2, 3); }
static double f_rounded(double x, double y, double z) {
    return ref_box(x, y, z, 0.8, 1.8, 2.8) - 0.2;
}
static double f_torus(double x, double y, double z) { return hypot(hypot(x, z) - 2, y) - 0.3; }
static double f_capsule(double x, double y, double z) {
    double t = fmax(0, fmin(1, (x + 2 * y + 3 * z) / 14));
    return len(x - t, y - 2 * t, z - 3 * t) - 0.25;
}
static double f_cylinder(double x, double y, double z) {
    double a = hypot(x, z) - 0.5, b = fabs(y) - 1;
    return a > 0 && b > 0 ? hypot(a, b) : fmax(a, b);
}
/* by a search over the profile's outline (2 h high, radii 0.8 and 0.2) */
static double f_cone(double x, double y, double z) {
    static const double outline[4][2] = {{0, -1}, {0.8, -1}, {0.2, 1}, {0, 1}};
    double r = hypot(x, z), best = 1e30;
    for (int i = 0; i < 3; i++) {
        double dx = outline[i + 1][0] - outline[i][0], dy = outline[i + 1][1] - outline[i][1];
        double t = ((r - outline[i][0]) * dx + (y - outline[i][1]) * dy) / (dx * dx + dy * dy);
        t = fmax(0, fmin(1, t));
        best = fmin(best, hypot(r - outline[i][0] - t * dx, y - outline[i][1] - t * dy));
    }
    bool inside = fabs(y) < 1 && r < 0.8 - 0.3 * (y + 1);
    return inside ? -best : best;
}
static double f_plane(double x, double y, double z) { return (void)x, (void)z, y + 1; }
static double f_ellipsoid(double x, double y, double z) { return (len(x, y / 2, z * 2) - 1) * 0.5; }
static double f_frame(double x, double y, double z) {
    double best = 1e30;
    for (int axis = 0; axis < 3; axis++) { /* four bars along each axis */
        for (int i = 0; i < 4; i++) {
            double a = i & 1 ? 0.9 : -0.9, b = i & 2 ? 0.9 : -0.9;
            double d = axis == 0   ? ref_box(x, y - a, z - b, 1, 0.1, 0.1)
                       : axis == 1 ? ref_box(x - a, y, z - b, 0.1, 1, 0.1)
                                   : ref_box(x - a, y - b, z, 0.1, 0.1, 1);
            best = fmin(best, d);
        }
    }
    return best;
}
static double f_link(double x, double y, double z) {
    double v = y > 0.5 ? y - 0.5 : y < -0.5 ? y + 0.5 : 0;
    return hypot(hypot(x, v) - 0.4, z) - 0.1;
}
static double f_union(double x, double y, double z) {
    return fmin(len(x, y, z) - 1, len(x - 2, y, z) - 0.5);
}
static double ref_smooth(double a, double b, double k) {
    double h = fmax(0, 1 - fabs(a - b) / k);
    return fmin(a, b) - k * h * h / 4;
}
static double f_smooth_union(double x, double y, double z) {
    double d = ref_smooth(len(x, y, z) - 1, ref_box(x - 1, y, z, 0.5, 0.5, 0.5), 0.3);
    return ref_smooth(d, hypot(hypot(x, z) - 2, y) - 0.1, 0.3);
}
static double f_smooth_difference(double x, double y, double z) {
    return -ref_smooth(-ref_box(x, y, z, 1, 1, 1), len(x, y, z) - 1.2, 0.1);
}
static double f_smooth_intersection(double x, double y, double z) {
    return -ref_smooth(-ref_box(x, y, z, 1, 1, 1), 1.2 - len(x, y, z), 0.1);
}
static double f_difference(double x, double y, double z) {
    return fmax(ref_box(x, y, z, 1, 1, 1), 1.2 - len(x, y, z));
}
static double f_intersection(double x, double y, double z) {
    return fmax(fmax(ref_box(x, y, z, 1, 1, 1), len(x, y, z) - 1.2), ref_box(x, y, z, 2, 0.5, 0.7));
}
/* counterclockwise from above: +z rotates towards +x */
static double f_rotate(double x, double y, double z) {
    double c = cos(PI / 6), s = sin(PI / 6);
    return ref_box(c * x - s * z, y, s * x + c * z, 1, 2, 3);
}
/* x by 90 degrees takes (1,2,3) to (1,3,2), z by 90 degrees that to (3,1,2) */
static double f_euler(double x, double y, double z) { return ref_box(x, y, z, 3, 1, 2); }
static double f_scale(double x, double y, double z) { return ref_box(x, y, z, 2, 2, 2); }
static double f_mirror(double x, double y, double z) {
    return fmin(len(x - 1, y - 1, z - 1), len(x + 1, y - 1, z - 1)) - 0.5;
}
static double f_repeat(double x, double y, double z) {
    double best = 1e30;
    for (int i = -6; i <= 6; i++) {
        for (int k = -6; k <= 6; k++) best = fmin(best, len(x - 4 * i, y, z - 4 * k) - 1);
    }
    return best;
}
static double f_repeat_aside(double x, double y, double z) {
    double best = 1e30;
    for (int i = -6; i <= 6; i++) {
        for (int k = -6; k <= 6; k++) {
            best = fmin(best, ref_box(x - 4 * i - 0.5, y, z - 4 * k - 0.3, 1, 3, 1));
        }
    }
    return best;
}
static double f_row(double x, double y, double z) {
    double best = 1e30;
    for (int i = -2; i <= 2; i++) {
        for (int k = 0; k < 4; k++) {
            best = fmin(best, ref_box(x - 4 * i - 0.5, y, z - 4 * k + 6 - 0.3, 1, 3, 1));
        }
    }
    return best;
}
static double f_polar(double x, double y, double z) {
    double best = 1e30;
    for (int i = 0; i < 7; i++) {
        double a = 2 * PI * i / 7;
        best = fmin(best, len(x - 3 * cos(a), y, z - 3 * sin(a)) - 0.5);
    }
    return best;
}
static double f_polar_two(double x, double y, double z) {
    return fmin(ref_box(x - 3, y, z - 0.2, 0.5, 0.4, 0.6),
                ref_box(-x - 3, y, -z - 0.2, 0.5, 0.4, 0.6));
}
static double f_twist(double x, double y, double z) {
    double c = cos(2 * y), s = sin(2 * y);
    return ref_box(c * x + s * z, y, c * z - s * x, 0.5, 2, 0.5);
}
/* along an arc about (0, 2) */
static double f_bend(double x, double y, double z) {
    return ref_box(2 * atan2(x, 2 - y), 2 - hypot(x, 2 - y), z, 2, 0.2, 0.5);
}
static double f_elongate(double x, double y, double z) {
    double w = z > 1 ? z - 1 : z < -1 ? z + 1 : 0;
    return hypot(hypot(x, w) - 1, y) - 0.2;
}
static double f_onion(double x, double y, double z) { return fabs(len(x, y, z) - 1) - 0.05; }
static double f_round(double x, double y, double z) { return ref_box(x, y, z, 1, 1, 1) - 0.1; }
static double f_displace(double x, double y, double z) {
    return len(x, y, z) - 1 + 0.1 * sin(5 * x) * sin(6 * y) * sin(7 * z);
}
static double f_morph(double x, double y, double z) {
    return 0.5 * (len(x, y, z) - 1) + 0.5 * ref_box(x, y, z, 1, 1, 1);
}
/* solid where no base-3 digit is 1 in two coordinates at once, to three levels */
static double f_menger(double x, double y, double z) {
    double p[3] = {x, y, z};
    if (fabs(x) > 1 || fabs(y) > 1 || fabs(z) > 1) return 1;
    for (int level = 0; level < 3; level++) {
        int middles = 0;
        for (int i = 0; i < 3; i++) {
            double u = (p[i] + 1) / 2 * 3;
            double digit = fmin(floor(u), 2);
            middles += digit == 1;
            p[i] = (u - digit) * 2 - 1;
        }
        if (middles >= 2) return 1;
    }
    return -1;
}
static double f_mixed(double x, double y, double z) {
    double c = cos(5 * y), s = sin(5 * y), u = x - 3;
    return fmin(len(x, y, z) - 1, ref_box(c * u + s * z, y, c * z - s * u, 0.4, 0.4, 0.4));
}

typedef enum how {
    EQUAL, /* the same number */
    NEAR,  /* the same up to 0.5; beyond that at most as large, and still at least 0.5 */
    SIGN   /* solid at the same points */
} how;

static const struct {
    const char *part;
    double (*f)(double, double, double);
    how how;
} formulas[] = {{"sphere", f_sphere, EQUAL},
                {"moving", f_moving, EQUAL},
                {"box", f_box, EQUAL},
                {"rounded_box", f_rounded, EQUAL},
                {"torus", f_torus, EQUAL},
                {"capsule", f_capsule, EQUAL},
                {"cylinder", f_cylinder, EQUAL},
                {"cone", f_cone, EQUAL},
                {"plane", f_plane, EQUAL},
                {"ellipsoid", f_ellipsoid, EQUAL},
                {"box_frame", f_frame, SIGN},
                {"link", f_link, EQUAL},
                {"union", f_union, EQUAL},
                {"smooth_union", f_smooth_union, EQUAL},
                {"smooth_difference", f_smooth_difference, EQUAL},
                {"smooth_intersection", f_smooth_intersection, EQUAL},
                {"difference", f_difference, EQUAL},
                {"intersection", f_intersection, EQUAL},
                {"rotate", f_rotate, EQUAL},
                {"euler", f_euler, EQUAL},
                {"scale", f_scale, EQUAL},
                {"mirror", f_mirror, EQUAL},
                {"repeat", f_repeat, EQUAL},
                {"repeat_aside", f_repeat_aside, NEAR},
                {"row", f_row, NEAR},
                {"polar", f_polar, EQUAL},
                {"polar_two", f_polar_two, EQUAL},
                {"twist", f_twist, SIGN},
                {"bend", f_bend, SIGN},
                {"elongate", f_elongate, EQUAL},
                {"onion", f_onion, EQUAL},
                {"round", f_round, EQUAL},
                {"displace", f_displace, EQUAL},
                {"morph", f_morph, EQUAL},
                {"menger", f_menger, SIGN},
                {"mixed", f_mixed, SIGN}};

static void near_part(uint64_t *seed, int part, double p[3]) {
    const masu_sdfc_part *at = &features.result.parts[part];
    if (!(at->radius >= 0)) return;
    for (int k = 0; k < 3; k++) p[k] = at->center[k] + random_between(seed, -1, 1) * at->radius;
}

static void values_are_those_of_the_formulas(void **state) {
    (void)state;
    const double params[2] = {0.5, 0.5};
    for (size_t i = 0; i < sizeof formulas / sizeof formulas[0]; i++) {
        uint64_t seed = 1; /* the same for all parts, so that a new row does not change the points
                              of the others */
        int part = part_named(formulas[i].part), solid = 0;
        for (int n = 0; n < POINTS; n++) {
            double reach = n % 2 ? 2 : 12, p[3];
            for (int k = 0; k < 3; k++) p[k] = random_between(&seed, -reach, reach);
            if (n % 4 == 1) near_part(&seed, part, p);
            double f = features.part_distance(params, 0, p, part);
            double g = formulas[i].f(p[0], p[1], p[2]);
            bool good = false;
            switch (formulas[i].how) {
            case EQUAL: good = fabs(f - g) < 1e-9; break;
            case NEAR: good = g < 0.5 ? fabs(f - g) < 1e-9 : f <= g + 1e-9 && f >= 0.5; break;
            case SIGN: good = (f < 0) == (g < 0) || fabs(f) < 1e-9; break;
            }
            solid += f < 0;
            if (!good) {
                fail_msg("%s at (%.17g, %.17g, %.17g): %.17g, by formula %.17g", formulas[i].part,
                         p[0], p[1], p[2], f, g);
            }
        }
        if (solid == 0) fail_msg("%s: no point within", formulas[i].part);
    }
}

/* ---- guarantees that the march relies on, checked on the generated C ---- */

static double apart(const double p[3], const double q[3]) {
    return len(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
}

static void constants_and_bounds_hold_for_the_C(void **state) {
    (void)state;
    uint64_t seed = 5;
    for (uint32_t i = 0; i < features.result.part_count; i++) {
        const masu_sdfc_part *part = &features.result.parts[i];
        bool estimate = !strcmp(part->name, "mandelbulb");
        for (int n = 0; n < POINTS; n++) {
            double p[3], q[3],
                params[2] = {random_between(&seed, 0.2, 1), random_between(&seed, -1, 1)};
            double time = random_between(&seed, 0, 10),
                   by = pow(10, random_between(&seed, -5, 0.5));
            for (int k = 0; k < 3; k++) p[k] = random_between(&seed, -6, 6);
            for (int k = 0; k < 3; k++) q[k] = p[k] + by * random_between(&seed, -1, 1);
            double f = features.part_distance(params, time, p, (int)i);
            double g = features.part_distance(params, time, q, (int)i);
            double most = part->lipschitz * apart(p, q) * (1 + 1e-9) + 1e-9;
            if (!estimate && !(fabs(f - g) <= most)) {
                fail_msg("%s: %.17g and %.17g are %.9g apart, more than %.9g", part->name, f, g,
                         fabs(f - g), most);
            }
            bool outside = part->radius >= 0 && apart(p, part->center) > part->radius + 1e-9;
            for (int k = 0; k < 3; k++) {
                outside = outside || p[k] < part->low[k] - 1e-9 || p[k] > part->high[k] + 1e-9;
            }
            if (outside && !(f > 0)) fail_msg("%s: solid outside of its bounds", part->name);
        }
    }
}

static void the_scene_is_the_union_of_its_parts(void **state) {
    (void)state;
    uint64_t seed = 9;
    const double params[2] = {0.7, -0.3};
    for (int n = 0; n < 200; n++) {
        double p[3], least = SDFC_INFINITY, step = SDFC_INFINITY, out[8];
        int nearest = -1;
        for (int k = 0; k < 3; k++) p[k] = random_between(&seed, -8, 8);
        for (uint32_t i = 0; i < features.result.part_count; i++) {
            double f = features.part_distance(params, 2, p, (int)i);
            least = fmin(least, f);
            if (f / features.result.parts[i].lipschitz < step) {
                step = f / features.result.parts[i].lipschitz;
                nearest = (int)i;
            }
        }
        assert_true(features.distance(params, 2, p) == least);
        assert_true(features.step(params, 2, p) == step);
        assert_int_equal(features.part(params, 2, p), nearest);
        features.material(part_named("box"), out);
        assert_true(out[0] == 0.4 && out[3] == 0.7 && out[7] == 0);
    }
}

/* ---- GLSL ---- */

static void assert_glsl_compiles(const masu_sdfc_result *result) {
    static const char *const options[] = {"", "-DMASU_SDF_ASCENDING"};
    if (!whole_run()) return; /* the sanitizers do not cover that compiler */
    write_text("sdf_scene.glsl", result->glsl);
    for (int i = 0; i < 2; i++) {
        int code = shell("glslangValidator --quiet -V %s --target-env vulkan1.1 -Ishaders -I%s "
                       "-o %s/x.spv tests/unit/sdfc_wrap.comp && "
                       "spirv-val --target-env vulkan1.1 %s/x.spv",
                       options[i], scratch, scratch, scratch);
        assert_int_equal(code, 0);
    }
}

static void glsl_of_all_features_compiles(void **state) {
    (void)state;
    assert_glsl_compiles(&features.result);
}

static int count(const char *text, const char *what) {
    int n = 0;
    for (const char *at = text; (at = strstr(at, what)); at++) n++;
    return n;
}

static void one_sphere_has_the_code_of_one_sphere(void **state) {
    (void)state;
    static const char text[] = "shape unused = menger(4);\npart a = sphere(1.5);\n";
    masu_sdfc_result result;
    assert_compiles(text, sizeof text - 1, &result);
    assert_glsl_compiles(&result);
    assert_int_equal(count(result.glsl, "masu_h_sphere("), 2);
    assert_int_equal(count(result.glsl, "masu_h_"), 2);
    assert_int_equal(count(result.glsl, "switch"), 0);
    assert_int_equal(count(result.glsl, "for ("), 0);
    assert_int_equal(count(result.glsl, "masu_part_at("), 0);
    assert_int_equal(count(result.glsl, "(x, y, z, 1.5)"), 1); /* a literal, no slot */
    assert_int_equal(count(result.glsl, "high = vec3(1.5, 1.5, 1.5)"), 1);
    assert_int_equal(result.slot_count, MASU_SDFC_PART_SLOTS + MASU_SDFC_MATERIAL_SLOTS);
    assert_false(result.dynamic);
    masu_sdfc_release(&result);
}

/* A scene's GLSL calls each library function that it defines. */
static void no_scene_has_a_function_that_it_does_not_call(void **state) {
    (void)state;
    uint32_t functions = 0;
    glob_t scenes;
    assert_int_equal(glob("scenes/*.sdf", 0, NULL, &scenes), 0);
    for (size_t i = 0; i < scenes.gl_pathc; i++) {
        static char text[1 << 16];
        masu_sdfc_result result;
        FILE *f = fopen(scenes.gl_pathv[i], "rb");
        assert_non_null(f);
        size_t bytes = fread(text, 1, sizeof text, f);
        fclose(f);
        assert_compiles(text, bytes, &result);
        for (const char *at = result.glsl; (at = strstr(at, "\nreal masu_h_"));) {
            char call[128];
            at += strlen("\nreal ");
            snprintf(call, sizeof call, "%.*s(", (int)strcspn(at, "("), at);
            if (count(result.glsl, call) < 2) fail_msg("%s: %s", scenes.gl_pathv[i], call);
            functions++;
        }
        masu_sdfc_release(&result);
    }
    globfree(&scenes);
    assert_true(functions > 20);
}

static void parts_of_one_form_share_its_code(void **state) {
    (void)state;
    static const char text[] =
        "param r = 1 [0, 2];\n"
        "for i in 0..100 { part a = translate((i, 0, 0), sphere(0.4)); }\n"
        "for i in 0..50 { part b = translate((0, i, 0), box((0.2, hash(i), r))); }\n";
    masu_sdfc_result result;
    assert_compiles(text, sizeof text - 1, &result);
    assert_glsl_compiles(&result);
    assert_int_equal(result.part_count, 150);
    assert_int_equal(result.shape_count, 2);
    assert_int_equal(count(result.glsl, "real masu_shape_"), 2);
    assert_true(result.dynamic && result.timeless);
    assert_string_equal(result.parts[7].name, "a_7");
    /* x of a; y, hash and r of b: everything else is shared */
    uint32_t head = 150 * MASU_SDFC_PART_SLOTS + MASU_SDFC_MATERIAL_SLOTS;
    assert_int_equal(result.slot_count, head + 100 + 3 * 50);
    const float *record = result.slots + 7 * MASU_SDFC_PART_SLOTS;
    assert_true(record[0] == 7 && record[3] > 0.4f && record[3] < 0.4001f && record[4] == 1);
    assert_true(record[5] == 0 && record[6] == (float)(head + 7) && record[7] == 0);
    assert_true(result.slots[head + 7] == 7);
    assert_int_equal(count(result.glsl, "masu_slot_write("), 50);
    masu_sdfc_release(&result);
    static const char own[] =
        "for i in 0..4 { part a = translate((i, 0, 0), glsl { return length(p) - 0.4; } "
        "bounds (-1, -1, -1), (1, 1, 1) lipschitz 1); }\n"
        "part b = glsl { return length(p) - 0.5; } bounds (-1, -1, -1), (1, 1, 1) "
        "lipschitz 1;\n";
    assert_compiles(own, sizeof own - 1, &result);
    assert_int_equal(result.part_count, 5);
    assert_int_equal(result.shape_count, 2);
    masu_sdfc_release(&result);
}

/* Slots depend on the anchor if it was asked for, and if a part has a place. */
static void what_depends_on_the_anchor_is_told(void **state) {
    (void)state;
    static const char text[] = "part a = translate((1, 2, 3), sphere(0.5));\n";
    for (int asked = 0; asked < 2; asked++) {
        masu_sdfc_options options = {.anchored = asked, .pairs = UINT32_MAX};
        masu_sdfc_result result;
        char error[2048];
        if (!masu_sdfc_compile_with(text, sizeof text - 1, "x.sdf", &options, &result, error,
                                    sizeof error))
            fail_msg("%s", error);
        assert_int_equal(result.anchored, asked);
        masu_sdfc_release(&result);
    }
}

/* Bits for the parts and their terms that a block can skip: only if the test pays off, if the part
 * is continuous in a ball, and not in a scene of many parts, which have entries in lists
 * instead. */
static void blocks_have_bits_for_what_can_be_left_out(void **state) {
    (void)state;
    static const struct {
        const char *text;
        uint32_t words;
        int terms; /* conditions on bits in the code */
    } cases[] = {
        {"part a = sphere(1);", 0, 0},
        {"part a = sphere(1);\npart b = plane((0, 1, 0), 0);", 0, 0},
        {"part a = sphere(1);\npart b = box((1, 2, 3));", 1, 0},
        {"part a = union(sphere(1), box((1, 2, 3)));", 1, 2},
        {"part a = smooth_union(0.2, sphere(1), union(torus(2, 0.1), cylinder(1, 1)));", 1, 4},
        {"part a = difference(sphere(1), torus(1, 0.2), box((1, 2, 3)));", 1, 3},
        {"part a = blend(0.2, sphere(1), torus(2, 0.1), cylinder(1, 1), box((1, 2, 3)));", 1, 3},
        {"part a = chamfer(0.2, sphere(1), stairs(0.1, 3, torus(2, 0.1), cylinder(1, 1)));", 1, 4},
        {"part a = xor(sphere(1), torus(2, 0.1));", 0, 0},
        {"for i in 0..8 { part a = translate((i, 0, 0), union(sphere(1), box((1, 2, 3)))); }", 1,
         2},
        /* more than 32 bits for all: none */
        {"for i in 0..20 { part a = translate((i, 0, 0), union(sphere(1), box((1, 2, 3)))); }", 1,
         0},
        /* the neighbour cell is evaluated too */
        {"part a = repeat((9, 0, 0), union(translate((2, 0, 0), sphere(1)), translate((-2, 0, 0), "
         "sphere(1))));",
         1, 2},
        {"part a = repeat((9, 0, 9), union(sphere(1), box((1, 2, 3))));", 1, 2},
        {"part a = repeat((2, 0, 3), union(translate((2, 0, 1), sphere(1)), translate((0.5, 0, 0), "
         "box((1, 2, 3)))));",
         1, 2},
        {"part a = repeat_limited((2, 0, 3), (5, 1, 9), union(translate((2, 0, 1), sphere(1)), "
         "box((1, 2, 3))));",
         1, 2},
        {"part a = repeat((2, 0, 0), torus(1.4, 0.1)); part b = polar(5, box((3, 1, 0.1)));", 1, 0},
        /* a cut skipped in one cell would bring it closer than the cells that are not evaluated */
        {"part a = repeat((4, 0, 4), intersection(box((1.9, 1.9, 1.9)),"
         " translate((0, 0.2, 0), plane((-0.5, 0.7071, 0.5), 0))));",
         0, 0},
        {"part a = polar(5, translate((9, 0, 0), union(sphere(1), box((1, 2, 3)))));", 0, 0},
        {"part a = twist(0.5, union(sphere(1), box((1, 2, 3))));", 0, 0},
        {"for i in 0..65 { part a = translate((i, 0, 0), union(sphere(1), box((1, 2, 3)))); }", 2,
         0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        masu_sdfc_result result;
        assert_compiles(cases[i].text, strlen(cases[i].text), &result);
        assert_glsl_compiles(&result);
        if (result.block_words != cases[i].words ||
            count(result.glsl, "if ((on &") != cases[i].terms) {
            fail_msg("%s: %u words, %d terms", cases[i].text, result.block_words,
                     count(result.glsl, "if ((on &"));
        }
        masu_sdfc_release(&result);
    }
}

/* The slots that the function masu_sdf_box reads, or its literals, for low or high. */
static void box_sides(const masu_sdfc_result *result, const char *name, double out[3]) {
    const char *at = strstr(result->glsl, "void masu_sdf_box(");
    assert_non_null(at);
    at = strstr(at, name);
    assert_non_null(at);
    at = strchr(at, '(') + 1;
    for (int i = 0; i < 3; i++) {
        unsigned slot;
        at += strspn(at, " (,)u");
        if (sscanf(at, "masu_slot(%u", &slot) == 1) {
            assert_true(slot < result->slot_count);
            out[i] = (double)result->slots[slot];
            at += strlen("masu_slot(");
        } else {
            assert_int_equal(sscanf(at, "%lf", &out[i]), 1);
        }
        at += strspn(at, "-+.e0123456789");
    }
}

static void the_box_of_the_parts_follows_the_parameters(void **state) {
    (void)state;
    for (double r = 0.25; r < 1.4; r += 0.25) {
        char text[512];
        double low[3], high[3];
        masu_sdfc_result result;
        int length = snprintf(text, sizeof text,
                              "param r = %.17g [0.2, 1.4];\n"
                              "part a = translate((0, r, -r), repeat((4, 0, 0), sphere(r)));\n"
                              "part b = translate((0, 1, 0), box((1, 0.5, 3)));\n"
                              "part c = plane((0, 1, 0), 0);\n",
                              r);
        assert_compiles(text, (size_t)length, &result);
        assert_glsl_compiles(&result);
        box_sides(&result, "low = ", low);
        box_sides(&result, "high = ", high);
        assert_true(low[0] <= -1e30 && high[0] >= 1e30);
        const double true_low[] = {0, -fmax(2 * r, 3)}, true_high[] = {fmax(2 * r, 1.5), 3};
        for (int i = 0; i < 2; i++) {
            assert_true(low[i + 1] <= true_low[i] && low[i + 1] > true_low[i] - 1e-5);
            assert_true(high[i + 1] >= true_high[i] && high[i + 1] < true_high[i] + 1e-5);
        }
        masu_sdfc_release(&result);
    }
}

/* Inputs of sdf_velocity: changing parts, by number and as bits, and changing half-spaces. */
static void parts_that_move_are_told_from_those_that_rest(void **state) {
    (void)state;
    static const struct {
        const char *text;
        int some, flat;
    } cases[] = {{"part a = sphere(1); part b = translate((3, 0, 0), box((1, 1, 1))); part c = "
                  "plane((0, 1, 0), 2);",
                  0, 0},
                 {"part a = sphere(1); part b = translate((sin(time), 0, 0), sphere(1)); part c = "
                  "box((1, 1, 1));"
                  "part d = plane((0, 1, 0), 2);",
                  1, 0},
                 {"param r = 1 [0.5, 2]; part a = sphere(1); part b = torus(r, 0.1); part c = "
                  "rotate((0, 1, 0), time, "
                  "box((1, 1, 1))); part e = union(sphere(1), translate((r, 0, 0), sphere(0.1)));",
                  1, 0},
                 {"part a = sphere(1); part b = plane((0, 1, 0), 0.1 * time);", 1, 1},
                 {"part a = sphere(1); part b = glsl { return length(p) - 1.0 - 0.1 * masu_time(); "
                  "} bounds (-2, -2, -2), (2, 2, 2) lipschitz 1;",
                  1, 0}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        masu_sdfc_result result;
        char wanted[64];
        uint32_t bits = 0;
        assert_compiles(cases[k].text, strlen(cases[k].text), &result);
        snprintf(wanted, sizeof wanted,
                 "#define MASU_SDF_MOVING %d\n#define MASU_SDF_MOVING_FLAT %d\n", cases[k].some,
                 cases[k].flat);
        if (count(result.glsl, wanted) != 1) fail_msg("%s: not %s", cases[k].text, wanted);
        const char *body = strstr(result.glsl, "bool masu_sdf_part_moves(uint part)");
        char asked[512];
        snprintf(asked, sizeof asked, "%.*s", (int)(strchr(body, '}') - body), body);
        for (uint32_t i = 0; i < result.part_count; i++) {
            /* In a run of several, the first and the last are named. */
            int moves = result.parts[i].dynamic || result.parts[i].user;
            snprintf(wanted, sizeof wanted, " %uu ", i);
            int alone = (i == 0 || !(result.parts[i - 1].dynamic || result.parts[i - 1].user)) &&
                        (i + 1 == result.part_count ||
                         !(result.parts[i + 1].dynamic || result.parts[i + 1].user));
            if (!moves) assert_null(strstr(asked, wanted));
            if (moves && alone) {
                snprintf(wanted, sizeof wanted, "part == %uu ", i);
                assert_non_null(strstr(asked, wanted));
            }
            bits |= (uint32_t)moves << i;
        }
        assert_int_equal(bits != 0, cases[k].some);
        assert_int_equal(result.timeless, k == 0 || k == 4); /* GLSL may use it */
        snprintf(wanted, sizeof wanted, "return word == 0 ? 0x%xu : 0x0u;", bits);
        if (count(result.glsl, wanted) != 1) fail_msg("%s: not %s", cases[k].text, wanted);
        masu_sdfc_release(&result);
    }
}

static void the_same_text_gives_the_same_result(void **state) {
    (void)state;
    size_t bytes;
    char *text = read_file(FEATURES, &bytes);
    masu_sdfc_result again;
    assert_compiles(text, bytes, &again);
    assert_string_equal(again.glsl, features.result.glsl);
    assert_string_equal(again.c, features.result.c);
    assert_string_equal(again.table, features.result.table);
    masu_sdfc_release(&again);
    free(text);
}

/* ---- mistakes in the text ---- */

static void the_least_roughness_of_what_is_lit_is_known(void **state) {
    (void)state;
    static const struct {
        const char *material;
        double least;
    } cases[] = {{"roughness 0.2", 0.2},
                 {"albedo 0.3", 0.5},
                 {"roughness 1 - 0.25 * 2", 0.5},
                 {"roughness p", 0},
                 {"roughness 1 - time", 0},
                 {"roughness -3", 0},
                 {"roughness 7", 1},
                 {"roughness 0.1; emissive (0, 2, 0)", 0.1},
                 {"roughness 0.1; emissive (0, p, 1)", 0.1},
                 {"roughness 1; emissive (0, 2, 0)", 1}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[256], error[256];
        masu_sdfc_result result;
        int n = snprintf(text, sizeof text,
                         "param p = 0.9 [0, 1]; material unused { roughness 0 }"
                         "material m { %s } part a : m = sphere(1);",
                         cases[i].material);
        masu_sdfc_options options = {.pairs = UINT32_MAX};
        if (!masu_sdfc_compile_with(text, (size_t)n, "x.sdf", &options, &result, error,
                                    sizeof error))
            fail_msg("%s: %s", cases[i].material, error);
        if (fabs(result.glossiest - cases[i].least) > 1e-12)
            fail_msg("%s: %g", cases[i].material, result.glossiest);
        masu_sdfc_release(&result);
    }
}

static void mistakes_name_their_place(void **state) {
    (void)state;
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"", "x.sdf:1:1: expected a part, found the end of the text"},
        {"part a = sphere(1)", "x.sdf:1:19: expected \";\", found the end of the text\n"
                               "part a = sphere(1)\n                  ^"},
        {"let a = 1;\npart b = spher(1);",
         "x.sdf:2:10: expected a shape, found \"spher\": did you mean \"sphere\"?\n"
         "part b = spher(1);\n         ^"},
        {"part a = tarus(2, 1);", /* one letter of five; two are too many */
         "x.sdf:1:10: expected a shape, found \"tarus\": did you mean \"torus\"?\n"
         "part a = tarus(2, 1);\n         ^"},
        {"part a = taris(2, 1);", "x.sdf:1:10: expected a shape, found \"taris\""},
        {"part a = box(1, 2);", "x.sdf:1:15: expected \")\", found \",\""},
        {"part a = sphere((1, 2, 3));", "x.sdf:1:17: expected a number, found three numbers"},
        {"part a : gold = sphere(1);", "x.sdf:1:10: expected a material, found \"gold\""},
        {"param r = 3 [0, 1]; part a = sphere(r);",
         "x.sdf:1:14: expected a range that holds 3, found [0, 1]"},
        {"part a = menger(9);", "x.sdf:1:17: expected a whole number from 1 to 8, found 9"},
        {"part a = menger(time);", "x.sdf:1:17: expected a whole number known at compile time, "
                                   "found an expression of parameters or time"},
        {"let pi = 3;", "x.sdf:1:5: expected a name that is not a keyword, found \"pi\""},
        {"let a = 1; let a = 2;",
         "x.sdf:1:16: expected a name that is not declared yet, found \"a\""},
        {"let a = 1 / 0;", "x.sdf:1:13: expected a divisor, found 0"},
        {"let a = $;", "x.sdf:1:9: expected a statement, found \"$\""},
        {"let a = 1e99;", "x.sdf:1:9: expected a number of at most 1e30"},
        {"part a = repeat((2, 0, 0), translate((0.6, 0, 0), sphere(3.1)));",
         "x.sdf:1:10: repeat: the shape reaches 3.7 from the centre of its cell along x: expected "
         "at most 3.6, 1.8 times "
         "the period"},
        {"part a = repeat_limited((0, 0, 2), (1, 1, 5), torus(4, 0.1));",
         "x.sdf:1:10: repeat_limited: the shape reaches 4.1 from the centre of its cell along z: "
         "expected at most 4, 2 "
         "times the period"},
        {"part a = repeat((2, 0, 0), difference(plane((0, 1, 0), 0), sphere(0.5)));",
         "x.sdf:1:10: repeat: the shape reaches inf from the centre of its cell along x: expected "
         "at most 4"},
        {"part a = polar(20, box((3, 1, 0.1)));", "x.sdf:1:10: polar: the shape covers 180 degrees "
                                                  "on either side of +x: expected at most 144"},
        {"part a = polar(20, translate((3, 0, 0.4), box((0.2, 0.2, 1))));",
         "x.sdf:1:10: polar: the shape covers 26.57 degrees on either side of +x: expected at most "
         "14.4"},
        {"part a = twist(1, plane((0, 1, 0), 0));",
         "x.sdf:1:10: twist: expected a bounded shape and a bounded rate"},
        {"part a = bend(2, box((1.6, 0.1, 1)));",
         "x.sdf:1:10: bend: x reaches 1.6, which the rate turns by 3.2: expected at most 3.14"},
        {"part a = bend(1, box((1.6, 1, 1)));",
         "x.sdf:1:10: bend: y times the rate reaches 1: expected at most 0.99, inside the centre "
         "of the arc"},
        {"part a = rotate((0, 0, 0), 1, sphere(1));",
         "x.sdf:1:10: rotate: expected an axis that is not zero"},
        {"param k = 0.5 [0, 1]; part a = glsl { return length(p) - masu_param(1); } bounds (-1, "
         "-1, -1), (1, 1, 1) "
         "lipschitz 1;",
         "x.sdf:1:32: masu_param(1): the scene has 1 parameter, counted from 0"},
        {"param k = 0.5 [0, 1]; part a = glsl { return length(p) - masu_param(0) - masu_param ( 1 ); "
         "} bounds (-1, -1, -1), (1, 1, 1) lipschitz 1;",
         "x.sdf:1:32: masu_param(1): the scene has 1 parameter, counted from 0"},
        {"part a = glsl { return 1.0; ", "x.sdf:1:15: expected a \"}\" for this \"{\""},
        {"for i in 0..9 { part a = sphere(1);",
         "x.sdf:1:36: expected param, let, shape, def, material, "
         "part or for, found the end of the text"},
        {"for i in 0..5000 { part a = sphere(1); }", "x.sdf:1:27: more than 4096 parts"},
        {"for i in 0..60000 { for j in 0..60000 { } }", "x.sdf:1:"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        masu_sdfc_result result;
        char error[1024];
        bool good = masu_sdfc_compile(cases[i].text, strlen(cases[i].text), "x.sdf", &result, error,
                                      sizeof error);
        size_t length = strlen(cases[i].message);
        if (good || strncmp(error, cases[i].message, length) != 0) {
            fail_msg("%s\nis answered by\n%s", cases[i].text, good ? "success" : error);
        }
        assert_null(result.glsl);
        masu_sdfc_release(&result);
    }
}

/* ---- repetitions, compared with the union of their copies ---- */

typedef struct writer {
    char text[4096];
    size_t length;
    uint64_t seed;
} writer;

static void put(writer *w, const char *format, ...) {
    va_list list;
    va_start(list, format);
    int n = vsnprintf(w->text + w->length, sizeof w->text - w->length, format, list);
    va_end(list);
    assert_true(n >= 0 && (size_t)n < sizeof w->text - w->length);
    w->length += (size_t)n;
}

static int whole(writer *w, int from, int to) {
    return (int)fmin(floor(random_between(&w->seed, from, to + 1)), to);
}
static double size(writer *w, double from, double to) { return random_between(&w->seed, from, to); }

static void put_solid(writer *w, int depth) {
    double a = size(w, 0.1, 1.3), b = size(w, 0.05, 0.4), c = size(w, 0.1, 1.3);
    int form = whole(w, 0, depth > 0 ? 20 : 10);
    switch (form) {
    case 0: put(w, "sphere(%.3f)", a); return;
    case 1: put(w, "torus(%.3f, %.3f)", a, b); return;
    case 2: put(w, "box((%.3f, %.3f, %.3f))", a, b, c); return;
    case 3: put(w, "rotate((1, 0, 0), pi / 2, torus(%.3f, %.3f))", a, b); return;
    case 4: put(w, "box_frame((%.3f, %.3f, %.3f), %.3f)", a, c, a, b / 4); return;
    case 5: put(w, "capsule((0, 0, 0), (%.3f, %.3f, 0), %.3f)", a, c, b); return;
    case 6: put(w, "link(%.3f, %.3f, %.3f)", a, c, b / 2); return;
    case 7: put(w, "cone(%.3f, %.3f, %.3f)", a, c, b); return;
    case 8: put(w, "octahedron(%.3f)", a); return;
    case 9: put(w, "tri_prism(%.3f, %.3f)", a, b); return;
    case 10: put(w, "ellipsoid((%.3f, %.3f, %.3f))", a, c, b); return;
    case 11:
        put(w, "translate((%.3f, %.3f, %.3f), ", size(w, -0.6, 0.6), b, size(w, -0.6, 0.6));
        break;
    case 12: put(w, "rotate((%d, 1, 0), %.3f, ", whole(w, 0, 1), a); break;
    case 13: put(w, "mirror((1, 0, 0), "); break;
    case 14: put(w, "onion(%.3f, ", b / 3); break;
    case 15:
        put(w, "repeat_limited((%.3f, 0, %.3f), (%d, 1, %d), ", a, a + c, whole(w, 1, 4),
            whole(w, 1, 3));
        break;
    case 16: put(w, "scale((1, 2, %.3f), ", a); break;
    case 17: put(w, "union("); break;
    case 18: put(w, "difference("); break;
    case 19: put(w, "smooth_union(%.3f, ", b); break;
    default: put(w, "intersection("); break;
    }
    put_solid(w, depth - 1);
    if (form >= 17) {
        put(w, ", ");
        put_solid(w, depth - 1);
    }
    put(w, ")");
}

typedef struct rows {
    double period[3];
    int count[3]; /* 0: without end */
    int around;   /* > 0: copies around y instead */
} rows;

/* The least value of all copies of part 1 that can be close. */
static double union_of_copies(const field *r, const rows *of, const double p[3]) {
    double least = 1e30;
    for (int i = 0; i < of->around; i++) {
        double a = 2 * PI * i / of->around,
               q[3] = {p[0] * cos(a) + p[2] * sin(a), p[1], p[2] * cos(a) - p[0] * sin(a)};
        least = fmin(least, field_value(r, 1, q));
    }
    if (of->around) return least;
    int from[3] = {0, 0, 0}, to[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++) {
        if (of->period[k] == 0) continue;
        int near = (int)floor(p[k] / of->period[k]);
        from[k] = of->count[k] ? 0 : near - 2;
        to[k] = of->count[k] ? of->count[k] - 1 : near + 3;
    }
    for (int x = from[0]; x <= to[0]; x++) {
        for (int y = from[1]; y <= to[1]; y++) {
            for (int z = from[2]; z <= to[2]; z++) {
                const int cell[3] = {x, y, z};
                double q[3];
                for (int k = 0; k < 3; k++) {
                    q[k] = p[k] - of->period[k] *
                                      (cell[k] - (of->count[k] ? (of->count[k] - 1) / 2.0 : 0));
                }
                least = fmin(least, field_value(r, 1, q));
            }
        }
    }
    return least;
}

static void put_rows(writer *w, rows *of, int form) {
    *of = (rows){{0}, {0}, 0};
    if (form == 2) {
        of->around = whole(w, 2, 14);
        put(w, "polar(%d, ", of->around);
        return;
    }
    for (int k = 0; k < 3; k++) {
        if (whole(w, 0, 2) > (k == 1 ? 0 : 1)) continue;
        of->period[k] = floor(size(w, 500, 3000)) / 1000;
        of->count[k] = form == 1 ? whole(w, 1, 6) : 0;
    }
    put(w, form ? "repeat_limited((%.3f, %.3f, %.3f), " : "repeat((%.3f, %.3f, %.3f), ",
        of->period[0], of->period[1], of->period[2]);
    if (form)
        put(w, "(%d, %d, %d), ", of->count[0] ? of->count[0] : 1, of->count[1] ? of->count[1] : 1,
            of->count[2] ? of->count[2] : 1);
}

/* Solid where the union is and nowhere else, no solid closer than f / L, and the constant holds. */
static void compare_copies(const char *text, const field *r, const rows *of, uint64_t *seed) {
    double L = r->c->shapes[r->c->parts[0].shape].facts.lipschitz;
    for (int n = 0; n < 150; n++) {
        double p[3], q[3], way[3], reach = n % 2 ? 2 : 6;
        for (int k = 0; k < 3; k++) {
            p[k] = random_between(seed, -reach, reach);
            way[k] = random_between(seed, -1, 1);
            /* At the border where the selection changes. */
            if (n % 8 == 0) p[k] = of->period[k] * round(2 * p[k]) / 2 + 1e-7 * way[k];
        }
        double f = field_value(r, 0, p), u = union_of_copies(r, of, p);
        for (int k = 0; k < 3 && n % 3 == 2; k++) { /* towards falling values of the union */
            memcpy(q, p, sizeof q);
            q[k] += 1e-5;
            way[k] = u - union_of_copies(r, of, q) + 1e-12 * way[k];
        }
        double length = len(way[0], way[1], way[2]);
        if (fabs(u) > 1e-9 && fabs(f) > 1e-9 && (f < 0) != (u < 0)) {
            fail_msg("%s: %.17g at (%.17g, %.17g, %.17g), the union of the copies %.17g", text, f,
                     p[0], p[1], p[2], u);
        }
        double step = n % 3 ? f / L : pow(10, random_between(seed, -6, 0));
        for (int k = 0; k < 3; k++) q[k] = p[k] + way[k] / length * step * 0.999999;
        double g = field_value(r, 0, q);
        if (fabs(f - g) > L * apart(p, q) * (1 + 1e-9) + 1e-9) {
            fail_msg(
                "%s: %.17g at (%.17g, %.17g, %.17g), %.17g at (%.17g, %.17g, %.17g), constant %g",
                text, f, p[0], p[1], p[2], g, q[0], q[1], q[2], L);
        }
        if (n % 3 && f > 1e-6 && union_of_copies(r, of, q) < -1e-9) {
            fail_msg("%s: %.17g at (%.17g, %.17g, %.17g), but (%.17g, %.17g, %.17g) is solid", text,
                     f, p[0], p[1], p[2], q[0], q[1], q[2]);
        }
    }
}

static void repetitions_are_the_union_of_their_copies(void **state) {
    (void)state;
    static const struct {
        const char *text, *child;
        rows rows;
    } cases[] = {
        {"repeat((2, 0, 2), ", "torus(1.4, 0.1)", {{2, 0, 2}, {0}, 0}},
        {"repeat((2, 0, 2), ", "translate((0.6, 0, 0), sphere(0.6))", {{2, 0, 2}, {0}, 0}},
        {"repeat((1, 0, 0), ", "translate((0.7, 0, 0), sphere(0.1))", {{1, 0, 0}, {0}, 0}},
        {"repeat_limited((2, 0, 2), (3, 1, 2), ", "torus(1.4, 0.1)", {{2, 0, 2}, {3, 1, 2}, 0}},
        {"repeat_limited((1, 1, 1), (2, 4, 3), ",
         "translate((0, 1, 4), torus(3, 0.1))",
         {{1, 1, 1}, {2, 4, 3}, 0}},
        {"polar(12, ", "translate((3, 0, 0), torus(2, 0.1))", {{0}, {0}, 12}},
        {"polar(6, ", "translate((-3, 0, 0), sphere(0.3))", {{0}, {0}, 6}},
        {"polar(5, ", "box((3, 1, 0.1))", {{0}, {0}, 5}},
        {"polar(12, ", "union(torus(2, 0.1), translate((2, 0, 0), sphere(0.3)))", {{0}, {0}, 12}},
    };
    enum { CASES = sizeof cases / sizeof *cases };
    int compared = 0;
    static writer w;
    w.seed = 49;
    for (int i = 0; i < CASES + 600; i++) {
        static char child[4096];
        static field r;
        rows of;
        w.length = 0;
        if (i < CASES) {
            snprintf(child, sizeof child, "%s", cases[i].child);
        } else {
            if (i % 3 == 2) put(&w, "translate((%.3f, 0, 0), ", size(&w, -1, 3));
            put_solid(&w, 2);
            if (i % 3 == 2) put(&w, ")");
            memcpy(child, w.text, w.length + 1);
        }
        w.length = 0;
        put(&w, "part a = ");
        if (i < CASES) {
            of = cases[i].rows;
            put(&w, "%s", cases[i].text);
        } else {
            put_rows(&w, &of, i % 3);
        }
        put(&w, "%s); part b = %s;", child, child);
        if (!field_start(&r, w.text)) {
            if (i < CASES || !(strstr(r.error, "reaches") || strstr(r.error, "covers")))
                fail_msg("%s: %s", w.text, r.error);
            continue;
        }
        compare_copies(w.text, &r, &of, &w.seed);
        field_stop(&r);
        compared++;
    }
    if (compared < 300) fail_msg("only %d of 600 compile", compared);
}

static void the_bounds_of_a_blend_are_those_of_equal_operands(void **state) {
    (void)state;
    static const struct {
        const char *text;
        double radius;
    } cases[] = {
        {"part a = smooth_union(1, sphere(1), sphere(1));", 1.25},
        {"part a = smooth_union(1, sphere(1), sphere(1), sphere(1));", 1.390625},
        {"part a = smooth_union(1, sphere(1), sphere(1), sphere(1), sphere(1), sphere(1), "
         "sphere(1), sphere(1), "
         "sphere(1), sphere(1), sphere(1));",
         1.7222},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        masu_sdfc_result result;
        assert_compiles(cases[i].text, strlen(cases[i].text), &result);
        if (fabs(result.parts[0].radius - cases[i].radius) > 1e-5)
            fail_msg("%s: %g", cases[i].text, result.parts[0].radius);
        masu_sdfc_release(&result);
    }
}

static void a_bend_is_as_steep_as_its_inner_side(void **state) {
    (void)state;
    static const struct {
        const char *text;
        double lipschitz;
    } cases[] = {
        {"part a = bend(0.8333, box((1.4, 0.3, 0.3)));", 1 / (1 - 0.8333 * 0.3)},
        {"part a = bend(-0.8333, box((1.4, 0.3, 0.3)));", 1 / (1 - 0.8333 * 0.3)},
        {"part a = bend(0.01, box((200, 0.3, 0.3)));", 1 / (1 - 0.01 * 0.3)},
        {"part a = bend(0.5, translate((0, -0.4, 0), box((1.4, 0.3, 0.3))));", 1},
        {"part a = bend(0, box((1, 1, 1)));", 1},
        {"param k = 0 [-0.5, 0.2]; part a = bend(k, box((1, 0.3, 1)));", 1 / (1 - 0.5 * 0.3)},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        masu_sdfc_result result;
        assert_compiles(cases[i].text, strlen(cases[i].text), &result);
        double found = result.parts[0].lipschitz / cases[i].lipschitz;
        if (!(found > 1 - 1e-9 && found < 1.0011))
            fail_msg("%s: %g", cases[i].text, result.parts[0].lipschitz);
        masu_sdfc_release(&result);
    }
}

static void depth_is_limited(void **state) {
    (void)state;
    char text[20000], error[256];
    masu_sdfc_result result;
    static const char *const opening[] = {"let a = ", "part a = "};
    static const char *const unit[] = {"(", "round(0,"};
    for (int kind = 0; kind < 2; kind++) {
        size_t length = (size_t)snprintf(text, sizeof text, "%s", opening[kind]);
        for (int i = 0; i < 2000; i++) {
            length += (size_t)snprintf(text + length, sizeof text - length, "%s", unit[kind]);
        }
        assert_false(masu_sdfc_compile(text, length, "x", &result, error, sizeof error));
        assert_non_null(strstr(error, "expected at most 64 levels of nesting"));
    }
}

/* Names that double: the tree is huge, the text is not. */
static void size_is_limited(void **state) {
    (void)state;
    char text[4096], error[256];
    size_t length = (size_t)snprintf(text, sizeof text, "shape s0 = sphere(1);\n");
    masu_sdfc_result result;
    for (int i = 0; i < 40; i++) {
        length += (size_t)snprintf(text + length, sizeof text - length,
                                   "shape s%d = union(s%d, s%d);\n", i + 1, i, i);
    }
    length += (size_t)snprintf(text + length, sizeof text - length, "part a = s40;\n");
    assert_false(masu_sdfc_compile(text, length, "x", &result, error, sizeof error));
    assert_non_null(strstr(error, "expected a part of at most 2048 shapes"));
}

/* ---- mistakes in the analysis, planted ---- */

typedef enum fault { FAULT_NONE, FAULT_LIPSCHITZ, FAULT_BOX, FAULT_SPHERE, FAULT_CELL } fault;

static bool check_finds(const char *text, fault planted, char *error, size_t error_size) {
    sdfc *c = calloc(1, sizeof *c);
    assert_non_null(c);
    *c = (sdfc){.text = text,
                .bytes = strlen(text),
                .name = "x.sdf",
                .error = error,
                .error_size = error_size,
                .time_expr = -1};
    if (setjmp(c->failed)) {
        sdfc_free(c);
        return true;
    }
    sdfc_lex(c);
    sdfc_parse(c);
    sdfc_facts *f = &c->shapes[c->parts[0].shape].facts;
    if (planted == FAULT_LIPSCHITZ) f->lipschitz *= 0.98;
    if (planted == FAULT_BOX) f->box.high[0] -= 0.1;
    if (planted == FAULT_SPHERE) f->radius *= 0.95;
    if (planted == FAULT_CELL)
        c->shapes[c->parts[0].shape].extra[0] = 1; /* only the nearest cell */
    sdfc_lower(c, &c->parts[0]);
    sdfc_group_parts(c);
    sdfc_check(c, 20000);
    sdfc_free(c);
    return false;
}

static void planted_faults_are_found(void **state) {
    (void)state;
    static const struct {
        const char *text;
        fault fault;
    } cases[] = {
        {"part a = sphere(1);", FAULT_LIPSCHITZ},
        {"part a = scale((1, 2, 4), union(sphere(1), torus(3, 0.2)));", FAULT_LIPSCHITZ},
        {"part a = box((1, 2, 3));", FAULT_BOX},
        {"part a = torus(2, 0.3);", FAULT_SPHERE},
        {"part a = repeat((4, 0, 0), translate((0.7, 0, 0), box((1, 1, 1))));", FAULT_CELL},
        {"part a = polar(5, translate((3, 0, 0.8), box((0.5, 1, 1))));", FAULT_CELL},
    };
    char error[1024];
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        if (check_finds(cases[i].text, FAULT_NONE, error, sizeof error)) fail_msg("%s", error);
        if (!check_finds(cases[i].text, cases[i].fault, error, sizeof error)) {
            fail_msg("%s: fault %d was not found", cases[i].text, (int)cases[i].fault);
        }
        if (!strstr(error, "x.sdf:1:6: part a: ")) fail_msg("%s", error);
    }
}

/* A camera inside a part has no view: the part is named, with the time of the key. */
static void cameras_inside_of_parts_are_told(void **state) {
    (void)state;
    static const char text[] = "part wall = translate((time, 0, 0), box((0.5, 1, 1)));\n"
                               "part floor = plane((0, 1, 0), -2);\n";
    static const struct {
        masu_sdfc_camera camera;
        const char *warning;
    } cases[] = {{{{0, 0, 0}, 0}, "the camera at (0, 0, 0), 0 s, is inside part \"wall\""},
                 {{{0, 0, 0}, 3}, ""},
                 {{{3.2, 0.5, 0}, 3}, "inside part \"wall\""},
                 {{{0.51, 0, 0}, 0}, ""},
                 {{{9, -2.5, 9}, 0}, "inside part \"floor\""}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        masu_sdfc_options options = {
            .pairs = UINT32_MAX, .cameras = &cases[i].camera, .camera_count = 1};
        masu_sdfc_result result;
        char error[1024];
        if (!masu_sdfc_compile_with(text, sizeof text - 1, "x.sdf", &options, &result, error,
                                    sizeof error))
            fail_msg("%s", error);
        if (!strstr(result.warnings, cases[i].warning) || !*cases[i].warning != !*result.warnings)
            fail_msg("case %zu: %s", i, result.warnings);
        masu_sdfc_release(&result);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_are_those_of_the_formulas),
        cmocka_unit_test(constants_and_bounds_hold_for_the_C),
        cmocka_unit_test(the_scene_is_the_union_of_its_parts),
        cmocka_unit_test(glsl_of_all_features_compiles),
        cmocka_unit_test(one_sphere_has_the_code_of_one_sphere),
        cmocka_unit_test(no_scene_has_a_function_that_it_does_not_call),
        cmocka_unit_test(parts_of_one_form_share_its_code),
        cmocka_unit_test(what_depends_on_the_anchor_is_told),
        cmocka_unit_test(blocks_have_bits_for_what_can_be_left_out),
        cmocka_unit_test(the_box_of_the_parts_follows_the_parameters),
        cmocka_unit_test(parts_that_move_are_told_from_those_that_rest),
        cmocka_unit_test(the_same_text_gives_the_same_result),
        cmocka_unit_test(the_least_roughness_of_what_is_lit_is_known),
        cmocka_unit_test(mistakes_name_their_place),
        cmocka_unit_test(repetitions_are_the_union_of_their_copies),
        cmocka_unit_test(the_bounds_of_a_blend_are_those_of_equal_operands),
        cmocka_unit_test(a_bend_is_as_steep_as_its_inner_side),
        cmocka_unit_test(depth_is_limited),
        cmocka_unit_test(size_is_limited),
        cmocka_unit_test(cameras_inside_of_parts_are_told),
        cmocka_unit_test(planted_faults_are_found),
    };
    return cmocka_run_group_tests(tests, load_features, unload_features);
}
