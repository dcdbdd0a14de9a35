/* parts.c: the parts of the city, one OBJ file each. Metres; y is up, a facade's outside is +z, and
 * a part stands on y = 0 or hangs below it. Sizes are multiples of the facade's module: 6 m wide,
 * floors of 3 m. */
#include "lab/world/mesh.h"
#include "lab/world/world.h"

#define WALL "wall"
#define TRIM "trim"
#define GLASS "glass"
#define METAL "metal"
#define DARK "dark"
#define WOOD "wood"
#define CLOTH "cloth"
#define SKIN "skin"
#define LEAF "leaf"
#define LIGHT "light"
#define STONE "stone"

static const char materials[] = "newmtl " WALL "\nKd 0.80 0.74 0.64\nNs 4\n"
                                "newmtl " TRIM "\nKd 0.72 0.66 0.56\nNs 6\n"
                                "newmtl " GLASS "\nKd 0.16 0.22 0.28\nNs 400\n"
                                "newmtl " METAL "\nKd 0.42 0.40 0.38\nNs 60\n"
                                "newmtl " DARK "\nKd 0.20 0.19 0.20\nNs 10\n"
                                "newmtl " WOOD "\nKd 0.52 0.36 0.24\nNs 8\n"
                                "newmtl " CLOTH "\nKd 0.62 0.24 0.20\nNs 2\n"
                                "newmtl " SKIN "\nKd 0.78 0.60 0.48\nNs 8\n"
                                "newmtl " LEAF "\nKd 0.28 0.46 0.20\nNs 2\n"
                                "newmtl " LIGHT "\nKd 0.95 0.90 0.75\nKe 1.0 0.9 0.6\nNs 10\n"
                                "newmtl " STONE "\nKd 0.60 0.58 0.56\nNs 4\n";

typedef masu_world_mesh mesh;

/* ---- facades: a slice 6 m wide, `floors` high, in front of the wall -------------------------- */

/* A window of w x h whose lower edge's centre is (x, y): frame, sill and a pane. */
static void window(mesh *m, double x, double y, double w, double h) {
    masu_world_material(m, TRIM);
    masu_world_box(m, x, y + h / 2, 0.07, w + 0.24, h, 0.14);
    masu_world_box(m, x, y + h, 0.12, w + 0.36, 0.16, 0.26);
    masu_world_box(m, x, y, 0.16, w + 0.36, 0.12, 0.34);
    masu_world_material(m, GLASS);
    masu_world_box(m, x, y + h / 2, 0.08, w, h - 0.1, 0.16);
}

static void arched_window(mesh *m, double x, double y, double w, double h) {
    enum { SIDES = 6 };
    window(m, x, y, w, h);
    masu_world_material(m, TRIM);
    masu_world_tube(m, 2, x, y + h + 0.05, 0, 0.19, w / 2 + 0.16, w / 2 + 0.06, SIDES);
}

static void shutters(mesh *m, double x, double y, double w, double h) {
    masu_world_material(m, WOOD);
    for (int side = -1; side <= 1; side += 2) {
        masu_world_box(m, x + side * (w / 2 + 0.40), y + h / 2, 0.06, 0.50, h, 0.05);
    }
}

static void shop(mesh *m) {
    masu_world_material(m, DARK);
    masu_world_box(m, 0, 1.25, 0.05, 4.6, 2.3, 0.10);
    masu_world_material(m, WOOD);
    for (int i = 0; i <= 4; i++) masu_world_box(m, -2.4 + 1.2 * i, 1.25, 0.14, 0.14, 2.5, 0.24);
    masu_world_box(m, 0, 0.25, 0.14, 5.0, 0.5, 0.26);
    masu_world_box(m, 0, 2.65, 0.16, 5.2, 0.4, 0.30);
    masu_world_material(m, CLOTH);
    for (int i = 0; i < 8; i++) { /* an awning of stripes */
        masu_world_box(m, -2.1 + 0.6 * i, 2.45 - 0.03 * (i & 1), 0.75, 0.56, 0.06, 1.4);
    }
}

