/* specular.c: see specular.h. */
#include "specular.h"

#include "measure/shade.h"
#include "measure/texel.h"
#include "scene/scene.h"
#include "shared/masu_shared.h"
#include "split_sum.h"
#include "reference/vec.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- The scene ------------------------------------------------------------------------------- */

/* Decodes a vertex normal, object space. */
static void decode(const int16_t packed[2], double n[3]) {
    double x = fmax(packed[0] / 32767.0, -1), y = fmax(packed[1] / 32767.0, -1);
    n[2] = 1 - fabs(x) - fabs(y);
    n[0] = n[2] >= 0 ? x : (1 - fabs(y)) * (x >= 0 ? 1 : -1);
    n[1] = n[2] >= 0 ? y : (1 - fabs(x)) * (y >= 0 ? 1 : -1);
    (void)unit3(n);
}

/* Normal matrix: the transposed inverse, up to the determinant, whose sign is applied. */
static void stand(const float t[12], double n[3]) {
    double row[3][3], out[3], c[3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) row[i][k] = (double)t[4 * i + k];
    for (int i = 0; i < 3; i++) {
        cross3(row[(i + 1) % 3], row[(i + 2) % 3], c);
        out[i] = dot3(c, n);
    }
    cross3(row[1], row[2], c);
    double sign = dot3(c, row[0]) < 0 ? -1 : 1;
    for (int k = 0; k < 3; k++) n[k] = sign * out[k];
    (void)unit3(n);
}

static const char *unknown(const masu_scene *scene, const masu_scene_view *v) {
    if (masu_scene_data_of(scene)->sdf) return "an SDF";
    if (masu_scene_data_of(scene)->textures) return "textures";
    if (masu_scene_data_of(scene)->meso) return "small reliefs";
    for (uint32_t i = 0; i < masu_scene_count(scene, MASU_SCENE_MATERIAL); i++)
        if (v->materials[i].specular < 0.5f || v->materials[i].specular > 0.5f)
            return "specular factors";
    if (masu_scene_count(scene, MASU_SCENE_LIGHT)) return "punctual lights";
    if (masu_scene_data_of(scene)->probes) return "light probes";
    if (masu_scene_shadow_cascades(scene, NULL)) return "shadows";
    if (masu_scene_data_of(scene)->environment_size || v->environment->turbidity > 0)
        return "a sky of more than two colours";
    if (masu_scene_data_of(scene)->fog) return "fog";
    return v->reflections ? NULL : "no reflections";
}

bool masu_ref_mirror_open(const masu_scene *scene, const masu_camera *camera, uint32_t width,
                          uint32_t height, masu_ref_mirror *m, char *error, size_t error_size) {
    memset(m, 0, sizeof *m);
    masu_scene_view v = masu_scene_view_of(scene);
    const char *what = unknown(scene, &v);
    if (what) {
        snprintf(error, error_size, "the scene has %s, which this reference does not support",
                 what);
        return false;
    }
    if (!masu_view_seen(scene, camera, width, height, &m->view, error, error_size)) return false;
    m->reach = (double)v.reflections->distance;
    bool good = masu_ref_triangles_open(scene, &m->world) != 0;
    if (good) {
        m->normals = malloc((m->world.count + 1) * sizeof *m->normals);
        m->looks = malloc((m->world.count + 1) * sizeof *m->looks);
    }
    if (!m->normals || !m->looks) {
        masu_ref_mirror_close(m);
        snprintf(error, error_size, "no memory for %u triangles",
                 (unsigned)masu_scene_triangles(scene));
        return false;
    }
    for (uint32_t i = 0; i < m->world.count; i++) {
        const masu_ref_triangle *t = &m->world.triangles[i];
        const masu_blob_material *look = &v.materials[v.primitives[t->primitive].material];
        double given[8] = {(double)look->base_color[0], (double)look->base_color[1],
                           (double)look->base_color[2], (double)look->roughness,
                           (double)look->emissive[0],   (double)look->emissive[1],
                           (double)look->emissive[2],   (double)look->metallic};
        memcpy(m->looks[i], given, sizeof given);
        for (int c = 0; c < 3; c++) {
            decode(v.vertices[t->vertex[c]].normal, m->normals[i][c]);
            stand(v.instances[t->instance].transform, m->normals[i][c]);
        }
    }
    return true;
}

void masu_ref_mirror_close(masu_ref_mirror *m) {
    masu_ref_triangles_close(&m->world);
    free(m->normals);
    free(m->looks);
    memset(m, 0, sizeof *m);
}

/* ---- One ray --------------------------------------------------------------------------------- */

