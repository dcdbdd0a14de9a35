/* file.c: whole files and temporary ones; see file.h. */
#define _XOPEN_SOURCE 700
#include "bake/base/file.h"
#include "cli/cli.h"
#include "atomic_file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <wctype.h>

static struct {
    pid_t owner; /* forked children inherit this state and must not act on it */
    char *directory;
    int lock; /* of the directory, until this process ends: platform/atomic_file.h */
    const char *file;
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

/* The next character of a UTF-8 text, in lower case. A byte that is no part of one is compared as
 * it is. */
static uint32_t next_letter(const char **at, locale_t letters) {
    const unsigned char *c = (const unsigned char *)*at;
    uint32_t bytes = *c >= 0xF0 ? 4 : *c >= 0xE0 ? 3 : *c >= 0xC0 ? 2 : 1;
    uint32_t code = bytes > 1 ? *c & (0x7Fu >> bytes) : *c;
    for (uint32_t i = 1; i < bytes; i++) {
        if ((c[i] & 0xC0) != 0x80) {
            bytes = 1;
            code = 0x110000u + *c;
            break;
        }
        code = code << 6 | (c[i] & 0x3Fu);
    }
    *at += bytes;
    if (letters != (locale_t)0 && code < 0x110000u)
        return (uint32_t)towlower_l((wint_t)code, letters);
    return code >= 'A' && code <= 'Z' ? code + 32 : code;
}

static bool same_letters(const char *a, const char *b, locale_t letters) {
    while (*a && *b) {
        if (next_letter(&a, letters) != next_letter(&b, letters)) return false;
    }
    return *a == *b;
}

/* The entry of a folder with these letters, or NULL; free() it. */
static char *find_entry(const char *folder, const char *name) {
    DIR *directory = opendir(folder);
    /* Without it: of ASCII only. */
    locale_t letters = newlocale(LC_CTYPE_MASK, "C.UTF-8", (locale_t)0);
    char *found = NULL;
    for (struct dirent *entry; directory && (entry = readdir(directory));) {
        if (!same_letters(entry->d_name, name, letters) ||
            (found && strcmp(found, entry->d_name) < 0))
            continue;
        free(found);
        found = masu_bake_allocate(strlen(entry->d_name) + 1);
        memcpy(found, entry->d_name, strlen(entry->d_name) + 1);
    }
    if (letters != (locale_t)0) freelocale(letters);
    if (directory) closedir(directory);
    return found;
}

bool masu_bake_append_spelling(masu_bake_buffer *path, const char *name) {
    size_t before = path->bytes;
    bool good = *name && *name != '/';
    while (good && *name) {
        size_t at = path->bytes, length = strcspn(name, "/");
        masu_bake_append(path, name, length);
        masu_bake_append(path, "", 1);
        if (access((const char *)path->data, F_OK) != 0) {
            path->bytes = at;
            masu_bake_append(path, at ? "" : ".", at ? 1 : 2);
            char *wanted = masu_bake_allocate(length + 1);
            memcpy(wanted, name, length);
            wanted[length] = '\0';
            char *found = find_entry((const char *)path->data, wanted);
            free(wanted);
            path->bytes = at;
            good = found != NULL;
            if (found) masu_bake_append(path, found, strlen(found) + 1);
            free(found);
            if (!found) break;
        }
        path->bytes--;
        name += length;
        for (bool first = true; *name == '/'; name++, first = false) {
            if (first) masu_bake_append(path, "/", 1);
        }
    }
    if (!good) path->bytes = before;
    masu_bake_append(path, "", 1);
    path->bytes--;
    return good;
}

#define TEMPORARY "masu-bake-"
#define TEMPORARY_RANDOM 6u

static const char *temporary_parent(void) {
    const char *parent = getenv("TMPDIR");
    return parent && *parent ? parent : "/tmp";
}

void masu_bake_sweep_temporary(void) {
    const char *parent = temporary_parent();
    DIR *directory = opendir(parent);
    for (struct dirent *entry; directory && (entry = readdir(directory));) {
        if (strncmp(entry->d_name, TEMPORARY, sizeof TEMPORARY - 1) != 0 ||
            strlen(entry->d_name) != sizeof TEMPORARY - 1 + TEMPORARY_RANDOM)
            continue;
        char *path = masu_bake_join(parent, entry->d_name);
        int lock = masu_atomic_file_lock_stale(path, true);
        if (lock >= 0) {
            remove_tree(path, 0);
            close(lock);
        }
        free(path);
    }
    if (directory) closedir(directory);
}

const char *masu_bake_temporary_directory(void) {
    masu_bake_sweep_temporary();
    clean_up_at_exit();
    for (int attempt = 0; attempt < 100; attempt++) {
        char *path = masu_bake_join(temporary_parent(), TEMPORARY "XXXXXX");
        if (!mkdtemp(path)) {
            masu_cli_error("cannot make a temporary directory %s: %s", path, strerror(errno));
            free(path);
            return NULL;
        }
        temporary.lock = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        if (temporary.lock >= 0 && masu_atomic_file_lock(temporary.lock, path))
            return temporary.directory = path;
        if (temporary.lock >= 0) close(temporary.lock); /* swept while it was new */
        free(path);
    }
    masu_cli_error("cannot make a temporary directory in %s", temporary_parent());
    return NULL;
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
    masu_atomic_file draft;
    clean_up_at_exit();
    int problem = masu_atomic_file_open(&draft, path);
    if (problem) return problem;
    temporary.file = draft.name;
    problem = masu_atomic_file_write(&draft, data, bytes);
    temporary.file = NULL; /* the next two remove it */
    if (!problem) return masu_atomic_file_commit(&draft, path);
    masu_atomic_file_discard(&draft);
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
