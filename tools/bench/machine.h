/* machine.h: machine.json in the folder of `masu bench`: machine, driver, version and date of each
 * run.
 *
 * sweep.json must be equal in all parts of a sweep, so it cannot hold these. The file is an array
 * of runs; merged folders have the runs of all parts. Owns nothing; functions that fail write one
 * line to `error`. */
#ifndef MASU_BENCH_MACHINE_H
#define MASU_BENCH_MACHINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct masu_machine {
    char cpu[128]; /* "model name" of /proc/cpuinfo, or "unknown" */
    char driver[256], masu[32], date[32]; /* "2026-05-01 12:00 UTC" */
    uint32_t threads;                     /* available to this process */
} masu_machine;

/* Describes this machine and the current time. */
void masu_machine_here(const char *driver, masu_machine *out);

/* Finds the CPU's name in the text of /proc/cpuinfo. Returns false if there is none; out is
 * "unknown". */
bool masu_machine_cpu(const char *cpuinfo, char *out, size_t size);

/* Appends to FOLDER/machine.json or creates it, unless the last entry differs only in the time of
 * day. It is an error if the file has other contents. */
bool masu_machine_append(const char *folder, const masu_machine *machine, char *error,
                         size_t error_size);

/* Removes the file of a folder without rows. */
void masu_machine_forget(const char *folder);

/* Adds the entries of `part` that FOLDER does not have. A part without the file adds nothing. */
bool masu_machine_merge(const char *folder, const char *part, char *error, size_t error_size);

/* Reads run i; 0 is the first. Returns false if there is no such run or no file. */
bool masu_machine_read(const char *folder, uint32_t i, masu_machine *out);

/* A hash of the running program's file; "" if it cannot be read. */
void masu_machine_build(char out[17]);

#endif
