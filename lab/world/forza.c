/* forza.c: the track forza of TORCS (Debian's torcs-data) with ten cars and a lap.
 *
 * The centre line comes from the track's XML, as TORCS reads it: straights by length, curves by arc
 * and two radii between which the radius changes evenly. TORCS's plane x-y is our x-(-z). The
 * heights come from the model: at each point the triangle nearest to the previous height. The model
 * has another origin than the XML; the offset was found by fitting the path to the road's triangles
 * (99.5 % of points up to 4.5 m to each side are then on them).
 *
 *   grounds  road, grass and sand get the reliefs asphalt, grass and gravel of masu-meso, whose
 *            files must be in the scene's folder; their colours are the track's
 *   camera   a lap at 50 m/s from 0 s on; then, for images, the stands ("crowd") and a view
 *            from above ("high"); their times are printed
 *   lights   two spots that are off, "head0" and "head1", which a program may attach to a car.
 *            forza_night.json has the same track at night, with lamps along it
 *   skid     a hidden model with the material of the skid marks, whose meshes a program creates
 *   plain    grass below the track, to the horizon: TORCS's ground ends behind the trees
 *   track    forza.track: the road and the cars in numbers, for a driving program
 *   (docs/drive.md) */
#include "lab/world/world.h"

#include "bake/base/file.h"
#include "bake/import/import.h"
#include "cli/cli.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define POINTS_MAX 8192
#define STEP 4.0 /* metres between points, TORCS's default */
#define SPEED 50.0
#define OFFSET_X 36.0 /* of the path's least x and y from the model's origin */
#define OFFSET_Y 45.7
#define WIDTH 11.0 /* of the road, if the XML names none */
#define LEAN_AT 4.0 /* metres from the centre line, where the road's lean is measured */

typedef struct point {
    double x, y, heading; /* TORCS's plane, radians */
    double height, along;
    double wall[2]; /* left, right: metres from the centre line to the barrier */
    double up[3];   /* world */
    double rise[2]; /* of the ground before the barrier over the plane of the road */
} point;

typedef struct track {
    point points[POINTS_MAX];
    int count;
    double x, y, heading;
    double width;
} track;

/* ---- the path -------------------------------------------------------------------------------- */

static bool advance(track *t, double length, double turn) {
    if (t->count >= POINTS_MAX) return false;
    t->heading += turn / 2;
    t->x += cos(t->heading) * length;
    t->y += sin(t->heading) * length;
    t->heading += turn / 2;
    point *p = &t->points[t->count++];
    *p = (point){.x = t->x, .y = t->y, .heading = t->heading};
    p->along = t->count > 1 ? p[-1].along + length : length;
    return true;
}

static bool bend(track *t, double arc, double radius0, double radius1, int side) {
    int n = (int)((radius0 + radius1) / 2 * arc / STEP) + 1;
    double sum = 0;
    for (int i = 0; i < n; i++) {
        sum += 1 / (radius0 + (radius1 - radius0) * (n > 1 ? (double)i / (n - 1) : 0));
    }
    for (int i = 0; i < n; i++) {
        double radius = radius0 + (radius1 - radius0) * (n > 1 ? (double)i / (n - 1) : 0);
        double turn = arc / (sum * radius);
        if (!advance(t, 2 * radius * sin(turn / 2), side * turn)) return false;
    }
    return true;
}

/* Next to the road are a border and a side, whose width changes evenly; then the barrier. */
static void read_sides(track *t, int first, const char *segment) {
    static const char *const names[2][2] = {{"Left Side", "Left Border"},
                                            {"Right Side", "Right Border"}};
    int count = t->count - first;
    for (int side = 0; side < 2; side++) {
        const char *end, *border_end;
        const char *at = masu_world_section(segment, names[side][0], &end);
        const char *border = masu_world_section(segment, names[side][1], &border_end);
        double w0 = at ? masu_world_number(at, end, "start width", 0) : 0;
        double w1 = at ? masu_world_number(at, end, "end width", w0) : 0;
        double edge = t->width / 2;
        if (border) edge += masu_world_number(border, border_end, "width", 0);
        for (int i = 0; i < count; i++) {
            t->points[first + i].wall[side] = edge + w0 + (w1 - w0) * (i + 1) / count;
        }
    }
}

