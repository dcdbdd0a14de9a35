/* cli.c: option parsing and messages of all Masu programs; cli.h is the manual. */
#define _POSIX_C_SOURCE 200809L
#include "cli/cli.h"

#include "atomic_file.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { OPTION_HELP = -10, OPTION_VERSION = -11, OPTION_QUIET = -12 };

static const masu_cli_option common_options[] = {
    {"help", NULL, "print this text and exit", OPTION_HELP, 'h'},
    {"version", NULL, "print the version and exit", OPTION_VERSION, 0},
    {"quiet", NULL, "print only warnings and errors", OPTION_QUIET, 0},
    {NULL, NULL, NULL, 0, 0},
};

static struct {
    char name[64]; /* "masu-bake" or "masu render": starts messages and the usage line */
    uint32_t warnings;
    bool quiet;
    bool progress_shown;
    void (*hears)(void *user, const char *text); /* receives warnings */
    void *user;
} state = {"masu", 0, false, false, NULL, NULL};

/* ---- messages ---- */

void masu_cli_progress_text(const char *text) { masu_cli_progress("%s", text); }

void masu_cli_progress_clear(void) {
    if (!state.progress_shown) return;
    fputs("\r\033[K", stderr);
    fflush(stderr);
    state.progress_shown = false;
}

void masu_cli_plain(char *text) {
    for (; *text; text++) {
        unsigned char c = (unsigned char)*text;
        if (c < 0x20 || c == 0x7F) *text = '?';
    }
}

static void message(const char *before, const char *format, va_list arguments, const char *after) {
    char text[4096];
    if (vsnprintf(text, sizeof text, format, arguments) < 0) text[0] = '\0';
    masu_cli_plain(text);
    masu_cli_progress_clear();
    fprintf(stderr, "%s: %s%s%s\n", state.name, before, text, after);
}

int masu_cli_error(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    message("", format, arguments, "");
    va_end(arguments);
    return MASU_CLI_FAILURE;
}

int masu_cli_usage_error(const char *format, ...) {
    char hint[96];
    snprintf(hint, sizeof hint, " (see %s --help)", state.name);
    va_list arguments;
    va_start(arguments, format);
    message("", format, arguments, hint);
    va_end(arguments);
    return MASU_CLI_USAGE;
}

void masu_cli_warn(const char *format, ...) {
    char text[4096];
    va_list arguments;
    va_start(arguments, format);
    if (vsnprintf(text, sizeof text, format, arguments) < 0) text[0] = '\0';
    va_end(arguments);
    masu_cli_plain(text);
    masu_cli_progress_clear();
    fprintf(stderr, "%s: warning: %s\n", state.name, text);
    if (state.hears) state.hears(state.user, text);
    state.warnings++;
}

void masu_cli_hear_warnings(void (*hears)(void *user, const char *text), void *user) {
    state.hears = hears;
    state.user = user;
}

uint32_t masu_cli_warnings(void) { return state.warnings; }

bool masu_cli_quiet(void) { return state.quiet; }

void masu_cli_progress(const char *format, ...) {
    if (state.quiet || (!isatty(STDERR_FILENO) && !getenv("MASU_PROGRESS"))) return;
    char text[72]; /* a line wrapped by the terminal could not be erased */
    va_list arguments;
    va_start(arguments, format);
    if (vsnprintf(text, sizeof text, format, arguments) < 0) text[0] = '\0';
    va_end(arguments);
    masu_cli_plain(text);
    fprintf(stderr, "\r\033[K%s", text);
    fflush(stderr);
    state.progress_shown = true;
}

/* ---- help ---- */

static void print_option(const masu_cli_option *option) {
    enum { COLUMN = 26 };
    char letter[5] = "    ";
    if (!option->name[0]) {
        printf("\n%s:\n", option->help);
        return;
    }
    if (option->letter) snprintf(letter, sizeof letter, "-%c, ", option->letter);
    bool apart = option->value && option->value[0] != '[';
    int width = printf("  %s--%s%s%s", letter, option->name, apart ? " " : "",
                       option->value ? option->value : "");
    if (width >= COLUMN) {
        putchar('\n');
        width = 0;
    }
    printf("%*s", COLUMN - width, "");
    for (const char *c = option->help; *c; c++) {
        putchar(*c);
        if (*c == '\n') printf("%*s", COLUMN, "");
    }
    putchar('\n');
}

