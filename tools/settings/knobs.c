/* knobs.c: see knobs.h. */
#include "settings/knobs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const masu_knob *masu_knob_find(const char *name, size_t length) {
    for (const masu_knob *k = masu_knob_table(); k->name; k++) {
        if (strlen(k->name) == length && !strncmp(k->name, name, length)) return k;
    }
    return NULL;
}

bool masu_knob_differs(const masu_knob *k, const masu_rung *a, const masu_rung *b) {
    return memcmp((const char *)a + k->offset, (const char *)b + k->offset, 4 * k->values) != 0;
}

void masu_knob_copy(const masu_knob *k, masu_rung *to, const masu_rung *from) {
    memcpy((char *)to + k->offset, (const char *)from + k->offset, 4 * k->values);
}

/* ---- Written --------------------------------------------------------------------------------- */

/* The fewest digits that read back as the same float; nine always do (FLT_DECIMAL_DIG). */
static void float_text(double value, char *out, size_t size) {
    for (int digits = 4; digits <= 9; digits++) {
        snprintf(out, size, "%.*g", digits, value);
        float back = strtof(out, NULL), is = (float)value;
        if (!memcmp(&back, &is, sizeof is)) return;
    }
}

/* One value of any kind of knob. */
static void value_text(const masu_knob *k, const masu_rung *rung, uint32_t i, char *out,
                       size_t size) {
    double value = masu_knob_get(k, rung, i);
    if (k->kind == MASU_KNOB_FLOAT) {
        float_text(value, out, size);
    } else if (k->kind == MASU_KNOB_WORD && value < k->word_count) {
        snprintf(out, size, "%s", k->words[(uint32_t)value].word);
    } else {
        snprintf(out, size, "%.0f", value);
    }
}

/* All values, with the text before, between and after several values. */
static void values_text(const masu_knob *k, const masu_rung *rung, const char *const around[3],
                        char *out, size_t size) {
    size_t used = 0;
    out[0] = '\0';
    for (uint32_t i = 0; i < k->values && used < size; i++) {
        char text[64];
        value_text(k, rung, i, text, sizeof text);
        used += (size_t)snprintf(out + used, size - used, "%s%s%s",
                                 k->values == 1 ? "" : around[i ? 1 : 0], text,
                                 i + 1 < k->values || k->values == 1 ? "" : around[2]);
    }
}

void masu_knob_text(const masu_knob *k, const masu_rung *rung, char *out, size_t size) {
    static const char *const around[3] = {"", "-", ""};
    values_text(k, rung, around, out, size);
}

void masu_knob_json(const masu_knob *k, const masu_rung *rung, char *out, size_t size) {
    static const char *const around[3] = {"[", ", ", "]"};
    char word[64];
    if (k->kind != MASU_KNOB_WORD) {
        values_text(k, rung, around, out, size);
    } else {
        value_text(k, rung, 0, word, sizeof word);
        snprintf(out, size, "\"%s\"", word);
    }
}

void masu_knob_c(const masu_knob *k, const masu_rung *rung, char *out, size_t size) {
    static const char *const around[3] = {"{", ", ", "}"};
    double value = masu_knob_get(k, rung, 0);
    char text[64];
    if (k->kind == MASU_KNOB_WORD && value < k->word_count) {
        snprintf(out, size, "%s", k->words[(uint32_t)value].name);
    } else if (k->kind == MASU_KNOB_FLOAT) {
        float_text(value, text, sizeof text);
        snprintf(out, size, "%s%sf", text, strpbrk(text, ".e") ? "" : ".0");
    } else {
        values_text(k, rung, around, out, size);
    }
}

/* Whether there is a gap between 0, which is always accepted, and the other numbers. */
static bool has_gap(const masu_knob *k) {
    return k->min > 0.0 && !(k->kind == MASU_KNOB_COUNT && k->min < 2.0);
}

/* The numbers that the knob accepts: "0 to 1", "0, 16 to 8192". */
static void numbers_text(const masu_knob *k, char *out, size_t size) {
    double min = has_gap(k) || k->min < 0.0 ? k->min : 0.0;
    snprintf(out, size, "%s%.6g to %.6g", has_gap(k) ? "0, " : "", min, k->max);
}

static size_t words_text(const masu_knob *k, char *out, size_t size) {
    size_t used = 0;
    out[0] = '\0';
    for (uint32_t w = 0; w < k->word_count && used < size; w++) {
        used += (size_t)snprintf(out + used, size - used, "%s%s", w ? ", " : "", k->words[w].word);
    }
    return used;
}

