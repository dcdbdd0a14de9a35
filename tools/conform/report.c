/* report.c: see report.h. */
#include "conform/report.h"

#include <math.h>
#include <string.h>

/* ---- Quoting --------------------------------------------------------------------------------- */

/* Bytes of the character at `p` if XML 1.0 can hold it, else 0. Overlong forms, surrogates and what
 * lies beyond U+10FFFF are no UTF-8 (RFC 3629). */
static size_t character(const unsigned char *p) {
    if (*p < 0x80) return *p >= ' ' || *p == '\t' || *p == '\n' || *p == '\r';
    size_t n = *p >= 0xF0 ? 4 : *p >= 0xE0 ? 3 : 2;
    uint32_t code = *p & (0x7Fu >> n);
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    if (*p < 0xC0 || *p > 0xF4) return 0;
    for (size_t i = 1; i < n; i++) {
        if ((p[i] & 0xC0) != 0x80) return 0; /* the terminating 0, too */
        code = code << 6 | (p[i] & 0x3Fu);
    }
    bool good = code >= least[n] && code <= 0x10FFFF && !(code >= 0xD800 && code <= 0xDFFF) &&
                code != 0xFFFE && code != 0xFFFF;
    return good ? n : 0;
}

void masu_xml_escape(FILE *f, const char *text) {
    const unsigned char *p = (const unsigned char *)text;
    while (*p) {
        size_t n = character(p);
        switch (n ? *p : 0) {
        case 0: fputc('?', f); break;
        case '&': fputs("&amp;", f); break;
        case '<': fputs("&lt;", f); break;
        case '>': fputs("&gt;", f); break;
        case '"': fputs("&quot;", f); break;
        case '\'': fputs("&apos;", f); break;
        case '\t':
        case '\n':
        case '\r': fprintf(f, "&#%u;", *p); break; /* else an attribute would have spaces */
        default: fwrite(p, 1, n, f);
        }
        p += n ? n : 1;
    }
}

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
            "%u failed in %.1f s\n",
            n, n == 1 ? "" : "s", t[MASU_VERDICT_PASS], t[MASU_VERDICT_WARNING],
            t[MASU_VERDICT_WARNING] == 1 ? "" : "s", t[MASU_VERDICT_UNSUPPORTED],
            t[MASU_VERDICT_RESOURCE], t[MASU_VERDICT_RESOURCE] == 1 ? "" : "s",
            t[MASU_VERDICT_FAIL], seconds(results, n));
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

static void attribute(FILE *f, const char *name, const char *value) {
    fprintf(f, " %s=\"", name);
    masu_xml_escape(f, value);
    fputc('"', f);
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
                                                         [MASU_VERDICT_FAIL] = "failure"};
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
    masu_xml_escape(f, masu_verdict_name(r->verdict));
    if (r->verdict == MASU_VERDICT_WARNING) {
        fputs(": ", f);
        masu_xml_escape(f, r->why);
    }
    for (int m = 0; m < MASU_MEASURE_COUNT; m++) {
        if (!isnan(r->values[m]))
            fprintf(f, "\n%s %.10g", masu_measure_name((masu_measure)m), r->values[m]);
    }
    if (masu_replay_token(suite, r->of, token, sizeof token)) {
        fputs("\nreplay ", f);
        masu_xml_escape(f, token);
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
            t[MASU_VERDICT_FAIL], t[MASU_VERDICT_RESOURCE], t[MASU_VERDICT_UNSUPPORTED],
            seconds(results, n));
    fputs("    <properties>\n", f);
    property(f, "suite", hash);
    property(f, "driver", driver);
    fputs("    </properties>\n", f);
    for (uint32_t i = 0; i < n; i++) junit_case(f, suite, &results[i]);
    fputs("  </testsuite>\n</testsuites>\n", f);
}
