/* make_structs.c: writes the enums and structs of include/masu_knobs.h that its tables define as
 * plain declarations, which editors, ctags and binding generators can read.
 *
 *     make_structs < include/masu_knobs.h > NEW     replaces the text between the markers
 *
 * `make docs-tables` runs it; tests/scripts/docs_tables.sh compares the header with its output, and
 * src/quality/knobs.c and src/plan/limits.c have assertions on types and offsets. */
#include "masu.h"

#include <stdio.h>
#include <string.h>

#ifndef MASU_LAB
#error "compile with MASU_LAB: its members are between #ifdef and #endif"
#endif

enum { COLUMNS = 96 };

/* Prints the comment above a member, wrapped. */
static void print_comment(const char *indent, const char *text) {
    size_t first = strlen(indent) + 3, column = first;
    printf("%s/* ", indent);
    for (const char *word = text; *word;) {
        size_t length = strcspn(word, " ");
        size_t end = word[length] ? 0 : 3; /* the end of the comment stays in the line */
        if (column > first && column + length + end > COLUMNS) {
            printf("\n%s * ", indent);
            column = first;
        } else if (column > first) {
            putchar(' ');
        }
        printf("%.*s", (int)length, word);
        column += length + (column > first);
        word += length + strspn(word + length, " ");
    }
    printf(" */\n");
}

/* ---- Enums ----------------------------------------------------------------------------------- */

#define WORD(name, value, word, text)                                                              \
    if ((text)[0]) print_comment("    ", text);                                                    \
    printf("    " #name " = %d,\n", value);

static void print_enums(void) {
    printf("typedef enum masu_switch {\n");
    MASU_SWITCH_WORDS(WORD)
    printf("} masu_switch;\n\ntypedef enum masu_easu {\n");
    MASU_EASU_WORDS(WORD)
    printf("} masu_easu;\n\ntypedef enum masu_aa {\n");
    MASU_AA_WORDS(WORD)
    printf("} masu_aa;\n");
}

/* ---- The rung -------------------------------------------------------------------------------- */

#define LAB_NAME(type, name, ...) #name,
static const char *const lab_names[] = {MASU_LAB_KNOBS(LAB_NAME, LAB_NAME)};

static int in_lab(const char *name) {
    for (size_t i = 0; i < sizeof lab_names / sizeof *lab_names; i++)
        if (!strcmp(name, lab_names[i])) return 1;
    return 0;
}

static void print_member(const char *type, const char *name, const char *text, const char *range) {
    char whole[2048];
    snprintf(whole, sizeof whole, "%s%s", text, range);
    if (in_lab(name)) printf("#ifdef MASU_LAB\n");
    print_comment("    ", whole);
    printf("    %s %s;\n", type, name);
    if (in_lab(name)) printf("#endif\n");
}

static const char *range_of(double low, double high, double zero, const char *unit) {
    static char text[128];
    int length =
        snprintf(text, sizeof text, " Range %.10g..%.10g%s%s", low, high, *unit ? " " : "", unit);
    if (zero != 0.0)
        length += snprintf(text + length, sizeof text - (size_t)length, "; 0: %.10g", zero);
    snprintf(text + length, sizeof text - (size_t)length, ".");
    return text;
}

#define NUMBER_MEMBER(type, name, low, high, zero, use, unit, text, cost)                          \
    print_member(#type, #name, text, range_of((double)(low), (double)(high), (double)(zero), unit));
#define WORD_MEMBER(type, name, auto_is, use, text, cost) print_member(#type, #name, text, "");

static void print_rung(void) {
    printf("typedef struct masu_rung {\n");
    MASU_KNOBS(NUMBER_MEMBER, WORD_MEMBER)
    printf("} masu_rung;\n");
}

/* ---- Limits ---------------------------------------------------------------------------------- */

#define LIMIT_MEMBER(name, max, text)                                                              \
    print_comment("    ", text);                                                                   \
    printf("    uint64_t " #name ";\n");
#define PEAK_MEMBER(name, max, text) printf("    uint64_t " #name ";\n");

static void print_limits(void) {
    printf("typedef struct masu_limits {\n");
    MASU_LIMITS(LIMIT_MEMBER)
    printf("} masu_limits;\n");
}

static void print_peaks(void) {
    printf("typedef struct masu_peak_info {\n"
           "    /* as in masu_limits */\n");
    MASU_LIMITS(PEAK_MEMBER)
    printf("    uint64_t host_bytes;   /* used in the host block */\n"
           "    uint64_t device_bytes; /* in all device blocks */\n"
           "} masu_peak_info;\n");
}

static const struct {
    const char *name;
    void (*print)(void);
} parts[] = {{"enums", print_enums},
             {"masu_rung", print_rung},
             {"masu_limits", print_limits},
             {"masu_peak_info", print_peaks}};
enum { PARTS = sizeof parts / sizeof *parts };

int main(void) {
    char line[4096], name[64];
    unsigned done = 0;
    int skips = 0;
    while (fgets(line, sizeof line, stdin)) {
        if (!strncmp(line, "/* end of what make_structs.c wrote */", 38)) skips = 0;
        if (!skips) fputs(line, stdout);
        if (sscanf(line, "/* written by make_structs.c: %63[a-z_] */", name) != 1) continue;
        for (unsigned i = 0; i < PARTS; i++) {
            if (strcmp(parts[i].name, name) != 0) continue;
            parts[i].print();
            done |= 1u << i;
        }
        skips = 1;
    }
    if (!skips && done == (1u << PARTS) - 1) return 0;
    fprintf(stderr, "make_structs: markers are missing or do not end\n");
    return 1;
}
