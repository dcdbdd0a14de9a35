/* files.c: see files.h. */
#define _DEFAULT_SOURCE /* scandir */
#include "support/files.h"

#include "image.h"

#include <dirent.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

char scratch[64];

int make_scratch(void **state) {
    (void)state;
    snprintf(scratch, sizeof scratch, "/tmp/masu-test-XXXXXX");
    return mkdtemp(scratch) ? 0 : 1;
}

int remove_scratch(void **state) {
    (void)state;
    return shell("rm -rf %s", scratch);
}

int remove_empty_scratch(void **state) {
    (void)state;
    return rmdir(scratch);
}

const char *in_scratch(const char *name) {
    static char paths[4][512];
    static uint32_t next;
    char *path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", scratch, name);
    return path;
}

const char *write_bytes(const char *name, const void *bytes, size_t count) {
    const char *path = in_scratch(name);
    FILE *f = fopen(path, "wb");
    if (!f) fail_msg("%s cannot be written", path);
    assert_int_equal(fwrite(bytes, 1, count, f), count);
    assert_int_equal(fclose(f), 0);
    return path;
}

const char *write_text(const char *name, const char *text) {
    return write_bytes(name, text, strlen(text));
}

bool is_in_scratch(const char *name) { return access(in_scratch(name), F_OK) == 0; }

void *read_file(const char *path, size_t *bytes) {
    char error[512];
    uint8_t *text;
    size_t count;
    if (!masu_file_read(path, (size_t)1 << 30, &text, &count, error, sizeof error))
        fail_msg("%s", error);
    text = realloc(text, count + 1);
    assert_non_null(text);
    text[count] = 0;
    if (bytes) *bytes = count;
    return text;
}

const char *build_dir(void) {
    const char *build = getenv("BUILD");
    return build ? build : "build";
}

const char *made_dir(void) {
    const char *made = getenv("MADE");
    return made ? made : build_dir();
}

const char *c_compiler(void) {
    const char *compiler = getenv("CC");
    return compiler && *compiler ? compiler : "cc";
}

bool long_run(void) {
    const char *is = getenv("LONG");
    return is && *is && strcmp(is, "0");
}

bool whole_run(void) {
    const char *driver = getenv("MASU_TEST_DRIVER"), *nested = getenv("NESTED");
    if (nested && *nested) return long_run();
    return long_run() || !driver || !*driver || !strcmp(driver, "system");
}

bool is_slow_driver(void) {
    const char *driver = getenv("MASU_TEST_DRIVER");
    return !long_run() && driver && !strcmp(driver, "swiftshader");
}

uint32_t trials(uint32_t all, uint32_t quick, uint32_t elsewhere) {
    return long_run() ? all : whole_run() ? quick : elsewhere;
}

int shell_list(const char *format, va_list arguments) {
    char command[8192];
    assert_true(vsnprintf(command, sizeof command, format, arguments) < (int)sizeof command);
    int status = system(command);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

int shell(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    int code = shell_list(format, arguments);
    va_end(arguments);
    return code;
}

/* ---- Scenes ---------------------------------------------------------------------------------- */

void hash_bytes(uint64_t *h, const void *bytes, size_t count) {
    for (size_t i = 0; i < count; i++) *h = (*h ^ ((const uint8_t *)bytes)[i]) * 0x100000001B3u;
}

static int is_input(const struct dirent *entry) {
    const char *end = strrchr(entry->d_name, '.');
    return end && end[1] && strcmp(end, ".masu") && strcmp(end, ".so");
}

/* Hash of all possible inputs of a scene: every file of the scratch folder. */
static uint64_t hash_of_inputs(const char *name) {
    struct dirent **list;
    uint64_t h = HASH_START;
    int count = scandir(scratch, &list, is_input, alphasort);
    assert_true(count > 0);
    hash_bytes(&h, name, strlen(name));
    for (int i = 0; i < count; i++) {
        size_t bytes;
        void *content = read_file(in_scratch(list[i]->d_name), &bytes);
        hash_bytes(&h, list[i]->d_name, strlen(list[i]->d_name) + 1);
        hash_bytes(&h, content, bytes);
        free(content);
        free(list[i]);
    }
    free(list);
    return h;
}

void bake_scene(const char *name, const char *json) {
    char file[64], kept[512] = "";
    const char *folder = getenv("MASU_BAKED");
    snprintf(file, sizeof file, "%s.json", name);
    write_text(file, json);
    if (folder && *folder) {
        snprintf(kept, sizeof kept, "%s/%016llx.masu", folder,
                 (unsigned long long)hash_of_inputs(name));
        if (access(kept, R_OK) == 0 && shell("cp %s %s/%s.masu", kept, scratch, name) == 0) return;
    }
    if (shell("%s/bin/masu-bake %s/%s -o %s/%s.masu --bare --quiet", build_dir(), scratch, file,
              scratch, name))
        fail_msg("%s cannot be baked", file);
    /* Published atomically: the run of another driver may be looking for it. */
    if (*kept)
        assert_int_equal(shell("cp %s/%s.masu %s.%ld && mv %s.%ld %s", scratch, name, kept,
                               (long)getpid(), kept, (long)getpid(), kept),
                         0);
}

const char *baked_scene(const char *name) {
    char file[64];
    snprintf(file, sizeof file, "%s.masu", name);
    return in_scratch(file);
}
