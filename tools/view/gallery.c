/* gallery.c: the start page, which shows the scenes of a folder as thumbnails. Child processes
 * render missing thumbnails one after the other while the page is open. They bake the scene unless
 * the folder "scenes" of the cache contains its blob. */
#include "view/viewer.h"

#include "image.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define TEXT(x) #x
#define NUMBER(x) TEXT(x)
#define PICTURE_SIZE NUMBER(MASU_UI_PICTURE_WIDTH) "x" NUMBER(MASU_UI_PICTURE_HEIGHT)

static int by_name(const void *a, const void *b) { return strcmp(a, b); }

static void name_of(const char *path, char *out, size_t size) {
    const char *slash = strrchr(path, '/');
    snprintf(out, size, "%s", slash ? slash + 1 : path);
    char *dot = strrchr(out, '.');
    if (dot && dot != out) *dot = '\0';
}

static void list_scenes(masu_gallery *g, const char *folder) {
    DIR *d = opendir(folder);
    const struct dirent *e;
    while (d && (e = readdir(d)) && g->count < MASU_GALLERY_MAX) {
        const char *dot = strrchr(e->d_name, '.');
        if (!dot || dot == e->d_name || strcmp(dot, ".json") != 0) continue;
        int n = snprintf(g->paths[g->count], sizeof g->paths[0], "%s/%s", folder, e->d_name);
        if (n > 0 && n < (int)sizeof g->paths[0]) g->count++;
    }
    if (d) closedir(d);
    qsort(g->paths, g->count, sizeof g->paths[0], by_name);
}

/* Returns false if there is no thumbnail of the expected size. */
static bool read_picture(masu_gallery *g, uint32_t i) {
    struct masu_image image = {0};
    bool good = masu_image_load_png(g->picture, &image, NULL, 0) &&
                image.width == MASU_UI_PICTURE_WIDTH && image.height == MASU_UI_PICTURE_HEIGHT;
    if (good) {
        g->pictures[i] = image.rgba;
        image.rgba = NULL;
        g->stale = true;
    }
    masu_image_free(&image);
    return good;
}

static void name_picture(masu_gallery *g, uint32_t i) {
    char name[256];
    name_of(g->paths[i], name, sizeof name);
    snprintf(g->picture, sizeof g->picture, "%.800s/%s.png", g->folder, name);
}

/* A thumbnail older than its scene description is rendered again. */
static bool is_fresh(const masu_gallery *g, uint32_t i) {
    struct stat picture, source;
    return !stat(g->picture, &picture) && !stat(g->paths[i], &source) &&
           picture.st_mtime >= source.st_mtime;
}

/* $1 scene, $2 thumbnail, $3 blob that may exist, $4 masu; then the baker. */
static void make_picture(masu_viewer *v, uint32_t i) {
    static const char words[] =
        "scene=$1 picture=$2 blob=$3 masu=$4; shift 4; made=; "
        "[ -f \"$blob\" ] && [ \"$blob\" -nt \"$scene\" ] || { blob=$picture.masu made=$blob; "
        "nice \"$@\" \"$scene\" -o \"$blob\" --quiet || exit 1; }; "
        "nice \"$masu\" render \"$blob\" -o \"$picture\" --frames 8 --setting temporal=on "
        "--size " PICTURE_SIZE " --quiet; "
        "code=$?; [ \"$made\" ] && rm -f \"$picture.masu\"; exit $code";
    masu_gallery *g = &v->gallery;
    char masu[1100], bake[1100], blob[1400], name[256], log[1200], command[2600];
    masu_program_beside(masu, sizeof masu, "masu");
    masu_program_beside(bake, sizeof bake, "masu-bake");
    name_of(g->paths[i], name, sizeof name);
    snprintf(blob, sizeof blob, "%.800s/../scenes/%s.masu", g->folder, name);
    snprintf(log, sizeof log, "%.1000s/log", g->folder);
    /* The baker of --bake is shell text, not one argument. */
    snprintf(command, sizeof command, "set -- \"$1\" \"$2\" \"$3\" \"$4\" %s; %s",
             v->o->bake ? v->o->bake : "\"$5\"", words);
    g->child = masu_child_start(v, command, log,
                                (char *[]){g->paths[i], g->picture, blob, masu, bake, NULL});
}

void masu_gallery_open(masu_viewer *v) {
    masu_gallery *g = &v->gallery;
    g->open = true;
    if (!v->o->gallery || g->count) return;
    list_scenes(g, v->o->gallery);
    const char *root = getenv("TMPDIR");
    if (v->o->cache)
        snprintf(g->folder, sizeof g->folder, "%s", v->o->cache);
    else
        snprintf(g->folder, sizeof g->folder, "%.900s/masu-view-pictures-%lu",
                 root && *root ? root : "/tmp", (unsigned long)getuid());
    if (mkdir(g->folder, 0777) && errno != EEXIST) g->made = g->count; /* no thumbnails */
    for (uint32_t i = 0; i < g->count; i++) { /* show the existing thumbnails at once */
        name_picture(g, i);
        if (is_fresh(g, i)) (void)read_picture(g, i);
    }
}

bool masu_gallery_poll(masu_viewer *v) {
    masu_gallery *g = &v->gallery;
    int status;
    if (g->child && masu_child_ended(g->child, false, &status)) {
        g->child = 0;
        name_picture(g, g->made);
        (void)read_picture(g, g->made++);
    }
    if (!g->open || g->child) return true;
    while (g->made < g->count && g->pictures[g->made]) g->made++;
    if (g->made < g->count) {
        name_picture(g, g->made);
        make_picture(v, g->made);
        if (!g->child) g->made = g->count;
    }
    if (!g->stale) return true;
    masu_viewer_settle(v);
    return masu_viewer_attach_ui(v);
}

void masu_gallery_draw(masu_viewer *v) {
    masu_gallery *g = &v->gallery;
    char name[256];
    masu_ui_window("start", MASU_UI_ALL, v->panels.focus);
    v->panels.focus = false;
    masu_ui_text(MASU_INK_TITLE, "Masu");
    masu_ui_text(MASU_INK, "Drop a file here: a model (.glb, .gltf, .obj, ...), an SDF (.sdf), a "
                           "scene description (.json) "
                           "or a baked scene (.masu).");
    if (g->count)
        masu_ui_text(MASU_INK_DIM, "Or choose a scene: arrow keys and Space, or the mouse.%s",
                     g->child ? " Pictures are being made." : "");
    for (uint32_t i = 0; i < g->count; i++) {
        name_of(g->paths[i], name, sizeof name);
        if (masu_ui_picture(i, name)) masu_baker_open(v, g->paths[i]);
    }
    masu_ui_window_end();
}

void masu_gallery_close(masu_gallery *g) {
    masu_child_end(g->child);
    for (uint32_t i = 0; i < g->count; i++) free(g->pictures[i]);
    memset(g, 0, sizeof *g);
}
