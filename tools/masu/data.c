/* data.c: see data.h. */
#define _POSIX_C_SOURCE 200809L
#include "masu/data.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The parent of the running program's folder; "" if unknown. */
static void program_root(char path[MASU_DATA_PATH]) {
    ssize_t length = readlink("/proc/self/exe", path, MASU_DATA_PATH - 1);
    path[length > 0 ? length : 0] = 0;
    for (int i = 0; i < 2; i++) {
        char *last = strrchr(path, '/');
        if (last) *last = 0;
    }
}

bool masu_data_folder(const char *kind, char path[MASU_DATA_PATH]) {
    static const char *const places[] = {"", "share/masu/"};
    char root[MASU_DATA_PATH];
    struct stat s;
    program_root(root);
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        int n = snprintf(path, MASU_DATA_PATH, "%s/%s%s", root, places[i], kind);
        if (n > 0 && n < MASU_DATA_PATH && !stat(path, &s) && S_ISDIR(s.st_mode)) return true;
    }
    snprintf(path, MASU_DATA_PATH, "%.1500s/%s, %.1500s/%s%s", root, kind, root, places[1], kind);
    return false;
}
