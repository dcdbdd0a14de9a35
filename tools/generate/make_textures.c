/* make_textures.c: generates the images of scenes/textures.json and of the tests:
 *
 *   make_textures FOLDER
 *
 * One in each file format that matters: PNG, JPEG, TGA with alpha, SGI .rgb. They are generated
 * during the build, so that the repository contains no binaries. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

#define PI 3.14159265358979323846

typedef struct picture {
    int size;
    uint8_t *rgba;
} picture;

static const char *folder;
static int failed;

static picture picture_of(int size) {
    picture p = {size, malloc((size_t)size * (size_t)size * 4)};
    if (!p.rgba) exit(1);
    return p;
}

static void set(picture *p, int x, int y, double r, double g, double b, double a) {
    const double v[4] = {r, g, b, a};
    for (int k = 0; k < 4; k++) {
        double c = v[k] < 0 ? 0 : v[k] > 1 ? 1 : v[k];
        p->rgba[4 * ((size_t)y * (size_t)p->size + (size_t)x) + (size_t)k] =
            (uint8_t)(c * 255 + 0.5);
    }
}

/* Integer noise: Wang's hash of the cell position. */
static double noise(int x, int y) {
    uint32_t h = (uint32_t)x * 73856093u ^ (uint32_t)y * 19349663u;
    h = (h ^ 61u) ^ h >> 16;
    h *= 9u;
    h ^= h >> 4;
    h *= 0x27d4eb2du;
    h ^= h >> 15;
    return h / 4294967295.0;
}