static void facade(mesh *m, int floors, int kind) {
    masu_world_material(m, TRIM);
    masu_world_box(m, 0, 3.0 * floors - 0.2, 0.20, 6.0, 0.4, 0.40);
    masu_world_box(m, 0, 3.0 * floors - 0.5, 0.10, 6.0, 0.2, 0.20);
    masu_world_box(m, -2.9, 1.5 * floors, 0.06, 0.2, 3.0 * floors, 0.12);
    if (kind == 1) masu_world_box(m, 0, 3.0, 0.08, 6.0, 0.2, 0.16);
    for (int f = 0; f < floors; f++) {
        double y = 3.0 * f;
        if (f == 0 && kind == 2) {
            shop(m);
            continue;
        }
        for (int side = -1; side <= 1; side += 2) {
            double x = 1.5 * side;
            if (kind == 1)
                arched_window(m, x, y + 0.9, 1.2, 1.0);
            else
                window(m, x, y + 0.9, 1.1, 1.5);
            if (kind == 0 && f % 2) shutters(m, x, y + 0.9, 1.1, 1.5);
        }
    }
}

static void facade_4_plain(mesh *m) { facade(m, 4, 0); }
static void facade_4_arch(mesh *m) { facade(m, 4, 1); }
static void facade_4_shop(mesh *m) { facade(m, 4, 2); }
static void facade_6_plain(mesh *m) { facade(m, 6, 0); }
static void facade_6_arch(mesh *m) { facade(m, 6, 1); }
static void facade_6_shop(mesh *m) { facade(m, 6, 2); }

/* ---- buildings ------------------------------------------------------------------------------- */

/* A metre on each side: placed with a scale. The city's occluders. */
static void shell(mesh *m) {
    masu_world_material(m, WALL);
    masu_world_box(m, 0, 0.5, 0, 1, 1, 1);
}

static void round_shell(mesh *m) {
    masu_world_material(m, WALL);
    masu_world_tube(m, 1, 0, 0, 0, 1, 0.5, 0.5, 32);
}

static void roof_flat(mesh *m) { /* over a square metre; scaled, with its height */
    masu_world_material(m, STONE);
    masu_world_box(m, 0, 0.2, 0.49, 1.04, 0.4, 0.04);
    masu_world_box(m, 0, 0.2, -0.49, 1.04, 0.4, 0.04);
    masu_world_box(m, 0.49, 0.2, 0, 0.04, 0.4, 0.96);
    masu_world_box(m, -0.49, 0.2, 0, 0.04, 0.4, 0.96);
    masu_world_material(m, METAL);
    masu_world_tube(m, 1, 0.2, 0, 0.2, 1.4, 0.12, 0.12, 24);
    masu_world_ball(m, 0.2, 1.4, 0.2, 0.12, 0.3, 0.12, 6, 24, 1);
    masu_world_box(m, -0.25, 0.6, -0.2, 0.3, 1.2, 0.25);
}

static void roof_gable(mesh *m) {
    const double outline[3][2] = {{-0.54, 0}, {0.54, 0}, {0, 2.6}};
    masu_world_material(m, CLOTH);
    masu_world_prism(m, outline, 3, -0.54, 0.54);
    masu_world_material(m, STONE);
    masu_world_box(m, 0.25, 1.8, 0.2, 0.08, 2.4, 0.08);
    masu_world_box(m, -0.2, 1.8, -0.3, 0.08, 2.4, 0.08);
}

static void roof_dome(mesh *m) {
    masu_world_material(m, METAL);
    masu_world_ball(m, 0, 0, 0, 0.5, 4.5, 0.5, 14, 32, 1);
    masu_world_tube(m, 1, 0, 4.3, 0, 2.4, 0.02, 0.0, 8);
    masu_world_material(m, STONE);
    for (int i = 0; i < 4; i++) {
        masu_world_tube(m, 1, i & 1 ? 0.46 : -0.46, 0, i & 2 ? 0.46 : -0.46, 2.2, 0.04, 0.03, 12);
        masu_world_ball(m, i & 1 ? 0.46 : -0.46, 2.3, i & 2 ? 0.46 : -0.46, 0.05, 0.4, 0.05, 6, 12,
                        0);
    }
}