static bool read_segments(const char *text, track *t) {
    const char *main_end = NULL, *main_track = strstr(text, "<section name=\"Main Track\"");
    if (main_track) main_end = strchr(main_track + 1, '\0');
    t->width = main_track ? masu_world_number(main_track, main_end, "width", WIDTH) : WIDTH;
    const char *at = strstr(text, "<section name=\"Track Segments\"");
    while (at && (at = strstr(at, "<attstr name=\"type\" val=\""))) {
        const char *type = at + strlen("<attstr name=\"type\" val=\"");
        const char *end = strstr(type, "<section"); /* its sides follow its numbers */
        if (!end) end = type + strlen(type);
        double length = masu_world_number(type, end, "lg", 0),
               arc = masu_world_number(type, end, "arc", 0);
        double radius = masu_world_number(type, end, "radius", 0);
        double radius1 = masu_world_number(type, end, "end radius", radius);
        int first = t->count;
        if (strncmp(type, "str", 3) == 0 && length > 0 && length < 1e4) {
            int n = (int)(length / STEP) > 1 ? (int)(length / STEP) : 1;
            for (int i = 0; i < n; i++) {
                if (!advance(t, length / n, 0)) return false;
            }
        } else if (arc > 0 && arc <= 360 && radius > 1 && radius1 > 1 && radius + radius1 < 1e5) {
            int side = strncmp(type, "lft", 3) == 0 ? 1 : -1;
            if (!bend(t, arc * (MASU_BAKE_PI / 180), radius, radius1, side)) return false;
        }
        read_sides(t, first, type);
        at = type;
    }
    return t->count > 100;
}

static void shift(track *t) {
    double x = 1e30, y = 1e30;
    for (int i = 0; i < t->count; i++) {
        x = fmin(x, t->points[i].x);
        y = fmin(y, t->points[i].y);
    }
    for (int i = 0; i < t->count; i++) {
        t->points[i].x += OFFSET_X - x;
        t->points[i].y += OFFSET_Y - y;
    }
}

/* ---- heights --------------------------------------------------------------------------------- */

typedef struct ground {
    const masu_bake_content *piece;
    double *corners; /* 9 per triangle, world */
    size_t triangles;
} ground;

static ground triangles_of(const masu_bake_content *piece) {
    ground g = {.piece = piece};
    masu_bake_buffer out = {0};
    for (uint64_t i = 0; i < masu_bake_count(piece, MASU_BLOB_INSTANCES); i++) {
        const masu_blob_instance *n = &MASU_BAKE_INSTANCES(piece)[i];
        const masu_blob_mesh *mesh = &MASU_BAKE_MESHES(piece)[n->mesh];
        masu_bake_affine a = masu_bake_transform(n);
        for (uint32_t j = 0; j < mesh->primitive_count; j++) {
            const masu_blob_primitive *p = &MASU_BAKE_PRIMITIVES(piece)[mesh->first_primitive + j];
            for (uint32_t k = 0; k < p->index_count; k++) {
                uint32_t v = p->first_vertex + MASU_BAKE_INDICES(piece)[p->first_index + k];
                masu_bake_vec3 at =
                    masu_bake_apply(&a, masu_bake_v3f(MASU_BAKE_VERTICES(piece)[v].position));
                const double corner[3] = {at.x, at.y, at.z};
                masu_bake_append(&out, corner, sizeof corner);
            }
        }
    }
    g.corners = (double *)(void *)out.data;
    g.triangles = out.bytes / (9 * sizeof(double));
    return g;
}