static void print_command_help(const masu_cli_command *command) {
    bool grouped = command->options && command->options->name && !command->options->name[0];
    printf("%s: %s\n\nUsage: %s %s\n%s", state.name, command->summary, state.name,
           command->arguments, grouped ? "" : "\nOptions:\n");
    for (const masu_cli_option *o = command->options; o && o->name; o++) print_option(o);
    if (grouped) printf("\nCommon:\n");
    for (const masu_cli_option *o = common_options; o->name; o++) print_option(o);
    if (command->details) printf("\n%s", command->details);
}

static void print_commands(const char *summary, const masu_cli_command *const *commands) {
    printf("%s: %s\n\nUsage: %s COMMAND [arguments] [options]\n\nCommands:\n", state.name, summary,
           state.name);
    for (const masu_cli_command *const *c = commands; *c; c++) {
        printf("  %-12s %s\n", (*c)->name, (*c)->summary);
    }
    printf("\n`%s COMMAND --help` describes a command.\n", state.name);
}

/* ---- options ---- */

static const masu_cli_option *find_long(const masu_cli_option *list, const char *name,
                                        size_t length) {
    for (; list && list->name; list++) {
        if (length && strlen(list->name) == length && memcmp(list->name, name, length) == 0)
            return list;
    }
    return NULL;
}

static const masu_cli_option *find_letter(const masu_cli_option *list, char letter) {
    for (; list && list->name; list++) {
        if (list->letter == letter) return list;
    }
    return NULL;
}

static int leave(masu_cli *cli, int exit_code) {
    cli->exit_code = exit_code;
    return MASU_CLI_EXIT;
}

/* `attached` is the value in the same argument, or NULL. */
static int take_option(masu_cli *cli, const masu_cli_option *option, const char *attached) {
    if (option->value && option->value[0] == '[') {
        cli->value = attached;
    } else if (option->value) {
        if (!attached && cli->next >= cli->argc) {
            return leave(cli,
                         masu_cli_usage_error("%s needs a value: %s", cli->option, option->value));
        }
        cli->value = attached ? attached : cli->argv[cli->next++];
    } else {
        if (attached) return leave(cli, masu_cli_usage_error("%s takes no value", cli->option));
        cli->value = NULL;
    }
    switch (option->id) {
    case OPTION_HELP: print_command_help(cli->command); return leave(cli, MASU_CLI_OK);
    case OPTION_VERSION:
        printf("%s %s\n", cli->program->name, cli->program->version);
        return leave(cli, MASU_CLI_OK);
    case OPTION_QUIET: state.quiet = true; return masu_cli_next(cli);
    default: return option->id;
    }
}

int masu_cli_next(masu_cli *cli) {
    if (cli->next >= cli->argc) return MASU_CLI_END;
    const char *word = cli->argv[cli->next++];
    if (!cli->arguments_only && strcmp(word, "--") == 0) {
        cli->arguments_only = true;
        return masu_cli_next(cli);
    }
    if (cli->arguments_only || word[0] != '-' || word[1] == '\0') { /* "-" alone is an argument */
        cli->value = word;
        cli->option = NULL;
        return MASU_CLI_ARGUMENT;
    }
    const masu_cli_option *option = NULL;
    const char *attached = NULL;
    if (word[1] == '-') {
        size_t length = strcspn(word + 2, "=");
        option = find_long(cli->command->options, word + 2, length);
        if (!option) option = find_long(common_options, word + 2, length);
        if (word[2 + length] == '=') attached = word + 3 + length;
        snprintf(cli->spelling, sizeof cli->spelling, "%.*s", (int)(length > 60 ? 60 : length) + 2,
                 word);
    } else {
        option = find_letter(cli->command->options, word[1]);
        if (!option) option = find_letter(common_options, word[1]);
        if (word[2] != '\0') attached = word + 2;
        snprintf(cli->spelling, sizeof cli->spelling, "%.2s", word);
    }
    cli->option = cli->spelling;
    if (!option) return leave(cli, masu_cli_usage_error("unknown option %s", cli->option));
    return take_option(cli, option, attached);
}

