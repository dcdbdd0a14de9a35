/* cars.c: the ten cars of forza, each a body and four wheels, on the road.
 *
 * A car's XML has the positions of its wheels, in the space of the body's model: x ahead, y to the
 * left (our -z), the road "ride height" below the origin. Wheels are models of one metre in every
 * direction with the rim's face at -z; they are scaled to the height and width of the tyres. Three
 * of the cars name no wheel: TORCS draws a textured disc for them, we use one of its stock
 * wheels.
 *
 * A car's height and tilt come from the plane through the ground below its wheels. */
#include "lab/world/world.h"

#include "bake/base/file.h"
#include "bake/import/import.h"
#include "cli/cli.h"

#include <stdlib.h>
#include <string.h>

#define INCH 0.0254
#define BRAKE_HEIGHT 0.78 /* of the brake lights above the road, metres */

typedef struct wheel {
    double x, left; /* of its centre, from the body's origin */
    double radius, width;
} wheel;

typedef struct car {
    wheel wheels[4]; /* front right, front left, rear right, rear left */
    double clearance;
    char rim[64];
} car;

static bool read_wheels(const char *text, car *out) {
    static const char *const names[4] = {"Front Right Wheel", "Front Left Wheel",
                                         "Rear Right Wheel", "Rear Left Wheel"};
    for (int i = 0; i < 4; i++) {
        const char *axle_end, *end;
        const char *axle = masu_world_section(text, i < 2 ? "Front Axle" : "Rear Axle", &axle_end);
        const char *at = masu_world_section(text, names[i], &end);
        if (!axle || !at) return false;
        wheel *w = &out->wheels[i];
        w->x = masu_world_number(axle, axle_end, "xpos", 0);
        w->left = masu_world_number(at, end, "ypos", 0);
        w->width = masu_world_number(at, end, "tire width", 0) / 1000;
        w->radius = masu_world_number(at, end, "rim diameter", 0) / 2 * INCH +
                    w->width * masu_world_number(at, end, "tire height-width ratio", 0);
        out->clearance += masu_world_number(at, end, "ride height", 100) / 1000 / 4;
        if (!(w->radius > 0.1 && w->radius < 2 && w->width > 0.05 && w->width < 2 &&
              fabs(w->x) < 10 && fabs(w->left) > 0.1 && fabs(w->left) < 10)) {
            return false;
        }
    }
    return out->wheels[0].x > out->wheels[2].x && out->wheels[1].left > out->wheels[0].left;
}

static bool read_car(const char *torcs, const char *name, const char *otherwise, car *out) {
    char place[128];
    snprintf(place, sizeof place, "cars/%s/%s.xml", name, name);
    char *path = masu_bake_join(torcs, place);
    masu_bake_buffer text = {0};
    bool good = masu_bake_read_file(path, 16 << 20, &text);
    if (good) {
        const char *t = (const char *)text.data;
        if (!masu_world_string(t, t + strlen(t), "3d wheel directory", out->rim, sizeof out->rim)) {
            snprintf(out->rim, sizeof out->rim, "%s", otherwise);
        }
        good = read_wheels(t, out);
        if (!good) masu_cli_error("%s: no four wheels that fit a car", path);
    }
    masu_bake_release(&text);
    free(path);
    return good;
}

/* The bounding box of a model. */
static bool measure(const char *path, masu_bake_box *box) {
    masu_bake_content piece = {0};
    bool good = masu_bake_import(path, MASU_BAKE_TEXTURES_WANTED, &piece);
    if (good) {
        masu_bake_affine identity = masu_bake_identity();
        *box = masu_bake_bounds(&piece, &identity);
        masu_bake_vec3 size = masu_bake_sub(box->high, box->low);
        good = size.x > 1e-3 && size.y > 1e-3 && size.z > 1e-3;
        if (!good) masu_cli_error("%s: the model is empty or flat", path);
    }
    masu_bake_content_release(&piece);
    return good;
}

/* A car's axes (ahead, up, and to its right) as a rotation about x, then y, then z. */
static masu_bake_vec3 angles_of(masu_bake_vec3 ahead, masu_bake_vec3 up, masu_bake_vec3 right) {
    double flat = hypot(ahead.x, ahead.y);
    masu_bake_vec3 a = {atan2(up.z, right.z), atan2(-ahead.z, flat), atan2(ahead.y, ahead.x)};
    if (flat < 1e-9) a = masu_bake_v3(atan2(-right.y, up.y), a.y, 0); /* x and z rotate alike */
    const double degrees = 180 / MASU_BAKE_PI;
    return masu_bake_v3(a.x * degrees, a.y * degrees, a.z * degrees);
}

/* more: members of the model, after a comma. */
static void place(FILE *out, const char *file, const char *name, masu_bake_vec3 angles,
                  masu_bake_vec3 scale, masu_bake_vec3 at, const char *more) {
    fprintf(out, ",\n    {\"file\": \"%s\", \"name\": \"%s\", \"moving\": true, ", file, name);
    if (scale.x != 1 || scale.y != 1 || scale.z != 1) {
        fprintf(out, "\"scale\": [%.4f, %.4f, %.4f], ", scale.x, scale.y, scale.z);
    }
    fprintf(out,
            "\"rotate\": [%.3f, %.3f, %.3f], \"translate\": [%.3f, %.3f, %.3f], \"merge\": 1000%s}",
            angles.x, angles.y, angles.z, at.x, at.y, at.z, more);
}

/* Brake lights: boxes in the rear of the body, which a program switches by masu_look.emission. The
 * origin of the body is `at`. */