/* Barycentric coordinates of a point in a triangle. */
static void shares(const masu_ref_triangle *t, const double p[3], double out[3]) {
    double e[3], f[3], g[3], n[3], c[3];
    for (int k = 0; k < 3; k++) {
        e[k] = t->b[k] - t->a[k];
        f[k] = t->c[k] - t->a[k];
        g[k] = p[k] - t->a[k];
    }
    cross3(e, f, n);
    double area = dot3(n, n);
    cross3(g, f, c);
    out[1] = dot3(c, n) / area;
    cross3(e, g, c);
    out[2] = dot3(c, n) / area;
    out[0] = 1 - out[1] - out[2];
}

bool masu_ref_seen(const masu_ref_mirror *m, const double from[3], const double direction[3],
                   double out[3]) {
    double t, p[3], share[3], n[3] = {0, 0, 0}, flat[3], back[3], mirrored[3];
    int64_t hit = masu_ref_hit(&m->world, from, direction, 0, m->reach, &t);
    masu_shade_open_sky(&m->view, direction, out);
    if (hit < 0) return false;
    const masu_ref_triangle *triangle = &m->world.triangles[hit];
    for (int k = 0; k < 3; k++) p[k] = from[k] + t * direction[k], back[k] = -direction[k];
    shares(triangle, p, share);
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++) n[k] += share[c] * m->normals[hit][c][k];
    (void)unit3(n);
    /* Two-sided lighting: the shading normal on the visible side; its component that still points
     * away is removed. */
    if (!masu_ref_normal(triangle, n, flat)) return false;
    if (dot3(flat, back) < 0)
        for (int k = 0; k < 3; k++) n[k] = -n[k];
    double away = -dot3(n, back);
    if (away > 0) {
        for (int k = 0; k < 3; k++) n[k] += away * back[k];
        (void)unit3(n);
    }
    masu_shade_exact(&m->view, direction, n, m->looks[hit], out, mirrored);
    for (int k = 0; k < 3; k++) out[k] += mirrored[k];
    return true;
}

/* ---- A pixel --------------------------------------------------------------------------------- */

bool masu_ref_surface_of(const masu_ref_mirror *m, uint32_t x, uint32_t y, float depth,
                         const uint8_t albedo[4], uint32_t normal, masu_ref_surface *s) {
    float unpacked[3];
    memset(s, 0, sizeof *s);
    if (!(depth > 0.0f) || masu_texel_is_unlit(normal)) return false;
    masu_view_ray ray = masu_view_ray_at(&m->view, x, y);
    double z = m->view.near_distance / (double)depth;
    masu_unpack_normal(normal, unpacked);
    for (int k = 0; k < 3; k++) {
        s->direction[k] = ray.direction[k];
        s->normal[k] = (double)unpacked[k];
        s->at[k] = m->view.eye[k] + ray.direction[k] * ray.z_scale * z;
    }
    (void)unit3(s->normal);
    s->width = z * 2 * m->view.tan_y / m->view.height;
    masu_texel_unpack(albedo, normal, s->look);
    return true;
}

static double random_of(uint64_t *state) { /* splitmix64; uniform in 0..1 */
    uint64_t z = *state += UINT64_C(0x9E3779B97F4A7C15);
    z = (z ^ z >> 30) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ z >> 27) * UINT64_C(0x94D049BB133111EB);
    return ((double)((z ^ z >> 31) >> 12) + 0.5) * 0x1p-52;
}

/* Smith's Lambda of GGX. */
static double lambda(double alpha, double cosine) {
    double tan2 = (1 - cosine * cosine) / (cosine * cosine);
    return 0.5 * (sqrt(1 + alpha * alpha * tan2) - 1);
}

typedef struct lobe {
    double alpha, tan2, n_h, n_l, n_v;
} lobe;

static double alpha_of(double roughness) {
    double r = fmax(roughness, MASU_TABLE_SMOOTHEST);
    return r * r;
}

/* Probability density of the half vectors: D (N.h). Beckmann's form of GGX's D, by the tangent. */
static double density(const lobe *x) {
    double a2 = x->alpha * x->alpha, c2 = x->n_h * x->n_h, k = a2 + x->tan2;
    return a2 / (3.14159265358979323846 * c2 * c2 * k * k) * x->n_h;
}

/* D G2 / (4 (N.v) (N.l)) times N.l. */
static double value(const lobe *x) {
    double g2 = 1 / (1 + lambda(x->alpha, x->n_l) + lambda(x->alpha, x->n_v));
    return density(x) / x->n_h * g2 / (4 * x->n_v);
}

