/* assimp_file.c: see assimp_file.h. Files are never opened for writing. */
#define _POSIX_C_SOURCE 200809L
#include "bake/import/assimp_file.h"
#include "bake/base/inside.h"
#include "bake/import/assimp.h"
#include "bake/import/picture_path.h"

#include <assimp/types.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static FILE *stream(struct aiFile *file) { return (FILE *)(void *)file->UserData; }

static size_t read_some(struct aiFile *file, char *to, size_t size, size_t count) {
    return size ? fread(to, size, count, stream(file)) : 0;
}

static size_t write_none(struct aiFile *file, const char *from, size_t size, size_t count) {
    (void)file, (void)from, (void)size, (void)count;
    return 0;
}

static size_t place(struct aiFile *file) {
    long at = ftell(stream(file));
    return at < 0 ? 0 : (size_t)at;
}

static size_t whole(struct aiFile *file) {
    struct stat about;
    return fstat(fileno(stream(file)), &about) == 0 && about.st_size > 0 ? (size_t)about.st_size
                                                                         : 0;
}

static enum aiReturn go_to(struct aiFile *file, size_t offset, enum aiOrigin from) {
    int whence = from == aiOrigin_SET ? SEEK_SET : from == aiOrigin_CUR ? SEEK_CUR : SEEK_END;
    return fseek(stream(file), (long)offset, whence) == 0 ? aiReturn_SUCCESS : aiReturn_FAILURE;
}

static void nothing(struct aiFile *file) { (void)file; }

static void close_file(struct aiFileIO *io, struct aiFile *file) {
    (void)io;
    if (!file) return;
    fclose(stream(file));
    free(file);
}

/* Assimp prefixes a name with the model's folder and also tries variants that do not exist. The
 * part after the folder is the name in the file. */
static const char *find(const masu_import_files *files, const char *path, masu_bake_buffer *out) {
    struct stat about;
    const char *slash = strrchr(files->model, '/');
    size_t folder = slash ? (size_t)(slash - files->model) + 1 : 0;
    if (stat(path, &about) == 0) return path;
    if (strncmp(path, "./", 2) == 0 && strncmp(files->model, "./", 2) != 0) path += 2;
    (void)masu_bake_picture_path(
        files->model, strncmp(path, files->model, folder) == 0 ? path + folder : path, out);
    return (const char *)out->data;
}

static struct aiFile *open_found(masu_import_files *files, const char *path) {
    struct stat about;
    if (stat(path, &about) != 0 || !S_ISREG(about.st_mode)) return NULL;
    if (!masu_bake_inside(files->model, path)) {
        if (!files->warned)
            masu_import_format(files->warnings,
                               "%.200s is outside of the model's folder: ignored\n", path);
        files->warned = true;
        return NULL;
    }
    FILE *opened = fopen(path, "rb");
    struct aiFile *file = opened ? malloc(sizeof *file) : NULL;
    if (!file) {
        if (opened) fclose(opened);
        return NULL;
    }
    *file = (struct aiFile){.ReadProc = read_some,
                            .WriteProc = write_none,
                            .TellProc = place,
                            .FileSizeProc = whole,
                            .SeekProc = go_to,
                            .FlushProc = nothing,
                            .UserData = (aiUserData)(void *)opened};
    return file;
}

static struct aiFile *open_file(struct aiFileIO *io, const char *path, const char *mode) {
    masu_import_files *files = (masu_import_files *)(void *)io->UserData;
    masu_bake_buffer found = {0};
    if (!path || !mode || mode[0] != 'r') return NULL;
    struct aiFile *file = open_found(files, find(files, path, &found));
    masu_bake_release(&found);
    return file;
}

void masu_import_use_files(masu_import_files *files) {
    files->io = (struct aiFileIO){
        .OpenProc = open_file, .CloseProc = close_file, .UserData = (aiUserData)(void *)files};
}
