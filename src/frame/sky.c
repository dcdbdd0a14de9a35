/* sky.c: see sky.h. Lengths in kilometres, coefficients per kilometre, in double precision: heights
 * of metres are differences of numbers as large as the earth's radius.
 *
 * Red, green and blue are sampled at the wavelengths 680, 550 and 440 nm. Coefficients of air
 * and ozone are from Bruneton and Neyret, Precomputed Atmospheric Scattering, EGSR 2008, and
 * Hillaire 2020. Aerosol: turbidity is (air + aerosol) / air of the vertical optical depth at
 * 550 nm (Preetham et al., A Practical Analytic Model for Daylight, SIGGRAPH 1999, section 3),
 * Angstrom's exponent 1.3. */
#include "frame/sky.h"

#include <math.h>
#include <string.h>

#include "frame/sky_table.h"

#define PI 3.14159265358979323846
#define EARTH 6360.0
#define TOP 90.0       /* nothing above scatters visibly */
#define EYE 0.2        /* where all views start */
#define AIR_SCALE 8.0  /* height over which density falls by e */
#define HAZE_SCALE 1.2
#define HAZE_ALBEDO 0.92
#define HAZE_ASYMMETRY 0.76
/* Half of the angle over which the earth's edge takes the sun away from a point of the air,
 * radians: the sun's radius is 0.0047. Wider, so that the shadow's edge does not jump from one
 * point of the integral to the next as the sun sets. */
#define AIR_PENUMBRA 0.010
#define DISC_RADIUS 0.0047
/* Minimum radiance without a sun, for displays; not a physical value. */
#define NIGHT 1.5e-4

#define STEPS 16        /* of a view that leaves the air */
#define GROUND_STEPS 8 /* for a ray that hits the ground */
#define SERIES_STEPS 8
#define AZIMUTHS 3 /* towards the sun, across, away from it */
#define HALF (MASU_SKY_ROWS / 2)

static const double air_coefficient[3] = {5.802e-3, 13.558e-3, 33.1e-3};
static const double ozone_coefficient[3] = {0.650e-3, 1.881e-3, 0.085e-3};
/* One shell with the column of their tent. */
#define OZONE_LOW (EARTH + 15.0)
#define OZONE_HIGH (EARTH + 35.0)
#define OZONE_DENSITY 0.75
static const double night_color[3] = {0.55, 0.75, 1.0};

static double clamped(double v, double lo, double hi) { return v < lo ? lo : v > hi ? hi : v; }

/* fmax and fmin test for NaN, which costs a call each. */
static double most(double a, double b) { return a > b ? a : b; }
static double least(double a, double b) { return a < b ? a : b; }

