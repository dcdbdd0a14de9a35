/* city.c: a city on four decks above each other, as a scene of parts placed many times. Tiles of 48
 * m: a street of 10 m around a block, which holds four buildings or a square with stalls and
 * people. A building is a plain shell (the occluder) with slices of facade in front of it, a roof,
 * and balconies, pipes, conditioners and signs on the facades.
 *
 *   groups   "deck/i.j/building": used by the culling tree
 *   camera   0 to 10 s a walk through the streets with fast turns (600 frames at 60 Hz),
 *            20 s the crowd on the central square, 30 s all decks from above
 *
 * All random values come from one generator with a fixed seed. */
#include "lab/world/world.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#define TILE 48.0
#define DEGREES 57.29577951308232
#define COLORS 6

typedef struct deck {
    int columns, rows; /* tiles */
    double x, y, z;    /* centre of its top */
    int missing;       /* of 100 tiles */
} deck;

/* Tiles of all decks are whole tiles apart, so that pillars stand on crossings of every deck. */
static const deck decks[] = {
    {2, 3, 72, -40, -96, 10}, {7, 7, 0, 0, 0, 0}, {4, 3, -24, 40, 0, 25}, {2, 3, -24, 80, 0, 20}};
enum { DECKS = sizeof decks / sizeof decks[0], GROUND = 1 };

enum { LAMPS = 1024 };
typedef struct city {
    FILE *out;
    uint64_t random;
    uint32_t objects;
    char group[64];
    bool night;
    uint32_t lamps;
    double lamp[LAMPS][3]; /* of the lamps' heads */
} city;

/* PCG32 (O'Neill 2014): 64 bits of state, 32 of output. */
static uint32_t next(city *c) {
    uint64_t old = c->random;
    c->random = old * 6364136223846793005u + 1442695040888963407u;
    uint32_t shifted = (uint32_t)(((old >> 18) ^ old) >> 27), turn = (uint32_t)(old >> 59);
    return shifted >> turn | shifted << ((32 - turn) & 31);
}

static int below(city *c, int n) { return (int)(next(c) % (uint32_t)n); }
static double between(city *c, double low, double high) {
    return low + (high - low) * (next(c) / 4294967296.0);
}

typedef struct place {
    double x, y, z, turn; /* degrees about y */
    double sx, sy, sz;
    int color; /* of the wall, or -1 */
} place;

/* Whether the windows of a facade are lit at night: a fifth are. It does not use the random
 * generator, because city and city_night have the same parts. */
static bool is_lit(uint32_t object) { return (object * 2654435761u) >> 16 < 65536 / 5; }

static void put(city *c, const char *part, place p) {
    static const double colors[COLORS][3] = {{0.72, 0.62, 0.46}, {0.66, 0.46, 0.34},
                                             {0.54, 0.50, 0.46}, {0.60, 0.58, 0.40},
                                             {0.46, 0.50, 0.56}, {0.74, 0.70, 0.62}};
    fprintf(c->out,
            "%s\n    {\"file\": \"%s.obj\", \"group\": \"%s\", \"translate\": [%.3f, %.3f, %.3f]",
            c->objects ? "," : "", part, c->group, p.x, p.y, p.z);
    if (p.turn != 0) fprintf(c->out, ", \"rotate_y\": %.2f", p.turn);
    if (p.sx != 1 || p.sy != 1 || p.sz != 1) {
        fprintf(c->out, ", \"scale\": [%.3f, %.3f, %.3f]", p.sx, p.sy, p.sz);
    }
    /* They are not area lights: "lights" has their light at night; by day there is none. */
    bool lit = c->night && !strncmp(part, "facade", 6) && is_lit(c->objects);
    if (lit || !strcmp(part, "lamp") || !strcmp(part, "sign"))
        fputs(", \"area_light\": false", c->out);
    if (lit) {
        fputs(",\n     \"materials\": [{\"match\": \"glass\", \"emissive\": [0.5, 0.31, 0.13]}]",
              c->out);
    }
    if (p.color >= 0) {
        const double *k = colors[p.color];
        fprintf(c->out, ", \"material\": {\"base_color\": [%.2f, %.2f, %.2f]}", k[0], k[1], k[2]);
    }
    fputc('}', c->out);
    c->objects++;
}

