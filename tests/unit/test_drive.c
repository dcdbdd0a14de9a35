/* test_drive.c: the game's physics, without rendering: the track file of the test scene, laps,
 * barriers, the other cars. */
#include "../../examples/drive/race.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

#define TRACK "tests/scenes/test_drive.track"

static track road;
static race r;

static void places_are_found_again(void **state) {
    (void)state;
    for (double along = 0; along < road.length; along += 1.7) {
        for (double side = -4; side <= 4; side += 4) {
            track_place p = track_along(&road, along, side),
                        found = track_find(&road, p.ground, -1);
            /* The road is straight between two points, and a position next to a corner has two
             * solutions. */
            assert_true(fabs(found.along - along) < 0.8 ||
                        fabs(found.along - along) > road.length - 0.8);
            assert_true(fabs(found.side - side) < 0.1);
        }
    }
    track_place last = track_along(&road, -1, 0);
    assert_true(last.along > road.length - 1.01 && last.point == road.count - 1);
}

static void ground_rises_from_the_edge_to_the_barrier(void **state) {
    (void)state;
    static track hilly;
    hilly = road;
    for (int i = 0; i < hilly.count; i++) hilly.points[i].rise[1] = -2; /* on the right: a ditch */
    assert_true(fabs(track_along(&hilly, 30, 4.9).ground.y) < 1e-9);
    assert_true(fabs(track_along(&hilly, 30, 7).ground.y + 1) < 1e-9);
    assert_true(fabs(track_along(&hilly, 30, 9).ground.y + 2) < 1e-9);
    assert_true(fabs(track_along(&hilly, 30, -7).ground.y) < 1e-9);
}

static void a_lap_counts_once(void **state) {
    (void)state;
    race_start(&r, &road);
    double started = r.cars[0].travelled;
    for (int i = 0; i < 60 * 60 && r.laps < 2; i++) {
        car_input in = race_autopilot(&r, 0);
        race_step(&r, &in, 1.0 / 60);
        assert_false(r.cars[0].off);
    }
    assert_int_equal(r.laps, 2);
    assert_true(r.best > 20 && r.best < 40);
    assert_true(r.cars[0].travelled >= 2 * road.length && started < road.length);
    /* Back over the line and forward again: no third lap. */
    for (int i = 0; i < 240; i++) race_step(&r, &(car_input){.brake = 1}, 1.0 / 60);
    assert_true(r.cars[0].travelled < 2 * road.length && car_speed(&r.cars[0]) < -3);
    for (int i = 0; i < 240; i++) race_step(&r, &(car_input){.throttle = 1}, 1.0 / 60);
    assert_true(r.cars[0].travelled > 2 * road.length);
    assert_int_equal(r.laps, 2);
}

static void barriers_hold(void **state) {
    (void)state;
    for (int way = -1; way <= 1; way++) {
        race_start(&r, &road);
        bool reached = false;
        for (int i = 0; i < 1200; i++) {
            race_step(&r, &(car_input){.throttle = 1, .steer = way}, 1.0 / 60);
            const car *c = &r.cars[0];
            reached = reached || fabs(c->place.side) > c->place.barrier - 1.1;
            assert_true(fabs(c->place.side) <= c->place.barrier - 0.9);
            assert_true(isfinite(c->at.x) && isfinite(c->heading) && fabs(car_speed(c)) < 80);
        }
        assert_true(reached);
    }
}

static void tyres_skid_when_locked_spinning_or_sliding(void **state) {
    (void)state;
    race_start(&r, &road);
    const car *c = &r.cars[0];
    race_step(&r, &(car_input){.throttle = 0.5}, 1.0 / 60);
    assert_true(c->skid == 0 && !c->braking);
    for (int i = 0; i < 15; i++) race_step(&r, &(car_input){.throttle = 1}, 1.0 / 60);
    assert_true(c->skid > 0.3); /* spinning */
    for (int i = 0; i < 60; i++) race_step(&r, &(car_input){.throttle = 1}, 1.0 / 60);
    assert_true(c->skid == 0);
    race_step(&r, &(car_input){.brake = 0.5}, 1.0 / 60);
    assert_true(c->skid == 0 && c->braking);
    race_step(&r, &(car_input){.brake = 1}, 1.0 / 60);
    assert_true(c->skid > 0.3 && c->braking); /* locked */
    double across[2];
    for (int hand = 0; hand < 2; hand++) {
        race_start(&r, &road);
        for (int i = 0; i < 90; i++) race_step(&r, &(car_input){.throttle = 1}, 1.0 / 60);
        for (int i = 0; i < 20; i++)
            race_step(&r, &(car_input){.steer = -1, .hand = hand}, 1.0 / 60);
        across[hand] = fabs(dot(c->velocity, cross(c->ahead, c->up)));
        assert_true((c->skid > 0.3) == (hand == 1));
    }
    assert_true(across[1] > 1.5 * across[0]);
}

