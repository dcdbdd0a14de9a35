/* threads.c: four renderers in four threads, each with its own instance, device and random live
 * calls. For the thread sanitizer (make threads): the library has no shared state, so threads with
 * their own renderers need no locks.
 *
 *     threads SCENE.masu [FRAMES]
 *
 * Every thread makes the same calls, at first alone and then beside the others, and must arrive at
 * the same pixels. Exit 0: it did. */
#include "session.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { THREADS = 4, WIDTH = 32, HEIGHT = 24, CALLS = 9, LIVES = 2 };

typedef struct renderer {
    const char *scene;
    uint32_t frames, random;
    uint32_t good, bad; /* calls that were obeyed, and refused by a named error */
    uint64_t hash;      /* of all pixels of all frames */
    char error[1024];   /* empty: none */
} renderer;

static uint32_t any(renderer *r, uint32_t below) {
    r->random = r->random * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)r->random * below >> 32);
}

static float number(renderer *r) { return (float)any(r, 1001) / 500.0f - 1.0f; }

static masu_result live_call(renderer *r, masu_renderer *m, masu_detail *d) {
    static const uint32_t texels[16 * 16] = {0xFF00FF00u, 0x80FF0000u};
    const masu_model model = masu_model_at(m, any(r, 8));
    const double place[3] = {(double)number(r), (double)number(r), (double)number(r)};
    switch (any(r, 9)) {
        case 0: return masu_instance_set_position(m, masu_instance_at(m, any(r, 12)), place, d);
        case 1: return masu_instance_show(m, masu_instance_at(m, any(r, 12)), any(r, 2), d);
        case 2: return masu_model_show(m, model, any(r, 2), d);
        case 3: {
            float rows[12] = {1, 0, 0, number(r), 0, 1, 0, number(r), 0, 0, 1, number(r)};
            masu_model out;
            return masu_model_add(m, model, rows, &out, d);
        }
        case 4: return masu_model_remove(m, model, d);
        case 5: {
            masu_punctual_light out;
            masu_punctual_light_state l = {.range = 4, .radius = 0.05f, .color = {1, 2, 1}};
            memcpy(l.position, place, sizeof place);
            return masu_punctual_light_add(m, &l, &out, d);
        }
        case 6: return masu_punctual_light_remove(m, masu_punctual_light_at(m, any(r, 4)), d);
        case 7: {
            const masu_material material = masu_material_at(m, any(r, 7));
            masu_material_state state;
            masu_result result = masu_material_get(m, material, &state, d);
            state.base_color[0] = (float)any(r, 2);
            return result ? result : masu_material_set(m, material, &state, d);
        }
        default: return masu_texture_write(m, any(r, 3), NULL, texels, 0, d);
    }
}

static bool draw(renderer *r, masu_session *s) {
    masu_frame_desc f = {MASU_FRAME_DESC, .time_step = 0.02f, .rung = any(r, 2)};
    masu_commands commands;
    if (!masu_session_frame(s, &f, true, &commands, r->error, sizeof r->error) ||
        !masu_headless_target_read(&s->host, &s->targets[0], r->error, sizeof r->error))
        return false;
    const uint8_t *pixels = s->targets[0].mapped;
    for (uint32_t i = 0; i < WIDTH * HEIGHT * 4; i++)
        r->hash = (r->hash ^ pixels[i]) * 0x100000001B3u;
    return true;
}

/* A renderer from its beginning to its end, LIVES times. */
static void *live(void *context) {
    renderer *r = context;
    masu_session s;
    r->random = 55, r->good = r->bad = 0, r->hash = 0xCBF29CE484222325u;
    bool good = true;
    for (uint32_t i = 0; i < LIVES && good; i++) {
        masu_session_desc d = {.scene_path = r->scene};
        d.desc.output = (VkExtent2D){WIDTH, HEIGHT};
        d.desc.targets.storage = 1;
        d.desc.rung_count = 2;
        d.desc.rungs[0] = (masu_rung){.scale = 1.0f};
        d.desc.rungs[1] = (masu_rung){.scale = 0.5f};
        d.desc.reserve = (masu_reserve){
            .models = 3, .lights = 3, .textures = 2, .texture_size = {16, 16}};
        d.desc.mutable_materials = d.desc.double_positions = 1;
        good = masu_session_open(&d, &s, r->error, sizeof r->error);
        if (!good) break;
        for (uint32_t k = 0; k < r->frames && good; k++) {
            good = draw(r, &s);
            for (uint32_t c = 0; c < CALLS && good; c++) {
                masu_detail detail;
                masu_result result = live_call(r, s.m, &detail);
                r->good += result == MASU_OK;
                r->bad += result != MASU_OK;
                good = result == MASU_OK || result == MASU_ERROR_ARGUMENT ||
                       result == MASU_ERROR_LIMIT || result == MASU_ERROR_STATE;
                if (!good) snprintf(r->error, sizeof r->error, "%s", detail.text);
            }
        }
        masu_session_close(&s);
    }
    if (good) *r->error = '\0'; /* a call that succeeds may have written to it */
    return NULL;
}

int main(int argc, char **argv) {
    static renderer alone, each[THREADS];
    pthread_t threads[THREADS];
    int wrong = 0;
    if (argc < 2) return 2;
    alone.scene = argv[1];
    alone.frames = argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 10) : 20;
    for (int i = 0; i < THREADS; i++) each[i] = alone;
    live(&alone);
    for (int i = 0; i < THREADS; i++)
        if (pthread_create(&threads[i], NULL, live, &each[i])) return 2;
    for (int i = 0; i < THREADS; i++) {
        pthread_join(threads[i], NULL);
        if (*each[i].error) printf("thread %d: %s\n", i, each[i].error), wrong = 1;
        if (each[i].hash != alone.hash) printf("thread %d has other pixels\n", i), wrong = 1;
    }
    printf("%d threads, %u frames each, %u live calls obeyed, %u refused\n", THREADS,
           LIVES * alone.frames, alone.good, alone.bad);
    if (*alone.error || !alone.good || !alone.bad) printf("alone: %s\n", alone.error), wrong = 1;
    return wrong;
}