/* ---- objects on facades ---------------------------------------------------------------------- */

static void balcony(mesh *m) {
    masu_world_material(m, STONE);
    masu_world_box(m, 0, 0.1, 0.65, 2.6, 0.2, 1.3);
    masu_world_box(m, -1.0, -0.2, 0.35, 0.2, 0.4, 0.7);
    masu_world_box(m, 1.0, -0.2, 0.35, 0.2, 0.4, 0.7);
    masu_world_material(m, METAL);
    masu_world_box(m, 0, 1.15, 1.25, 2.6, 0.06, 0.06);
    masu_world_box(m, -1.27, 1.15, 0.65, 0.06, 0.06, 1.3);
    masu_world_box(m, 1.27, 1.15, 0.65, 0.06, 0.06, 1.3);
    for (int i = 0; i <= 10; i++) {
        masu_world_tube(m, 1, -1.25 + i * 0.25, 0.2, 1.25, 0.95, 0.02, 0.02, 4);
    }
    for (int i = 0; i < 4; i++) {
        masu_world_tube(m, 1, -1.27, 0.2, 0.2 + 0.25 * i, 0.95, 0.02, 0.02, 4);
        masu_world_tube(m, 1, 1.27, 0.2, 0.2 + 0.25 * i, 0.95, 0.02, 0.02, 4);
    }
    masu_world_material(m, LEAF);
    masu_world_ball(m, -0.7, 0.5, 0.9, 0.4, 0.3, 0.25, 5, 8, 0);
}

static void pipe(mesh *m) { /* up a wall, 6 m */
    masu_world_material(m, METAL);
    masu_world_tube(m, 1, 0, 0, 0.22, 6.0, 0.11, 0.11, 10);
    masu_world_tube(m, 1, 0.34, 0, 0.20, 6.0, 0.07, 0.07, 8);
    for (int i = 0; i < 2; i++) {
        masu_world_tube(m, 1, 0, 0.6 + 3.0 * i, 0.22, 0.12, 0.16, 0.16, 10);
        masu_world_box(m, 0.17, 0.9 + 3.0 * i, 0.1, 0.6, 0.06, 0.2);
    }
}

static void pipe_bundle(mesh *m) { /* under a deck, 24 m along x */
    masu_world_material(m, METAL);
    for (int k = 0; k < 4; k++) {
        double r = 0.25 + 0.1 * k, z = -2.4 + 1.5 * k;
        masu_world_tube(m, 0, -12, -1.2, z, 24, r, r, 20);
        for (int i = 0; i < 5; i++) {
            masu_world_tube(m, 0, -10 + 5 * i, -1.2, z, 0.3, r + 0.1, r + 0.1, 20);
        }
    }
    masu_world_material(m, DARK);
    for (int i = 0; i < 5; i++) masu_world_box(m, -9.5 + 5 * i, -0.6, 0, 0.2, 1.2, 6.5);
}

static void conditioner(mesh *m) {
    masu_world_material(m, TRIM);
    masu_world_box(m, 0, 0.4, 0.35, 1.1, 0.8, 0.5);
    masu_world_material(m, DARK);
    masu_world_tube(m, 2, -0.15, 0.4, 0.6, 0.04, 0.32, 0.32, 20);
    masu_world_material(m, METAL);
    for (int i = 0; i < 7; i++) masu_world_box(m, -0.15, 0.12 + 0.093 * i, 0.66, 0.7, 0.02, 0.02);
    masu_world_box(m, -0.4, -0.05, 0.25, 0.06, 0.1, 0.5);
    masu_world_box(m, 0.4, -0.05, 0.25, 0.06, 0.1, 0.5);
    masu_world_tube(m, 1, 0.48, -1.2, 0.12, 1.2, 0.04, 0.04, 8);
}

static void sign(mesh *m) {
    masu_world_material(m, DARK);
    masu_world_box(m, 0, 1.0, 0.7, 0.12, 2.0, 0.9);
    masu_world_material(m, LIGHT);
    for (int i = 0; i < 2; i++) {
        masu_world_ball(m, 0, 0.5 + 0.9 * i, 0.7, 0.12, 0.3, 0.3, 6, 8, 0);
    }
}

