/* cli.h: the command line of all Masu programs, with uniform options and messages.
 *
 *   --name VALUE, --name=VALUE, -n VALUE, -nVALUE
 *                an optional value only as --name=VALUE;
 *                before or after the arguments; `--` ends the options
 *   -h, --help, --version, --quiet
 *                in every program and subcommand, handled here; `masu help COMMAND` is
 *                `masu COMMAND --help`
 *   exit code    0 done, 1 failed, 2 the command line is wrong
 *   stderr       one line per error or warning, "masu-bake: cannot read x.glb: ...", and a progress
 *                line, only on a terminal and without --quiet
 *
 * A program is a masu_cli_program whose main calls masu_cli_main. A program without subcommands has
 * one command whose name is NULL; `masu` has one per subcommand, and its messages start with "masu
 * render: ". A command's run function reads its options in the order of the command line:
 *
 *   static int run(masu_cli *cli) {
 *       const char *scene = NULL;
 *       uint32_t frames = 1;
 *       for (;;) {
 *           switch (masu_cli_next(cli)) {
 *           case OPTION_FRAMES:
 *               if (!masu_cli_uint(cli, 1, 100000, &frames)) return MASU_CLI_USAGE;
 *               break;
 *           case MASU_CLI_ARGUMENT: scene = cli->value; break;
 *           case MASU_CLI_EXIT: return cli->exit_code;    --help, --version, or a reported mistake
 *           case MASU_CLI_END: return render(scene, frames);
 *           }
 *       }
 *   }
 *
 * Nothing here allocates; returned strings point into argv. The program's name, --quiet and the
 * progress line are static state, because a process has one command line. */
#ifndef MASU_CLI_H
#define MASU_CLI_H

#include <stdbool.h>
#include <stdint.h>

enum { MASU_CLI_OK = 0, MASU_CLI_FAILURE = 1, MASU_CLI_USAGE = 2 }; /* exit codes */

enum {
    MASU_CLI_ARGUMENT = 0, /* cli->value is an argument, not an option */
    MASU_CLI_END = -1,     /* the command line has been read completely */
    MASU_CLI_EXIT = -2     /* exit with cli->exit_code */
};

#if defined(__GNUC__)
#define MASU_CLI_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define MASU_CLI_PRINTF(text, first)
#endif

typedef struct masu_cli masu_cli;

typedef struct masu_cli_option {
    const char *name;  /* long name without dashes; "": `help` is a heading of the help text,
                        * without colon; NULL ends the list */
    const char *value; /* name of the value in the help, "FILE"; NULL: none, a switch; "[=N]": an
                        * optional value, --name=N */
    const char *help;  /* may contain '\n': the following lines are indented */
    int id;            /* > 0; what masu_cli_next returns */
    char letter;       /* -o as a short form of --output; 0: none */
} masu_cli_option;

typedef struct masu_cli_command {
    const char *name;               /* "render"; NULL if the program has no subcommands */
    const char *arguments;          /* of the usage line: "SCENE.masu -o OUT.png [options]" */
    const char *summary;            /* one line */
    const masu_cli_option *options; /* its options besides the common three; NULL: none */
    const char *details;            /* text below the options, ending in '\n'; NULL: none */
    int (*run)(masu_cli *cli);      /* returns an exit code */
} masu_cli_command;

typedef struct masu_cli_program {
    const char *name;                        /* "masu-bake" */
    const char *version;                     /* "1.2.3" */
    const char *summary;                     /* of the whole program; unused without subcommands */
    const masu_cli_command *const *commands; /* NULL at the end */
} masu_cli_program;

struct masu_cli {
    const masu_cli_program *program;
    const masu_cli_command *command;
    const char *value;  /* of the option or argument that masu_cli_next returned; NULL: none */
    const char *option; /* that option as written, "--size"; for messages */
    int exit_code;      /* after MASU_CLI_EXIT */
    int argc, next;     /* rest of the command line */
    char **argv;
    char spelling[64];
    bool arguments_only; /* after "--" */
};

/* The body of main: finds the command, runs it and clears the progress line. A failed write to
 * stdout (a full disk, a closed stream) makes the exit code 1. A signal that ends the program
 * removes its temporary files (atomic_file.h). */
int masu_cli_main(const masu_cli_program *program, int argc, char **argv);

/* The end of masu_cli_main, for a child that ends by exit(): returns the exit code. */
int masu_cli_end(int exit_code);

/* For commands with subcommands, such as `masu-lab study march`: their run function calls this. */
int masu_cli_commands(masu_cli *cli, const char *summary, const masu_cli_command *const *commands);

/* The next option's id, or MASU_CLI_ARGUMENT, _END or _EXIT. */
int masu_cli_next(masu_cli *cli);

/* Parse cli->value. On false the error has been reported: return MASU_CLI_USAGE. */
bool masu_cli_uint(const masu_cli *cli, uint32_t minimum, uint32_t maximum, uint32_t *out);
bool masu_cli_double(const masu_cli *cli, double minimum, double maximum, double *out);
/* Azimuth and elevation in degrees, "60,15". */
bool masu_cli_sun(const masu_cli *cli, double out[2]);
/* "1920x1080", each from 1 to maximum */
bool masu_cli_extent(const masu_cli *cli, uint32_t maximum, uint32_t *width, uint32_t *height);
/* one of the names; NULL ends the list */
bool masu_cli_choice(const masu_cli *cli, const char *const *names, uint32_t *index);

/* Replaces control characters, including line ends, with '?', so that text from a file remains one
 * line. */
void masu_cli_plain(char *text);

/* Print one line on stderr after the program's name. Control characters become '?', so that a name
 * from a file cannot forge lines. Each returns its exit code, for `return masu_cli_error(...)`; the
 * usage form adds "(see NAME --help)". */
int masu_cli_error(const char *format, ...) MASU_CLI_PRINTF(1, 2);
int masu_cli_usage_error(const char *format, ...) MASU_CLI_PRINTF(1, 2);

/* "signal 11 (SIGSEGV)", for messages; valid until the next call. */
const char *masu_cli_signal(int number);

/* A status of waitpid or system: "ended by signal 11 (SIGSEGV)", "exit code 3"; valid until the
 * next call. */
const char *masu_cli_status(int status);

/* "NAME: warning: ...", even with --quiet. */
void masu_cli_warn(const char *format, ...) MASU_CLI_PRINTF(1, 2);
uint32_t masu_cli_warnings(void); /* number of warnings so far */
/* Sets the function that receives the text of each later warning, without "warning: "; NULL:
 * none. */
void masu_cli_hear_warnings(void (*hears)(void *user, const char *text), void *user);

/* Shows the current activity. The next call replaces the line; any message and the end of the
 * program erase it. Only on a terminal, or with MASU_PROGRESS in the environment, which masu-view
 * sets for its baker. */
void masu_cli_progress(const char *format, ...) MASU_CLI_PRINTF(1, 2);
void masu_cli_progress_text(const char *text); /* as a callback */
void masu_cli_progress_clear(void);

bool masu_cli_quiet(void); /* whether --quiet was read */

#endif
