/* test_picture_path.c: search paths for the textures that models name, in folders made here. */
#define _XOPEN_SOURCE 700
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "bake/import/picture_path.h"
#include "support/files.h"

/* For a model below the scratch folder, a name resolves to a path below it, or to an absolute
 * one. */
static void leads(const char *model, const char *name, const char *expected) {
    char from[512], to[512];
    masu_bake_buffer out = {0};
    snprintf(from, sizeof from, "%s/%s", scratch, model);
    snprintf(to, sizeof to, "%s/%s", scratch, expected);
    masu_bake_picture_path(from, name, &out);
    assert_string_equal((const char *)out.data, *expected == '/' ? expected : to);
    assert_int_equal(out.bytes, strlen((const char *)out.data) + 1);
    masu_bake_release(&out);
}

static void names_of_other_machines(void **state) {
    (void)state;
    leads("m/x.dae", "a b.png", "m/a b.png");
    leads("m/x.dae", "a%20b.png", "m/a b.png");
    leads("m/x.dae", "./maps/a%20c.png", "m/maps/a c.png");
    leads("m/x.dae", "50%25.png", "m/50%.png");
    leads("m/x.dae", "9%20.png", "m/9%20.png"); /* its literal name */
    leads("m/x.dae", ".\\maps\\a c.png", "m/maps/a c.png");
    leads("m/x.dae", "C:\\textures\\a b.png", "m/a b.png");
    leads("m/x.dae", "/home/somebody/a%20b.png", "m/a b.png");
    leads("m/x.dae", "file:///C:/textures/a%20b.png", "m/a b.png");
    leads("m/x.dae", "gone%20.png", "m/gone%20.png");
    leads("m/x.dae", "C:\\gone.png", "m/C:/gone.png");
    leads("m/x.dae", "/gone/gone.png", "/gone/gone.png");
    leads("m/x.dae", "%2Fetc%2Fpasswd", "m/%2Fetc%2Fpasswd"); /* no escape from the folder */
    leads("m/x.dae", "/", "/");
}

static void names_in_other_case(void **state) {
    (void)state;
    leads("m/x.dae", "A B.PNG", "m/a b.png");
    leads("m/x.dae", "Maps/A C.png", "m/maps/a c.png");
    leads("m/x.dae", "MAPS\\a%20C.PNG", "m/maps/a c.png");
    leads("m/x.dae", "C:\\Textures\\A B.PNG", "m/a b.png");
    /* Beyond ASCII. */
    leads("m/x.dae", "MAPS/D\xC3\x84" "CH\xD0\x96.PNG", "m/maps/d\xC3\xA4" "ch\xD0\xB6.png");
    leads("m/x.dae", "../M/a b.png", "m/a b.png"); /* the last part, in the model's own folder */
    leads("m/x.dae", "Twice.png", "m/TWICE.png");  /* the first of two, in byte order */
    leads("m/x.dae", "twice.png", "m/twice.png");
    leads("t/tracks/road/r/r.acc", "TREE.RGB", "t/data/textures/tree.rgb");
}

static void tracks_have_textures_in_common(void **state) {
    (void)state;
    leads("t/tracks/road/r/r.acc", "own.rgb", "t/tracks/road/r/own.rgb");
    leads("t/tracks/road/r/r.acc", "tree.rgb", "t/data/textures/tree.rgb");
    leads("t/tracks/road/r/r.acc", "../../x/tree.rgb", "t/data/textures/tree.rgb");
    leads("t/cars/c/c.acc", "tree.rgb", "t/data/textures/tree.rgb");
    /* next to the folder of textures, not inside it */
    leads("t/cars/c/c.acc", "secret", "t/cars/c/secret");
    leads("t/tracks/road/r/r.ac", "tree.rgb", "t/tracks/road/r/tree.rgb");
    leads("t/other/road/r/r.acc", "tree.rgb", "t/other/road/r/tree.rgb");
    leads("t/tracks/r.acc", "tree.rgb", "t/tracks/tree.rgb");
    char here[512];
    assert_non_null(getcwd(here, sizeof here));
    snprintf(here, sizeof here, "%s/t/tracks/road/r", scratch);
    assert_int_equal(chdir(here), 0);
    masu_bake_buffer out = {0};
    masu_bake_picture_path("r.acc", "tree.rgb", &out); /* by a relative path */
    snprintf(here, sizeof here, "%s/t/data/textures/tree.rgb", scratch);
    assert_string_equal((const char *)out.data, here);
    masu_bake_release(&out);
}

static int make_folders(void **state) {
    (void)state;
    static const char *const folders[] = {"m",       "m/maps",       "t",
                                          "t/tracks", "t/tracks/road", "t/tracks/road/r",
                                          "t/other",  "t/other/road",  "t/other/road/r",
                                          "t/cars",   "t/cars/c",      "t/data",
                                          "t/data/textures"};
    static const char *const files[] = {"m/a b.png",
                                        "m/maps/a c.png",
                                        "m/maps/d\303\244ch\320\266.png",
                                        "m/twice.png",
                                        "m/TWICE.png",
                                        "m/50%.png",
                                        "m/9%20.png",
                                        "t/tracks/road/r/own.rgb",
                                        "t/tracks/road/r/r.acc",
                                        "t/tracks/road/r/r.ac",
                                        "t/other/road/r/r.acc",
                                        "t/tracks/r.acc",
                                        "t/cars/c/c.acc",
                                        "t/data/textures/tree.rgb",
                                        "t/data/secret"};
    if (make_scratch(state)) return -1;
    for (size_t i = 0; i < sizeof folders / sizeof *folders; i++) {
        if (mkdir(in_scratch(folders[i]), 0700)) return -1;
    }
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) write_text(files[i], "");
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_of_other_machines),
        cmocka_unit_test(names_in_other_case),
        cmocka_unit_test(tracks_have_textures_in_common),
    };
    return cmocka_run_group_tests(tests, make_folders, remove_scratch);
}