void masu_knob_range(const masu_knob *k, char *out, size_t size) {
    char text[160];
    if (k->kind == MASU_KNOB_WORD) {
        words_text(k, text, sizeof text);
        snprintf(out, size, "one of %s", text);
        return;
    }
    const char *what = k->kind == MASU_KNOB_FLOAT ? "a number" : "a whole number";
    numbers_text(k, text, sizeof text);
    if (k->values > 1)
        snprintf(out, size, "%u whole numbers, each from %s", k->values, text);
    else if (has_gap(k))
        snprintf(out, size, "0 or %s from %.6g to %.6g", what, k->min, k->max);
    else
        snprintf(out, size, "%s from %s", what, text);
}

/* ---- Read ------------------------------------------------------------------------------------ */

const char *masu_json_given(const json_t *value, char *out, size_t size) {
    static const char *const names[] = {"an object", "an array", "a string", "a number",
                                        "a number",  "true",     "false",    "null"};
    if (json_is_number(value)) {
        snprintf(out, size, "%.10g", json_number_value(value));
    } else if (json_is_string(value)) {
        snprintf(out, size, "'%.60s'", json_string_value(value));
    } else {
        snprintf(out, size, "%s", value ? names[json_typeof(value)] : "nothing");
    }
    return out;
}

/* The index of the word given by the first `length` characters, or -1. */
static double word_at(const masu_knob *k, const char *text, size_t length) {
    for (uint32_t w = 0; w < k->word_count; w++) {
        if (strlen(k->words[w].word) == length && !strncmp(k->words[w].word, text, length))
            return w;
    }
    return -1.0;
}

static bool json_value(const masu_knob *k, const json_t *value, double *out) {
    if (k->kind == MASU_KNOB_WORD) {
        if (!json_is_string(value)) return false;
        *out = word_at(k, json_string_value(value), json_string_length(value));
    } else {
        if (!json_is_number(value)) return false;
        *out = json_number_value(value);
    }
    return masu_knob_accepts(k, *out) != 0;
}

bool masu_knob_from_json(const masu_knob *k, const json_t *value, masu_rung *rung, char *error,
                         size_t error_size) {
    char range[200], is[80];
    masu_rung read = *rung;
    bool several = k->values > 1, good = !several || json_array_size(value) == k->values;
    for (uint32_t i = 0; i < k->values && good; i++) {
        double one = 0.0;
        good = json_value(k, several ? json_array_get(value, i) : value, &one);
        masu_knob_set(k, &read, i, one);
    }
    if (good) {
        *rung = read;
        return true;
    }
    masu_knob_range(k, range, sizeof range);
    snprintf(error, error_size, "expected %s%s, found %s", several ? "an array of " : "", range,
             masu_json_given(value, is, sizeof is));
    return false;
}

/* Returns the end of one value. "1e+09" is one number: a '+' ends a value only at the end of a
 * number. */
static const char *text_value(const masu_knob *k, const char *text, double *out) {
    const char *end = text;
    char *after;
    if (k->kind == MASU_KNOB_WORD) {
        end = text + strcspn(text, "+");
        *out = word_at(k, text, (size_t)(end - text));
    } else if (k->kind == MASU_KNOB_FLOAT) {
        if (!*text || !strchr("-.0123456789", *text)) return NULL; /* no space, no sign, no "nan" */
        *out = (double)strtof(text, &after);
        end = after;
    } else {
        end += strspn(text, "0123456789");
        *out = strtod(text, NULL);
    }
    return end > text && masu_knob_accepts(k, *out) ? end : NULL;
}

const char *masu_knob_from_text(const masu_knob *k, const char *text, masu_rung *rung) {
    masu_rung read = *rung;
    for (uint32_t i = 0; i < k->values; i++) {
        double one = 0.0;
        if (i && *text++ != '-') return NULL;
        text = text_value(k, text, &one);
        if (!text) return NULL;
        masu_knob_set(k, &read, i, one);
    }
    *rung = read;
    return text;
}

/* ---- Pages ----------------------------------------------------------------------------------- */

static void zero_text(const masu_knob *k, char *out, size_t size) {
    if (k->kind == MASU_KNOB_WORD)
        snprintf(out, size, "%s", k->words[0].word);
    else
        snprintf(out, size, "%.10g", k->zero);
}

