/* study.c: see study.h. */
#include "lab/meso/study.h"

#include <stdlib.h>
#include <string.h>

#include "cli/cli.h"

const double masu_meso_judged[MASU_MESO_JUDGED] = {0, 30, 60, 80, 88};
const uint32_t masu_meso_level_size[MASU_MESO_LEVELS] = {32, 8, 2};
const uint32_t masu_meso_mip_size[MASU_MESO_MIPS] = {16, 4, 1};

#define BIN_LOW (-0.5)
#define BIN_HIGH 1.5
#define COUNT(array) ((uint32_t)(sizeof(array) / sizeof *(array)))

static void set_judged(masu_meso_setup *s) {
    static const double elevation[] = {8, 15, 25, 37, 52, 70};
    static const double azimuth[] = {0, 30, 60, 90, 120, 143, 157, 172, 180};
    memcpy(s->view, masu_meso_judged, sizeof masu_meso_judged);
    s->view_count = MASU_MESO_JUDGED;
    masu_meso_set_lights(s, elevation, COUNT(elevation), azimuth, COUNT(azimuth));
}

/* ---- comparison ------------------------------------------------------------------------------ */

static void shade(const masu_meso_shader *shader, const masu_meso_texel *texel, masu_meso_vec3 v,
                  double azimuth, const masu_meso_setup *setup, double weight, double *out) {
    masu_meso_surface seen = masu_meso_seen(shader, texel, v);
    double sky[3] = {0, 0, 0};
    masu_meso_add_sky(shader, &seen, v, MASU_MESO_SKY, sky);
    for (uint32_t j = 0; j < setup->light_count; j++) {
        double got[3] = {sky[0], sky[1], sky[2]};
        masu_meso_vec3 l = masu_meso_light_direction(&setup->light[j], azimuth, 1);
        masu_meso_add_sun(shader, &seen, v, l, got);
        for (int k = 0; k < 3; k++) out[3 * j + (uint32_t)k] += weight * got[k];
    }
}

static double relative_error(const double *got, const double *want, size_t count) {
    double sum = 0, mean = 0;
    for (size_t i = 0; i < count; i++) {
        sum += (got[i] - want[i]) * (got[i] - want[i]);
        mean += want[i];
    }
    return sqrt(sum / (double)count) / fmax(mean / (double)count, 1e-9);
}

/* Mean radiance of all texels against the radiance of the mean texel. */
static double filtered_error(const masu_meso_study *study, const masu_meso_shader *shader,
                             masu_meso_vec3 v, const masu_meso_setup *setup, double *bias) {
    double mean[MASU_MESO_LIGHTS_MAX * 3] = {0}, got[MASU_MESO_LIGHTS_MAX * 3] = {0};
    size_t texels = (size_t)study->made.size * study->made.size;
    shade(shader, &study->made.mean, v, 0, setup, 1, got);
    for (size_t t = 0; t < texels; t++) {
        shade(shader, &study->made.texels[t], v, 0, setup, 1.0 / (double)texels, mean);
    }
    double sum[2] = {0, 0};
    for (uint32_t i = 0; i < setup->light_count * 3; i++) {
        sum[0] += got[i];
        sum[1] += mean[i];
    }
    *bias = sum[0] / fmax(sum[1], 1e-9) - 1;
    return relative_error(got, mean, setup->light_count * 3);
}

/* Signed means over all lights of the radiance of mips against that of the map. */
static void judge_mips(masu_meso_study *study, const masu_meso_setup *setup) {
    masu_meso_texel *texels[MASU_MESO_MIPS + 1] = {study->made.texels};
    uint32_t size[MASU_MESO_MIPS + 1] = {study->made.size}, numbers = setup->light_count * 3;
    masu_meso_shader shader = {&study->made.table, study->made.curves, MASU_MESO_CURVES, false};
    for (uint32_t m = 1; m <= MASU_MESO_MIPS; m++) {
        size[m] = masu_meso_mip_size[m - 1];
        texels[m] = masu_meso_mip(&study->made, size[m]);
    }
    for (uint32_t i = 0; i < setup->view_count; i++) {
        masu_meso_vec3 v = masu_meso_from_above(setup->view[i], 0);
        double mean[MASU_MESO_MIPS + 1] = {0};
        for (uint32_t m = 0; m <= MASU_MESO_MIPS; m++) {
            double sum[MASU_MESO_LIGHTS_MAX * 3] = {0}, count = (double)size[m] * size[m];
            for (uint32_t t = 0; t < size[m] * size[m]; t++) {
                shade(&shader, &texels[m][t], v, 0, setup, 1 / count, sum);
            }
            for (uint32_t k = 0; k < numbers; k++) mean[m] += sum[k];
            if (m) study->verdict[i].mip_mean[m - 1] = mean[m] / fmax(mean[0], 1e-9) - 1;
        }
    }
    for (uint32_t m = 1; m <= MASU_MESO_MIPS; m++) free(texels[m]);
}