/* ---- values ---- */

static const char *value_owner(const masu_cli *cli) {
    return cli->option ? cli->option : "argument";
}

bool masu_cli_uint(const masu_cli *cli, uint32_t minimum, uint32_t maximum, uint32_t *out) {
    const char *text = cli->value;
    char *end = NULL;
    errno = 0;
    unsigned long long number = 0;
    bool digits = text[0] >= '0' && text[0] <= '9'; /* strtoull would accept "-1" and " 1" */
    if (digits) number = strtoull(text, &end, 10);
    if (!digits || *end || errno || number < minimum || number > maximum) {
        masu_cli_usage_error("%s: expected a whole number from %u to %u, not \"%s\"",
                             value_owner(cli), minimum, maximum, text);
        return false;
    }
    *out = (uint32_t)number;
    return true;
}

bool masu_cli_double(const masu_cli *cli, double minimum, double maximum, double *out) {
    const char *text = cli->value;
    char *end = NULL;
    double number = strtod(text, &end);
    if (end == text || *end || !isfinite(number) || !(number >= minimum) || !(number <= maximum)) {
        masu_cli_usage_error("%s: expected a number from %g to %g, not \"%s\"", value_owner(cli),
                             minimum, maximum, text);
        return false;
    }
    *out = number;
    return true;
}

bool masu_cli_sun(const masu_cli *cli, double out[2]) {
    const char *text = cli->value;
    char *end = NULL;
    out[0] = strtod(text, &end);
    bool good = end != text && *end == ',' && fabs(out[0]) <= 360.0;
    text = good ? end + 1 : "";
    out[1] = strtod(text, &end);
    if (good && end != text && !*end && fabs(out[1]) <= 90.0) return true;
    masu_cli_usage_error(
        "%s: expected AZIMUTH,ELEVATION in degrees, at most 360 and 90, not \"%s\"",
        value_owner(cli), cli->value);
    return false;
}

bool masu_cli_extent(const masu_cli *cli, uint32_t maximum, uint32_t *width, uint32_t *height) {
    const char *text = cli->value;
    unsigned long long size[2] = {0, 0};
    bool good = true;
    for (int i = 0; i < 2 && good; i++) {
        char *end = NULL;
        good = *text >= '0' && *text <= '9';
        if (!good) break;
        errno = 0;
        size[i] = strtoull(text, &end, 10);
        good = errno == 0 && size[i] >= 1 && size[i] <= maximum && *end == (i == 0 ? 'x' : '\0');
        text = end + 1;
    }
    if (!good) {
        masu_cli_usage_error("%s: expected WIDTHxHEIGHT with each from 1 to %u, not \"%s\"",
                             value_owner(cli), maximum, cli->value);
        return false;
    }
    *width = (uint32_t)size[0];
    *height = (uint32_t)size[1];
    return true;
}

bool masu_cli_choice(const masu_cli *cli, const char *const *names, uint32_t *index) {
    char list[256] = "";
    size_t used = 0;
    for (uint32_t i = 0; names[i]; i++) {
        if (strcmp(names[i], cli->value) == 0) {
            *index = i;
            return true;
        }
        int wrote = snprintf(list + used, sizeof list - used, "%s%s", i ? ", " : "", names[i]);
        if (wrote > 0 && (size_t)wrote < sizeof list - used) used += (size_t)wrote;
    }
    masu_cli_usage_error("%s: expected one of %s, not \"%s\"", value_owner(cli), list, cli->value);
    return false;
}

/* ---- signals ---- */

