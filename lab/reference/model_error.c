/* model_error.c: see model_error.h. */
#include "lab/reference/model_error.h"

#include "lab/reference/bsdf.h"

#include <string.h>

/* Cells of the hemisphere, equal in projected solid angle. */
enum { RINGS = 8, SECTORS = 16, PARTS = RINGS * SECTORS };

typedef struct light {
    double part[PARTS], sum, square;
} light;

static void add(light *to, ref_vec l, double value) {
    double out = ref_clamp(l.x * l.x + l.y * l.y, 0, 1 - 1e-9);
    /* The mirror direction is at the centre of a sector. */
    int sector = (int)((atan2(l.y, l.x) / REF_PI + 1) / 2 * SECTORS + 0.5) % SECTORS;
    to->part[(int)(out * RINGS) * SECTORS + sector] += value;
    to->sum += value;
    to->square += value * value;
}

static void compare(FILE *to, const char *name, const ref_surface *s, double cosine, uint32_t paths,
                    uint64_t seed) {
    static const char row[] = "%s,%g,%g,%.4f,%.4f,%.1f,%.1f,%.1f\n";
    light light_of[2];
    ref_vec v = ref_v(sqrt(1 - cosine * cosine), 0, cosine);
    ref_bsdf b[2];
    memset(light_of, 0, sizeof light_of);
    for (int k = 0; k < 2; k++) ref_bsdf_make(&b[k], s, v, k == 1);
    for (uint32_t i = 0; i < paths; i++) {
        ref_random r = ref_random_at(seed, 0, i);
        ref_lobes lobes;
        ref_vec l, weight;
        if (ref_bsdf_sample(&b[0], &r, &l, &lobes))
            add(&light_of[0], l, ref_lobes_sum(&lobes).x / paths);
        if (ref_layers_sample(&b[1], &r, &l, &weight)) add(&light_of[1], l, weight.x / paths);
    }
    ref_lobes albedo = ref_bsdf_albedo(&b[0]);
    double design = ref_lobes_sum(&albedo).x, walked = light_of[1].sum, elsewhere = 0;
    for (int i = 0; i < PARTS; i++)
        elsewhere += 0.5 * fabs(light_of[0].part[i] - light_of[1].part[i]);
    double noise = sqrt(fmax(light_of[1].square - walked * walked / paths, 0));
    fprintf(to, row, name, s->roughness, cosine, design, walked, 100 * (design / walked - 1),
            100 * elsewhere / walked, 100 * noise / walked);
}

void ref_model_error(FILE *to, uint32_t paths, uint64_t seed) {
    static const struct {
        const char *name;
        double albedo, metallic, coat, coat_roughness;
    } kinds[] = {{"metal 0.9", .9, 1, 0, 0},
                 {"metal 0.5", .5, 1, 0, 0},
                 {"dielectric 0.8", .8, 0, 0, 0},
                 {"dielectric 0.2", .2, 0, 0, 0},
                 {"dielectric 0", 0, 0, 0, 0},
                 {"half metal 0.8", .8, .5, 0, 0},
                 {"coated metal 0.9", .9, 1, 1, .1},
                 {"coated dielectric 0.5", .5, 0, 1, .1},
                 {"rough coat on metal 0.9", .9, 1, 1, .5}};
    static const double roughness[] = {.1, .2, .4, .6, .8, 1}, cosines[] = {.1, .25, .5, .75, 1};
    ref_ggx_tables();
    fprintf(to, "material,roughness,cosine,design,physics,error_percent,elsewhere_percent,"
                "noise_percent\n");
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        for (size_t k = 0; k < 6; k++) {
            ref_surface s = {.albedo = ref_splat(kinds[i].albedo),
                             .roughness = roughness[k],
                             .metallic = kinds[i].metallic,
                             .specular = 0.5,
                             .coat = kinds[i].coat,
                             .coat_roughness = kinds[i].coat_roughness,
                             .occlusion = 1,
                             .normal = ref_v(0, 0, 1),
                             .coat_normal = ref_v(0, 0, 1)};
            for (size_t n = 0; n < 5; n++) compare(to, kinds[i].name, &s, cosines[n], paths, seed);
        }
    }
}