static void put_at(city *c, const char *part, double x, double y, double z, double turn) {
    put(c, part, (place){x, y, z, turn, 1, 1, 1, -1});
}

/* ---- buildings ------------------------------------------------------------------------------- */

typedef struct building {
    double x, y, z;      /* centre of its base */
    double w, d, height; /* w along x */
} building;

/* The objects on one slice of facade; (x, z) is the slice's centre on the wall. */
static void dress(city *c, const building *b, double x, double z, double turn, double base,
                  int floors) {
    double a = turn / DEGREES, rx = cos(a), rz = -sin(a); /* to the right along the wall */
    for (int f = 1; f < floors; f += 2) {
        double y = b->y + base + 3.0 * f;
        int kind = below(c, 10), side = below(c, 2) ? 1 : -1;
        double at = 1.5 * side;
        if (kind < 1) put_at(c, "balcony", x + rx * at, y, z + rz * at, turn);
        if (kind == 2) put_at(c, "conditioner", x, y + 0.2, z, turn);
    }
    if (below(c, 12) == 0) {
        for (int i = 0; 6 * i < 3 * floors; i++) {
            put_at(c, "pipe", x + rx * 2.7, b->y + base + 6.0 * i, z + rz * 2.7, turn);
        }
    }
    if (base < 1 && below(c, 5) == 0) put_at(c, "sign", x, b->y + 3.2, z, turn);
}

static void facades(city *c, const building *b, double base, int floors) {
    static const char *const parts[2][3] = {{"facade_4_plain", "facade_4_arch", "facade_4_shop"},
                                            {"facade_6_plain", "facade_6_arch", "facade_6_shop"}};
    int kind = below(c, 2);
    for (int side = 0; side < 4; side++) {
        double turn = 90.0 * side, a = turn / DEGREES, nx = sin(a), nz = cos(a);
        double length = side & 1 ? b->d : b->w, out = (side & 1 ? b->w : b->d) / 2;
        int slices = (int)(length / 6 + 0.5);
        for (int i = 0; i < slices; i++) {
            double along = -length / 2 + 3 + 6.0 * i;
            double x = b->x + nx * out + nz * along, z = b->z + nz * out - nx * along;
            int shop = base < 1 && below(c, 3) == 0;
            put_at(c, parts[floors == 6][shop ? 2 : kind], x, b->y + base, z, turn);
            dress(c, b, x, z, turn, base, floors);
        }
    }
}

static void put_building(city *c, building b, int color) {
    static const int storeys[5][2] = {{4, 0}, {6, 0}, {4, 4}, {4, 6}, {6, 0}}; /* at most 30 m */
    const int *floors = storeys[below(c, 5)];
    b.height = 3.0 * (floors[0] + floors[1]);
    put(c, "shell", (place){b.x, b.y, b.z, 0, b.w, b.height, b.d, color});
    facades(c, &b, 0, floors[0]);
    if (floors[1]) facades(c, &b, 3.0 * floors[0], floors[1]);
    int roof = below(c, 7);
    const char *part = roof < 3 ? "roof_flat" : roof < 6 ? "roof_gable" : "roof_dome";
    double turn = 90.0 * below(c, 2), sx = b.w, sz = b.d;
    if (turn > 0) {
        sx = b.d;
        sz = b.w;
    }
    put(c, part, (place){b.x, b.y + b.height, b.z, turn, sx, 1.5, sz, -1});
}

static void put_tower(city *c, double x, double y, double z) {
    put(c, "round_shell", (place){x, y, z, 0, 10, 30, 10, 4});
    put(c, "roof_dome", (place){x, y + 30, z, 0, 10, 1.2, 10, -1});
    for (int i = 0; i < 12; i++) {
        double turn = 30.0 * i, a = turn / DEGREES;
        put_at(c, "balcony", x + 5 * sin(a), y + 3 + 2.2 * i, z + 5 * cos(a), turn);
    }
}

