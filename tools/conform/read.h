/* read.h: reads values of a suite's JSON and checks their ranges. An error is one line with the
 * file, the case, the key, the expected and the given value.
 *
 * Owns nothing; strings belong to the JSON. On false the error of `at` is written. */
#ifndef MASU_CONFORM_READ_H
#define MASU_CONFORM_READ_H

#include "conform/suite.h"

/* A position in the file, for messages. */
typedef struct masu_suite_place {
    masu_suite *suite;
    const char *case_name; /* or "defaults" */
    char *error;
    size_t error_size;
} masu_suite_place;

bool masu_suite_wrong(const masu_suite_place *at, const char *key, const char *format, ...);
bool masu_suite_number(const masu_suite_place *at, const char *key, const json_t *value, double low,
                       double high, bool whole, double *out);
bool masu_suite_count(const masu_suite_place *at, const char *key, const json_t *value,
                      uint32_t low, uint32_t high, uint32_t *out);
bool masu_suite_flag(const masu_suite_place *at, const char *key, const json_t *value, bool *out);
bool masu_suite_string(const masu_suite_place *at, const char *key, const json_t *value,
                       const char **out);
bool masu_suite_object(const masu_suite_place *at, const char *key, const json_t *value);
bool masu_suite_choice(const masu_suite_place *at, const char *key, const json_t *value,
                       const char *const *names, uint32_t *out);
bool masu_suite_names(const masu_suite_place *at, const char *key, const json_t *value,
                      const char *const *names, uint32_t *out);
bool masu_suite_unknown(const masu_suite_place *at, const char *group, const char *key);

#endif
