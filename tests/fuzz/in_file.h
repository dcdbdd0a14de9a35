/* in_file.h: for fuzzers of readers that want a file's name and say what is wrong on standard error: a folder of
 * this process with the bytes in it, and what has been said about them.
 *
 * Standard error of stdio alone is caught: what the sanitizers and libFuzzer write goes where it went. */
#ifndef FUZZ_IN_FILE_H
#define FUZZ_IN_FILE_H

#include "expect.h"

static FILE *in_file_terminal; /* where standard error went */
static char in_file_said[4096], in_file_folder[32];

static inline void in_file_remove(void) {
    char command[64];
    snprintf(command, sizeof command, "rm -rf %s", in_file_folder);
    if (system(command)) fprintf(in_file_terminal, "%s is left\n", in_file_folder);
}

/* FOLDER/NAME with these bytes; out: room for 64. From then on nothing has been said. */
static inline const char *in_file(const char *name, const uint8_t *data, size_t size,
                                  char out[64]) {
    if (!in_file_terminal) {
        in_file_terminal = stderr;
        /* In memory, where there is such a folder: some files are synced with their disk. */
        snprintf(in_file_folder, sizeof in_file_folder, "%s/masu-fuzz-XXXXXX",
                 access("/dev/shm", W_OK) ? "/tmp" : "/dev/shm");
        EXPECT(mkdtemp(in_file_folder));
        EXPECT(!atexit(in_file_remove));
    }
    snprintf(out, 64, "%s/%s", in_file_folder, name);
    FILE *file = fopen(out, "wb");
    EXPECT(file && fwrite(data, 1, size, file) == size && !fclose(file));
    if (stderr != in_file_terminal) fclose(stderr);
    memset(in_file_said, 0, sizeof in_file_said);
    stderr = fmemopen(in_file_said, sizeof in_file_said - 1, "w");
    EXPECT(stderr);
    setvbuf(stderr, NULL, _IONBF, 0);
    return out;
}

/* Whether the file has these bytes and no others. */
static inline int in_file_is(const char *path, const uint8_t *data, size_t size) {
    FILE *file = fopen(path, "rb");
    EXPECT(file);
    int same = 1;
    for (size_t i = 0; i < size && same; i++) same = fgetc(file) == data[i];
    same = same && fgetc(file) == EOF;
    fclose(file);
    return same;
}

#endif