/* ---- tiles ----------------------------------------------------------------------------------- */

static void put_square(city *c, double x, double y, double z, int people) {
    static const char *const persons[3] = {"person_red", "person_pale", "person_green"};
    for (int i = 0; i < 4; i++) {
        put_at(c, "tree", x + (i & 1 ? 14 : -14), y + 0.15, z + (i & 2 ? 14 : -14), 90.0 * i);
    }
    for (int i = 0; i < 8; i++) {
        double a = 45.0 * i;
        put_at(c, "stall", x + 10.5 * sin(a / DEGREES), y + 0.15, z + 10.5 * cos(a / DEGREES), a);
    }
    for (int i = 0; i < people; i++) {
        double px = between(c, -17, 17), pz = between(c, -17, 17);
        put_at(c, persons[below(c, 3)], x + px, y + 0.15, z + pz, floor(between(c, 0, 360)));
    }
    put_at(c, "airship", x, y + 14, z, 30.0 * below(c, 12));
}

/* Buildings of a `dense` block fill their lots, with only lanes between them. */
static void put_block(city *c, double x, double y, double z, bool dense) {
    char tile[sizeof c->group];
    memcpy(tile, c->group, sizeof tile);
    for (int lot = 0; lot < 4; lot++) {
        snprintf(c->group, sizeof c->group, "%.48s/%d", tile, lot);
        double lx = x + (lot & 1 ? 9 : -9), lz = z + (lot & 2 ? 9 : -9);
        int kind = below(c, 12);
        if (kind == 0) {
            put_at(c, "tree", lx, y + 0.15, lz, 0);
        } else if (kind == 1) {
            put_tower(c, lx, y + 0.15, lz);
        } else {
            bool wide = below(c, 3) == 0, deep = below(c, 3) == 0;
            double w = wide != dense ? 18 : 12, d = deep != dense ? 18 : 12;
            put_building(c, (building){lx, y + 0.15, lz, w, d, 0}, below(c, COLORS));
        }
    }
    memcpy(c->group, tile, sizeof tile);
}

/* Railings where the deck ends. `edge`: a bit for each side without a neighbour. */
static void put_edge(city *c, double x, double y, double z, unsigned edge) {
    for (int side = 0; side < 4; side++) {
        if (!(edge >> side & 1)) continue;
        double turn = 90.0 * side, a = turn / DEGREES;
        for (int i = 0; i < 4; i++) {
            double along = -18 + 12.0 * i;
            put_at(c, "railing", x + 23.8 * sin(a) + along * cos(a), y,
                   z + 23.8 * cos(a) - along * sin(a), turn);
        }
    }
}

static void put_tile(city *c, int level, int i, int j, unsigned edge) {
    const deck *k = &decks[level];
    double x = k->x + TILE * (i - (k->columns - 1) / 2.0);
    double z = k->z + TILE * (j - (k->rows - 1) / 2.0);
    bool middle = level == GROUND && i == 3 && j == 3;
    bool dense = level == GROUND && i > 0 && i < 6 && j > 0 && j < 6; /* along the camera's walk */
    snprintf(c->group, sizeof c->group, "deck%d/%d.%d", level, i, j);
    put_at(c, "deck", x, k->y, z, 0);
    put_edge(c, x, k->y, z, edge);
    for (int corner = 0; corner < 4; corner++) {
        double at[3] = {x + (corner & 1 ? 18.5 : -18.5), k->y + 0.15,
                        z + (corner & 2 ? 18.5 : -18.5)};
        put_at(c, "lamp", at[0], at[1], at[2], 45);
        if (c->lamps < LAMPS) memcpy(c->lamp[c->lamps++], at, sizeof at);
    }
    for (int n = below(c, 4); n > 0; n--) { /* passers-by */
        put_at(c, "person_pale", x + between(c, -17, 17), k->y + 0.15, z + 18.4,
               floor(between(c, 0, 360)));
    }
    if (middle || (!dense && below(c, 3) == 0))
        put_square(c, x, k->y, z, middle ? 160 : 20);
    else
        put_block(c, x, k->y, z, dense);
    if (level > 0 && below(c, 2)) put_at(c, "pipe_bundle", x, k->y - 3.5, z, 90.0 * below(c, 2));
    if (level + 1 < DECKS && below(c, 4) == 0) {
        put_at(c, "stairs", x, k->y, z + 21.5, 0);
    }
    if (level > 0 && below(c, 3) == 0) put_at(c, "pillar", x - 20.2, k->y - 40, z - 20.2, 0);
    if (level > 0 && edge & 2 && below(c, 2)) put_at(c, "bridge", x + TILE, k->y, z, 0);
}