/* The height nearest to `guess` at (x, z); false: no ground there. */
static bool height_at(const ground *g, double x, double z, double guess, double *out) {
    bool found = false;
    for (size_t i = 0; i < g->triangles; i++) {
        const double *a = g->corners + 9 * i, *b = a + 3, *c = a + 6;
        double area = (b[0] - a[0]) * (c[2] - a[2]) - (c[0] - a[0]) * (b[2] - a[2]);
        double u = ((x - a[0]) * (c[2] - a[2]) - (c[0] - a[0]) * (z - a[2])) / area;
        double v = ((b[0] - a[0]) * (z - a[2]) - (x - a[0]) * (b[2] - a[2])) / area;
        if (!(fabs(area) > 1e-9 && u >= 0 && v >= 0 && u + v <= 1)) continue;
        double y = a[1] + u * (b[1] - a[1]) + v * (c[1] - a[1]);
        if (!found || fabs(y - guess) < fabs(*out - guess)) *out = y;
        found = true;
    }
    return found;
}

/* Bridges a gap in the model, or a wall over one; the road may climb meanwhile. */
static int find_heights(track *t, const ground *g) {
    int missing = 0, run = 1000; /* the first height is unknown */
    double last = 0;
    for (int i = 0; i < t->count; i++) {
        point *p = &t->points[i];
        double y = last;
        if (height_at(g, p->x, -p->y, last, &y) && fabs(y - last) <= 2 + 0.5 * run) {
            last = y;
            run = 0;
        } else {
            missing++;
            run++;
        }
        p->height = last;
    }
    return missing;
}

/* ---- the scene ------------------------------------------------------------------------------- */

/* The position `left` metres to the left of point i, `above` metres above the road. */
static masu_bake_vec3 beside(const track *t, int i, double left, double above) {
    const point *p = &t->points[i % t->count];
    double x = p->x - sin(p->heading) * left, y = p->y + cos(p->heading) * left;
    return masu_bake_v3(x, p->height + above, -y);
}

static double height_below(void *user, double x, double z, double guess) {
    double y = guess;
    return height_at(user, x, z, guess, &y) && fabs(y - guess) < 1 ? y : guess;
}

/* The road's tilt, from the ground on both sides of its centre line. */
static void find_normals(track *t, ground *g) {
    for (int i = 0; i < t->count; i++) {
        int before = (i + t->count - 1) % t->count, after = (i + 1) % t->count;
        masu_bake_vec3 left = beside(t, i, LEAN_AT, 0), right = beside(t, i, -LEAN_AT, 0);
        left.y = height_below(g, left.x, left.z, left.y);
        right.y = height_below(g, right.x, right.z, right.y);
        masu_bake_vec3 up =
            masu_bake_cross(masu_bake_sub(right, left),
                            masu_bake_sub(beside(t, after, 0, 0), beside(t, before, 0, 0)));
        if (!masu_bake_normalize(&up) || up.y < 0.5) up = masu_bake_v3(0, 1, 0);
        point *p = &t->points[i];
        p->up[0] = up.x, p->up[1] = up.y, p->up[2] = up.z;
        for (int side = 0; side < 2; side++) {
            double off = fmax(p->wall[side] - 1, 0);
            masu_bake_vec3 at = beside(t, i, side ? -off : off, 0);
            double plane = at.y - (up.x * (at.x - p->x) + up.z * (at.z + p->y)) / up.y, y = plane;
            p->rise[side] =
                height_at(g, at.x, at.z, plane, &y) && fabs(y - plane) < 5 ? y - plane : 0;
        }
    }
}

/* The format is in docs/drive.md. */
static void write_road(const track *t, FILE *out) {
    fprintf(out, "masu-track 1\npoints %d\n", t->count);
    for (int i = 0; i < t->count; i++) {
        const point *p = &t->points[i];
        masu_bake_vec3 at = beside(t, i, 0, 0);
        fprintf(out, "%.3f %.3f %.3f  %.4f %.4f %.4f  %.2f %.2f  %.2f %.2f  %.3f %.3f\n", at.x,
                at.y, at.z, p->up[0], p->up[1], p->up[2], t->width / 2, t->width / 2, p->wall[0],
                p->wall[1], p->rise[0], p->rise[1]);
    }
}