static void brakes(FILE *out, int index, const masu_bake_box *body, masu_bake_vec3 angles,
                   masu_bake_vec3 at, const masu_bake_vec3 axes[3], double clearance) {
    for (int i = 0; i < 2; i++) {
        double side = (i ? -0.62 : 0.62) * body->high.z;
        masu_bake_vec3 p = masu_bake_mad(at, axes[0], body->low.x + 0.06);
        p = masu_bake_mad(masu_bake_mad(p, axes[1], BRAKE_HEIGHT - clearance), axes[2], side);
        fprintf(out,
                ",\n    {\"mesh\": {\"box\": {\"size\": [0.16, 0.11, 0.3]}}, \"name\": "
                "\"car%d/brake%d\", \"moving\": true,\n     \"rotate\": [%.3f, %.3f, %.3f], "
                "\"translate\": [%.3f, %.3f, %.3f], \"area_light\": false,\n     \"material\": "
                "{\"base_color\": [0.2, 0.01, 0.01], \"emissive\": [2.4, 0.036, 0.024]}}",
                index, i, angles.x, angles.y, angles.z, p.x, p.y, p.z);
    }
}

static bool put(FILE *out, FILE *road, const char *torcs, const char *name, int index, const car *c,
                masu_bake_vec3 at, double heading, masu_world_height height, void *user) {
    double ch = cos(heading), sh = sin(heading);
    double under[4];
    for (int i = 0; i < 4; i++) {
        const wheel *w = &c->wheels[i];
        under[i] =
            height(user, at.x + ch * w->x - sh * w->left, at.z - sh * w->x - ch * w->left, at.y);
    }
    /* The plane through four heights contains the mean of each pair. */
    double base = c->wheels[0].x - c->wheels[2].x;
    double track =
        (c->wheels[1].left - c->wheels[0].left + c->wheels[3].left - c->wheels[2].left) / 2;
    double front = (under[0] + under[1]) / 2, rear = (under[2] + under[3]) / 2;
    double slope = (front - rear) / base;
    double lean = (under[0] + under[2] - under[1] - under[3]) / 2 / track; /* up to the right */
    masu_bake_vec3 ahead = {ch, slope, -sh}, right = {sh, lean, ch};
    masu_bake_normalize(&ahead);
    masu_bake_vec3 up = masu_bake_cross(right, ahead);
    masu_bake_normalize(&up);
    right = masu_bake_cross(ahead, up);
    masu_bake_vec3 ground = {at.x, front - slope * c->wheels[0].x, at.z};
    masu_bake_vec3 angles = angles_of(ahead, up, right);

    char file[4096], label[32];
    snprintf(file, sizeof file, "%s/cars/%s/%s.acc", torcs, name, name);
    snprintf(label, sizeof label, "car%d", index);
    place(out, file, label, angles, masu_bake_v3(1, 1, 1),
          masu_bake_mad(ground, up, c->clearance),
          ",\n     \"material\": {\"roughness\": 0.35, \"coat\": 1, \"coat_roughness\": 0.05}");
    fprintf(road, "car %s  %.3f %.3f %.3f  %.6f %.6f %.6f  %.6f %.6f %.6f  %.3f\n", label, ground.x,
            ground.y, ground.z, ahead.x, ahead.y, ahead.z, up.x, up.y, up.z, c->clearance);
    masu_bake_box box;
    if (!measure(file, &box)) return false;
    brakes(out, index, &box, angles, masu_bake_mad(ground, up, c->clearance),
           (masu_bake_vec3[3]){ahead, up, right}, c->clearance);
    snprintf(file, sizeof file, "%s/wheels/%s/wheel0.acc", torcs, c->rim);
    if (!measure(file, &box)) return false;
    masu_bake_vec3 size = masu_bake_sub(box.high, box.low);
    for (int i = 0; i < 4; i++) {
        const wheel *w = &c->wheels[i];
        masu_bake_vec3 middle = masu_bake_mad(ground, ahead, w->x);
        middle = masu_bake_mad(masu_bake_mad(middle, right, -w->left), up, w->radius);
        /* On the right rotated, not mirrored: the tyres have writing. */
        double side = w->left > 0 ? 1 : -1;
        masu_bake_vec3 scale = {side * 2 * w->radius / size.x, 2 * w->radius / size.y,
                                side * w->width / size.z};
        snprintf(label, sizeof label, "car%d/wheel%d", index, i);
        place(out, file, label, angles, scale, middle, "");
        fprintf(road, "wheel %s  %.3f %.3f %.3f %d\n", label, w->x, -w->left, w->radius, i < 2);
    }
    return true;
}

bool masu_world_car(FILE *out, FILE *road, const char *torcs, int index, masu_bake_vec3 at,
                    double heading, masu_world_height height, void *user) {
    static const struct {
        const char *name, *wheel; /* for a car that names none */
    } cars[MASU_WORLD_CARS] = {
        {"155-DTM", "stock1-1"}, {"acura-nsx-sz", "stock1-3"}, {"car1-trb1", "trb1-1"},
        {"car2-trb1", "trb1-1"}, {"car3-trb1", "trb1-1"},      {"car4-trb1", "trb1-1"},
        {"car5-trb1", "trb1-1"}, {"car6-trb1", "trb1-1"},      {"car7-trb1", "trb1-1"},
        {"p406", "stock1-2"},
    };
    car c = {.clearance = 0};
    return read_car(torcs, cars[index].name, cars[index].wheel, &c) &&
           put(out, road, torcs, cars[index].name, index, &c, at, heading, height, user);
}
