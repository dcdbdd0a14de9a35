/* report.c: see report.h. */
#include "conform/report.h"

#include "cli/markup.h"

#include <math.h>
#include <string.h>

/* ---- Quoting --------------------------------------------------------------------------------- */

void masu_shell_quote(FILE *f, const char *text) {
    static const char plain[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._:/=+,@-";
    if (*text && !text[strspn(text, plain)]) {
        fputs(text, f);
        return;
    }
    fputc('\'', f);
    for (; *text; text++) {
        if (*text == '\'')
            fputs("'\\''", f);
        else
            fputc(*text, f);
    }
    fputc('\'', f);
}

static void csv_text(FILE *f, const char *text) {
    fputc('"', f);
    for (; *text; text++) {
        if (*text == '"') fputc('"', f);
        fputc(*text, f);
    }
    fputc('"', f);
}

/* ---- Lines ----------------------------------------------------------------------------------- */

static void print_replay(FILE *f, const masu_suite *suite, const masu_case *c) {
    char token[256];
    if (masu_replay_token(suite, c, token, sizeof token)) masu_shell_quote(f, token);
}

void masu_conform_print(FILE *f, const masu_suite *suite, const masu_conform_result *r,
                        const char *command) {
    char size[24];
    snprintf(size, sizeof size, "%ux%u", r->of->width, r->of->height);
    fprintf(f, "%-15s  %-36s %9s %7.2f s\n", masu_verdict_name(r->verdict), r->of->name, size,
            r->seconds);
    if (r->why[0]) fprintf(f, "    %s\n", r->why);
    if (r->note[0]) fprintf(f, "    note: %s\n", r->note);
    if (!masu_verdict_failed(r->verdict)) return;
    fprintf(f, "    replay: %s --replay ", command);
    print_replay(f, suite, r->of);
    fputc('\n', f);
}

void masu_conform_tally(const masu_conform_result *results, uint32_t n,
                        uint32_t tally[MASU_VERDICT_COUNT]) {
    memset(tally, 0, MASU_VERDICT_COUNT * sizeof *tally);
    for (uint32_t i = 0; i < n; i++) tally[results[i].verdict]++;
}

static double seconds(const masu_conform_result *results, uint32_t n) {
    double sum = 0.0;
    for (uint32_t i = 0; i < n; i++) sum += results[i].seconds;
    return sum;
}

void masu_conform_sum(FILE *f, const masu_conform_result *results, uint32_t n) {
    uint32_t t[MASU_VERDICT_COUNT];
    masu_conform_tally(results, n, t);
    fprintf(f,
            "%u case%s: %u passed, %u quality warning%s, %u not supported, %u resource error%s, "
            "%u failed",
            n, n == 1 ? "" : "s", t[MASU_VERDICT_PASS], t[MASU_VERDICT_WARNING],
            t[MASU_VERDICT_WARNING] == 1 ? "" : "s", t[MASU_VERDICT_UNSUPPORTED],
            t[MASU_VERDICT_RESOURCE], t[MASU_VERDICT_RESOURCE] == 1 ? "" : "s",
            t[MASU_VERDICT_FAIL]);
    if (t[MASU_VERDICT_NOT_RUN]) fprintf(f, ", %u not run", t[MASU_VERDICT_NOT_RUN]);
    fprintf(f, " in %.1f s\n", seconds(results, n));
}

/* ---- Files ----------------------------------------------------------------------------------- */

void masu_conform_csv(FILE *f, const masu_suite *suite, const masu_conform_result *results,
                      uint32_t n, const char *driver) {
    fprintf(f, "case,scene,width,height,verdict,seconds");
    for (int m = 0; m < MASU_MEASURE_COUNT; m++)
        fprintf(f, ",%s", masu_measure_name((masu_measure)m));
    fprintf(f, ",why,replay,driver\n");
    for (uint32_t i = 0; i < n; i++) {
        const masu_conform_result *r = &results[i];
        char token[256] = "";
        csv_text(f, r->of->name);
        fputc(',', f);
        csv_text(f, r->of->scene);
        fprintf(f, ",%u,%u,%s,%.3f", r->of->width, r->of->height, masu_verdict_name(r->verdict),
                r->seconds);
        for (int m = 0; m < MASU_MEASURE_COUNT; m++) {
            fputc(',', f);
            if (!isnan(r->values[m])) fprintf(f, "%.10g", r->values[m]);
        }
        fputc(',', f);
        csv_text(f, r->why);
        fputc(',', f);
        if (masu_replay_token(suite, r->of, token, sizeof token)) csv_text(f, token);
        fputc(',', f);
        csv_text(f, driver);
        fputc('\n', f);
    }
}

/* ---- Tables ---------------------------------------------------------------------------------- */

/* Writes a table cell: escapes the characters that end a cell or start a tag. */
static void cell(FILE *f, const char *text) {
    for (; *text; text++) {
        if (*text == '|' || *text == '<' || *text == '\\') fputc('\\', f);
        fputc((unsigned char)*text < ' ' ? ' ' : *text, f);
    }
}

static double limit_of(const masu_bound *b) { return isnan(b->fail) ? b->warn : b->fail; }

static void print_limits(FILE *f, const masu_case *c) {
    const char *join = "";
    static const char *const same[] = MASU_SAME_NAMES;
    for (int m = 0; m < MASU_MEASURE_COUNT; m++) {
        const char *name = masu_measure_name((masu_measure)m);
        bool more = masu_measure_more((masu_measure)m);
        if (masu_bound_is_set(&c->bounds[m])) {
            double limit = limit_of(&c->bounds[m]);
            if (!limit && !more) /* 0 cannot be undercut: print equality */
                fprintf(f, "%s%s = 0", join, name);
            else
                fprintf(f, "%s%s %s %.4g", join, name, more ? "\xE2\x89\xA5" : "\xE2\x89\xA4",
                        limit);
            join = ", ";
        }
        if (masu_bound_is_set(&c->least[m])) {
            fprintf(f, "%s%s \xE2\x89\xA5 %.4g", join, name, limit_of(&c->least[m]));
            join = ", ";
        }
    }
    if (c->exact_memory) fprintf(f, "%sone byte less is rejected", join), join = ", ";
    for (int i = 0; same[i]; i++) {
        if (c->same & 1u << i) fprintf(f, "%sbit-identical: %s", join, same[i]), join = ", ";
    }
    if (c->against) {
        fprintf(f, "%sagainst ", join);
        cell(f, c->against);
    }
}

void masu_conform_table(FILE *f, const masu_suite *suite, const masu_conform_result *results,
                        uint32_t n, const char *driver) {
    (void)suite;
    (void)driver;
    for (uint32_t i = 0; i < n; i++) {
        const masu_conform_result *r = &results[i];
        const char *join = "";
        fprintf(f, "| %s | ", masu_verdict_name(r->verdict));
        cell(f, r->of->name);
        fprintf(f, " %ux%u | ", r->of->width, r->of->height);
        cell(f, r->of->extreme.input ? r->of->extreme.input : r->of->scene);
        fputs(" | ", f);
        print_limits(f, r->of);
        fputs(" | ", f);
        for (int m = 0; m < MASU_MEASURE_COUNT; m++) {
            bool asked =
                masu_bound_is_set(&r->of->bounds[m]) || masu_bound_is_set(&r->of->least[m]);
            bool unlimited = masu_bound_is_set(&r->of->bounds[m]) && !limit_of(&r->of->bounds[m]) &&
                             !(r->values[m] > 0);
            if (!asked || unlimited || isnan(r->values[m])) continue;
            fprintf(f, "%s%s %.4g", join, masu_measure_name((masu_measure)m), r->values[m]);
            join = ", ";
        }
        if (!*join) fputs(r->verdict == MASU_VERDICT_PASS ? "all 0" : "-", f);
        fputs(" |\n", f);
    }
}

/* ---- JUnit ----------------------------------------------------------------------------------- */

static void attribute(FILE *f, const char *name, const char *value) {
    masu_markup(f, " %s=\"%s\"", name, value);
}

static void property(FILE *f, const char *name, const char *value) {
    fputs("      <property", f);
    attribute(f, "name", name);
    attribute(f, "value", value);
    fputs("/>\n", f);
}

static void junit_case(FILE *f, const masu_suite *suite, const masu_conform_result *r) {
    static const char *const tags[MASU_VERDICT_COUNT] = {[MASU_VERDICT_UNSUPPORTED] = "skipped",
                                                         [MASU_VERDICT_RESOURCE] = "error",
                                                         [MASU_VERDICT_FAIL] = "failure",
                                                         [MASU_VERDICT_NOT_RUN] = "error"};
    char name[200], token[256];
    snprintf(name, sizeof name, "%s (%ux%u)", r->of->name, r->of->width, r->of->height);
    fputs("    <testcase classname=\"conform\"", f);
    attribute(f, "name", name);
    fprintf(f, " time=\"%.3f\">\n", r->seconds);
    if (tags[r->verdict]) {
        fprintf(f, "      <%s", tags[r->verdict]);
        attribute(f, "message", r->why);
        if (r->verdict != MASU_VERDICT_UNSUPPORTED)
            attribute(f, "type", masu_verdict_name(r->verdict));
        fputs("/>\n", f);
    }
    fputs("      <system-out>", f);
    masu_markup_text(f, masu_verdict_name(r->verdict));
    if (r->verdict == MASU_VERDICT_WARNING) {
        fputs(": ", f);
        masu_markup_text(f, r->why);
    }
    for (int m = 0; m < MASU_MEASURE_COUNT; m++) {
        if (!isnan(r->values[m]))
            fprintf(f, "\n%s %.10g", masu_measure_name((masu_measure)m), r->values[m]);
    }
    if (masu_replay_token(suite, r->of, token, sizeof token)) {
        fputs("\nreplay ", f);
        masu_markup_text(f, token);
    }
    fputs("</system-out>\n    </testcase>\n", f);
}

void masu_conform_junit(FILE *f, const masu_suite *suite, const masu_conform_result *results,
                        uint32_t n, const char *driver) {
    uint32_t t[MASU_VERDICT_COUNT];
    char hash[16];
    masu_conform_tally(results, n, t);
    snprintf(hash, sizeof hash, "%08x", suite->hash);
    fputs("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n  <testsuite", f);
    attribute(f, "name", suite->file);
    fprintf(f, " tests=\"%u\" failures=\"%u\" errors=\"%u\" skipped=\"%u\" time=\"%.3f\">\n", n,
            t[MASU_VERDICT_FAIL], t[MASU_VERDICT_RESOURCE] + t[MASU_VERDICT_NOT_RUN],
            t[MASU_VERDICT_UNSUPPORTED], seconds(results, n));
    fputs("    <properties>\n", f);
    property(f, "suite", hash);
    property(f, "driver", driver);
    fputs("    </properties>\n", f);
    for (uint32_t i = 0; i < n; i++) junit_case(f, suite, &results[i]);
    fputs("  </testsuite>\n</testsuites>\n", f);
}