static bool cars(const track *t, ground *g, const char *torcs, FILE *out, FILE *road) {
    for (int i = 0; i < MASU_WORLD_CARS; i++) {
        int at = i < 6 ? 6 + 3 * i : 60 + 70 * (i - 6); /* a grid of six, the others on the track */
        masu_bake_vec3 p = beside(t, at, i & 1 ? 3.2 : -3.2, 0);
        if (!masu_world_car(out, road, torcs, i, p, t->points[at].heading, height_below, g))
            return false;
    }
    return true;
}

static void key(FILE *out, double time, masu_bake_vec3 eye, masu_bake_vec3 at, const char *end) {
    fprintf(out,
            "      {\"time\": %.3f, \"position\": [%.3f, %.3f, %.3f], "
            "\"target\": [%.3f, %.3f, %.3f]}%s\n",
            time, eye.x, eye.y, eye.z, at.x, at.y, at.z, end);
}

/* For the track's textures: the metres that one usually spans along u and v. A relief's period is a
 * quarter of a metre. */
static void grounds(FILE *out) {
    static const struct {
        const char *picture, *relief;
        double u, v;
    } rows[] = {{"Road.png", "asphalt", 35, 11},    {"GRAS2B.png", "grass", 10.5, 8.4},
                {"RSGRAS_n.png", "grass", 15, 1},   {"SAND_n.png", "gravel", 8.8, 8.8},
                {"RSSAND_n.png", "gravel", 5.3, 1}, {"SANDT_n.png", "gravel", 10, 6.2}};
    fputs(",\n     \"materials\": [", out);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const char *r = rows[i].relief;
        fprintf(
            out,
            "%s\n      {\"match\": \"%s\", \"roughness\": 1, \"normal_map\": \"%s_normal.png\", "
            "\"roughness_map\": \"%s_rough.png\",\n       \"occlusion_map\": \"%s_ao.png\", "
            "\"meso\": \"%s.json\", \"detail\": [%g, %g]}",
            i ? "," : "", rows[i].picture, r, r, r, r, 4 * rows[i].u, 4 * rows[i].v);
    }
    fputs("]", out);
}

/* TORCS's ground ends behind the trees, where the sky would begin. The plain is just below the
 * model's lowest point, -3.4 m, and wide enough to fade in the fog. It casts no shadows and is not
 * in the BVH, because it would enlarge both. */
static void plain(FILE *out, const char *torcs) {
    fprintf(
        out,
        ",\n    {\"mesh\": {\"plane\": {\"size_x\": 12000, \"size_z\": 12000, \"tile\": 800}}, "
        "\"name\": \"plain\",\n"
        "     \"translate\": [1150, -3.6, -600], \"shadows\": false, \"traced\": false,\n"
        "     \"material\": {\"base_color\": [1, 1, 1], \"roughness\": 1, \"alpha\": \"opaque\",\n"
        "                  \"base_color_map\": \"%s/tracks/road/forza/GRAS2B.png\"}}",
        torcs);
}

/* Lamps behind the barriers, on alternating sides. The emission of their heads is only for the
 * camera; the light comes from the spots of lamp_lights. */
#define LAMP_EVERY 10 /* points */
#define LAMP_HEIGHT 9.0

static masu_bake_vec3 lamp_foot(const track *t, int i) {
    int side = i / LAMP_EVERY & 1;
    double off = t->points[i].wall[side] + 1.5;
    masu_bake_vec3 at = beside(t, i, side ? -off : off, 0);
    at.y += t->points[i].rise[side];
    return at;
}

static void lamp_models(const track *t, FILE *out) {
    for (int i = 0; i + LAMP_EVERY < t->count; i += LAMP_EVERY) {
        masu_bake_vec3 foot = lamp_foot(t, i);
        fprintf(out,
                ",\n    {\"mesh\": {\"box\": {\"size\": [0.16, 10, 0.16]}}, \"translate\": [%.2f, "
                "%.2f, %.2f],\n"
                "     \"material\": {\"base_color\": [0.3, 0.3, 0.3]}},\n"
                "    {\"mesh\": {\"box\": {\"size\": [1, 0.16, 1]}}, \"translate\": [%.2f, %.2f, "
                "%.2f], "
                "\"area_light\": false,\n"
                "     \"shadows\": false, \"material\": {\"emissive\": [6, 5.4, 4.4]}}",
                foot.x, foot.y + LAMP_HEIGHT - 5, foot.z, foot.x, foot.y + LAMP_HEIGHT, foot.z);
    }
}