/* The part of the base's light that a coat transmits: from the table, as bsdf.glsl defines it. */
static double through_of(const masu_ref_surface *s, double n_l, double n_v) {
    double row = (s->coat_roughness - MASU_TABLE_SMOOTHEST) * (MASU_TABLE_ROWS - 1) /
                 (1 - MASU_TABLE_SMOOTHEST);
    uint32_t at = (uint32_t)fmin(fmax(row, 0) + 0.5, MASU_TABLE_ROWS - 1);
    float line[2];
    memcpy(line, masu_split_sum + MASU_TABLE_COAT_AVERAGE + 4 * at + 2, sizeof line);
    double steep = pow(1 - fmin(fmin(n_l, n_v), 1), 5);
    return fmax(1 - s->coat * ((double)line[0] + (double)line[1] * steep), 0);
}

/* A half vector from the base's distribution or from the coat's, at random, with the lobes divided
 * by the combined density of l, which is the density of h over 4 h.v. (Walter et al., "Microfacet
 * Models for Refraction", EGSR 2007, sections 5.2 and 5.3; joint masking of both directions: Heitz,
 * JCGT 3-2, 2014, section 5.3.) Without a coat D cancels. */
masu_ref_estimate masu_ref_mirrored(const masu_ref_mirror *m, const masu_ref_surface *s,
                                    uint32_t rays, uint64_t seed) {
    masu_ref_estimate e;
    double sum[3] = {0}, square[3] = {0}, tangent[3] = {1, 0, 0}, across[3], v[3], from[3];
    double far = 0, brightest = 0;
    uint64_t state = seed * UINT64_C(0xD1342543DE82EF95) + 1;
    if (fabs(s->normal[0]) > 0.8) tangent[0] = 0, tangent[1] = 1;
    cross3(s->normal, tangent, across);
    (void)unit3(across);
    cross3(across, s->normal, tangent);
    for (int k = 0; k < 3; k++) {
        v[k] = -s->direction[k];
        far = fmax(far, fmax(fabs(s->at[k]), fabs(s->at[k] - m->view.eye[k])));
        brightest = fmax(brightest, s->look[k]);
    }
    for (int k = 0; k < 3; k++)
        from[k] = s->at[k] + s->normal[k] * (0.125 * s->width + 9.6e-7 * far);
    double n_v = fmax(dot3(s->normal, v), 1e-4);
    double metallic = s->look[7], f90 = 1 + (fmin(50 * brightest, 1) - 1) * metallic;
    for (uint32_t i = 0; i < rays; i++) {
        lobe base = {.alpha = alpha_of(s->look[3]), .n_v = n_v}, coat = base;
        coat.alpha = alpha_of(s->coat_roughness);
        double drawn = s->coat > 0 && random_of(&state) < 0.5 ? coat.alpha : base.alpha;
        double u = random_of(&state), phi = 6.283185307179586 * random_of(&state), light[3];
        double tan2 = drawn * drawn * u / (1 - u), n_h = 1 / sqrt(1 + tan2), r = n_h * sqrt(tan2);
        double h[3], l[3];
        for (int k = 0; k < 3; k++)
            h[k] = n_h * s->normal[k] + r * (cos(phi) * tangent[k] + sin(phi) * across[k]);
        double h_v = dot3(h, v);
        for (int k = 0; k < 3; k++) l[k] = 2 * h_v * h[k] - v[k];
        double n_l = dot3(s->normal, l);
        if (!(h_v > 0 && n_l > 0)) continue;
        base.tan2 = coat.tan2 = tan2, base.n_h = coat.n_h = n_h, base.n_l = coat.n_l = n_l;
        double pdf = density(&base), worth = value(&base), coated = 0,
               steep = pow(fmax(1 - h_v, 0), 5);
        if (s->coat > 0) {
            pdf = 0.5 * (pdf + density(&coat));
            worth *= through_of(s, n_l, n_v);
            coated = s->coat * (0.04 + 0.96 * steep) * value(&coat);
        }
        (void)masu_ref_seen(m, from, l, light);
        for (int k = 0; k < 3; k++) {
            double f0 = 0.04 + (s->look[k] - 0.04) * metallic;
            double x = (worth * (f0 + (f90 - f0) * steep) + coated) * 4 * h_v / pdf * light[k];
            sum[k] += x;
            square[k] += x * x;
        }
    }
    for (int k = 0; k < 3; k++) {
        e.mean[k] = sum[k] / rays;
        e.variance[k] = fmax(square[k] / rays - e.mean[k] * e.mean[k], 0);
    }
    return e;
}
