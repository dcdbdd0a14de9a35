/* file.c: whole files and temporary ones; see file.h. */
#define _XOPEN_SOURCE 700
#include "bake/base/file.h"
#include "cli/cli.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static struct {
    pid_t owner; /* forked children inherit this state and must not act on it */
    char *directory;
    char *file;
    bool registered;
} temporary;

/* ---- cleaning up ---- */

static void remove_tree(const char *path, int depth) {
    struct stat about;
    if (depth > 16 || lstat(path, &about) != 0) return;
    if (!S_ISDIR(about.st_mode)) {
        unlink(path);
        return;
    }
    DIR *directory = opendir(path);
    if (directory) {
        for (struct dirent *entry; (entry = readdir(directory));) {
            if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0) continue;
            char *inner = masu_bake_join(path, entry->d_name);
            remove_tree(inner, depth + 1);
            free(inner);
        }
        closedir(directory);
    }
    rmdir(path);
}

static void clean_up(void) {
    if (getpid() != temporary.owner) return;
    if (temporary.file) unlink(temporary.file);
    if (temporary.directory) remove_tree(temporary.directory, 0);
    free(temporary.file);
    free(temporary.directory);
    temporary.file = temporary.directory = NULL;
}

static void clean_up_at_exit(void) {
    temporary.owner = getpid();
    if (!temporary.registered) atexit(clean_up);
    temporary.registered = true;
}

/* ---- names ---- */

char *masu_bake_join(const char *directory, const char *name) {
    size_t bytes = strlen(directory) + strlen(name) + 2;
    char *path = masu_bake_allocate(bytes);
    snprintf(path, bytes, "%s/%s", directory, name);
    return path;
}

char *masu_bake_directory_of(const char *path) {
    const char *slash = strrchr(path, '/');
    size_t length = slash ? (size_t)(slash - path) : 1;
    if (slash == path) length = 1; /* "/x" lies in "/" */
    char *directory = masu_bake_allocate(length + 1);
    memcpy(directory, slash ? path : ".", length);
    directory[length] = '\0';
    return directory;
}

const char *masu_bake_temporary_directory(void) {
    const char *parent = getenv("TMPDIR");
    char *path = masu_bake_join(parent && *parent ? parent : "/tmp", "masu-bake-XXXXXX");
    clean_up_at_exit();
    if (!mkdtemp(path)) {
        masu_cli_error("cannot make a temporary directory %s: %s", path, strerror(errno));
        free(path);
        return NULL;
    }
    return temporary.directory = path;
}

/* ---- reading ---- */

static bool read_open_file(int fd, const char *path, size_t limit, masu_bake_buffer *out) {
    struct stat about;
    if (fstat(fd, &about) != 0 || !S_ISREG(about.st_mode)) {
        masu_cli_error("cannot read %s: not a regular file", path);
        return false;
    }
    if ((uintmax_t)about.st_size > limit) {
        masu_cli_error("cannot read %s: more than %zu bytes", path, limit);
        return false;
    }
    size_t bytes = (size_t)about.st_size, done = 0;
    unsigned char *data = masu_bake_append(out, NULL, bytes + 1);
    while (done < bytes) {
        ssize_t got = read(fd, data + done, bytes - done);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) {
            masu_cli_error("cannot read %s: %s", path, strerror(errno));
            return false;
        }
        if (got == 0) break; /* it shrank meanwhile */
        done += (size_t)got;
    }
    data[done] = '\0';
    out->bytes -= bytes + 1 - done;
    return true;
}

bool masu_bake_read_file(const char *path, size_t limit, masu_bake_buffer *out) {
    int fd = open(path, O_RDONLY | O_NONBLOCK); /* a FIFO must not block the open */
    if (fd < 0) {
        masu_cli_error("cannot read %s: %s", path, strerror(errno));
        return false;
    }
    bool good = read_open_file(fd, path, limit, out);
    close(fd);
    return good;
}

/* ---- writing ---- */

static int write_all(int fd, const void *data, size_t bytes) {
    const char *at = data;
    while (bytes > 0) {
        ssize_t wrote = write(fd, at, bytes);
        if (wrote < 0 && errno == EINTR) continue;
        if (wrote < 0) return errno;
        at += wrote;
        bytes -= (size_t)wrote;
    }
    return 0;
}

static int write_straight(const char *path, const void *data, size_t bytes) {
    int fd = open(path, O_WRONLY);
    if (fd < 0) return errno;
    int problem = write_all(fd, data, bytes);
    if (close(fd) != 0 && !problem) problem = errno;
    return problem;
}

static int write_and_rename(const char *path, const void *data, size_t bytes) {
    size_t room = strlen(path) + 12;
    char *draft = masu_bake_allocate(room);
    snprintf(draft, room, "%s.tmpXXXXXX", path);
    clean_up_at_exit();
    int fd = mkstemp(draft);
    if (fd < 0) {
        int problem = errno;
        free(draft);
        return problem;
    }
    temporary.file = draft;
    /* mkstemp makes a private file; the result should have the rights of any new file. */
    mode_t mask = umask(0);
    umask(mask);
    int problem = fchmod(fd, 0666 & ~mask) != 0 ? errno : 0;
    if (!problem) problem = write_all(fd, data, bytes);
    if (!problem && fsync(fd) != 0 && errno != EINVAL && errno != ENOSYS) problem = errno;
    if (close(fd) != 0 && !problem) problem = errno;
    if (!problem && rename(draft, path) != 0) problem = errno;
    if (problem) unlink(draft);
    temporary.file = NULL;
    free(draft);
    return problem;
}

bool masu_bake_write_file(const char *path, const void *data, size_t bytes) {
    struct stat about;
    int problem;
    if (stat(path, &about) != 0) {
        problem = write_and_rename(path, data, bytes);
    } else if (S_ISDIR(about.st_mode)) {
        problem = EISDIR;
    } else if (!S_ISREG(about.st_mode)) {
        problem = write_straight(path, data, bytes);
    } else {
        char *resolved = realpath(path, NULL); /* replace what a link points at, not the link */
        problem = resolved ? write_and_rename(resolved, data, bytes) : errno;
        free(resolved);
    }
    if (problem) masu_cli_error("cannot write %s: %s", path, strerror(problem));
    return problem == 0;
}