static double smooth(double t) {
    t = clamped(t, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

/* Scattered and absorbed light per kilometre at the ground. */
static void haze_coefficient(double turbidity, double out[3]) {
    static const double wave[3] = {680.0 / 550.0, 1.0, 440.0 / 550.0};
    double depth = (turbidity - 1.0) * air_coefficient[1] * AIR_SCALE;
    for (uint32_t c = 0; c < 3; c++) out[c] = depth / HAZE_SCALE * pow(wave[c], -1.3);
}

/* ---- Depth towards the sun ------------------------------------------------------------------- */

/* exp(y^2) erfc(y) for y >= 0, within 0.3 % (Ren and MacKenzie, Atmospheric Science Letters 8,
 * 2007, equation 3). */
static double scaled_erfc(double y) {
    const float a = 2.911f, root = 1.77245385f;
    float t = root * (float)y;
    return (double)(a / ((a - 1.0f) * t + sqrtf(t * t + a * a)));
}

/* A point in the atmosphere and its values that do not depend on the sun. */
typedef struct air_point {
    double height, radius, root; /* root of the radius */
    double air, haze;            /* densities, 1 at the ground */
} air_point;

static air_point point_at(double height) {
    double r = EARTH + height;
    return (air_point){height, r, sqrt(r), exp(-height / AIR_SCALE), exp(-height / HAZE_SCALE)};
}

static double positive_root(double v) { return v > 0.0 ? sqrt(v) : 0.0; }

/* Optical path from a point through a density that falls by e over `scale`: Chapman's function
 * for rising rays (approximated as in Fitzmaurice, Applied Optics 3, 1964); a falling ray is the
 * whole ray through its lowest point minus the part behind the point. `low` is that point's
 * height. */
static double slant(const air_point *at, double density, double mu, double low, double scale) {
    double root = sqrt(0.5 * PI * scale), to_erfc = sqrt(0.5 / scale);
    double up = density * root * at->root * scaled_erfc(to_erfc * at->root * fabs(mu));
    if (mu >= 0.0) return up;
    return most(2.0 * (double)expf((float)(-low / scale)) * root * sqrt(EARTH + low) - up, 0.0);
}

/* The same of ozone: chords of its shell. */
static double ozone_slant(double r, double mu, double p2) {
    double at = r * fabs(mu);
    double low = positive_root(OZONE_LOW * OZONE_LOW - p2);
    double high = positive_root(OZONE_HIGH * OZONE_HIGH - p2);
    double above = most(high, at) - most(low, at);
    return OZONE_DENSITY * (mu >= 0.0 ? above : 2.0 * (high - low) - above);
}

/* The share of the sun above the earth's edge; `half` is half of the angle of the transition. */
static double above_edge(const air_point *at, double mu, double half) {
    if (mu > half) return 1.0;
    double edge = -positive_root(at->height * (EARTH + at->radius)) / at->radius;
    return smooth(0.5 + 0.5 * (mu - edge) / half);
}

static void sun_light(const air_point *at, double mu, const double haze[3], double half,
                      double out[3]) {
    double seen = above_edge(at, mu, half);
    out[0] = out[1] = out[2] = 0.0;
    if (!(seen > 0.0)) return;
    double p2 = at->radius * at->radius * (1.0 - mu * mu);
    double low = mu < 0.0 ? most(positive_root(p2) - EARTH, -2.0 * HAZE_SCALE) : 0.0;
    double air = slant(at, at->air, mu, low, AIR_SCALE);
    double aerosol = slant(at, at->haze, mu, low, HAZE_SCALE);
    double ozone = ozone_slant(at->radius, mu, p2);
    for (uint32_t c = 0; c < 3; c++) {
        double depth =
            air_coefficient[c] * air + haze[c] * aerosol + ozone_coefficient[c] * ozone;
        out[c] = seen * (double)expf((float)-depth);
    }
}

void masu_sky_transmittance(double height, double mu, double turbidity, double out[3]) {
    double haze[3];
    air_point at = point_at(height);
    haze_coefficient(turbidity, haze);
    sun_light(&at, mu, haze, DISC_RADIUS, out);
}

/* ---- A path through the air ------------------------------------------------------------------ */

/* Samples along a ray with the length of their segments. */
typedef struct air_step {
    air_point at;
    double distance;
    double air[3], haze[3]; /* scattering coefficients there */
    double weight[3];       /* light scattered there times this arrives at the ray's start */
} air_step;

typedef struct air_path {
    air_step steps[STEPS];
    uint32_t count;
    int ground;
    double length;
    double left[3]; /* transmittance from the segment's end */
} air_path;

/* The ray from `height` upwards by the sine `mu`. Pieces grow with the cube of their number:
 * density is greatest near the ground. Within one, light is scattered and lost evenly (Hillaire,
 * Physically Based Sky, Atmosphere and Cloud Rendering in Frostbite, SIGGRAPH 2016 course,
 * section 5.6.3). */
static void build_path(double height, double mu, const double haze[3], uint32_t steps,
                       uint32_t ground_steps, air_path *path) {
    double r = EARTH + height, b = r * mu;
    double to_ground = b * b - height * (EARTH + r);
    double top = EARTH + TOP;
    path->ground = mu < 0.0 && to_ground >= 0.0;
    path->length = path->ground ? most(-b - sqrt(to_ground), 0.0)
                                : sqrt(most(b * b + (top - r) * (top + r), 0.0)) - b;
    path->count = path->ground ? ground_steps : steps;
    path->left[0] = path->left[1] = path->left[2] = 1.0;
    double before = 0.0;
    for (uint32_t i = 0; i < path->count; i++) {
        air_step *s = &path->steps[i];
        double t = (double)(i + 1) / path->count, m = ((double)i + 0.5) / path->count;
        double end = path->length * t * t * t;
        double d = s->distance = path->length * m * m * m;
        double radius = sqrt(most(r * r + d * d + 2.0 * b * d, EARTH * EARTH));
        s->at = point_at(
            most((height * (EARTH + r) + d * d + 2.0 * b * d) / (radius + EARTH), 0.0));
        double ozone = radius > OZONE_LOW && radius < OZONE_HIGH ? OZONE_DENSITY : 0.0;
        for (uint32_t c = 0; c < 3; c++) {
            s->air[c] = air_coefficient[c] * s->at.air;
            s->haze[c] = haze[c] * s->at.haze;
            double lost = s->air[c] + s->haze[c] + ozone_coefficient[c] * ozone;
            double passes = (double)expf((float)(-lost * (end - before)));
            s->haze[c] *= HAZE_ALBEDO;
            s->weight[c] = lost > 1e-12 ? path->left[c] * (1.0 - passes) / lost
                                        : path->left[c] * (end - before);
            path->left[c] *= passes;
        }
        before = end;
    }
}

/* Cosine of the sun's zenith angle at a distance on the path. cosine: of the angle between the
 * view's and the sun's azimuth times both sines of zenith angles. */
static double sun_there(double start, double mu, double distance, double radius, double cosine,
                        double sun_y) {
    double y = (start + distance * mu) * sun_y;
    return clamped((y + distance * cosine) / radius, -1.0, 1.0);
}

/* ---- Scattered more than once ---------------------------------------------------------------- */

/* Nodes: heights as squares, zenith cosines of the sun from FALLEN to 1, close together at the
 * horizon. */
#define FALLEN 0.30

static double node_height(uint32_t i) {
    double t = (double)i / (MASU_SKY_HEIGHTS - 1);
    return 50.0 * t * t;
}

static double mu_to_node(double mu) {
    double low = -sqrt(FALLEN), t = mu < 0.0 ? -sqrt(-mu) : sqrt(mu);
    return clamped((t - low) / (1.0 - low), 0.0, 1.0) * (MASU_SKY_SUNS - 1);
}

static double node_mu(uint32_t j) {
    double low = -sqrt(FALLEN), t = low + (1.0 - low) * j / (MASU_SKY_SUNS - 1);
    return t * fabs(t);
}

/* One node of the table: radiance from all directions at a point after one more scattering
 * event, and the share that the next event passes on; the geometric series gives the sum. Four
 * rings of directions, three of each on one side of the sun. */
static void series(masu_sky *sky, uint32_t i, uint32_t j, const double haze[3]) {
    /* Gauss-Legendre over the cosine, order 4 (Abramowitz and Stegun, 25.4.30). */
    static const double node[4] = {-0.861136311594053, -0.339981043584856, 0.339981043584856,
                                   0.861136311594053};
    static const double weight[4] = {0.347854845137454, 0.652145154862546, 0.652145154862546,
                                     0.347854845137454};
    double height = node_height(i), sun_y = node_mu(j);
    double start = EARTH + height, second[3] = {0, 0, 0}, passed[3] = {0, 0, 0};
    double across = positive_root(1.0 - sun_y * sun_y);
    for (uint32_t ring = 0; ring < 4; ring++) {
        air_path path;
        double mu = node[ring];
        build_path(height, mu, haze, SERIES_STEPS, SERIES_STEPS, &path);
        for (uint32_t side = 0; side < 3; side++) {
            double cosine = cos(PI * (side + 0.5) / 3.0) * across * sqrt(1.0 - mu * mu);
            double share = weight[ring] / 6.0, light[3];
            for (uint32_t k = 0; k < path.count; k++) {
                const air_step *s = &path.steps[k];
                double there = sun_there(start, mu, s->distance, s->at.radius, cosine, sun_y);
                sun_light(&s->at, there, haze, AIR_PENUMBRA, light);
                for (uint32_t c = 0; c < 3; c++) {
                    double scattered = (s->air[c] + s->haze[c]) * s->weight[c];
                    second[c] += share * scattered * light[c] / (4.0 * PI);
                    passed[c] += share * scattered;
                }
            }
            sky->steps += path.count;
            if (!path.ground) continue;
            air_point level = point_at(0.0);
            double there = sun_there(start, mu, path.length, EARTH, cosine, sun_y);
            sun_light(&level, there, haze, AIR_PENUMBRA, light);
            for (uint32_t c = 0; c < 3; c++) {
                second[c] += share * path.left[c] * light[c] * most(there, 0.0) *
                             (double)sky->ground[c] / PI;
            }
        }
    }
    for (uint32_t c = 0; c < 3; c++)
        sky->multiple[i][j][c] = (float)(second[c] / (1.0 - least(passed[c], 0.98)));
}

static void multiple_at(const masu_sky *sky, double height, double mu, double out[3]) {
    double x = mu_to_node(mu), y = sqrt(least(height / 50.0, 1.0)) * (MASU_SKY_HEIGHTS - 1);
    uint32_t j = (uint32_t)least(x, MASU_SKY_SUNS - 2),
             i = (uint32_t)least(y, MASU_SKY_HEIGHTS - 2);
    x -= j, y -= i;
    /* Beyond the table night has fallen. */
    double night = smooth((mu + FALLEN) / 0.05);
    for (uint32_t c = 0; c < 3; c++) {
        double a = (double)sky->multiple[i][j][c], b = (double)sky->multiple[i][j + 1][c];
        double d = (double)sky->multiple[i + 1][j][c], e = (double)sky->multiple[i + 1][j + 1][c];
        out[c] = night * ((1.0 - y) * (a + x * (b - a)) + y * (d + x * (e - d)));
    }
}

/* ---- The table ------------------------------------------------------------------------------- */

typedef struct row_values {
    double term[AZIMUTHS][MASU_SKY_TERMS][3]; /* no direction, Rayleigh, aerosol */
    double ground[AZIMUTHS][3]; /* irradiance / pi of the sun on the ground there */
    double left[3]; /* transmittance of the ground's light; 0: the row does not see the ground */
} row_values;

/* The horizon from the height EYE is slightly below the level; the table's horizon is at the
 * level, where the scene's ground ends. */
static double row_sine(uint32_t row) {
    double t = ((double)row + 0.5 - HALF) / (HALF - 0.5), y = t * fabs(t);
    double dip = -sqrt(EYE * (2.0 * EARTH + EYE)) / (EARTH + EYE);
    return clamped(y > 0.0 ? dip + (1.0 - dip) * y : dip + (1.0 + dip) * y, -1.0, 1.0);
}

static void fill_row(masu_sky *sky, uint32_t row, const double haze[3], double sun_y,
                     row_values *out) {
    static const double azimuth[AZIMUTHS] = {1.0, 0.0, -1.0};
    const double unit = MASU_SKY_SUN * PI;
    double mu = row_sine(row), light[3], more[3];
    air_path path;
    build_path(EYE, mu, haze, STEPS, GROUND_STEPS, &path);
    memset(out, 0, sizeof *out);
    sky->steps += AZIMUTHS * path.count;
    double across = positive_root(1.0 - mu * mu) * positive_root(1.0 - sun_y * sun_y);
    for (uint32_t a = 0; a < AZIMUTHS; a++) {
        double cosine = azimuth[a] * across;
        for (uint32_t k = 0; k < path.count; k++) {
            const air_step *s = &path.steps[k];
            double there = sun_there(EARTH + EYE, mu, s->distance, s->at.radius, cosine, sun_y);
            sun_light(&s->at, there, haze, AIR_PENUMBRA, light);
            multiple_at(sky, s->at.height, there, more);
            for (uint32_t c = 0; c < 3; c++) {
                double w = unit * s->weight[c];
                out->term[a][0][c] += w * (s->air[c] + s->haze[c]) * more[c];
                out->term[a][1][c] += w * s->air[c] * light[c];
                out->term[a][2][c] += w * s->haze[c] * light[c];
            }
        }
        if (!path.ground) continue;
        air_point level = point_at(0.0);
        double there = sun_there(EARTH + EYE, mu, path.length, EARTH, cosine, sun_y);
        sun_light(&level, there, haze, AIR_PENUMBRA, out->ground[a]);
        for (uint32_t c = 0; c < 3; c++) {
            out->ground[a][c] *= MASU_SKY_SUN * most(there, 0.0);
            out->left[c] = path.left[c];
        }
    }
}

/* The polynomial through the logarithms at three azimuths: they are nearly linear, because
 * towards the sun the light falls off exponentially at dusk. If one side is in the earth's
 * shadow, the polynomial would exceed both ends in between; the dark end is raised until the
 * maximum is the bright end. */
static void store_row(masu_sky *sky, uint32_t row, const row_values *v) {
    masu_vec4 *to = &sky->uniforms.rows[row * MASU_SKY_ROW];
    for (uint32_t t = 0; t < MASU_SKY_TERMS; t++) {
        for (uint32_t c = 0; c < 3; c++) {
            double l[AZIMUTHS];
            for (uint32_t a = 0; a < AZIMUTHS; a++) l[a] = log2(most(v->term[a][t][c], 1e-9));
            if (l[1] <= l[0]) {
                l[2] = most(l[2], 4.0 * l[1] - 3.0 * l[0]);
            } else if (l[1] <= l[2]) {
                l[0] = most(l[0], 4.0 * l[1] - 3.0 * l[2]);
            }
            to[3 * t][c] = (float)l[1];
            to[3 * t + 1][c] = (float)(0.5 * (l[0] - l[2]));
            to[3 * t + 2][c] = (float)(0.5 * (l[0] + l[2]) - l[1]);
        }
    }
}

static void add_night(row_values *v) {
    for (uint32_t a = 0; a < AZIMUTHS; a++)
        for (uint32_t c = 0; c < 3; c++) v->term[a][0][c] += NIGHT * night_color[c];
}

/* ---- Irradiance ------------------------------------------------------------------------------ */

/* Squares of the basis's normalisation times the cosine lobe's share of the band: 1, 2/3, 1/4
 * (Ramamoorthi and Hanrahan, An Efficient Representation for Irradiance Environment Maps, SIGGRAPH
 * 2001, section 3). */
#define BAND_0 (1.0 / (4.0 * PI))
#define BAND_1 (3.0 / (4.0 * PI) * 2.0 / 3.0)
#define BAND_2 (15.0 / (4.0 * PI) / 4.0)
#define BAND_2_UP (5.0 / (16.0 * PI) / 4.0)
#define BAND_2_FLAT (15.0 / (16.0 * PI) / 4.0)

static const double band_scale[9] = {BAND_0, BAND_1, BAND_1,    BAND_1,     BAND_2,
                                     BAND_2, BAND_2, BAND_2_UP, BAND_2_FLAT};

static void basis(const double d[3], double out[9]) {
    out[0] = 1.0;
    for (uint32_t k = 0; k < 3; k++) out[1 + k] = d[k];
    for (uint32_t k = 0; k < 3; k++) out[4 + k] = d[k] * d[(k + 1) % 3];
    out[7] = 3.0 * d[1] * d[1] - 1.0;
    out[8] = d[0] * d[0] - d[2] * d[2];
}

/* Adds light from d with separate weights of band 0 and band 2. */
static void add_bands(masu_sky_irradiance *to, const double d[3], const double light[3],
                      const double even[3], const double two[3]) {
    double b[9];
    basis(d, b);
    for (uint32_t k = 0; k < 9; k++) {
        for (uint32_t c = 0; c < 3; c++) {
            double more = k == 0 ? even[c] : k >= 4 ? two[c] : 0.0;
            to->sh[k][c] += (float)(band_scale[k] * b[k] * (light[c] + more));
        }
    }
}

static double legendre_4(double c) {
    double c2 = c * c;
    return (35.0 * c2 * c2 - 30.0 * c2 + 3.0) / 8.0;
}

/* A clamped cosine with a round corner. */
static double lobe(double c) {
    const double w = (double)MASU_SKY_ROUND;
    double t = most(c + w, 0.0);
    return c > w ? c : t * t / (4.0 * w);
}

void masu_sky_irradiance_at(const masu_sky_irradiance *s, const float n[3], float out[3]) {
    const double d[3] = {(double)n[0], (double)n[1], (double)n[2]};
    double b[9];
    basis(d, b);
    double towards = d[0] * (double)s->direction[0] + d[1] * (double)s->direction[1] +
                     d[2] * (double)s->direction[2];
    for (uint32_t c = 0; c < 3; c++) {
        double sum = lobe(towards) * (double)s->glow[c] +
                     legendre_4(d[1]) * (double)s->ring[c];
        for (uint32_t k = 0; k < 9; k++) sum += b[k] * (double)s->sh[k][c];
        out[c] = (float)sum;
    }
}

/* Sample directions for the irradiance: midpoints of u over the elevation, with y = u^3 (4 -
 * 3u), dense at the horizon and, for a high sun's aureole, at the zenith. */
#define RINGS 24
#define RING_POINTS 14
#define GLOW_LOWEST 0.08

typedef struct sky_point {
    double direction[3]; /* below the sun: +x; the other side, -z, is the same */
    double light[3];     /* radiance times solid angle, of both sides */
} sky_point;

typedef struct sky_half {
    sky_point points[RINGS][RING_POINTS];
} sky_half;

/* One half of the sky: rings with y of that sign. */
static void look_around(const masu_sky *sky, double sun_y, double sign, sky_half *half) {
    double across = positive_root(1.0 - sun_y * sun_y);
    for (uint32_t r = 0; r < RINGS; r++) {
        double u = ((double)r + 0.5) / RINGS;
        double y = sign * u * u * u * (4.0 - 3.0 * u);
        double width = 12.0 * u * u * (1.0 - u) / RINGS;
        double flat = sqrt(1.0 - y * y);
        for (uint32_t p = 0; p < RING_POINTS; p++) {
            double angle = PI * ((double)p + 0.5) / RING_POINTS, x = cos(angle);
            sky_point *to = &half->points[r][p];
            float light[3];
            to->direction[0] = flat * x;
            to->direction[1] = y;
            to->direction[2] = flat * sin(angle);
            masu_sky_evaluate(&sky->uniforms, (float)y, (float)x,
                              (float)(flat * x * across + y * sun_y), light);
            for (uint32_t c = 0; c < 3; c++)
                to->light[c] = (double)light[c] * width * 2.0 * PI / RING_POINTS;
        }
    }
}

/* Irradiance / pi of the upper half on level ground. */
static void on_ground(const sky_half *half, double out[3]) {
    out[0] = out[1] = out[2] = 0.0;
    for (uint32_t r = 0; r < RINGS; r++) {
        for (uint32_t p = 0; p < RING_POINTS; p++) {
            for (uint32_t c = 0; c < 3; c++)
                out[c] += half->points[r][p].light[c] * half->points[r][p].direction[1] / PI;
        }
    }
}

/* In the frame with the sun over +x, terms odd in z cancel. */
static void add_half(masu_sky_irradiance *to, const sky_half *half) {
    static const uint32_t even[6] = {0, 1, 2, 4, 7, 8};
    for (uint32_t r = 0; r < RINGS; r++) {
        double sum[6][3], b[9];
        memset(sum, 0, sizeof sum);
        for (uint32_t p = 0; p < RING_POINTS; p++) {
            basis(half->points[r][p].direction, b);
            for (uint32_t k = 0; k < 6; k++)
                for (uint32_t c = 0; c < 3; c++)
                    sum[k][c] += b[even[k]] * half->points[r][p].light[c];
        }
        for (uint32_t k = 0; k < 6; k++) {
            for (uint32_t c = 0; c < 3; c++)
                to->sh[even[k]][c] += (float)(band_scale[even[k]] * sum[k][c]);
        }
    }
}

/* The residual of a clamped cosine after order 2 is its band 4, then 6 (the odd ones above 1 are
 * 0). Most of a sky's band 4 is the aureole around the sun, then the bright ring above the horizon.
 * So light equal to the sky's band 4 along the aureole's centre is moved from the coefficients to a
 * separate lobe, and the residual along the vertical is kept as a tenth function.
 *
 * The lobe is a clamped cosine whose corner is rounded over +-w, with w so that its bands 4 and
 * 6 relate to the clamped cosine's about as those of the aerosol's phase function do: (c + w)^2
 * / 4w for |c| < w, which has 1 + w^2 / 3, 1, 1 - 2/3 w^2 + w^4 / 5 and (1 - w^2)^3 times the
 * bands 0, 1, 2 and 4 of a clamped cosine. */
#define LOBE_0 (1.0 + ROUND * ROUND / 3.0)
#define LOBE_2 (1.0 - ROUND * ROUND * (2.0 / 3.0 - ROUND * ROUND / 5.0))
#define LOBE_4 ((1.0 - ROUND * ROUND) * (1.0 - ROUND * ROUND) * (1.0 - ROUND * ROUND))
#define ROUND ((double)MASU_SKY_ROUND)

/* Band 4 along d and along the vertical. */
static void measure_band_4(const sky_half *half, const double d[3], double glow[3],
                           double ring[3]) {
    for (uint32_t r = 0; r < RINGS; r++) {
        for (uint32_t p = 0; p < RING_POINTS; p++) {
            const double *at = half->points[r][p].direction;
            double along = legendre_4(d[0] * at[0] + d[1] * at[1]), up = legendre_4(at[1]);
            for (uint32_t c = 0; c < 3; c++) {
                glow[c] += along * half->points[r][p].light[c];
                ring[c] += up * half->points[r][p].light[c];
            }
        }
    }
}

/* Least squares of band 4 by its two zonal functions, along d and along the vertical. Where
 * these are one, at noon under the tropics, the ridge shares it evenly. */
static void take_band_4(masu_sky_irradiance *to, const double d[3], const double glow[3],
                        const double ring[3]) {
    const double ridge = 1.02;
    double mixed = legendre_4(d[1]), k[3], even[3], two[3];
    for (uint32_t c = 0; c < 3; c++) {
        double det = ridge * ridge - mixed * mixed;
        double along = (ridge * glow[c] - mixed * ring[c]) / det;
        double up = (ridge * ring[c] - mixed * glow[c]) / det;
        k[c] = along / LOBE_4;
        to->glow[c] = (float)(k[c] / PI);
        /* 9/2 of the integral of a clamped cosine times P4, -1/48 */
        to->ring[c] = (float)(-9.0 / 96.0 / PI * up);
        k[c] = -k[c];
        even[c] = k[c] * (LOBE_0 - 1.0);
        two[c] = k[c] * (LOBE_2 - 1.0);
    }
    add_bands(to, d, k, even, two);
}

/* The centre of the bright area: the sun, but never below GLOW_LOWEST, from which the light
 * arrives at dusk. */
static void glow_direction(double sun_y, double out[3]) {
    double above = sun_y - GLOW_LOWEST;
    out[1] = GLOW_LOWEST + 0.5 * (above + sqrt(above * above + 0.01));
    out[1] = least(out[1], 1.0);
    out[0] = sqrt(1.0 - out[1] * out[1]);
    out[2] = 0.0;
}

/* Rotates from the frame with the sun over +x to the world's; terms odd in z are 0. */
static void turn(masu_sky_irradiance *s, double x, double z) {
    for (uint32_t c = 0; c < 3; c++) {
        double across = (double)s->sh[1][c], tilted = (double)s->sh[4][c];
        double twice = (double)s->sh[8][c];
        s->sh[1][c] = (float)(across * x);
        s->sh[3][c] = (float)(across * z);
        s->sh[4][c] = (float)(tilted * x);
        s->sh[5][c] = (float)(tilted * z);
        s->sh[6][c] = (float)(4.0 * x * z * twice);
        s->sh[8][c] = (float)((x * x - z * z) * twice);
    }
}

/* ---- Update ---------------------------------------------------------------------------------- */

/* The disc sets at the horizon as seen from the camera, which the table puts at the level. */
static void sun_disc(masu_sky *sky, const double haze[3], double sun_y) {
    double light[3], seen = smooth(0.5 + 0.5 * sun_y / DISC_RADIUS);
    double dip = sqrt(EYE * (2.0 * EARTH + EYE)) / (EARTH + EYE);
    /* The visible part of the disc. */
    double middle = most(sun_y, 0.5 * (sun_y + DISC_RADIUS)) - dip * (1.0 - fabs(sun_y));
    air_point eye = point_at(EYE);
    sun_light(&eye, clamped(middle, -1.0, 1.0), haze, 1e-6, light);
    for (uint32_t c = 0; c < 3; c++) {
        sky->sun_color[c] = (float)(MASU_SKY_SUN * seen * light[c]);
        sky->uniforms.disc[c] = (float)((double)MASU_SKY_DISC * MASU_SKY_SUN * light[c]);
    }
}

static void update_sun(masu_sky *sky, const double haze[3]) {
    double sun_y = (double)sky->sun[1], flat = hypot((double)sky->sun[0], (double)sky->sun[2]);
    double x = flat > 1e-9 ? (double)sky->sun[0] / flat : 1.0;
    double z = flat > 1e-9 ? (double)sky->sun[2] / flat : 0.0;
    struct masu_sky_uniforms *u = &sky->uniforms;
    sky_half half;
    row_values rows[HALF];
    memcpy(u->sun, sky->sun, sizeof sky->sun);
    u->sun[3] = (float)HAZE_ASYMMETRY;
    u->azimuth[0] = (float)x;
    u->azimuth[1] = (float)z;
    u->azimuth[3] = 1.0f;
    masu_sky_irradiance *to = &sky->irradiance;
    double middle[3], glow[3] = {0, 0, 0}, ring[3] = {0, 0, 0};
    glow_direction(sun_y, middle);
    memset(to, 0, sizeof *to);
    for (uint32_t row = HALF; row < MASU_SKY_ROWS; row++) {
        fill_row(sky, row, haze, sun_y, &rows[0]);
        add_night(&rows[0]);
        store_row(sky, row, &rows[0]);
    }
    double below[3];
    look_around(sky, sun_y, 1.0, &half);
    on_ground(&half, below);
    add_half(to, &half);
    measure_band_4(&half, middle, glow, ring);
    for (uint32_t row = 0; row < HALF; row++) {
        fill_row(sky, row, haze, sun_y, &rows[row]);
        add_night(&rows[row]);
        for (uint32_t a = 0; a < AZIMUTHS; a++) {
            for (uint32_t c = 0; c < 3; c++) {
                rows[row].term[a][0][c] += rows[row].left[c] * (double)sky->ground[c] *
                                           (rows[row].ground[a][c] + below[c]);
            }
        }
        store_row(sky, row, &rows[row]);
    }
    masu_sky_tables(u);
    look_around(sky, sun_y, -1.0, &half);
    add_half(to, &half);
    measure_band_4(&half, middle, glow, ring);
    take_band_4(to, middle, glow, ring);
    turn(to, x, z);
    for (uint32_t k = 0; k < 3; k++)
        to->direction[k] = (float)(k == 1 ? middle[1] : middle[0] * (k ? z : x));
    sun_disc(sky, haze, sun_y);
}

int masu_sky_update(masu_sky *sky, const float sun[3], float turbidity, const float ground[3]) {
    double haze[3], s[3] = {(double)sun[0], (double)sun[1], (double)sun[2]};
    double length = sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
    float unit[3] = {0.0f, 1.0f, 0.0f}, albedo[3];
    if (length > 0.0 && isfinite(length))
        for (uint32_t k = 0; k < 3; k++) unit[k] = (float)(s[k] / length);
    /* These also replace NaN by a number. */
    turbidity = fminf(fmaxf(turbidity, MASU_SKY_TURBIDITY_MIN), MASU_SKY_TURBIDITY_MAX);
    for (uint32_t c = 0; c < 3; c++) albedo[c] = fminf(fmaxf(ground[c], 0.0f), 1.0f);
    int air = !sky->valid || memcmp(&turbidity, &sky->turbidity, sizeof turbidity) != 0 ||
              memcmp(albedo, sky->ground, sizeof albedo) != 0;
    if (!air && memcmp(unit, sky->sun, sizeof unit) == 0) return 0;
    sky->turbidity = turbidity;
    memcpy(sky->ground, albedo, sizeof albedo);
    memcpy(sky->sun, unit, sizeof unit);
    haze_coefficient((double)turbidity, haze);
    if (air) {
        for (uint32_t i = 0; i < MASU_SKY_HEIGHTS; i++)
            for (uint32_t j = 0; j < MASU_SKY_SUNS; j++) series(sky, i, j, haze);
        sky->air_updates++;
    }
    update_sun(sky, haze);
    sky->sun_updates++;
    sky->valid = 1;
    return 1;
}
