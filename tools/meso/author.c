/* author.c: see author.h. */
#include "meso/author.h"

#include <stdlib.h>
#include <string.h>

#include "cli/cli.h"

/* Texels that the fit uses one by one, and texels of the map of which it uses the mean, for
 * FIT_SIDE rays per side or more. Fewer rays reduce both proportionally, to a sixth at least: a
 * draft is a draft in both. */
#define FIT_TEXELS 144u
#define FINE_TEXELS 256u
#define FIT_SIDE 96u

void *masu_meso_allocated(size_t count, size_t bytes) {
    void *r = calloc(count, bytes);
    if (!r) exit(masu_cli_error("out of memory: %zu times %zu bytes", count, bytes));
    return r;
}

void masu_meso_set_lights(masu_meso_setup *s, const double *elevation, uint32_t elevations,
                       const double *azimuth, uint32_t azimuths) {
    s->light_count = 0;
    for (uint32_t i = 0; i < elevations; i++) {
        for (uint32_t j = 0; j < azimuths; j++) {
            s->light[s->light_count++] = (masu_meso_light){elevation[i], azimuth[j]};
        }
    }
}

#define COUNT(array) ((uint32_t)(sizeof(array) / sizeof *(array)))

/* Azimuths are denser near the mirror direction, where radiance changes fastest. */
static void set_fitted(masu_meso_setup *s) {
    static const double view[] = {0, 15, 30, 45, 60, 70, 80, 85, 88};
    static const double elevation[] = {5, 10, 20, 30, 45, 60, 80};
    static const double azimuth[] = {0, 15, 45, 75, 105, 135, 150, 165, 180};
    memcpy(s->view, view, sizeof view);
    s->view_count = COUNT(view);
    masu_meso_set_lights(s, elevation, COUNT(elevation), azimuth, COUNT(azimuth));
}

masu_meso_texel *masu_meso_mip(const masu_meso_material *made, uint32_t size) {
    masu_meso_texel *out = masu_meso_allocated((size_t)size * size, sizeof *out);
    uint32_t step = made->size / size;
    masu_meso_texel *block = masu_meso_allocated((size_t)step * step, sizeof *block);
    for (uint32_t t = 0; t < size * size; t++) {
        for (uint32_t i = 0; i < step * step; i++) {
            uint32_t x = t % size * step + i % step, y = t / size * step + i / step;
            block[i] = made->texels[(size_t)y * made->size + x];
        }
        out[t] = masu_meso_mean_texel(block, (size_t)step * step);
    }
    free(block);
    return out;
}

static uint32_t fit_share(uint32_t texels, uint32_t side) {
    if (side >= FIT_SIDE) return texels;
    return side * 6 > FIT_SIDE ? texels * side / FIT_SIDE : texels / 6;
}

/* Selects texels spread over the map, and computes their radiance from above. */
static void pick_texels(const masu_meso_material *made, const masu_meso_tracer *tracer,
                        const masu_meso_patch *patch, const masu_meso_options *options,
                        masu_meso_samples *samples) {
    enum { SIDE = 32 };
    static const double elevation[] = {10, 25, 45, 70}, azimuth[] = {0, 90, 180};
    masu_meso_setup lights = {.side = 3, .sky_rays = options->sky_rays, .seed = options->seed + 5};
    masu_meso_set_lights(&lights, elevation, COUNT(elevation), azimuth, COUNT(azimuth));
    uint32_t numbers = lights.light_count * 3, texel_count = fit_share(FIT_TEXELS, options->side);
    uint32_t fine_count = fit_share(FINE_TEXELS, options->side);
    double *all = masu_meso_allocated((size_t)SIDE * SIDE * numbers, sizeof *all);
    masu_meso_look_along(tracer, patch, &lights, 0, 0, made->height, MASU_MESO_SKY, SIDE, all);
    masu_meso_texel *texels = masu_meso_allocated(texel_count, sizeof *texels),
                    *mip = masu_meso_mip(made, SIDE);
    double *near = masu_meso_allocated((size_t)texel_count * numbers, sizeof *near);
    for (uint32_t t = 0; t < texel_count; t++) {
        uint32_t from = t * 1021 / texel_count;
        texels[t] = mip[from];
        memcpy(near + (size_t)t * numbers, all + (size_t)from * numbers, numbers * sizeof *near);
    }
    free(mip);
    free(all);
    masu_meso_texel *fine = masu_meso_allocated(fine_count, sizeof *fine);
    for (uint32_t t = 0; t < fine_count; t++) {
        double u, v;
        masu_meso_point(t, options->seed + 11, &u, &v);
        fine[t] =
            made->texels[(size_t)(v * made->size) * made->size + (size_t)(u * made->size)];
    }
    samples->fine = fine;
    samples->fine_count = fine_count;
    samples->texels = texels;
    samples->near = near;
    samples->texel_count = texel_count;
    samples->near_count = lights.light_count;
    memcpy(samples->near_light, lights.light, lights.light_count * sizeof *lights.light);
}

bool masu_meso_author(const masu_meso_patch *patch, const masu_meso_options *options,
                      masu_meso_material *made) {
    *made = (masu_meso_material){.size = options->size};
    masu_cli_progress("building the patch of %u triangles", patch->triangle_count);
    masu_meso_tracer *tracer = masu_meso_tracer_create(patch);
    if (!tracer) return false;
    made->texels = masu_meso_allocated((size_t)options->size * options->size, sizeof *made->texels);
    masu_cli_progress("measuring the view from above");
    masu_meso_look_down(tracer, patch, options->size, 2, options->sky_rays, options->seed,
                        made->texels, &made->height);
    made->mean = masu_meso_mean_texel(made->texels, (size_t)options->size * options->size);
    masu_meso_sky_table_make(&made->table);
    made->setup = (masu_meso_setup){
        .side = options->side, .sky_rays = options->sky_rays, .seed = options->seed};
    set_fitted(&made->setup);
    masu_cli_progress("measuring");
    bool good = masu_meso_measure(tracer, patch, &made->setup, made->views);
    if (good) {
        masu_meso_samples samples = {
            .setup = &made->setup, .views = made->views, .mean = made->mean};
        pick_texels(made, tracer, patch, options, &samples);
        made->curves = masu_meso_fit(&samples, &made->table, patch->roughness, &made->misfit);
        free((void *)samples.texels);
        free((void *)samples.near);
        free((void *)samples.fine);
    } else {
        masu_cli_error("no ray hits the relief");
    }
    masu_cli_progress_clear();
    masu_meso_tracer_free(tracer);
    return good;
}

void masu_meso_material_free(masu_meso_material *made) {
    free(made->texels);
    made->texels = NULL;
}
