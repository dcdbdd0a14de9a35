/* path.c: see path.h. */
#define _POSIX_C_SOURCE 200809L
#include "bake/light/path.h"

#include <float.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <string.h>
#include <unistd.h>

#define THREADS_MAX 64u

/* ---- numbers ---- */

/* The finaliser of SplitMix64 (Steele, Lea, Flood 2014). */
static uint64_t mixed(uint64_t x) {
    x += 0x9E3779B97F4A7C15u;
    x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9u;
    x = (x ^ x >> 27) * 0x94D049BB133111EBu;
    return x ^ x >> 31;
}

static float unit(uint64_t bits) { return (float)(bits >> 40) * 0x1p-24f; }

/* Pairs 0 and 1 are shifted Kronecker sequences. Their steps are the first two powers of 1 / r, r
 * the real root of r^3 = r + 1 for one, of r^4 = r + 1 for the other (Roberts 2018). From pair 2 on
 * they are random numbers, because low discrepancy has no benefit in that many dimensions. */
void masu_path_sample(uint64_t seed, uint32_t index, uint32_t pair, float out[2]) {
    static const uint64_t steps[2][2] = {{0xC13FA9A902A6328Fu, 0x91E10DA5C79E7B1Cu},
                                         {0xD1B54A32D192ED03u, 0xABC98388FB8FAC02u}};
    for (uint32_t k = 0; k < 2; k++) {
        uint64_t shift = mixed(seed ^ mixed(pair * 2u + k + 1));
        if (pair < 2) {
            out[k] = unit(shift + steps[pair][k] * index);
        } else {
            out[k] = unit(mixed(shift + index));
        }
    }
}

void masu_path_sphere(const float u[2], float out[3]) {
    float z = 1.0f - 2.0f * u[0], r = sqrtf(fmaxf(0.0f, 1.0f - z * z));
    float a = 6.2831853f * u[1];
    out[0] = r * cosf(a);
    out[1] = r * sinf(a);
    out[2] = z;
}

/* Duff et al., Building an Orthonormal Basis, Revisited (JCGT 6-1, 2017). */
void masu_path_cosine(const float n[3], const float u[2], float out[3]) {
    float r = sqrtf(u[0]), a = 6.2831853f * u[1];
    float x = r * cosf(a), y = r * sinf(a), z = sqrtf(fmaxf(0.0f, 1.0f - u[0]));
    float s = n[2] >= 0 ? 1.0f : -1.0f, p = -1.0f / (s + n[2]), q = n[0] * n[1] * p;
    const float b1[3] = {1.0f + s * n[0] * n[0] * p, s * q, -s * n[0]};
    const float b2[3] = {q, s + n[1] * n[1] * p, -n[1]};
    for (int k = 0; k < 3; k++) out[k] = x * b1[k] + y * b2[k] + z * n[k];
}

/* ---- paths ---- */

static float dot3(const float a[3], const float b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Adds the sunlight that the surface reflects. */
static uint64_t add_suns(const masu_bake_trace *trace, const masu_path_lights *l,
                         const masu_bake_hit *hit, const float through[3], float (*sum)[3]) {
    uint64_t rays = 0;
    for (uint32_t i = 0; i < l->suns; i++) {
        float facing = dot3(hit->normal, l->sun[i]);
        if (!(facing > 0)) continue;
        rays++;
        if (!masu_bake_trace_free(trace, hit->position, l->sun[i], FLT_MAX)) continue;
        for (int c = 0; c < 3; c++) sum[i][c] += through[c] * hit->albedo[c] * facing;
    }
    return rays;
}

uint64_t masu_path_radiance(const masu_bake_trace *trace, const masu_path_lights *l,
                            const float origin[3], const float direction[3], uint64_t seed,
                            uint32_t index, float scale, float (*sum)[3], masu_bake_hit *first) {
    float through[3] = {scale, scale, scale}, at[3], d[3];
    uint64_t rays = 0;
    memcpy(at, origin, sizeof at);
    memcpy(d, direction, sizeof d);
    for (uint32_t bounce = 0;; bounce++) {
        masu_bake_hit hit;
        rays++;
        bool met = masu_bake_trace_ray(trace, at, d, FLT_MAX, &hit);
        if (bounce == 0) {
            if (met) {
                *first = hit;
            } else {
                first->t = -1;
            }
        }
        if (!met) {
            float rgb[MASU_PATH_SETS_MAX * 3];
            if (!l->sky_sets) break;
            l->sky(l->context, d, rgb);
            for (uint32_t s = 0; s < l->sky_sets; s++) {
                for (int c = 0; c < 3; c++) sum[s][c] += through[c] * rgb[s * 3 + (uint32_t)c];
            }
            break;
        }
        for (int c = 0; c < 3; c++) sum[l->sky_sets][c] += through[c] * hit.emissive[c];
        rays += add_suns(trace, l, &hit, through, sum + l->sky_sets + 1);
        if (bounce + 1 >= l->bounces) break;
        float u[2], most = 0;
        for (int c = 0; c < 3; c++) {
            through[c] *= hit.albedo[c];
            most = fmaxf(most, hit.albedo[c]);
        }
        if (!(most > 0)) break;
        if (bounce >= 1) { /* Russian roulette: dark paths are continued less often */
            float kept = fminf(fmaxf(most, 0.1f), 1.0f);
            masu_path_sample(seed, index, bounce * 2 + 1, u);
            if (u[0] >= kept) break;
            for (int c = 0; c < 3; c++) through[c] /= kept;
        }
        masu_path_sample(seed, index, bounce == 0 ? 1 : bounce * 2, u);
        masu_path_cosine(hit.normal, u, d);
        memcpy(at, hit.position, sizeof at);
    }
    return rays;
}

/* ---- threads ---- */

typedef struct share {
    void (*work)(void *context, uint32_t item);
    void *context;
    uint32_t count;
    atomic_uint next;
} share;

static void *worker(void *data) {
    share *s = data;
    for (;;) {
        uint32_t item = atomic_fetch_add(&s->next, 1);
        if (item >= s->count) return NULL;
        s->work(s->context, item);
    }
}

void masu_path_share(uint32_t count, uint32_t threads, void (*work)(void *context, uint32_t item),
                     void *context) {
    share s = {.work = work, .context = context, .count = count};
    atomic_init(&s.next, 0);
    if (!threads) {
        long there = sysconf(_SC_NPROCESSORS_ONLN);
        threads = there > 0 ? (uint32_t)there : 1;
    }
    if (threads > THREADS_MAX) threads = THREADS_MAX;
    pthread_t others[THREADS_MAX];
    uint32_t started = 0;
    while (started + 1 < threads && !pthread_create(&others[started], NULL, worker, &s)) started++;
    worker(&s);
    for (uint32_t i = 0; i < started; i++) pthread_join(others[i], NULL);
}