static void put_deck(city *c, int level) {
    const deck *k = &decks[level];
    unsigned char there[8][8] = {{0}};
    for (int j = 0; j < k->rows; j++) {
        for (int i = 0; i < k->columns; i++) there[j][i] = below(c, 100) >= k->missing;
    }
    for (int j = 0; j < k->rows; j++) {
        for (int i = 0; i < k->columns; i++) {
            if (!there[j][i]) continue;
            unsigned edge = 0; /* sides +z, +x, -z, -x: in the order of facades */
            edge |= j + 1 >= k->rows || !there[j + 1][i] ? 1u : 0;
            edge |= i + 1 >= k->columns || !there[j][i + 1] ? 2u : 0;
            edge |= j == 0 || !there[j - 1][i] ? 4u : 0;
            edge |= i == 0 || !there[j][i - 1] ? 8u : 0;
            put_tile(c, level, i, j, edge);
        }
    }
}

/* ---- the camera ------------------------------------------------------------------------------ */

static double smooth(double t) {
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    return t * t * (3 - 2 * t);
}

static void key(FILE *out, double time, const double eye[3], double yaw, double pitch) {
    double c = cos(pitch / DEGREES);
    fprintf(out,
            "      {\"time\": %.4f, \"position\": [%.3f, %.3f, %.3f], \"target\": [%.4f, %.4f, "
            "%.4f]},\n",
            time, eye[0], eye[1], eye[2], eye[0] + 10 * c * sin(yaw / DEGREES),
            eye[1] + 10 * sin(pitch / DEGREES), eye[2] + 10 * c * cos(yaw / DEGREES));
}

/* Along streets at 12 m/s; at each crossing a quarter turn within a tenth of a second, sometimes a
 * look over the shoulder or up. A key per frame. */
static void walk(FILE *out) {
    static const struct {
        double from, to, yaw; /* yaw rotates to this from `from` on */
    } turns[] = {{0.0, 0.0, 0},    {2.0, 2.10, 90}, {3.4, 3.48, 270}, {3.8, 3.88, 90},
                 {6.0, 6.10, 180}, {7.2, 7.5, 540}, {8.0, 8.12, 450}, {9.2, 9.3, 270}};
    static const double corners[][3] = {/* time, x, z */
                                        {0, -24, -48},
                                        {2, -24, -24},
                                        {6, 24, -24},
                                        {8, 24, -48},
                                        {10, 48, -48}};
    for (int frame = 0; frame <= 600; frame++) {
        double t = frame / 60.0, yaw = 0, last = 0;
        for (size_t i = 0; i < sizeof turns / sizeof turns[0]; i++) {
            if (t < turns[i].from) break;
            double length = turns[i].to - turns[i].from;
            yaw = last +
                  (turns[i].yaw - last) * (length > 0 ? smooth((t - turns[i].from) / length) : 1);
            last = turns[i].yaw;
        }
        size_t s = 0;
        while (s + 2 < sizeof corners / sizeof corners[0] && t > corners[s + 1][0]) s++;
        double f = (t - corners[s][0]) / (corners[s + 1][0] - corners[s][0]);
        double eye[3] = {corners[s][1] + (corners[s + 1][1] - corners[s][1]) * f, 1.75,
                         corners[s][2] + (corners[s + 1][2] - corners[s][2]) * f};
        key(out, t, eye, yaw, 25 * smooth(sin(t * 1.7)) - 2);
    }
}

