/* machine.h: machine.json in the folder of `masu bench`: on what, with what and when each of
 * its runs was made.
 *
 * sweep.json must be the same in all parts of a sweep, so it cannot say that. An array, a run after
 * the other; merged folders have those of all parts. Owns nothing; what fails writes one line to
 * `error`. */
#ifndef MASU_BENCH_MACHINE_H
#define MASU_BENCH_MACHINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct masu_machine {
    char cpu[128]; /* "model name" of /proc/cpuinfo; "unknown" where there is none */
    char driver[256], masu[32], date[32]; /* "2026-05-01 12:00 UTC" */
    uint32_t threads;                     /* that this process may run on */
} masu_machine;

/* This machine, at this moment. */
void masu_machine_here(const char *driver, masu_machine *out);

/* The CPU's name out of the text of /proc/cpuinfo. False: it has none; out is "unknown". */
bool masu_machine_cpu(const char *cpuinfo, char *out, size_t size);

/* Appends to FOLDER/machine.json, or begins it; not what is the last one's but for the time of day. What is
 * no such file is an error. */
bool masu_machine_append(const char *folder, const masu_machine *machine, char *error,
                         size_t error_size);

/* Of a folder that has no row left. */
void masu_machine_forget(const char *folder);

/* Those of `part` that FOLDER does not have. A part without the file adds nothing. */
bool masu_machine_merge(const char *folder, const char *part, char *error, size_t error_size);

/* Run i, 0 the first. False: there are not as many, or no file. */
bool masu_machine_read(const char *folder, uint32_t i, masu_machine *out);

/* A hash of the running program's file; "" if the system does not say. */
void masu_machine_build(char out[17]);

#endif
