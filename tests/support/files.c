/* files.c: see files.h. */
#include "support/files.h"

#include "image.h"

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
    static char paths[4][256];
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

uint32_t trials(uint32_t all, uint32_t quick) { return long_run() ? all : quick; }

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

void bake_scene(const char *name, const char *json) {
    char file[64];
    snprintf(file, sizeof file, "%s.json", name);
    write_text(file, json);
    if (shell("%s/bin/masu-bake %s/%s -o %s/%s.masu --quiet", build_dir(), scratch, file, scratch,
              name))
        fail_msg("%s cannot be baked", file);
}

const char *baked_scene(const char *name) {
    char file[64];
    snprintf(file, sizeof file, "%s.masu", name);
    return in_scratch(file);
}