static void lamp_lights(const track *t, FILE *out) {
    for (int i = 0; i + LAMP_EVERY < t->count; i += LAMP_EVERY) {
        masu_bake_vec3 foot = lamp_foot(t, i);
        const point *p = &t->points[i];
        fprintf(out,
                ",\n    {\"type\": \"spot\", \"position\": [%.2f, %.2f, %.2f], \"direction\": "
                "[%.2f, %.2f, %.2f],\n"
                "     \"color\": [1, 0.9, 0.74], \"intensity\": 400, \"outer\": 75, \"inner\": 40, "
                "\"range\": 80, "
                "\"radius\": 0.3}",
                foot.x, foot.y + LAMP_HEIGHT - 0.2, foot.z, p->x - foot.x,
                p->height - foot.y - LAMP_HEIGHT, -p->y - foot.z);
    }
}

#define SHADOWS "\"shadows\": {\"cascades\": 4, \"resolution\": 1024, \"distance\": 300}"
#define FOG "  \"fog\": {\"visibility\": 8000, \"falloff\": 0.004},\n"
/* Afternoon: a low sun to the right of the start, with shadows of trees on the road. */
static const char day[] =
    "  \"sun\": {\"azimuth\": 165, \"elevation\": 24,\n"
    "          " SHADOWS "},\n"
    "  \"sky\": {\"turbidity\": 3, \"ground\": [0.12, 0.13, 0.1]}, \"exposure\": 1.2,\n" FOG;
static const char night[] = "  \"sun\": {\"azimuth\": 230, \"elevation\": 42, \"color\": [0.5, "
                            "0.6, 1], \"intensity\": 0.06,\n"
                            "          " SHADOWS "},\n"
                            "  \"ambient\": [0.03, 0.036, 0.05],\n"
                            "  \"sky\": {\"zenith\": [0.004, 0.006, 0.014], \"horizon\": [0.02, "
                            "0.022, 0.03]}, \"exposure\": 2,\n" FOG;

static bool write_models(const track *t, ground *g, const char *torcs, bool is_night, FILE *out,
                         FILE *road) {
    fprintf(out,
            "{\n  \"models\": [\n    {\"file\": \"%s/tracks/road/forza/forza.acc\", \"merge\": 128",
            torcs);
    grounds(out);
    fputs("}", out);
    if (!cars(t, g, torcs, out, road)) return false;
    plain(out, torcs);
    fputs(",\n    {\"mesh\": {\"plane\": {\"size_x\": 1, \"size_z\": 1}}, \"name\": \"skid\", "
          "\"hidden\": true,\n     \"material\": {\"name\": \"skid\", \"base_color\": [0.03, "
          "0.03, 0.03], \"specular\": 0, \"roughness\": 1, \"depth_bias\": 0.001}}",
          out);
    if (is_night) lamp_models(t, out);
    return true;
}

