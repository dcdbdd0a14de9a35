/* The two sides of ask.h: the child, which compiles, and its parent. */
#include "lab/isa/ask.h"

#include "bake/base/file.h"
#include "bake/base/process.h"
#include "cli/cli.h"
#include "command/options.h"
#include "image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SECONDS = 900 };

static const char child_variable[] = "MASU_ISA_CHILD";

/* ---- The child ------------------------------------------------------------------------------- */

bool masu_isa_is_child(void) { return getenv(child_variable) != NULL; }

static void say_pass(const char *pass) {
    printf("at\t%s\n", pass);
    fflush(stdout);
}

int masu_isa_child(const char *scene_path, const char *ladder, masu_desc *desc) {
    static masu_isa_rows rows;
    static masu_scene scene;
    char error[1024];
    uint8_t *bytes;
    size_t count;
    masu_detail detail;
    int code = masu_use_ladder(ladder, desc);
    if (code) return code;
    if (!masu_file_read(scene_path, (size_t)2 << 30, &bytes, &count, error, sizeof error))
        return masu_cli_error("%s", error);
    bool good = !masu_scene_bind(bytes, count, &scene, &detail);
    if (!good) snprintf(error, sizeof error, "%s: %s", scene_path, detail.text);
    desc->scene = &scene;
    good = good && masu_isa_compile(desc, say_pass, &rows, error, sizeof error);
    free(bytes);
    if (!good) return masu_cli_error("%s", error);
    if (!masu_isa_send(&rows, stdout)) return masu_cli_error("cannot write to standard output");
    _Exit(MASU_CLI_OK); /* the renderer and its device still exist */
}

/* ---- The parent ------------------------------------------------------------------------------ */

/* The rest of the last line with this start; NULL: none. */
static const char *last_line(const char *text, const char *start, char *out, size_t size) {
    const char *found = NULL;
    for (const char *line = text; line && *line; line = strchr(line, '\n'), line += line != NULL)
        if (!strncmp(line, start, strlen(start))) found = line + strlen(start);
    if (!found) return NULL;
    snprintf(out, size, "%.*s", (int)strcspn(found, "\n"), found);
    return out;
}

/* Finds why a child failed: its error, even after other text of a driver on the same line;
 * otherwise the last printed line and the exit status. */
static const char *reason_of(const char *text, int code, char *out, size_t size) {
    static const char name[] = "masu-lab isa: ";
    const char *found = NULL, *last = NULL;
    for (const char *at = text; (at = strstr(at, name)); at += sizeof name - 1)
        found = at + sizeof name - 1;
    for (const char *line = text; line && *line; line = strchr(line, '\n'), line += line != NULL)
        if (*line != '\n' && strncmp(line, "at\t", 3) != 0) last = line;
    if (found && *found != '\n') snprintf(out, size, "%.*s", (int)strcspn(found, "\n"), found);
    else if (last) snprintf(out, size, "exit code %d: %.*s", code, (int)strcspn(last, "\n"), last);
    else snprintf(out, size, "exit code %d without a message", code);
    return out;
}

bool masu_isa_ask(const masu_isa_gpu *gpu, const char *const *arguments, masu_isa_rows *rows) {
    char error[2048], line[512];
    const char *directory = masu_bake_temporary_directory();
    const char *command[64] = {"/proc/self/exe"};
    if (!directory) return false;
    for (int i = 0; i < 62 && arguments[i]; i++) command[i + 1] = arguments[i];
    char *icd = masu_bake_join(directory, "icd.json");
    if (!masu_isa_gpu_environment(gpu, icd, error, sizeof error)) {
        masu_cli_error("%s", error);
        free(icd);
        return false;
    }
    masu_bake_buffer output = {0};
    setenv(child_variable, gpu->name, 1);
    masu_cli_progress("%s: compiling", gpu->name);
    masu_bake_result r = masu_bake_run(command, SECONDS, &output);
    masu_cli_progress_clear();
    unsetenv(child_variable);
    masu_isa_gpu_leave();
    free(icd);
    masu_bake_append(&output, "", 1);
    const char *text = (const char *)output.data,
               *pass = last_line(text, "at\t", line, sizeof line);
    bool good = false;
    if (r.end == MASU_BAKE_SIGNALED) {
        masu_cli_error("%s: its compiler was ended by %s at pass %s", gpu->name,
                       masu_cli_signal(r.code), pass ? pass : "none");
    } else if (r.end == MASU_BAKE_TIMEOUT) {
        masu_cli_error("%s: its compiler took more than %d seconds, at pass %s", gpu->name, r.code,
                       pass ? pass : "none");
    } else if (r.end != MASU_BAKE_EXITED || r.code) {
        char why[1024];
        masu_cli_error("%s: %s", gpu->name, reason_of(text, r.code, why, sizeof why));
    } else {
        good = masu_isa_receive(text, rows);
        if (!good) masu_cli_error("%s: its rows cannot be read", gpu->name);
    }
    masu_bake_release(&output);
    return good;
}

uint32_t masu_isa_list(const char *option, const char *list,
                       const masu_isa_gpu *out[MASU_ISA_GPUS]) {
    uint32_t n = 0;
    for (const char *at = list;; at++) {
        char name[32];
        size_t length = strcspn(at, ",");
        snprintf(name, sizeof name, "%.*s", (int)(length < 31 ? length : 31), at);
        const masu_isa_gpu *gpu = masu_isa_gpu_find(name);
        if (!gpu) {
            masu_cli_usage_error("%s: there is no GPU '%s'; `masu-lab isa --gpu=help` lists them",
                                 option, name);
            return 0;
        }
        if (n == MASU_ISA_GPUS) {
            masu_cli_usage_error("%s: at most %d GPUs", option, MASU_ISA_GPUS);
            return 0;
        }
        out[n++] = gpu;
        at += length;
        if (!*at) return n;
    }
}