/* ---- streets --------------------------------------------------------------------------------- */

static void lamp(mesh *m) {
    masu_world_material(m, METAL);
    masu_world_tube(m, 1, 0, 0, 0, 0.5, 0.16, 0.12, 16);
    masu_world_tube(m, 1, 0, 0.5, 0, 3.6, 0.07, 0.05, 12);
    masu_world_box(m, 0, 3.9, 0, 1.2, 0.06, 0.06);
    masu_world_material(m, LIGHT);
    masu_world_ball(m, -0.55, 3.65, 0, 0.18, 0.22, 0.18, 6, 10, 0);
    masu_world_ball(m, 0.55, 3.65, 0, 0.18, 0.22, 0.18, 6, 10, 0);
}

static void railing(mesh *m) { /* 12 m along x */
    masu_world_material(m, METAL);
    masu_world_box(m, 0, 1.1, 0, 12, 0.08, 0.08);
    masu_world_box(m, 0, 0.15, 0, 12, 0.05, 0.05);
    for (int i = 0; i < 24; i++) {
        masu_world_tube(m, 1, -5.75 + 0.5 * i, 0.15, 0, 0.95, 0.02, 0.02, 4);
    }
    for (int i = 0; i < 5; i++) masu_world_box(m, -5.95 + 2.975 * i, 0.6, 0, 0.12, 1.2, 0.12);
}

static void stall(mesh *m) {
    masu_world_material(m, WOOD);
    masu_world_box(m, 0, 0.45, 0, 2.4, 0.9, 1.2);
    for (int i = 0; i < 4; i++) {
        masu_world_tube(m, 1, i & 1 ? 1.15 : -1.15, 0, i & 2 ? 0.75 : -0.75, 2.5, 0.05, 0.05, 8);
    }
    masu_world_material(m, CLOTH);
    for (int i = 0; i < 6; i++) {
        masu_world_box(m, -1.1 + 0.44 * i, 2.5 + 0.04 * (i & 1), 0, 0.42, 0.06, 1.9);
    }
    masu_world_material(m, LEAF);
    for (int i = 0; i < 8; i++) {
        masu_world_ball(m, -0.95 + 0.27 * i, 1.0, 0.2 - 0.4 * (i & 1), 0.12, 0.12, 0.12, 6, 8, 0);
    }
}

static void tree(mesh *m) {
    masu_world_material(m, STONE);
    masu_world_tube(m, 1, 0, 0, 0, 0.6, 0.9, 1.0, 12);
    masu_world_material(m, WOOD);
    masu_world_tube(m, 1, 0, 0.6, 0, 2.4, 0.18, 0.10, 10);
    masu_world_material(m, LEAF);
    static const double crowns[6][4] = {{0, 4.0, 0, 1.3},    {0.8, 3.4, 0.3, 0.9},
                                        {-0.7, 3.5, 0.5, 1}, {0.2, 3.3, -0.9, 0.9},
                                        {-0.3, 4.9, 0.1, 1}, {0.4, 4.6, -0.5, 0.8}};
    for (int i = 0; i < 6; i++) {
        const double *c = crowns[i];
        masu_world_ball(m, c[0], c[1], c[2], c[3], c[3] * 0.85, c[3], 8, 14, 0);
    }
}