static void judge_far(masu_meso_study *study, const masu_meso_setup *setup,
                      const masu_meso_view *views) {
    double want[MASU_MESO_LIGHTS_MAX * 3], got[MASU_MESO_LIGHTS_MAX * 3];
    uint32_t numbers = setup->light_count * 3;
    masu_meso_shader shader = {&study->made.table, study->made.curves, 0, false};
    for (uint32_t i = 0; i < setup->view_count; i++) {
        masu_meso_vec3 v = masu_meso_from_above(setup->view[i], 0);
        for (uint32_t j = 0; j < numbers; j++) {
            want[j] = views[i].sun[j / 3][j % 3] + MASU_MESO_SKY * views[i].sky[j % 3];
        }
        for (shader.way = 0; shader.way < MASU_MESO_WAYS; shader.way++) {
            memset(got, 0, sizeof got);
            shade(&shader, &study->made.mean, v, 0, setup, 1, got);
            study->verdict[i].far[shader.way] = relative_error(got, want, numbers);
        }
        double unused;
        for (shader.way = 0; shader.way < MASU_MESO_WAYS; shader.way++) {
            study->verdict[i].filtered[shader.way] = filtered_error(
                study, &shader, v, setup, &study->verdict[i].filtered_mean[shader.way]);
        }
        shader.way = MASU_MESO_CURVES;
        shader.no_specular = true;
        study->verdict[i].filtered_diffuse = filtered_error(study, &shader, v, setup, &unused);
        shader.no_specular = false;
    }
}

/* A setup with every `step`th light. */
static masu_meso_setup thinned(const masu_meso_setup *setup, uint32_t step) {
    masu_meso_setup s = *setup;
    s.light_count = 0;
    for (uint32_t i = 0; i < setup->light_count; i += step)
        s.light[s.light_count++] = setup->light[i];
    return s;
}

static void average_down(const double *from, uint32_t size, uint32_t step, uint32_t numbers,
                         double *to) {
    uint32_t small = size / step;
    memset(to, 0, (size_t)small * small * numbers * sizeof *to);
    for (uint32_t t = 0; t < size * size; t++) {
        double *out = to + (size_t)(t / size / step * small + t % size / step) * numbers;
        for (uint32_t k = 0; k < numbers; k++) {
            out[k] += from[(size_t)t * numbers + k] / ((double)step * step);
        }
    }
}

static void judge_texels(masu_meso_study *study, const masu_meso_tracer *tracer,
                         const masu_meso_patch *patch, const masu_meso_setup *setup) {
    enum { AZIMUTHS = 2 };
    masu_meso_setup lights = thinned(setup, 5);
    lights.side = 3;
    uint32_t fine = masu_meso_level_size[0], numbers = lights.light_count * 3;
    size_t all = (size_t)fine * fine * numbers;
    double *want = masu_meso_allocated(all, sizeof *want),
           *reduced = masu_meso_allocated(all, sizeof *reduced);
    double *got = masu_meso_allocated(all, sizeof *got);
    masu_meso_shader shader = {&study->made.table, study->made.curves, 0, false};
    for (uint32_t i = 0; i < MASU_MESO_JUDGED * AZIMUTHS; i++) {
        double angle = masu_meso_judged[i / AZIMUTHS], azimuth = 0.7 + 1.9 * (i % AZIMUTHS);
        masu_meso_vec3 v = masu_meso_from_above(angle, azimuth);
        masu_cli_progress("texels at %g degrees", angle);
        lights.seed = setup->seed + 99991 * (i + 1);
        masu_meso_look_along(tracer, patch, &lights, angle, azimuth, study->made.height,
                             MASU_MESO_SKY, fine, want);
        for (uint32_t m = 0; m < MASU_MESO_LEVELS; m++) {
            uint32_t size = masu_meso_level_size[m];
            masu_meso_texel *mip = masu_meso_mip(&study->made, size);
            average_down(want, fine, fine / size, numbers, reduced);
            for (shader.way = 0; shader.way < MASU_MESO_WAYS; shader.way++) {
                memset(got, 0, all * sizeof *got);
                for (uint32_t t = 0; t < size * size; t++) {
                    shade(&shader, &mip[t], v, azimuth, &lights, 1, got + (size_t)t * numbers);
                }
                double e = relative_error(got, reduced, (size_t)size * size * numbers);
                double *sum = &study->verdict[i / AZIMUTHS].texel[m][shader.way];
                *sum = sqrt(*sum * *sum + e * e / AZIMUTHS);
            }
            free(mip);
        }
    }
    free(want);
    free(reduced);
    free(got);
}