static const char *path_of(const char *name) {
    static char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static void check(int good, const char *name) {
    if (good) return;
    fprintf(stderr, "make_textures: cannot write %s/%s\n", folder, name);
    failed = 1;
}

static void save(picture *p, const char *name) {
    const char *kind = strrchr(name, '.');
    int good;
    if (!strcmp(kind, ".jpg")) {
        good = stbi_write_jpg(path_of(name), p->size, p->size, 4, p->rgba, 92);
    } else if (!strcmp(kind, ".tga")) {
        good = stbi_write_tga(path_of(name), p->size, p->size, 4, p->rgba);
    } else {
        good = stbi_write_png(path_of(name), p->size, p->size, 4, p->rgba, 4 * p->size);
    }
    check(good, name);
    free(p->rgba);
}

/* Uncompressed SGI: a header of 512 bytes, then the channels, each from its lowest row up. */
static void save_sgi(picture *p, const char *name) {
    uint8_t head[512] = {0x01, 0xDA, 0, 1, 0, 3};
    FILE *f = fopen(path_of(name), "wb");
    head[6] = head[8] = (uint8_t)(p->size >> 8);
    head[7] = head[9] = (uint8_t)p->size;
    head[11] = 4;
    head[19] = 255;
    int good = f && fwrite(head, 1, sizeof head, f) == sizeof head;
    for (size_t k = 0; k < 4 && good; k++) {
        for (int y = p->size - 1; y >= 0; y--) {
            for (int x = 0; x < p->size; x++) {
                fputc(p->rgba[4 * ((size_t)y * (size_t)p->size + (size_t)x) + k], f);
            }
        }
    }
    if (f && fclose(f)) good = 0;
    check(good, name);
    free(p->rgba);
}

/* ---- bricks: height, and from it colour, normal and roughness ---- */

#define BRICKS 256

typedef struct brick {
    double height; /* 0 in the mortar, 1 on the face */
    int column, row;
} brick;

static brick brick_at(int x, int y) {
    x = (x + BRICKS) % BRICKS;
    y = (y + BRICKS) % BRICKS;
    int row = y / 32, shift = row % 2 ? 32 : 0, column = (x + shift) % BRICKS / 64;
    double u = (x + shift) % 64 + 0.5, v = y % 32 + 0.5;
    double edge = fmin(fmin(u, 64 - u), fmin(v, 32 - v));
    double t = (edge - 1.5) / 3;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    return (brick){t * t * (3 - 2 * t) * (0.93 + 0.07 * noise(x / 3, y / 3)), column, row};
}

static void make_bricks(void) {
    picture color = picture_of(BRICKS), normal = picture_of(BRICKS), rough = picture_of(BRICKS);
    for (int y = 0; y < BRICKS; y++) {
        for (int x = 0; x < BRICKS; x++) {
            brick b = brick_at(x, y);
            double shade = 0.75 + 0.25 * noise(b.column + 17, b.row) + 0.12 * noise(x, y);
            double h = b.height > 0.5 ? 1 : 0;
            set(&color, x, y, h * 0.68 * shade + (1 - h) * 0.66, h * 0.33 * shade + (1 - h) * 0.64,
                h * 0.25 * shade + (1 - h) * 0.6, 1);
            /* A relief of 4 texels. +y of a normal map points up in the image. */
            double dx = (brick_at(x + 1, y).height - brick_at(x - 1, y).height) * 2;
            double dy = (brick_at(x, y + 1).height - brick_at(x, y - 1).height) * 2;
            double l = sqrt(dx * dx + dy * dy + 1);
            set(&normal, x, y, (128 - 127 * dx / l) / 255, (128 + 127 * dy / l) / 255,
                (128 + 127 / l) / 255, 1);
            double r = 0.95 - 0.35 * b.height + 0.1 * noise(x + 5, y + 9);
            set(&rough, x, y, r, r, r, 1);
        }
    }
    save(&color, "bricks.png");
    save(&normal, "bricks_normal.png");
    save(&rough, "bricks_rough.png");
}

/* ---- the others ---- */

/* A fern: leaflets along a stalk; the background has alpha 0 and another colour. */
static void make_leaf(void) {
    picture p = picture_of(128);
    for (int y = 0; y < 128; y++) {
        for (int x = 0; x < 128; x++) {
            double u = (x - 63.5) / 64, v = (127 - y) / 128.0;
            double width = 0.9 * (1 - v) * (0.35 + 0.65 * fabs(cos(v * 9 * PI + fabs(u) * 2)));
            double leaf = v < 0.98 && (fabs(u) < width || fabs(u) < 0.03) ? 1 : 0;
            set(&p, x, y, leaf * (0.2 + 0.1 * noise(x / 4, y / 4)), leaf * (0.45 + 0.25 * v),
                leaf * 0.12, leaf);
        }
    }
    save(&p, "leaf.tga");
}

static void make_ground(void) {
    picture p = picture_of(256);
    for (int y = 0; y < 256; y++) {
        for (int x = 0; x < 256; x++) {
            int tile = (x / 64 + y / 64) % 2;
            int joint = x % 64 < 2 || y % 64 < 2;
            double grain = 0.06 * noise(x, y) + 0.08 * noise(x / 5, y / 5);
            double c = joint ? 0.22 : tile ? 0.6 + grain : 0.42 + grain;
            set(&p, x, y, c, c * 0.98, c * 0.94, 1);
        }
    }
    save(&p, "ground.jpg");
}

/* A sign with rings, some of which glow in the second image. */
static void make_sign(void) {
    picture p = picture_of(100), glow = picture_of(100);
    for (int y = 0; y < 100; y++) {
        for (int x = 0; x < 100; x++) {
            double r = sqrt((x - 49.5) * (x - 49.5) + (y - 49.5) * (y - 49.5));
            int ring = (int)(r / 10);
            double on = ring % 2 && ring < 5;
            set(&p, x, y, on ? 0.9 : 0.12, on ? 0.75 : 0.14, on ? 0.2 : 0.3, 1);
            set(&glow, x, y, on, on * 0.7, on * 0.15, 1);
        }
    }
    save_sgi(&p, "sign.rgb");
    save(&glow, "sign_glow.png");
}

/* A checkerboard of single texels, with power-of-two and odd sizes, for the tests. */
static void make_checker(int size, const char *name) {
    picture p = picture_of(size);
    for (int y = 0; y < size; y++) {
        for (int x = 0; x < size; x++) {
            double c = (x + y) % 2;
            set(&p, x, y, c, c, c, 1);
        }
    }
    save(&p, name);
}

/* Gradients: red along x, green along y; no two texels are the same. */
static void make_gradient(void) {
    picture p = picture_of(64);
    for (int y = 0; y < 64; y++) {
        for (int x = 0; x < 64; x++) set(&p, x, y, x / 63.0, y / 63.0, 0.5, 1);
    }
    save(&p, "gradient.png");
}

/* More texels than one staging buffer holds. */
static void make_large(void) {
    picture p = picture_of(1200);
    for (int y = 0; y < 1200; y++) {
        for (int x = 0; x < 1200; x++) {
            set(&p, x, y, 0.5 + 0.5 * sin(x * 0.031), 0.5 + 0.5 * sin(y * 0.023 + x * 0.011),
                x / 1199.0, 1);
        }
    }
    save(&p, "large.jpg");
}

/* An opaque disc on a transparent background. */
static void make_disc(void) {
    picture p = picture_of(64);
    for (int y = 0; y < 64; y++) {
        for (int x = 0; x < 64; x++) {
            double r = sqrt((x - 31.5) * (x - 31.5) + (y - 31.5) * (y - 31.5));
            set(&p, x, y, 0.8, 0.5, 0.1, r < 24 ? 1 : 0);
        }
    }
    save(&p, "disc.png");
}

/* Smoke: grey, lumpy, with alpha that fades out at the rim. */
static void make_smoke(void) {
    picture p = picture_of(64);
    for (int y = 0; y < 64; y++) {
        for (int x = 0; x < 64; x++) {
            double u = (x - 31.5) / 31, v = (y - 31.5) / 31, r = sqrt(u * u + v * v);
            double lumps =
                0.5 + 0.25 * sin(u * 7 + 2 * sin(v * 5)) + 0.25 * sin(v * 9 + 3 * sin(u * 4));
            double a = r < 1 ? (1 - r) * (1 - r) * (1 + 2 * r) * (0.4 + 0.6 * lumps) : 0;
            set(&p, x, y, 0.8, 0.8, 0.85, a);
        }
    }
    save(&p, "smoke.png");
}

/* Needles: thin alpha shapes at any distance, 16 samples per texel; tiles seamlessly. */
static void make_needles(void) {
    enum { SIZE = 128, FINE = 4 * SIZE };
    picture p = picture_of(SIZE);
    uint8_t *fine = calloc(FINE, FINE);
    if (!fine) exit(1);
    for (int n = 0; n < 60; n++) {
        double x = noise(n, 1) * FINE, y = noise(n, 2) * FINE, turn = noise(n, 3) * 2 * PI;
        for (int j = -90; j <= 90; j++) {
            for (int i = -90; i <= 90; i++) {
                double u = (i * cos(turn) + j * sin(turn)) / 90;
                double v = (j * cos(turn) - i * sin(turn)) / 2.2;
                if (u * u + v * v >= 1) continue;
                fine[(size_t)((int)y + j + FINE) % FINE * FINE +
                     (size_t)((int)x + i + FINE) % FINE] = 1;
            }
        }
    }
    for (int y = 0; y < SIZE; y++) {
        for (int x = 0; x < SIZE; x++) {
            int sum = 0;
            for (int k = 0; k < 16; k++)
                sum += fine[(size_t)(4 * y + k / 4) * FINE + (size_t)(4 * x + k % 4)];
            set(&p, x, y, 0.1, 0.3, 0.1, sum / 16.0);
        }
    }
    free(fine);
    save(&p, "needles.png");
}

/* Constant tilted normals: 30 degrees to the right, and 30 degrees up. */
static void make_slopes(void) {
    picture right = picture_of(16), up = picture_of(16);
    double lean = (128 + 127 * sin(PI / 6)) / 255, rest = (128 + 127 * cos(PI / 6)) / 255;
    for (int y = 0; y < 16; y++) {
        for (int x = 0; x < 16; x++) {
            set(&right, x, y, lean, 128 / 255.0, rest, 1);
            set(&up, x, y, 128 / 255.0, lean, rest, 1);
        }
    }
    save(&right, "lean_right.png");
    save(&up, "lean_up.png");
}

int main(int argc, char **argv) {
    if (argc != 2) {
        fprintf(stderr, "usage: make_textures FOLDER\n");
        return 2;
    }
    folder = argv[1];
    make_bricks();
    make_leaf();
    make_ground();
    make_sign();
    make_checker(64, "checker.png");
    make_checker(37, "checker_odd.png");
    make_gradient();
    make_large();
    make_disc();
    make_needles();
    make_smoke();
    make_slopes();
    return failed;
}