static void grass_is_slow(void **state) {
    (void)state;
    double speed[2];
    for (int grass = 0; grass < 2; grass++) {
        race_start(&r, &road);
        if (grass) r.cars[0].at.z += 4; /* 27 + 4: 6 m from the centre line; the edge is at 5 */
        for (int i = 0; i < 150; i++) race_step(&r, &(car_input){.throttle = 1}, 1.0 / 60);
        assert_int_equal(r.cars[0].off, grass);
        speed[grass] = car_speed(&r.cars[0]);
    }
    assert_true(speed[1] < 0.7 * speed[0]);
}

static void the_others_drive_the_lap(void **state) {
    (void)state;
    race_start(&r, &road);
    for (int i = 0; i < 60 * 40; i++) {
        race_step(&r, &(car_input){0}, 1.0 / 60);
        for (int k = 1; k < 3; k++) assert_false(r.cars[k].off);
    }
    for (int k = 1; k < 3; k++) assert_true(r.cars[k].travelled > road.length);
}

static void the_same_drive_twice(void **state) {
    (void)state;
    static race first;
    for (int run = 0; run < 2; run++) {
        race_start(&r, &road);
        for (int i = 0; i < 600; i++) {
            car_input in = race_autopilot(&r, 0);
            race_step(&r, &in, 1.0 / 60);
        }
        if (!run) first = r;
    }
    assert_memory_equal(&r.cars[0].at, &first.cars[0].at, sizeof first.cars[0].at);
    assert_true(r.distance == first.distance && r.distance > 50);
}

/* The real file with another header. */
static bool takes(const char *head, size_t bytes) {
    static char text[1 << 16];
    static track t;
    const char *copy = "build/test_drive.track";
    FILE *in = fopen(TRACK, "r"), *out = fopen(copy, "w");
    assert_true(in && out);
    size_t all = fread(text, 1, sizeof text, in), skip = strlen("masu-track 1\npoints 80\n");
    fputs(head, out);
    fwrite(text + skip, 1, bytes < all - skip ? bytes : all - skip, out);
    fclose(in);
    fclose(out);
    bool taken = track_read(&t, copy);
    remove(copy);
    return taken;
}

static void what_is_no_track_is_refused(void **state) {
    (void)state;
    assert_true(takes("masu-track 1\npoints 80\n", SIZE_MAX));
    assert_false(takes("masu-track 2\npoints 80\n", SIZE_MAX));
    assert_false(takes("masu-road 1\npoints 80\n", SIZE_MAX));
    assert_false(takes("masu-track 1\npoints 79\n", SIZE_MAX));
    assert_false(takes("masu-track 1\npoints 81\n", SIZE_MAX));
    assert_false(takes("masu-track 1\npoints 4097\n", SIZE_MAX));
    assert_false(takes("masu-track 1\npoints 80\n", 1000));
    assert_false(takes("masu-track 1\npoints 80\nnan ", SIZE_MAX));
    static track none;
    assert_false(track_read(&none, "no/such.track"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(places_are_found_again),
        cmocka_unit_test(ground_rises_from_the_edge_to_the_barrier),
        cmocka_unit_test(a_lap_counts_once),
        cmocka_unit_test(barriers_hold),
        cmocka_unit_test(tyres_skid_when_locked_spinning_or_sliding),
        cmocka_unit_test(grass_is_slow),
        cmocka_unit_test(the_others_drive_the_lap),
        cmocka_unit_test(the_same_drive_twice),
        cmocka_unit_test(what_is_no_track_is_refused),
    };
    if (!track_read(&road, TRACK)) return 1;
    return cmocka_run_group_tests_name("drive", tests, NULL, NULL);
}