static void person(mesh *m, const char *clothes) {
    masu_world_material(m, DARK);
    masu_world_tube(m, 1, -0.11, 0, 0, 0.85, 0.07, 0.09, 10);
    masu_world_tube(m, 1, 0.11, 0, 0.05, 0.85, 0.07, 0.09, 10);
    masu_world_ball(m, -0.11, 0.05, 0.06, 0.07, 0.06, 0.14, 5, 8, 0);
    masu_world_ball(m, 0.11, 0.05, 0.11, 0.07, 0.06, 0.14, 5, 8, 0);
    masu_world_material(m, clothes);
    masu_world_tube(m, 1, 0, 0.8, 0, 0.6, 0.20, 0.17, 14);
    masu_world_ball(m, 0, 1.38, 0, 0.22, 0.12, 0.15, 5, 12, 0);
    masu_world_tube(m, 1, -0.26, 0.78, 0, 0.62, 0.05, 0.06, 8);
    masu_world_tube(m, 1, 0.26, 0.78, 0, 0.62, 0.05, 0.06, 8);
    masu_world_material(m, SKIN);
    masu_world_tube(m, 1, 0, 1.42, 0, 0.14, 0.06, 0.06, 8);
    masu_world_ball(m, 0, 1.66, 0, 0.11, 0.14, 0.12, 7, 10, 0);
    masu_world_ball(m, -0.26, 0.74, 0, 0.05, 0.07, 0.05, 5, 8, 0);
    masu_world_ball(m, 0.26, 0.74, 0, 0.05, 0.07, 0.05, 5, 8, 0);
    masu_world_material(m, WOOD);
    masu_world_ball(m, 0, 1.70, -0.02, 0.125, 0.13, 0.125, 4, 10, 1);
}

static void person_red(mesh *m) { person(m, CLOTH); }
static void person_pale(mesh *m) { person(m, TRIM); }
static void person_green(mesh *m) { person(m, LEAF); }

/* ---- decks ----------------------------------------------------------------------------------- */

static void deck(mesh *m) { /* 48 m square, its top at y = 0 */
    masu_world_material(m, STONE);
    masu_world_box(m, 0, -1, 0, 48, 2, 48);
    masu_world_material(m, TRIM); /* the pavement around the block, a step high */
    masu_world_box(m, 0, 0.075, 0, 38, 0.15, 38);
    masu_world_material(m, METAL);
    for (int i = 0; i < 6; i++) {
        masu_world_box(m, 0, -2.5, -20 + 8 * i, 47, 1.0, 0.5);
        masu_world_box(m, -20 + 8 * i, -3.2, 0, 0.5, 0.5, 47);
    }
    masu_world_material(m, DARK); /* drains along the street */
    for (int i = 0; i < 8; i++) {
        masu_world_box(m, -21 + 6 * i, 0.01, 19.6, 1.2, 0.02, 0.5);
        masu_world_box(m, 19.6, 0.01, -21 + 6 * i, 0.5, 0.02, 1.2);
    }
}

static void pillar(mesh *m) { /* 38 m high */
    masu_world_material(m, STONE);
    masu_world_tube(m, 1, 0, 0, 0, 38, 2.2, 2.2, 32);
    masu_world_tube(m, 1, 0, 0, 0, 3, 3.2, 2.4, 32);
    masu_world_tube(m, 1, 0, 34, 0, 4, 2.4, 4.0, 32);
    masu_world_material(m, METAL);
    for (int i = 0; i < 5; i++) masu_world_tube(m, 1, 0, 6 + 6 * i, 0, 0.6, 2.4, 2.4, 32);
}

static void stairs(mesh *m) { /* two flights of 20 m between decks, zigzag along x */
    masu_world_material(m, STONE);
    for (int i = 0; i < 80; i++) {
        int flight = i / 40, step = i % 40;
        double x = flight ? 8 - 0.4 * step : -8 + 0.4 * step;
        masu_world_box(m, x, 0.25 + 0.5 * i - 0.15, flight ? 1.3 : -1.3, 0.42, 0.3, 2.4);
    }
    masu_world_box(m, 8.8, 19.8, 0, 2, 0.4, 5.2);
    masu_world_material(m, METAL);
    masu_world_tube(m, 1, 9.4, 0, 2.2, 20, 0.2, 0.2, 12);
    masu_world_tube(m, 1, 9.4, 0, -2.2, 20, 0.2, 0.2, 12);
    for (int i = 0; i < 16; i++) {
        masu_world_tube(m, 1, -8 + 1.0 * i, 1.25 * i, -2.5, 1.6, 0.03, 0.03, 6);
        masu_world_tube(m, 1, 8 - 1.0 * i, 20 + 1.25 * i, 2.5, 1.6, 0.03, 0.03, 6);
    }
}