#define DAY "city.json"
#define NIGHT "city_night.json"
/* A nearly logarithmic distribution: near cascades have twice the resolution of the default. */
#define SHADOWS                                                                                    \
    "\"shadows\": {\"cascades\": 4, \"resolution\": 1024, \"distance\": 400, \"lambda\": 0.92}"
/* Afternoon: a low sun lights the space under the decks. */
static const char day[] =
    "  \"sun\": {\"azimuth\": 150, \"elevation\": 20,\n"
    "          " SHADOWS "},\n"
    "  \"sky\": {\"turbidity\": 3, \"ground\": [0.18, 0.2, 0.23]}, \"exposure\": {\"factor\": "
    "0.5},\n"
    /* Below a deck little of the sky is visible. Distance maps would take 400 bytes per probe. */
    "  \"probes\": {\"spacing\": [8, 5, 8], \"rays\": 512, \"bounces\": 3, \"sky_bands\": 2, "
    "\"visibility\": 0},\n";
static const char night[] =
    "  \"sun\": {\"azimuth\": 130, \"elevation\": 48, \"color\": [0.5, 0.6, 1], \"intensity\": "
    "0.02,\n"
    "          " SHADOWS "},\n"
    "  \"ambient\": [0.010, 0.012, 0.020],\n"
    "  \"sky\": {\"zenith\": [0.004, 0.006, 0.014], \"horizon\": [0.03, 0.03, 0.04]}, "
    "\"exposure\": 2,\n";

/* Below the heads of the lamps, which they would light otherwise. */
static void put_lights(city *c) {
    fputs("  \"lights\": [", c->out);
    for (uint32_t i = 0; i < c->lamps; i++)
        fprintf(c->out,
                "%s\n    {\"type\": \"point\", \"position\": [%.3f, %.3f, %.3f], "
                "\"color\": [1, 0.74, 0.44], \"intensity\": 14, \"range\": 26, \"radius\": 0.1}",
                i ? "," : "", c->lamp[i][0], c->lamp[i][1] + 3.35, c->lamp[i][2]);
    fputs("\n  ],\n", c->out);
}

static bool write_scene(city *c, const char *folder) {
    fputs("{\n  \"models\": [", c->out);
    for (int level = 0; level < DECKS; level++) put_deck(c, level);
    fputs("\n  ],\n  \"camera\": {\n    \"fov_y\": 60,\n    \"near\": 0.1,\n    \"keys\": [\n",
          c->out);
    walk(c->out);
    const double crowd[3] = {-9, 1.9, 15}, high[3] = {150, 130, 205};
    key(c->out, 20, crowd, 150, 2);
    key(c->out, 21, crowd, 150, 2);
    key(c->out, 30, high, 216, -24);
    fputs(
        "      {\"time\": 31, \"position\": [150, 130, 205], \"target\": [0, 20, 0]}\n    ]\n  },\n"
        "  \"ambient_occlusion\": {\"radius\": 2.5}, \"reflections\": false,\n",
        c->out);
    fputs(c->night ? night : day, c->out);
    if (c->night) put_lights(c);
    fputs("  \"lods\": 3,\n  \"occluders\": 4\n}\n", c->out);
    return masu_world_close(c->out, folder, c->night ? NIGHT : DAY);
}

static bool write_city(const char *folder, bool night) {
    static city c; /* 24 KB: not for the stack */
    c = (city){.random = 0x6D617375u, .night = night};
    c.out = masu_world_create(folder, night ? NIGHT : DAY);
    return c.out && write_scene(&c, folder);
}

bool masu_world_city(const char *folder) {
    return write_city(folder, false) && write_city(folder, true) && masu_world_parts(folder);
}