/* ---- the shadow's distribution --------------------------------------------------------------- */

double masu_meso_bin_value(uint32_t bin) {
    return BIN_LOW + (BIN_HIGH - BIN_LOW) * (bin + 0.5) / MASU_MESO_BINS;
}

static void count_shadows(masu_meso_study *study, const masu_meso_tracer *tracer,
                          const masu_meso_patch *patch, const masu_meso_setup *setup) {
    const masu_meso_curves *c = &study->made.curves;
    uint32_t size = study->made.size, step = size / 32;
    for (uint32_t t = 0; t < 32 * 32; t++) {
        uint32_t x = t % 32 * step, y = t / 32 * step;
        const masu_meso_texel *texel = &study->made.texels[(size_t)y * size + x];
        masu_meso_vec3 n = {texel->normal[0], texel->normal[1], texel->normal[2]};
        masu_meso_vec3 from = {(x + 0.5) / size, patch->high + 1e-4, (y + 0.5) / size};
        masu_meso_hit h;
        if (!masu_meso_trace(tracer, from, masu_bake_v3(0, -1, 0), &h)) continue;
        for (uint32_t j = 0; j < setup->light_count; j++) {
            masu_meso_vec3 l = masu_meso_light_direction(&setup->light[j], t * 2.399963, 1);
            double n_l = masu_bake_dot(n, l);
            if (!(n_l > 0)) continue; /* unlit even without shadows */
            double f = c->offset - c->alpha * (1 - texel->ao);
            double at = (f - BIN_LOW) / (BIN_HIGH - BIN_LOW) * MASU_MESO_BINS;
            uint32_t bin = at < 0 ? 0 : at >= MASU_MESO_BINS ? MASU_MESO_BINS - 1 : (uint32_t)at;
            bool lit = masu_bake_dot(h.normal, l) > 0 &&
                       !masu_meso_blocked(tracer, h.position, h.normal, l);
            study->bins[bin].count += 1;
            study->bins[bin].lit += lit;
        }
    }
    for (uint32_t b = 0; b < MASU_MESO_BINS; b++) {
        if (study->bins[b].count > 0) study->bins[b].lit /= study->bins[b].count;
    }
}

/* ---- The study ------------------------------------------------------------------------------- */

bool masu_meso_study_run(const masu_meso_patch *patch, const masu_meso_options *options,
                         masu_meso_study *study) {
    *study = (masu_meso_study){0};
    if (!masu_meso_author(patch, options, &study->made)) return false;
    masu_meso_tracer *tracer = masu_meso_tracer_create(patch);
    if (!tracer) return false;
    masu_meso_setup judged = {
        .side = options->side, .sky_rays = options->sky_rays, .seed = options->seed + 7777};
    masu_meso_view views[MASU_MESO_VIEWS_MAX];
    set_judged(&judged);
    masu_cli_progress("measuring under other lights");
    bool good = masu_meso_measure(tracer, patch, &judged, views);
    if (good) {
        judge_far(study, &judged, views);
        judge_mips(study, &judged);
        judge_texels(study, tracer, patch, &judged);
        count_shadows(study, tracer, patch, &judged);
    } else {
        masu_cli_error("no ray hits the patch");
    }
    masu_cli_progress_clear();
    masu_meso_tracer_free(tracer);
    return good;
}

void masu_meso_study_free(masu_meso_study *study) { masu_meso_material_free(&study->made); }

double masu_meso_study_gain(const masu_meso_study *study, double *angle) {
    double least = 1e300;
    for (uint32_t i = 0; i < MASU_MESO_JUDGED; i++) {
        const double *e = study->verdict[i].far;
        double gain = e[MASU_MESO_PLAIN] / fmax(e[MASU_MESO_CURVES], 1e-9);
        if (gain < least) {
            least = gain;
            *angle = masu_meso_judged[i];
        }
    }
    return least;
}
