/* cli.h: the command line of every Masu program, so that all of them read and speak alike.
 *
 *   --name VALUE, --name=VALUE, -n VALUE, -nVALUE
 *                a value that may be left out only as --name=VALUE;
 *                before or after the arguments; `--` ends the options
 *   -h, --help, --version, --quiet
 *                in every program and subcommand, handled here; `masu help COMMAND` is
 *                `masu COMMAND --help`
 *   exit code    0 done, 1 failed, 2 the command line is wrong
 *   stderr       one line per error or warning, "masu-bake: cannot read x.glb: ...", and a progress
 *                line, only on a terminal and without --quiet
 *
 * A program is a masu_cli_program whose main is one call of masu_cli_main. A program without
 * subcommands has one command whose name is NULL; `masu` has one per subcommand, and its messages
 * then begin with "masu render: ". A command's run function pulls its options in the order in which
 * they were written:
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
 * Nothing here allocates; strings handed out point into argv. The program's name, --quiet and the
 * progress line are the file's own state: a process is one command line. */
#ifndef MASU_CLI_H
#define MASU_CLI_H

#include <stdbool.h>
#include <stdint.h>

enum { MASU_CLI_OK = 0, MASU_CLI_FAILURE = 1, MASU_CLI_USAGE = 2 }; /* exit codes */

enum {
    MASU_CLI_ARGUMENT = 0, /* cli->value is an argument that is no option */
    MASU_CLI_END = -1,     /* the command line is read to its end */
    MASU_CLI_EXIT = -2     /* leave with cli->exit_code */
};

#if defined(__GNUC__)
#define MASU_CLI_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define MASU_CLI_PRINTF(text, first)
#endif

typedef struct masu_cli masu_cli;

typedef struct masu_cli_option {
    const char *name;  /* long name without dashes; "": help is the heading of a group in the help
                          text, without colon; NULL ends the list */
    const char *value; /* what the help calls the value, "FILE"; NULL: a switch, which takes none;
                          "[=N]": one that may be left out, --name=N */
    const char *help;  /* may contain '\n': the following lines are indented */
    int id;            /* > 0; what masu_cli_next returns */
    char letter;       /* -o as a short form of --output; 0: none */
} masu_cli_option;

typedef struct masu_cli_command {
    const char *name;               /* "render"; NULL in a program without subcommands */
    const char *arguments;          /* of the usage line: "SCENE.masu -o OUT.png [options]" */
    const char *summary;            /* what it does, one line */
    const masu_cli_option *options; /* its own; the common three are added. NULL: none */
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
    const char *value;  /* of the option or argument that masu_cli_next returned; NULL: left out */
    const char *option; /* that option as written, "--size"; for messages */
    int exit_code;      /* after MASU_CLI_EXIT */
    int argc, next;     /* what is left of the command line */
    char **argv;
    char spelling[64];
    bool arguments_only; /* after "--" */
};

/* The body of main: finds the command, runs it, clears the progress line, and makes a failed write
 * to stdout (a full disk, a closed one) exit code 1. A signal that ends the program removes its
 * temporary files (atomic_file.h). */
int masu_cli_main(const masu_cli_program *program, int argc, char **argv);

/* Its end by itself, for a child that leaves by exit(): returns the exit code. */
int masu_cli_end(int exit_code);

/* For a command that has commands of its own, `masu-lab study march`: its run function calls
 * this. */
int masu_cli_commands(masu_cli *cli, const char *summary, const masu_cli_command *const *commands);

/* The next option's id, or MASU_CLI_ARGUMENT, _END or _EXIT. */
int masu_cli_next(masu_cli *cli);

/* Read cli->value. On false the mistake has been reported: return MASU_CLI_USAGE. */
bool masu_cli_uint(const masu_cli *cli, uint32_t minimum, uint32_t maximum, uint32_t *out);
bool masu_cli_double(const masu_cli *cli, double minimum, double maximum, double *out);
/* Azimuth and elevation in degrees, "60,15". */
bool masu_cli_sun(const masu_cli *cli, double out[2]);
/* "1920x1080", each from 1 to maximum */
bool masu_cli_extent(const masu_cli *cli, uint32_t maximum, uint32_t *width, uint32_t *height);
/* one of the names; NULL ends the list */
bool masu_cli_choice(const masu_cli *cli, const char *const *names, uint32_t *index);

/* Control characters, ends of lines among them, become '?': what a file says in a message is one line. */
void masu_cli_plain(char *text);

/* One line on stderr behind the program's name; control characters become '?', so that a name out
 * of a file cannot forge lines. Each returns its exit code, for `return masu_cli_error(...)`; the
 * usage form adds "(see NAME --help)". */
int masu_cli_error(const char *format, ...) MASU_CLI_PRINTF(1, 2);
int masu_cli_usage_error(const char *format, ...) MASU_CLI_PRINTF(1, 2);

/* "signal 11 (SIGSEGV)", for messages; valid until the next call. */
const char *masu_cli_signal(int number);

/* A status of waitpid or system: "ended by signal 11 (SIGSEGV)", "exit code 3"; valid until the
 * next call. */
const char *masu_cli_status(int status);

/* "NAME: warning: ...", with --quiet too. */
void masu_cli_warn(const char *format, ...) MASU_CLI_PRINTF(1, 2);
uint32_t masu_cli_warnings(void); /* how many so far */
/* Is called with the text of each from now on, behind "warning: "; NULL: no more. */
void masu_cli_hear_warnings(void (*hears)(void *user, const char *text), void *user);

/* What is going on now: replaced by the next one, wiped by any message and at the end. On a terminal, or with
 * MASU_PROGRESS in the environment, as masu-view sets it for its baker. */
void masu_cli_progress(const char *format, ...) MASU_CLI_PRINTF(1, 2);
void masu_cli_progress_text(const char *text); /* as a callback */
void masu_cli_progress_clear(void);

bool masu_cli_quiet(void); /* --quiet has been read */

#endif
