/* gnuplot.c: see gnuplot.h. */
#include "cli/gnuplot.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

enum { CANNOT_START = 127 };

static int is_control(char c) { return (unsigned char)c < ' ' || c == 127; }

/* gnuplot escapes a single quote by doubling it; there is no other escape in single quotes. */
void masu_gnuplot_quote(FILE *f, const char *text) {
    fputc('\'', f);
    for (; *text; text++) {
        if (*text == '\'') fputc('\'', f);
        fputc(is_control(*text) ? ' ' : *text, f);
    }
    fputc('\'', f);
}

/* Data are not commands, but a string in data ends at the next quote and cannot contain one. */
void masu_gnuplot_label(FILE *f, const char *text) {
    fputc('"', f);
    for (; *text; text++)
        fputc(*text == '"' || *text == '\\' ? '\'' : is_control(*text) ? ' ' : *text, f);
    fputc('"', f);
}

int masu_gnuplot_can_name(const char *path) {
    for (; *path; path++) {
        if (is_control(*path)) return 0;
    }
    return 1;
}

static void draw(const char *folder, int commands) {
    int nowhere = open("/dev/null", O_RDWR);
    if (nowhere < 0 || (folder && chdir(folder))) _exit(1);
    dup2(commands, STDIN_FILENO);
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    execlp("gnuplot", "gnuplot", (char *)NULL);
    _exit(CANNOT_START);
}

/* Writes to a reader that may have exited. */
static void give(int fd, const char *text, size_t bytes) {
    struct sigaction ignore = {.sa_handler = SIG_IGN}, before;
    sigemptyset(&ignore.sa_mask);
    sigaction(SIGPIPE, &ignore, &before);
    while (bytes > 0) {
        ssize_t n = write(fd, text, bytes);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) break;
        text += n;
        bytes -= (size_t)n;
    }
    sigaction(SIGPIPE, &before, NULL);
}

masu_gnuplot_end masu_gnuplot_run(const char *folder, const char *commands, size_t bytes) {
    int ends[2], status = 0;
    if (pipe(ends)) return MASU_GNUPLOT_FAILED;
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        close(ends[1]);
        draw(folder, ends[0]);
    }
    close(ends[0]);
    if (child > 0) give(ends[1], commands, bytes);
    close(ends[1]);
    while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (child < 0 || !WIFEXITED(status)) return MASU_GNUPLOT_FAILED;
    return WEXITSTATUS(status) == 0              ? MASU_GNUPLOT_DRAWN
           : WEXITSTATUS(status) == CANNOT_START ? MASU_GNUPLOT_MISSING
                                                 : MASU_GNUPLOT_FAILED;
}