/* Prints text in lines of at most `width` characters, each indented by `indent` spaces. */
static void print_wrapped(FILE *to, const char *text, int indent, size_t width) {
    size_t column = 0;
    while (*text) {
        size_t n = strcspn(text, " ");
        if (column && column + 1 + n > width) {
            fputc('\n', to);
            column = 0;
        }
        if (!column) fprintf(to, "%*s", indent, "");
        column += (size_t)fprintf(to, "%s%.*s", column ? " " : "", (int)n, text);
        text += n + (text[n] == ' ');
    }
    fputc('\n', to);
}

static void values_of(const masu_knob *k, char *out, size_t size) {
    char numbers[80];
    if (k->kind == MASU_KNOB_WORD) {
        words_text(k, out, size);
        return;
    }
    numbers_text(k, numbers, sizeof numbers);
    int n = k->values > 1 ? snprintf(out, size, "%u values of ", k->values) : 0;
    snprintf(out + n, size - (size_t)n, "%s%s%s", numbers, k->unit[0] ? " " : "", k->unit);
}

void masu_knobs_print(FILE *to) {
    char values[200], zero[40], text[1024];
    fprintf(to, "Knobs of a rung, with their names in settings (scale=0.5+aa=fxaa), "
                "ladder.json and suites:\n");
    for (const masu_knob *k = masu_knob_table(); k->name; k++) {
        values_of(k, values, sizeof values);
        zero_text(k, zero, sizeof zero);
        fprintf(to, "\n  %-22s %s (default %s)\n", k->name, values, zero);
        snprintf(text, sizeof text, "%s Cost: %s Applies to: %s.", k->text, k->cost, k->where);
        print_wrapped(to, text, 6, 90);
    }
    fprintf(to, "\nLimits of a scene; 0 is no limit, except for the maximum given here:\n\n");
    for (const masu_limit *l = masu_limit_table(); l->name; l++) {
        fprintf(to, "  %-22s", l->name);
        if (l->max) fprintf(to, " at most %llu", (unsigned long long)l->max);
        fputc('\n', to);
        print_wrapped(to, l->text, 6, 90);
    }
}

/* Prints the lists of values, each once. */
static void document_words(FILE *to) {
    for (const masu_knob *k = masu_knob_table(); k->name; k++) {
        bool seen = !k->words;
        for (const masu_knob *o = masu_knob_table(); o < k; o++)
            seen = seen || o->words == k->words;
        if (seen) continue;
        fprintf(to, "\n`%s`", k->name);
        for (const masu_knob *o = k + 1; o->name; o++) {
            if (o->words == k->words) fprintf(to, ", `%s`", o->name);
        }
        fprintf(to, ":\n\n| value | enumerator | description |\n|---|---|---|\n");
        for (uint32_t w = 0; w < k->word_count; w++) {
            fprintf(to, "| %s | `%s` | %s |\n", k->words[w].word, k->words[w].name,
                    k->words[w].text);
        }
    }
}

void masu_knobs_document(FILE *to) {
    char values[200], zero[40];
    fprintf(
        to,
        "# Knobs and limits\n\nGenerated by `make docs-tables` from `MASU_KNOBS` and "
        "`MASU_LIMITS` in include/masu_knobs.h.\n\n## Knobs of a rung\n\n"
        "Members of `masu_rung`, in the order of setting names (`scale=0.5+aa=fxaa`). "
        "ladder.json and suites use\nthe same names and values. 0 in a member is the default.\n\n"
        "| knob | values | default | applies to | description | cost "
        "|\n|---|---|---|---|---|---|\n");
    for (const masu_knob *k = masu_knob_table(); k->name; k++) {
        values_of(k, values, sizeof values);
        zero_text(k, zero, sizeof zero);
        fprintf(to, "| `%s` | %s | %s | %s | %s | %s |\n", k->name, values, zero, k->where, k->text,
                k->cost);
    }
    fprintf(to, "\n## Values\n");
    document_words(to);
    fprintf(to, "\n## Limits of a scene\n\nMembers of `masu_limits`, where 0 is no limit, and of "
                "`masu_peak_info`, which reports the counts of a renderer.\n\n"
                "| limit | maximum | cost per element |\n|---|---|---|\n");
    for (const masu_limit *l = masu_limit_table(); l->name; l++) {
        char most[32] = "";
        if (l->max) snprintf(most, sizeof most, "at most %llu", (unsigned long long)l->max);
        fprintf(to, "| `%s` | %s | %s |\n", l->name, most, l->text);
    }
}