const char *masu_cli_signal(int number) {
    static const struct {
        int number;
        const char *name;
    } names[] = {{SIGHUP, "HUP"},   {SIGINT, "INT"},   {SIGQUIT, "QUIT"}, {SIGILL, "ILL"},
                 {SIGTRAP, "TRAP"}, {SIGABRT, "ABRT"}, {SIGBUS, "BUS"},   {SIGFPE, "FPE"},
                 {SIGKILL, "KILL"}, {SIGSEGV, "SEGV"}, {SIGPIPE, "PIPE"}, {SIGALRM, "ALRM"},
                 {SIGTERM, "TERM"}, {SIGXCPU, "XCPU"}, {SIGXFSZ, "XFSZ"}, {SIGSYS, "SYS"},
                 {SIGUSR1, "USR1"}, {SIGUSR2, "USR2"}};
    static char text[40];
    snprintf(text, sizeof text, "signal %d", number);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (names[i].number == number)
            snprintf(text, sizeof text, "signal %d (SIG%s)", number, names[i].name);
    }
    return text;
}

const char *masu_cli_status(int status) {
    static char text[80];
    int code = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
    if (WIFSIGNALED(status))
        snprintf(text, sizeof text, "ended by %s", masu_cli_signal(WTERMSIG(status)));
    else if (code > 128 && code < 128 + 32) /* the form in which a shell reports its command */
        snprintf(text, sizeof text, "exit code %d, which stands for %s", code,
                 masu_cli_signal(code - 128));
    else snprintf(text, sizeof text, "exit code %d", code);
    return text;
}

/* ---- main ---- */

/* Without this, the next opened file would get the number of a closed stream, and output would go
 * there. Uses modes with which the stream's use still fails. */
static void keep_streams(void) {
    for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; stream++) {
        if (fcntl(stream, F_GETFD) >= 0 || errno != EBADF) continue;
        if (open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY) != stream) abort();
    }
}

/* Changes "help a b" to "a b --help"; `help` has been read. */
static void turn_help(masu_cli *cli) {
    static char option[] = "--help";
    for (int i = cli->next; i < cli->argc; i++) cli->argv[i - 1] = cli->argv[i];
    cli->argv[cli->argc - 1] = option;
    cli->next--;
}

int masu_cli_commands(masu_cli *cli, const char *summary, const masu_cli_command *const *commands) {
    if (cli->next >= cli->argc) return masu_cli_usage_error("expected a command");
    const char *word = cli->argv[cli->next++];
    if (strcmp(word, "help") == 0) {
        turn_help(cli);
        word = cli->argv[cli->next++];
    }
    if (strcmp(word, "-h") == 0 || strcmp(word, "--help") == 0) {
        print_commands(summary, commands);
        return MASU_CLI_OK;
    }
    if (strcmp(word, "--version") == 0) {
        printf("%s %s\n", cli->program->name, cli->program->version);
        return MASU_CLI_OK;
    }
    for (const masu_cli_command *const *c = commands; *c; c++) {
        if (strcmp((*c)->name, word) != 0) continue;
        size_t used = strlen(state.name);
        snprintf(state.name + used, sizeof state.name - used, " %s", word);
        cli->command = *c;
        return cli->command->run(cli);
    }
    return masu_cli_usage_error("unknown command \"%s\"", word);
}

int masu_cli_end(int exit_code) {
    masu_cli_progress_clear();
    if (fflush(stdout) != 0 || ferror(stdout)) {
        int code = masu_cli_error("cannot write to standard output: %s", strerror(errno));
        if (exit_code == MASU_CLI_OK) exit_code = code;
    }
    return exit_code;
}

int masu_cli_main(const masu_cli_program *program, int argc, char **argv) {
    masu_cli cli = {.program = program, .argc = argc, .next = 1, .argv = argv};
    keep_streams();
    masu_atomic_file_catch_signals();
    snprintf(state.name, sizeof state.name, "%s", program->name);
    cli.command = program->commands[0];
    int exit_code = cli.command->name ? masu_cli_commands(&cli, program->summary, program->commands)
                                      : cli.command->run(&cli);
    return masu_cli_end(exit_code);
}
