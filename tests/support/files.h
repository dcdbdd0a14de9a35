/* files.h: files and folders for tests: a scratch folder per group, reading and writing files,
 * running programs in a shell, baking scenes from a text. Every failure fails the test. */
#ifndef SUPPORT_FILES_H
#define SUPPORT_FILES_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The scratch folder. make_scratch creates a new one; use it as the set-up of a group or of each
 * test. */
extern char scratch[];
int make_scratch(void **state);
int remove_scratch(void **state);
int remove_empty_scratch(void **state); /* fails unless the folder is empty */

/* Path of a file in it; static storage, four names at a time. */
const char *in_scratch(const char *name);

/* Writes a file to it; returns its path, as in_scratch does. */
const char *write_bytes(const char *name, const void *bytes, size_t count);
const char *write_text(const char *name, const char *text);
bool is_in_scratch(const char *name);

/* A whole file, aligned for masu_scene_bind, with a 0 byte after it. The caller frees it. bytes may
 * be NULL. */
void *read_file(const char *path, size_t *bytes);

/* $BUILD or "build": programs. $MADE, or the same folder: SPIR-V in gen/, baked scenes. $CC or
 * "cc". */
const char *build_dir(void);
const char *made_dir(void);
const char *c_compiler(void);

/* True if LONG is set (make check LONG=1): tests then run every row and trial, otherwise a
 * sample. */
bool long_run(void);

/* True if LONG is set or this is the system's driver (the first one). On other drivers, tests that
 * hardly depend on the driver run a part of their rows. So do unit tests under the sanitizers
 * (NESTED), which make them ten times slower. */
bool whole_run(void);
/* True on SwiftShader, unless LONG is set: it takes four times as long as the others, and tests leave
 * to the others what the host decides. */
bool is_slow_driver(void);
/* `all` if LONG is set, `quick` on the system's driver, else `elsewhere`. */
uint32_t trials(uint32_t all, uint32_t quick, uint32_t elsewhere);

/* FNV-1a of 64 bits; *h starts as HASH_START. */
#define HASH_START 0xCBF29CE484222325u
void hash_bytes(uint64_t *h, const void *bytes, size_t count);

/* Runs a command; returns its exit code. */
int shell(const char *format, ...) __attribute__((format(printf, 1, 2)));
int shell_list(const char *format, va_list arguments);

/* Bakes a scene description to NAME.masu in the scratch folder. If $MASU_BAKED names a folder
 * (tests/run.sh makes one per run), a scene that a test has already baked for another driver is
 * copied from there. */
void bake_scene(const char *name, const char *json);
const char *baked_scene(const char *name); /* its path; static storage, four names at a time */

#endif
