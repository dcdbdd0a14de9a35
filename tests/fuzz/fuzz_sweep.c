/* fuzz_sweep.c: any bytes as a folder of `masu bench`: sweep.json, results.csv, steady.csv, machine.json, ladder.json,
 * one after the other, a line of four dashes between them. Read as a report, compared, merged into another folder:
 * whatever names are in it, nothing is written outside of that folder. */
#include "expect.h"
#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

#include "bench/against.h"
#include "bench/machine.h"
#include "bench/report.h"

static const char *const files[] = {"sweep.json", "results.csv", "steady.csv", "machine.json",
                                    "ladder.json"};
enum { FILES = sizeof files / sizeof *files };

static char root[64], part[80], merged[80];

static void remove_all(const char *path) {
    DIR *d = opendir(path);
    struct dirent *e;
    char below[512];
    while (d && (e = readdir(d))) {
        if (!strcmp(e->d_name, ".") || !strcmp(e->d_name, "..")) continue;
        snprintf(below, sizeof below, "%s/%s", path, e->d_name);
        if (unlink(below)) remove_all(below);
    }
    if (d) closedir(d);
    (void)rmdir(path);
}

static void at_end(void) { remove_all(root); }

static void begin(void) {
    if (*root) return;
    /* In memory, where there is such a folder: files are synced with their disk. */
    snprintf(root, sizeof root, "%s/masu-fuzz-XXXXXX",
             access("/dev/shm", W_OK) ? "/tmp" : "/dev/shm");
    EXPECT(mkdtemp(root));
    snprintf(part, sizeof part, "%s/part", root);
    snprintf(merged, sizeof merged, "%s/merged", root);
    EXPECT(!mkdir(part, 0777));
    (void)atexit(at_end);
}

static void write_parts(const uint8_t *data, size_t size) {
    static const char line[] = "\n----\n";
    for (int k = 0; k < FILES; k++) {
        size_t n = 0;
        char path[160];
        while (n < size && (size - n < 6 || memcmp(data + n, line, 6) != 0)) n++;
        if (k == FILES - 1) n = size;
        snprintf(path, sizeof path, "%s/%s", part, files[k]);
        (void)unlink(path);
        if (n) {
            FILE *f = fopen(path, "wb");
            EXPECT(f && fwrite(data, 1, n, f) == n && !fclose(f));
        }
        data += n < size ? n + 6 : n;
        size -= n < size ? n + 6 : n;
    }
}

/* Of a refusal: one line. */
static void check(bool good, const char *error) {
    EXPECT(good || (*error && !strchr(error, '\n')));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static masu_setting_list list;
    static masu_against against;
    char error[8192] = "";
    masu_machine machine;
    const char *const parts[] = {part};
    begin();
    write_parts(data, size);
    check(masu_report_rungs(part, &list, error, sizeof error), error);
    check(masu_report_unsteady(part, &list, error, sizeof error), error);
    check(masu_against_compare(part, part, &against, error, sizeof error), error);
    for (uint32_t i = 0; i < 4 && masu_machine_read(part, i, &machine); i++)
        EXPECT(strlen(machine.cpu) < sizeof machine.cpu);
    check(masu_sweep_merge(merged, parts, 1, error, sizeof error), error);
    remove_all(merged);
    DIR *d = opendir(root);
    struct dirent *e;
    while (d && (e = readdir(d))) EXPECT(e->d_name[0] == '.' || !strcmp(e->d_name, "part"));
    if (d) closedir(d);
    return 0;
}
