/* measure.c: see measure.h. */
#include "meso/measure.h"

#include <string.h>

#include "bake/texture/texel.h"

#define RADIANS (MASU_BAKE_PI / 180)

masu_meso_vec3 masu_meso_from_above(double angle, double azimuth) {
    double s = sin(angle * RADIANS);
    return masu_bake_v3(s * cos(azimuth), cos(angle * RADIANS), s * sin(azimuth));
}

masu_meso_vec3 masu_meso_light_direction(const masu_meso_light *light, double view_azimuth,
                                         int hand) {
    double turn = view_azimuth + (hand ? 1 : -1) * light->azimuth * RADIANS;
    return masu_meso_from_above(90 - light->elevation, turn);
}

static double hashed(uint64_t seed) {
    uint64_t z = seed + 0x9E3779B97F4A7C15u;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

void masu_meso_point(uint64_t n, uint64_t seed, double *u, double *v) {
    double x = hashed(2 * seed) + (double)n * 0.7548776662466927;
    double y = hashed(2 * seed + 1) + (double)n * 0.5698402909980532;
    *u = x - floor(x);
    *v = y - floor(y);
}

masu_meso_vec3 masu_meso_cosine_ray(masu_meso_vec3 n, double u, double v) {
    /* Two tangents (Duff et al., JCGT 6-1, 2017). */
    double sign = n.z < 0 ? -1 : 1, a = -1 / (sign + n.z), b = n.x * n.y * a;
    masu_meso_vec3 t = {1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
    masu_meso_vec3 s = {b, sign + n.y * n.y * a, -n.y};
    double r = sqrt(u), turn = 2 * MASU_BAKE_PI * v, up = sqrt(fmax(1 - u, 0));
    masu_meso_vec3 d = {0, 0, 0};
    d = masu_bake_mad(d, t, r * cos(turn));
    d = masu_bake_mad(d, s, r * sin(turn));
    return masu_bake_mad(d, n, up);
}

/* Traces sky rays of a hit: returns the fraction that escapes; `radiance` is the light towards the
 * viewer. */
static double look_at_sky(const masu_meso_tracer *tracer, const masu_meso_hit *h, masu_meso_vec3 v,
                          double roughness, uint32_t rays, uint64_t seed, double radiance[3]) {
    double open = 0, diffuse = 0, specular = 0;
    for (uint32_t i = 0; i < rays; i++) {
        double a, b;
        masu_meso_point(i, seed, &a, &b);
        masu_meso_vec3 l = masu_meso_cosine_ray(h->normal, a, b);
        if (!(l.y > 0) || masu_meso_blocked(tracer, h->position, h->normal, l)) continue;
        open += 1;
        masu_meso_lobes lobes = masu_meso_brdf(h->normal, v, l, roughness);
        diffuse += lobes.diffuse;
        specular += lobes.specular;
    }
    double n = rays ? rays : 1;
    for (int k = 0; k < 3; k++) radiance[k] = (h->color[k] * diffuse + specular) / n;
    return open / n;
}

static void add_hit(const masu_meso_tracer *tracer, const masu_meso_patch *patch,
                    const masu_meso_setup *setup, const masu_meso_hit *h, masu_meso_vec3 v,
                    double azimuth, uint64_t seed, masu_meso_view *view) {
    double sky[3], along[2] = {cos(azimuth), sin(azimuth)};
    view->ao += look_at_sky(tracer, h, v, patch->roughness, setup->sky_rays, seed, sky);
    view->toward += h->normal.x * along[0] + h->normal.z * along[1];
    view->up += h->normal.y;
    for (int k = 0; k < 3; k++) {
        view->color[k] += h->color[k];
        view->sky[k] += sky[k];
    }
    for (uint32_t j = 0; j < setup->light_count; j++) {
        masu_meso_vec3 l = masu_meso_light_direction(&setup->light[j], azimuth, (seed + j) & 1);
        double n_l = masu_bake_dot(h->normal, l);
        if (!(n_l > 0) || masu_meso_blocked(tracer, h->position, h->normal, l)) continue;
        masu_meso_lobes lobes = masu_meso_brdf(h->normal, v, l, patch->roughness);
        view->lit[j] += 1;
        for (int k = 0; k < 3; k++) {
            view->sun[j][k] += n_l * (h->color[k] * lobes.diffuse + lobes.specular);
        }
    }
}

bool masu_meso_measure(const masu_meso_tracer *tracer, const masu_meso_patch *patch,
                       const masu_meso_setup *setup, masu_meso_view *views) {
    for (uint32_t i = 0; i < setup->view_count; i++) {
        masu_meso_view *view = &views[i];
        memset(view, 0, sizeof *view);
        view->angle = setup->view[i];
        uint64_t rays = (uint64_t)setup->side * setup->side, hits = 0;
        for (uint64_t r = 0; r < rays; r++) {
            double u, w, turn = hashed(setup->seed * 31 + i * rays + r) * 2 * MASU_BAKE_PI;
            masu_meso_point(r, setup->seed + 1000 * i, &u, &w);
            masu_meso_vec3 v = masu_meso_from_above(view->angle, turn);
            masu_meso_hit h;
            masu_meso_vec3 down = {-v.x, -v.y, -v.z}, from = {u, patch->high + 1e-4, w};
            if (!masu_meso_trace(tracer, from, down, &h)) continue;
            add_hit(tracer, patch, setup, &h, v, turn, setup->seed + r, view);
            hits++;
        }
        if (!hits) return false;
        double n = (double)hits;
        view->toward /= n;
        view->up /= n;
        view->length = sqrt(view->toward * view->toward + view->up * view->up);
        view->ao /= n;
        for (int k = 0; k < 3; k++) {
            view->color[k] /= n;
            view->sky[k] /= n;
            for (uint32_t j = 0; j < setup->light_count; j++) view->sun[j][k] /= n;
        }
        for (uint32_t j = 0; j < setup->light_count; j++) view->lit[j] /= n;
    }
    return true;
}

/* ---- from straight above ---- */

void masu_meso_look_down(const masu_meso_tracer *tracer, const masu_meso_patch *patch,
                         uint32_t size, uint32_t samples, uint32_t sky_rays, uint64_t seed,
                         masu_meso_texel *texels, double *mean_height) {
    double height = 0, hits = 0;
    for (uint32_t y = 0; y < size; y++) {
        for (uint32_t x = 0; x < size; x++) {
            masu_meso_texel t = {{0, 0, 0}, {0, 0, 0}, 0, 0};
            double n = 0, unused[3];
            for (uint32_t s = 0; s < samples * samples; s++) {
                double u = (x + (s % samples + 0.5) / samples) / size;
                double w = (y + (s / samples + 0.5) / samples) / size;
                masu_meso_hit h;
                masu_meso_vec3 up = {0, 1, 0}, down = {0, -1, 0};
                masu_meso_vec3 from = {u, patch->high + 1e-4, w};
                if (!masu_meso_trace(tracer, from, down, &h)) continue;
                t.ao += look_at_sky(tracer, &h, up, patch->roughness, sky_rays,
                                    seed + (y * (uint64_t)size + x) * 64 + s, unused);
                for (int k = 0; k < 3; k++) t.color[k] += h.color[k];
                t.normal[0] += h.normal.x;
                t.normal[1] += h.normal.y;
                t.normal[2] += h.normal.z;
                height += h.position.y;
                n += 1;
            }
            hits += n;
            n = n > 0 ? n : 1; /* a hole: black, closed, facing up */
            masu_meso_vec3 mean = {t.normal[0] / n, t.normal[1] / n, t.normal[2] / n};
            double length = masu_bake_length(mean);
            if (!masu_bake_normalize(&mean)) mean = masu_bake_v3(0, 1, 0);
            t.normal[0] = mean.x;
            t.normal[1] = mean.y;
            t.normal[2] = mean.z;
            t.roughness = (double)masu_texel_rougher((float)patch->roughness, (float)length);
            t.ao /= n;
            for (int k = 0; k < 3; k++) t.color[k] /= n;
            texels[(size_t)y * size + x] = t;
        }
    }
    *mean_height = hits > 0 ? height / hits : 0;
}

void masu_meso_look_along(const masu_meso_tracer *tracer, const masu_meso_patch *patch,
                          const masu_meso_setup *setup, double angle, double azimuth, double height,
                          double sky, uint32_t size, double *radiance) {
    masu_meso_vec3 v = masu_meso_from_above(angle, azimuth), down = {-v.x, -v.y, -v.z};
    double rise = (patch->high + 1e-4 - height) / v.y;
    for (uint32_t t = 0; t < size * size; t++) {
        double *out = radiance + (size_t)t * setup->light_count * 3;
        memset(out, 0, setup->light_count * 3 * sizeof *out);
        double n = setup->side * setup->side, hits = 0;
        for (uint32_t s = 0; s < setup->side * setup->side; s++) {
            uint64_t seed = setup->seed + (uint64_t)t * 4096 + s;
            double u = (t % size + (s % setup->side + hashed(seed * 2)) / setup->side) / size;
            double w = (t / size + (s / setup->side + hashed(seed * 2 + 1)) / setup->side) / size;
            masu_meso_vec3 from = masu_bake_mad(masu_bake_v3(u, height, w), v, rise);
            masu_meso_hit h;
            double above[3];
            if (!masu_meso_trace(tracer, from, down, &h)) continue;
            hits++;
            look_at_sky(tracer, &h, v, patch->roughness, setup->sky_rays, seed, above);
            for (uint32_t j = 0; j < setup->light_count; j++) {
                masu_meso_vec3 l = masu_meso_light_direction(&setup->light[j], azimuth, 1);
                double n_l = masu_bake_dot(h.normal, l);
                for (int k = 0; k < 3; k++) out[3 * j + (uint32_t)k] += sky * above[k] / n;
                if (!(n_l > 0) || masu_meso_blocked(tracer, h.position, h.normal, l)) continue;
                masu_meso_lobes lobes = masu_meso_brdf(h.normal, v, l, patch->roughness);
                for (int k = 0; k < 3; k++) {
                    out[3 * j + (uint32_t)k] +=
                        n_l * (h.color[k] * lobes.diffuse + lobes.specular) / n;
                }
            }
        }
        for (uint32_t j = 0; j < setup->light_count * 3 && hits > 0; j++) out[j] *= n / hits;
    }
}

masu_meso_texel masu_meso_mean_texel(const masu_meso_texel *texels, size_t count) {
    masu_meso_texel m = {{0, 0, 0}, {0, 0, 0}, 0, 0};
    for (size_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            m.color[k] += texels[i].color[k] / (double)count;
            m.normal[k] += texels[i].normal[k] / (double)count;
        }
        m.roughness += texels[i].roughness / (double)count;
        m.ao += texels[i].ao / (double)count;
    }
    masu_meso_vec3 n = {m.normal[0], m.normal[1], m.normal[2]};
    double length = masu_bake_length(n);
    if (!masu_bake_normalize(&n)) n = masu_bake_v3(0, 1, 0);
    m.normal[0] = n.x;
    m.normal[1] = n.y;
    m.normal[2] = n.z;
    m.roughness = (double)masu_texel_rougher((float)m.roughness, (float)length);
    return m;
}
