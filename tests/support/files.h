/* files.h: files and folders of tests: a scratch folder for a group, what is written to it and read
 * back, programs run in a shell, scenes baked from a text. Whatever goes wrong fails the test. */
#ifndef SUPPORT_FILES_H
#define SUPPORT_FILES_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The scratch folder. make_scratch gives a new one; as the set-up of a group, or of each test. */
extern char scratch[];
int make_scratch(void **state);
int remove_scratch(void **state);
int remove_empty_scratch(void **state); /* fails if anything is left in it */

/* Path of a file in it; static storage, four names at a time. */
const char *in_scratch(const char *name);

/* Writes a file to it; returns its path, as in_scratch does. */
const char *write_bytes(const char *name, const void *bytes, size_t count);
const char *write_text(const char *name, const char *text);
bool is_in_scratch(const char *name);

/* A whole file, aligned as masu_scene_bind wants it, with a 0 behind it; free(). bytes may be NULL. */
void *read_file(const char *path, size_t *bytes);

/* $BUILD, or build: programs. $MADE, or that: SPIR-V in gen/, baked scenes. $CC, or cc. */
const char *build_dir(void);
const char *made_dir(void);
const char *c_compiler(void);

/* Whether LONG is set (make check LONG=1): every row and trial, where else a part of them stands for all. */
bool long_run(void);

/* Whether it is, or this is the system's driver, the first: elsewhere a test of what hardly depends on the driver
 * does a part. So do unit tests with the sanitizers (NESTED), under which they take ten times as long. */
bool whole_run(void);
/* The first if LONG is set, the second on the system's driver, else the third. */
uint32_t trials(uint32_t all, uint32_t quick, uint32_t elsewhere);

/* FNV-1a of 64 bits: *h starts as HASH_START. */
#define HASH_START 0xCBF29CE484222325u
void hash_bytes(uint64_t *h, const void *bytes, size_t count);

/* Runs a command; returns its exit code. */
int shell(const char *format, ...) __attribute__((format(printf, 1, 2)));
int shell_list(const char *format, va_list arguments);

/* Bakes a scene description to NAME.masu of the scratch folder. Where $MASU_BAKED names a folder (tests/run.sh: one
 * for each run), a scene that a test has baked for another driver is taken from there. */
void bake_scene(const char *name, const char *json);
const char *baked_scene(const char *name); /* its path; static storage, four names at a time */

#endif