/* Writes the camera's keys, and prints the times of its views. */
static void write_camera(const track *t, FILE *out, const char *folder) {
    fputs("\n  ],\n  \"camera\": {\n    \"fov_y\": 60,\n    \"near\": 0.2,\n    \"keys\": [\n",
          out);
    for (int i = 0; i < t->count; i += 2) {
        key(out, t->points[i].along / SPEED, beside(t, i, 0, 1.3), beside(t, i + 6, 0, 1.1), ",");
    }
    double end = ceil(t->points[t->count - 1].along / SPEED) + 10;
    /* The stand at the end of the lap, left of the road. */
    masu_bake_vec3 crowd = beside(t, t->count - 50, -5, 2.2);
    masu_bake_vec3 stands = beside(t, t->count - 32, 56, 14);
    masu_bake_vec3 high = beside(t, 0, 160, 140), middle = beside(t, 60, 0, 0);
    key(out, end, crowd, stands, ",");
    key(out, end + 1, crowd, stands, ",");
    key(out, end + 10, high, middle, ",");
    /* Behind the third car of the grid. */
    masu_bake_vec3 near = beside(t, 10, -0.4, 1.2), car = beside(t, 12, -3.2, 0.5);
    key(out, end + 11, high, middle, ",");
    key(out, end + 20, near, car, ",");
    key(out, end + 21, near, car, "");
    fputs("    ]\n  },\n", out);
    if (!masu_cli_quiet() && folder) {
        printf("%s/forza.json: a lap of %.0f m; crowd at %.0f s, high at %.0f s, cars at %.0f s\n",
               folder, t->points[t->count - 1].along, end, end + 10, end + 20);
    }
}

static bool write_scene(const track *t, ground *g, const char *folder, const char *torcs,
                        bool is_night) {
    const char *name = is_night ? "forza_night.json" : "forza.json";
    FILE *road = masu_world_create(folder, "forza.track");
    if (!road) return false;
    FILE *out = masu_world_create(folder, name);
    if (!out) return fclose(road), false;
    write_road(t, road);
    bool placed = write_models(t, g, torcs, is_night, out, road);
    bool good = masu_world_close(road, folder, "forza.track") && placed;
    if (!good) return fclose(out), false;
    write_camera(t, out, is_night ? NULL : folder);
    fputs(is_night ? night : day, out);
    fputs("  \"ambient_occlusion\": {\"radius\": 1.5}, \"reflections\": {\"cutoff\": 0.4, "
          "\"smallest\": 1.4},\n"
          "  \"lights\": [\n"
          "    {\"name\": \"head0\", \"type\": \"spot\", \"position\": [0, 0, 0], \"direction\": "
          "[1, 0, 0], "
          "\"intensity\": 0},\n"
          "    {\"name\": \"head1\", \"type\": \"spot\", \"position\": [0, 0, 0], \"direction\": "
          "[1, 0, 0], "
          "\"intensity\": 0}",
          out);
    if (is_night) lamp_lights(t, out);
    fputs("],\n  \"lods\": 3,\n  \"occluders\": 4\n}\n", out);
    return masu_world_close(out, folder, name);
}

static bool write_track(const char *folder, const char *torcs, const char *xml, const char *model) {
    static track t; /* 320 KB: not for the stack */
    masu_bake_buffer text = {0};
    if (!masu_bake_read_file(xml, 16 << 20, &text)) return false;
    bool good = read_segments((const char *)text.data, &t);
    masu_bake_release(&text);
    if (!good) return masu_cli_error("%s: no track segments that make a road", xml), false;
    point first = t.points[0], last = t.points[t.count - 1];
    if (hypot(last.x - first.x, last.y - first.y) > 3 * STEP) {
        return masu_cli_error("%s: the road does not close", xml), false;
    }
    shift(&t);
    masu_bake_content piece = {0};
    good = masu_bake_import(model, MASU_BAKE_TEXTURES_WANTED, &piece);
    if (good) {
        ground g = triangles_of(&piece);
        int missing = find_heights(&t, &g);
        if (missing > t.count / 20) {
            masu_cli_error("%s: %d of %d points of the road have no ground below", model, missing,
                           t.count);
            good = false;
        }
        if (good) find_normals(&t, &g);
        good = good && write_scene(&t, &g, folder, torcs, false) &&
               write_scene(&t, &g, folder, torcs, true);
        free(g.corners);
    }
    masu_bake_content_release(&piece);
    return good;
}

bool masu_world_forza(const char *folder, const char *torcs) {
    char *xml = masu_bake_join(torcs, "tracks/road/forza/forza.xml");
    char *model = masu_bake_join(torcs, "tracks/road/forza/forza.acc");
    bool good = write_track(folder, torcs, xml, model);
    free(xml);
    free(model);
    return good;
}
