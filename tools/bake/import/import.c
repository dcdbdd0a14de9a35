/* import.c: reads a model in a child process; see import.h.
 *
 * The pipe carries a uint64 length and the bytes for each kind of section, for images, cameras,
 * suns, warnings and the error; then END, which proves that the child finished. */
#define _POSIX_C_SOURCE 200809L
#include "bake/import/import.h"
#include "bake/base/process.h"
#include "bake/scene/check.h"
#include "cli/cli.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#define END 0x4B4F454B41424D00u

static void send_buffer(int fd, const masu_bake_buffer *buffer) {
    uint64_t bytes = buffer->bytes;
    masu_bake_send(fd, &bytes, sizeof bytes);
    if (bytes) masu_bake_send(fd, buffer->data, buffer->bytes);
}

typedef struct import {
    const char *path;
    masu_bake_wanted how;
} import;

/* A file of a hundred bytes may claim to have a billion faces. The memory that a valid file needs
 * grows with its size; forza's 11 MB need 75 MB. */
static void limit_memory(const char *path) {
    if (MASU_BAKE_SANITIZED) return;
    struct stat about;
    struct rlimit old;
    rlim_t most = MASU_BAKE_IMPORT_MEMORY;
    if (stat(path, &about) == 0) most += (rlim_t)about.st_size * 16;
    if (getrlimit(RLIMIT_AS, &old) == 0 && (old.rlim_cur == RLIM_INFINITY || old.rlim_cur > most)) {
        setrlimit(RLIMIT_AS, &(struct rlimit){.rlim_cur = most, .rlim_max = old.rlim_max});
    }
}

static void import_in_child(void *argument, int fd) {
    const import *wanted = argument;
    limit_memory(wanted->path);
    masu_bake_content piece = {0};
    masu_bake_buffer warnings = {0}, error = {0};
    masu_bake_read_model(wanted->path, &wanted->how, &piece, &warnings, &error);
    if (piece.names_cut) {
        char text[96];
        snprintf(text, sizeof text, "%u names are longer than %u bytes, and cut\n", piece.names_cut,
                 MASU_BLOB_NAME_MAX);
        masu_bake_append_text(&warnings, text);
    }
    for (uint32_t kind = 1; kind < MASU_BLOB_KIND_COUNT; kind++) {
        send_buffer(fd, &piece.section[kind]);
    }
    send_buffer(fd, &piece.maps);
    send_buffer(fd, &piece.images);
    send_buffer(fd, &piece.image_text);
    send_buffer(fd, &piece.image_data);
    send_buffer(fd, &piece.cameras);
    send_buffer(fd, &piece.suns);
    send_buffer(fd, &warnings);
    send_buffer(fd, &error);
    masu_bake_send(fd, &(uint64_t){END}, sizeof(uint64_t));
}

typedef struct reader {
    const unsigned char *at;
    size_t left;
} reader;

static bool take(reader *r, void *out, size_t bytes) {
    if (bytes > r->left) return false;
    memcpy(out, r->at, bytes);
    r->at += bytes;
    r->left -= bytes;
    return true;
}

static bool take_buffer(reader *r, masu_bake_buffer *out) {
    uint64_t bytes;
    if (!take(r, &bytes, sizeof bytes) || bytes > r->left) return false;
    if (bytes) masu_bake_append(out, r->at, (size_t)bytes);
    r->at += bytes;
    r->left -= (size_t)bytes;
    return true;
}

static bool take_piece(const masu_bake_buffer *from, masu_bake_content *piece,
                       masu_bake_buffer *warnings, masu_bake_buffer *error) {
    reader r = {from->data, from->bytes};
    for (uint32_t kind = 1; kind < MASU_BLOB_KIND_COUNT; kind++) {
        if (!take_buffer(&r, &piece->section[kind])) return false;
    }
    uint64_t end = 0;
    return take_buffer(&r, &piece->maps) && take_buffer(&r, &piece->images) &&
           take_buffer(&r, &piece->image_text) && take_buffer(&r, &piece->image_data) &&
           take_buffer(&r, &piece->cameras) && take_buffer(&r, &piece->suns) &&
           take_buffer(&r, warnings) && take_buffer(&r, error) && take(&r, &end, sizeof end) &&
           end == END && r.left == 0;
}

static void report_lines(const char *path, masu_bake_buffer *text) {
    masu_bake_append(text, "", 1);
    for (char *line = (char *)text->data; *line;) {
        size_t length = strcspn(line, "\n");
        bool last = line[length] == '\0';
        line[length] = '\0';
        if (length) masu_cli_warn("%s: %s", path, line);
        line += last ? length : length + 1;
    }
}

static bool report_end(const char *path, masu_bake_result result) {
    switch (result.end) {
    case MASU_BAKE_SIGNALED:
        masu_cli_error("cannot read %s: the importer crashed: %s", path,
                       masu_cli_signal(result.code));
        break;
    case MASU_BAKE_TIMEOUT:
        masu_cli_error("cannot read %s: the importer took more than %d seconds", path, result.code);
        break;
    case MASU_BAKE_NO_CHILD:
        masu_cli_error("cannot start the importer: %s", strerror(result.code));
        break;
    case MASU_BAKE_EXITED:
        masu_cli_error("cannot read %s: the importer gave up (exit code %d)", path, result.code);
        break;
    }
    return false;
}

/* The library's own messages for these errors are worse. */
static bool readable(const char *path) {
    struct stat about;
    int cause = 0;
    if (stat(path, &about) != 0 || access(path, R_OK) != 0)
        cause = errno;
    else if (S_ISDIR(about.st_mode))
        cause = EISDIR;
    if (cause) {
        masu_cli_error("cannot read %s: %s", path, strerror(cause));
        return false;
    }
    if (!S_ISREG(about.st_mode)) {
        masu_cli_error("cannot read %s: not a regular file", path);
        return false;
    }
    return true;
}

static bool receive(import wanted, masu_bake_content *piece, masu_bake_buffer *output,
                    masu_bake_buffer *warnings, masu_bake_buffer *error) {
    const char *path = wanted.path;
    masu_bake_result result =
        masu_bake_fork(import_in_child, &wanted, MASU_BAKE_IMPORT_SECONDS, output);
    if (result.end != MASU_BAKE_EXITED || !take_piece(output, piece, warnings, error)) {
        return report_end(path, result);
    }
    masu_bake_release(output);
    if (error->bytes) {
        masu_bake_append(error, "", 1);
        masu_cli_error("cannot read %s: %s", path, (const char *)error->data);
        return false;
    }
    report_lines(path, warnings);
    const char *problem = masu_bake_check(piece);
    if (problem) masu_cli_error("cannot read %s: the importer returned %s", path, problem);
    return !problem;
}

static bool import_file(import wanted, masu_bake_content *piece) {
    if (!readable(wanted.path)) return false;
    masu_bake_buffer output = {0}, warnings = {0}, error = {0};
    bool good = receive(wanted, piece, &output, &warnings, &error);
    masu_bake_release(&output);
    masu_bake_release(&warnings);
    masu_bake_release(&error);
    return good;
}

bool masu_bake_import(const char *path, masu_bake_textures textures, masu_bake_content *piece) {
    return import_file((import){path, {.textures = textures}}, piece);
}

bool masu_bake_import_as(const char *path, const masu_bake_wanted *wanted,
                         masu_bake_content *piece) {
    return import_file((import){path, *wanted}, piece);
}
