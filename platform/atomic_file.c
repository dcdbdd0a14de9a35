/* atomic_file.c: see atomic_file.h. */
#define _POSIX_C_SOURCE 200809L
#include "atomic_file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define ATTEMPTS 100u

/* ---- Locks ---- */

static bool is_at(int file, const char *path) {
    struct stat open_one, there;
    return fstat(file, &open_one) == 0 && lstat(path, &there) == 0 &&
           open_one.st_ino == there.st_ino && open_one.st_dev == there.st_dev;
}

bool masu_atomic_file_lock(int file, const char *path) {
    int r;
    do r = flock(file, LOCK_EX);
    while (r != 0 && errno == EINTR);
    return is_at(file, path);
}

int masu_atomic_file_lock_stale(const char *path, bool folder) {
    struct stat about;
    if (lstat(path, &about) != 0 || (folder ? !S_ISDIR(about.st_mode) : !S_ISREG(about.st_mode)) ||
        about.st_uid != geteuid())
        return -1;
    int file = open(path, O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
    if (file < 0) return -1;
    /* If its owner has renamed it meanwhile, the file is no longer at this path. */
    if (flock(file, LOCK_EX | LOCK_NB) == 0 && is_at(file, path)) return file;
    (void)close(file);
    return -1;
}

/* ---- Names ---- */

/* "X" and "X.123-0.part". */
static bool is_draft_of(const char *name, const char *target, size_t length) {
    static const char digits[] = "0123456789";
    if (strncmp(name, target, length) != 0 || name[length] != '.') return false;
    const char *at = name + length + 1;
    size_t pid = strspn(at, digits);
    if (!pid || at[pid] != '-') return false;
    size_t count = strspn(at + pid + 1, digits);
    return count && strcmp(at + pid + 1 + count, ".part") == 0;
}

void masu_atomic_file_remove_stale(const char *target) {
    const char *slash = strrchr(target, '/'), *base = slash ? slash + 1 : target;
    size_t length = strlen(base), front = (size_t)(base - target);
    char *path = malloc(front + length + 2 + 256);
    if (!path) return;
    memcpy(path, target, front);
    strcpy(path + front, front ? "" : ".");
    DIR *folder = *base ? opendir(path) : NULL;
    for (struct dirent *entry; folder && (entry = readdir(folder));) {
        if (!is_draft_of(entry->d_name, base, length) || strlen(entry->d_name) > length + 256)
            continue;
        strcpy(path + front, entry->d_name);
        int file = masu_atomic_file_lock_stale(path, false);
        if (file < 0) continue;
        (void)unlink(path);
        (void)close(file);
    }
    if (folder) (void)closedir(folder);
    free(path);
}

/* ---- Signals ---- */

#define DRAFTS_MAX 8

/* Files being written by this process. A child that it forks must not remove them. */
static const char *volatile drafts[DRAFTS_MAX];
static volatile pid_t drafts_owner;

static void replace_draft(const char *old, const char *name) {
    for (int i = 0; i < DRAFTS_MAX; i++) {
        if (drafts[i] != old) continue;
        drafts[i] = name;
        return;
    }
}

/* Async-signal-safe. The default action, restored by SA_RESETHAND, then ends the process. */
static void remove_drafts(int number) {
    for (int i = 0; i < DRAFTS_MAX && getpid() == drafts_owner; i++)
        if (drafts[i]) (void)unlink(drafts[i]);
    (void)raise(number);
}

void masu_atomic_file_catch_signals(void) {
    static const int ending[] = {SIGINT, SIGTERM, SIGHUP};
    struct sigaction action = {.sa_handler = remove_drafts, .sa_flags = (int)SA_RESETHAND}, before;
    sigemptyset(&action.sa_mask);
    for (size_t i = 0; i < sizeof ending / sizeof *ending; i++) {
        if (sigaction(ending[i], NULL, &before) == 0 && before.sa_handler == SIG_DFL)
            (void)sigaction(ending[i], &action, NULL);
    }
    (void)signal(SIGXFSZ, SIG_IGN); /* write() then fails with EFBIG */
}

/* ---- Drafts ---- */

static void forget(masu_atomic_file *draft) {
    if (draft->name) replace_draft(draft->name, NULL);
    free(draft->name);
    *draft = (masu_atomic_file){.file = -1, .name = NULL};
}

/* Its permissions follow the umask, which mkstemp's would not. */
int masu_atomic_file_open(masu_atomic_file *draft, const char *target) {
    size_t room = strlen(target) + 48;
    int problem = EEXIST;
    *draft = (masu_atomic_file){.file = -1, .name = malloc(room)};
    if (!draft->name) return ENOMEM;
    masu_atomic_file_remove_stale(target);
    for (unsigned attempt = 0; attempt < ATTEMPTS && draft->file < 0 && problem == EEXIST;
         attempt++) {
        snprintf(draft->name, room, "%s.%ld-%u.part", target, (long)getpid(), attempt);
        draft->file = open(draft->name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (draft->file < 0) {
            problem = errno;
        } else if (!masu_atomic_file_lock(draft->file, draft->name)) {
            (void)close(draft->file);
            draft->file = -1;
        }
    }
    if (draft->file >= 0) {
        if (drafts_owner != getpid()) /* the parent's files do not belong to a forked child */
            for (int i = 0; i < DRAFTS_MAX; i++) drafts[i] = NULL;
        drafts_owner = getpid();
        replace_draft(NULL, draft->name);
        return 0;
    }
    forget(draft);
    return problem;
}

int masu_atomic_file_write(masu_atomic_file *draft, const void *bytes, size_t count) {
    const char *at = bytes;
    while (count) {
        ssize_t wrote = write(draft->file, at, count);
        if (wrote < 0 && errno == EINTR) continue;
        if (wrote <= 0) return wrote ? errno : EIO;
        at += wrote;
        count -= (size_t)wrote;
    }
    return 0;
}

int masu_atomic_file_commit(masu_atomic_file *draft, const char *target) {
    /* Without the sync, a power cut after the rename could still leave an empty file. */
    int problem = fsync(draft->file) != 0 && errno != EINVAL && errno != ENOSYS ? errno : 0;
    if (!problem && rename(draft->name, target) != 0) problem = errno;
    if (problem) {
        masu_atomic_file_discard(draft);
        return problem;
    }
    /* Renamed before it is closed: as long as it has this name, the lock is held. */
    problem = close(draft->file) != 0 ? errno : 0;
    forget(draft);
    return problem;
}

void masu_atomic_file_discard(masu_atomic_file *draft) {
    if (draft->file >= 0) {
        (void)unlink(draft->name);
        (void)close(draft->file);
    }
    forget(draft);
}