static void bridge(mesh *m) { /* 48 m along x, 6 wide */
    masu_world_material(m, STONE);
    masu_world_box(m, 0, -0.5, 0, 48, 1, 6);
    for (int i = 0; i < 12; i++) { /* an arch of blocks below */
        double x = -22 + 4.0 * i, rise = 8.0 * (1 - (x / 24) * (x / 24));
        masu_world_box(m, x, -10 + rise, 0, 4.2, 1.2, 5);
        if (i != 5 && i != 6) masu_world_box(m, x, -5.4 + rise / 2, 0, 0.8, 8.8 - rise, 4);
    }
    masu_world_material(m, METAL);
    for (int s = -1; s <= 1; s += 2) {
        masu_world_box(m, 0, 1.1, 2.9 * s, 48, 0.1, 0.1);
        for (int i = 0; i < 96; i++)
            masu_world_tube(m, 1, -23.75 + 0.5 * i, 0, 2.9 * s, 1.1, 0.03, 0.03, 5);
    }
}

static void airship(mesh *m) { /* 30 m along z */
    masu_world_material(m, CLOTH);
    masu_world_ball(m, 0, 8, 0, 5, 5, 15, 24, 40, 0);
    masu_world_material(m, WOOD);
    masu_world_box(m, 0, 0.8, 0, 3, 1.6, 9);
    masu_world_ball(m, 0, 0.8, 4.5, 1.5, 0.8, 2.5, 8, 16, 0);
    masu_world_material(m, METAL);
    for (int i = 0; i < 8; i++) {
        masu_world_tube(m, 1, i & 1 ? 1.4 : -1.4, 1.5, -3.6 + 2.4 * (i / 2), 3.4, 0.05, 0.05, 6);
    }
    for (int i = 0; i < 2; i++) {
        masu_world_tube(m, 2, i ? 2.6 : -2.6, 1.2, -4, 2.5, 0.7, 0.5, 20);
        for (int k = 0; k < 4; k++) {
            masu_world_box(m, i ? 2.6 : -2.6, 1.2, -4.1, k & 1 ? 0.2 : 2.8, k & 1 ? 2.8 : 0.2,
                           0.06);
        }
    }
    masu_world_box(m, 0, 8, -14, 0.3, 9, 4);
    masu_world_box(m, 0, 8, -14, 9, 0.3, 4);
}

bool masu_world_parts(const char *folder) {
    static const struct {
        const char *name;
        void (*make)(mesh *m);
    } parts[] = {
        {"facade_4_plain", facade_4_plain},
        {"facade_4_arch", facade_4_arch},
        {"facade_4_shop", facade_4_shop},
        {"facade_6_plain", facade_6_plain},
        {"facade_6_arch", facade_6_arch},
        {"facade_6_shop", facade_6_shop},
        {"shell", shell},
        {"round_shell", round_shell},
        {"roof_flat", roof_flat},
        {"roof_gable", roof_gable},
        {"roof_dome", roof_dome},
        {"balcony", balcony},
        {"pipe", pipe},
        {"pipe_bundle", pipe_bundle},
        {"conditioner", conditioner},
        {"sign", sign},
        {"lamp", lamp},
        {"railing", railing},
        {"stall", stall},
        {"tree", tree},
        {"person_red", person_red},
        {"person_pale", person_pale},
        {"person_green", person_green},
        {"deck", deck},
        {"pillar", pillar},
        {"stairs", stairs},
        {"bridge", bridge},
        {"airship", airship},
    };
    FILE *out = masu_world_create(folder, "city.mtl");
    if (!out) return false;
    fputs(materials, out);
    if (!masu_world_close(out, folder, "city.mtl")) return false;
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        char name[64];
        snprintf(name, sizeof name, "%s.obj", parts[i].name);
        mesh m = {.out = masu_world_create(folder, name)};
        if (!m.out) return false;
        fprintf(m.out, "mtllib city.mtl\no %s\n", parts[i].name);
        parts[i].make(&m);
        masu_world_finish(&m);
        if (!masu_world_close(m.out, folder, name)) return false;
    }
    return true;
}
