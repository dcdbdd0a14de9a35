/* test_first_look.c: the default scene that masu-bake makes for a model, checked by projecting each
 * vertex here: the model fills the frame and does not leave it, at any size and position; an object
 * without surroundings gets a ground that does not occlude it, with shadows and reflections. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "bake/build/first_look.h"
#include "bake/build/look.h"
#include "bake/build/parts.h"
#include "bake/scene/piece.h"

#define ASPECT (16.0 / 9)

static void place_shape(masu_bake_content *content, masu_bake_vec3 size, double scale,
                        masu_bake_vec3 at) {
    masu_bake_shape shape = {.kind = MASU_BAKE_BOX, .size = size};
    masu_bake_content piece = {0};
    masu_bake_make_shape(&shape, false, &piece);
    masu_bake_overrides none = {NULL, 0};
    masu_bake_residence residence = {0};
    masu_bake_affine move = masu_bake_translation(at),
                     grow = masu_bake_scaling(masu_bake_v3(scale, scale, scale));
    masu_bake_affine placement = masu_bake_multiply(&move, &grow);
    assert_null(masu_bake_place(content, &piece, &residence, &placement, &none, NULL));
    masu_bake_content_release(&piece);
}

/* Largest |x| and |y| in the image (1 at its edge) of the first `instances`. All are in front of
 * `near`. */
static void project(const masu_bake_content *c, uint64_t instances, const masu_blob_camera_key *key,
                    double most[2]) {
    masu_bake_vec3 eye = masu_bake_v3f(key->position);
    masu_bake_vec3 f = masu_bake_sub(masu_bake_v3f(key->target), eye);
    assert_true(masu_bake_normalize(&f));
    masu_bake_vec3 r = masu_bake_cross(f, masu_bake_v3(0, 1, 0));
    assert_true(masu_bake_normalize(&r));
    masu_bake_vec3 u = masu_bake_cross(r, f);
    double t = tan((double)key->fov_y / 2);
    most[0] = most[1] = 0;
    for (uint64_t i = 0; i < instances; i++) {
        masu_bake_affine world = masu_bake_transform(&MASU_BAKE_INSTANCES(c)[i]);
        const masu_blob_mesh *mesh = &MASU_BAKE_MESHES(c)[MASU_BAKE_INSTANCES(c)[i].mesh];
        const masu_blob_primitive *p = &MASU_BAKE_PRIMITIVES(c)[mesh->first_primitive];
        for (uint32_t k = 0; k < p->vertex_count; k++) {
            const float *v = MASU_BAKE_VERTICES(c)[p->first_vertex + k].position;
            masu_bake_vec3 q = masu_bake_sub(masu_bake_apply(&world, masu_bake_v3f(v)), eye);
            double z = masu_bake_dot(q, f);
            assert_true(z > 0);
            most[0] = fmax(most[0], fabs(masu_bake_dot(q, r)) / (z * t * ASPECT));
            most[1] = fmax(most[1], fabs(masu_bake_dot(q, u)) / (z * t));
        }
    }
}

static void the_model_fills_the_frame(void **state) {
    (void)state;
    static const struct {
        double size[3];
        bool ground;
    } things[] = {{{1, 1, 1}, true},     {{1, 8, 1}, true},   {{8, 1, 1}, true},
                  {{1, 1, 9}, true},     {{10, 0.2, 10}, false}, {{0.01, 3, 0.01}, true},
                  {{4, 1.3, 1.8}, true}, {{0.001, 1, 1}, true},
                  {{2, 1.25, 3.6}, true}};
    static const double scales[] = {1e-2, 1, 3e3};
    static const double places[][3] = {{0, 0, 0}, {5, -3, 11}, {-1000, 200, 400}};
    for (size_t n = 0; n < sizeof things / sizeof *things; n++) {
        for (size_t s = 0; s < 3; s++) {
            for (size_t p = 0; p < 3; p++) {
                bool plays = p == 1;
                /* a model of a centimetre is not possible in floats of a thousand metres */
                if (scales[s] < 1 && p == 2) continue;
                const double *e = things[n].size, *at = places[p];
                masu_bake_content content = {0};
                masu_bake_description d = {.reflections = {.wanted = true}};
                place_shape(&content, masu_bake_v3(e[0], e[1], e[2]), scales[s],
                            masu_bake_v3(at[0], at[1], at[2]));
                masu_bake_affine identity = masu_bake_identity();
                masu_bake_box bounds = masu_bake_bounds(&content, &identity);
                masu_blob_clip clip = {0};
                if (plays) masu_bake_append(&content.section[MASU_BLOB_CLIPS], &clip, sizeof clip);
                masu_bake_make_first_look(&bounds, &content, &d);
                assert_true(masu_bake_build_models(&d, 0, MASU_BAKE_TEXTURES_OFF, &content));
                assert_int_equal(d.look.key_count, 1);
                double most[2];
                project(&content, 1, d.look.keys, most);
                double share = plays ? 0.75 : 0.89; /* room to move */
                assert_true(fabs(fmax(most[0], most[1]) - share) < 0.03);
                assert_int_equal(masu_bake_count(&content, MASU_BLOB_INSTANCES),
                                 things[n].ground ? 2 : 1);
                /* a long table is viewed from above, not along its top */
                if (e[1] < 0.5 * fmax(e[0], e[2]))
                    assert_true((double)d.look.keys[0].position[1] >
                                bounds.high.y + 0.25 * e[1] * scales[s]);
                masu_bake_box all = masu_bake_bounds(&content, &identity);
                if (things[n].ground) { /* below it, but by an invisible gap at most */
                    double gap = bounds.low.y - all.low.y;
                    assert_true(gap > 0 && gap < 0.002 * scales[s] * fmax(e[0], fmax(e[1], e[2])));
                    assert_true(all.high.y == bounds.high.y && all.low.x < bounds.low.x);
                }
                assert_true(d.look.shadows && d.look.occlusion && d.reflections.wanted &&
                            d.look.smooth_edges);
                assert_true(d.look.shadow_distance > 0 && d.look.occlusion_radius > 0);
                assert_true(d.look.sun_direction.y > 0.3);
                masu_bake_description_release(&d);
                masu_bake_content_release(&content);
            }
        }
    }
}

/* The near plane of a scene without one: a centimetre for any size of scene, so that no wall before
 * the camera is clipped; less for a scene that is small as a whole. */
static void the_near_plane_is_near(void **state) {
    (void)state;
    static const double cases[][2] = {
        {1e5, 0.01}, {100, 0.01}, {1, 0.01}, {0.1, 0.02 * 0.1}, {0.001, 0.02 * 0.001}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double side = cases[i][0] / sqrt(3);
        masu_bake_box bounds = {masu_bake_v3(-side, -side, -side), masu_bake_v3(side, side, side)};
        masu_bake_content content = {0};
        masu_bake_look look = masu_bake_default_look();
        masu_bake_build_look(&look, &bounds, &content);
        double near =
            (double)MASU_BAKE_ARRAY(&content, MASU_BLOB_ENVIRONMENT, masu_blob_environment)
                ->near_distance;
        if (!(fabs(near - cases[i][1]) <= 1e-6 * cases[i][1]))
            fail_msg("%g for a radius of %g", near, cases[i][0]);
        masu_bake_content_release(&content);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_model_fills_the_frame),
                                       cmocka_unit_test(the_near_plane_is_near)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
