/* message.c: formats error messages: position, line, a caret, the signature of the shape whose
 * arguments are being parsed, the call stack, and the known name that is most similar to an unknown
 * one. An error in a statement does not end the parsing: the next statement is parsed (parse.c). */
#include "sdfc/internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LINE_SHOWN 160u

static void append(char *out, size_t size, size_t *length, const char *text, size_t bytes) {
    for (size_t i = 0; i < bytes && *length + 1 < size; i++) {
        unsigned char b = (unsigned char)text[i];
        out[(*length)++] = b == '\n' || (b >= 0x20 && b < 0x7F) ? (char)b : b == '\t' ? ' ' : '?';
    }
    if (size) out[*length] = '\0';
}

static const char *file_of(const sdfc *c, uint32_t offset) {
    for (int i = c->file_count; i-- > 1;) {
        if (offset >= c->files[i].begin) return c->files[i].name;
    }
    return c->name;
}

/* Appends "name:line:column: message", the line, and a caret below the column to the previous
 * messages. */
void sdfc_report(sdfc *c, uint32_t line, uint32_t column, uint32_t offset, const char *message) {
    char head[64], *out = c->error;
    size_t length = c->error_length, size = c->error_size;
    const char *name = file_of(c, offset);
    if (length) append(out, size, &length, "\n", 1);
    append(out, size, &length, name, strlen(name));
    snprintf(head, sizeof head, ":%u:%u: ", line, column);
    append(out, size, &length, head, strlen(head));
    append(out, size, &length, message, strlen(message));
    size_t begin = offset - (column - 1), skip = 0;
    size_t end = begin;
    while (end < c->bytes && c->text[end] != '\n' && c->text[end] != '\r') end++;
    if (column > LINE_SHOWN) skip = column - LINE_SHOWN / 2;
    size_t shown = end - begin > skip ? end - begin - skip : 0;
    append(out, size, &length, "\n", 1);
    append(out, size, &length, c->text + begin + skip, shown < LINE_SHOWN ? shown : LINE_SHOWN);
    append(out, size, &length, "\n", 1);
    for (size_t i = 1; i + skip < column; i++) append(out, size, &length, " ", 1);
    append(out, size, &length, "^", 1);
    if (c->open_kind >= 0) {
        const char *shape = sdfc_kinds[c->open_kind].name,
                   *arguments = sdfc_kinds[c->open_kind].arguments;
        append(out, size, &length, "\n    ", 5);
        append(out, size, &length, shape, strlen(shape));
        append(out, size, &length, "(", 1);
        append(out, size, &length, arguments, strlen(arguments));
        append(out, size, &length, ")", 1);
    }
    c->error_length = length;
}

static SDFC_NORETURN void give_up(sdfc *c) {
    if (c->in_statement) longjmp(c->statement, 1);
    longjmp(c->failed, 1);
}

void sdfc_fail(sdfc *c, int token, const char *format, ...) {
    char message[640];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(message, 512, format, arguments);
    va_end(arguments);
    const sdfc_token *t = &c->tokens[token];
    if (c->call_token >= 0 && length >= 0 && length < 512) {
        const sdfc_token *from = &c->tokens[c->call_token];
        snprintf(message + length, sizeof message - (size_t)length, " (in %.*s of line %u)",
                 (int)from->length, c->text + from->offset, from->line);
    }
    sdfc_report(c, t->line, t->column, t->offset - (t->kind == TOKEN_RAW), message);
    give_up(c);
}

void sdfc_warn(sdfc *c, int token, const char *format, ...) {
    char message[512], whole[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    const sdfc_token *t = &c->tokens[token];
    const char *name = file_of(c, t->offset);
    size_t length = 0;
    append(whole, sizeof whole, &length, name, strlen(name));
    sdfc_put(c, &c->warnings, "%s:%u:%u: %s\n", whole, t->line, t->column, message);
}

/* A name whose declaration was wrong has been spoken of. */
static bool is_broken(sdfc *c, int token) {
    const sdfc_symbol *s = c->tokens[token].kind == TOKEN_NAME ? sdfc_find(c, token) : NULL;
    return s && s->kind == SYMBOL_BROKEN;
}

void sdfc_expected(sdfc *c, int token, const char *format, ...) {
    char message[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    const sdfc_token *t = &c->tokens[token];
    int length = t->length < 40 ? (int)t->length : 40;
    if (c->errors && is_broken(c, token)) give_up(c);
    switch (t->kind) {
    case TOKEN_END: sdfc_fail(c, token, "expected %s, found the end of the text", message);
    case TOKEN_RAW: sdfc_fail(c, token, "expected %s, found a block", message);
    default:
        sdfc_fail(c, token, "expected %s, found \"%.*s\"", message, length, c->text + t->offset);
    }
}

/* ---- did you mean ---- */

/* Letters to insert, remove, change or swap with their neighbour. */
static int edits(const char *a, int m, const char *b, int n) {
    int row[3][MASU_SDFC_NAME_MAX + 1];
    for (int j = 0; j <= n; j++) row[0][j] = j;
    for (int i = 1; i <= m; i++) {
        int *now = row[i % 3], *before = row[(i + 2) % 3], *older = row[(i + 1) % 3];
        now[0] = i;
        for (int j = 1; j <= n; j++) {
            int least = before[j - 1] + (a[i - 1] != b[j - 1]);
            if (before[j] + 1 < least) least = before[j] + 1;
            if (now[j - 1] + 1 < least) least = now[j - 1] + 1;
            bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
            if (swapped && older[j - 2] + 1 < least) least = older[j - 2] + 1;
            now[j] = least;
        }
    }
    return row[m % 3][n];
}

typedef struct guess {
    const char *word, *best;
    int length, best_length, least;
} guess;

static void consider(guess *g, const char *name, int length) {
    if (length >= MASU_SDFC_NAME_MAX || abs(length - g->length) >= g->least) return;
    int d = edits(g->word, g->length, name, length);
    if (d >= g->least) return;
    g->least = d;
    g->best = name;
    g->best_length = length;
}

void sdfc_unknown(sdfc *c, int token, unsigned kinds, const char *what) {
    const sdfc_token *t = &c->tokens[token];
    if (t->kind != TOKEN_NAME || is_broken(c, token)) sdfc_expected(c, token, "%s", what);
    guess g = {.word = c->text + t->offset, .length = (int)t->length};
    g.least = g.length < 2 ? 1 : g.length < 6 ? 2 : g.length / 3 + 1;
    if (kinds & SDFC_NAMES_SHAPES) {
        for (int i = 0; i < SDFC_KIND_COUNT; i++)
            consider(&g, sdfc_kinds[i].name, (int)strlen(sdfc_kinds[i].name));
    }
    const char *function;
    for (int i = 0; kinds & SDFC_NAMES_NUMBERS && (function = sdfc_function_name(i)); i++) {
        consider(&g, function, (int)strlen(function));
    }
    for (int i = 0; i < c->symbol_count; i++) {
        const sdfc_symbol *s = &c->symbols[i];
        if (i >= c->hidden_from && i < c->hidden_to) continue;
        bool fits = s->kind == SYMBOL_DEF ||
                    (s->kind == SYMBOL_SHAPE && kinds & SDFC_NAMES_SHAPES) ||
                    (s->kind == SYMBOL_LET && kinds & SDFC_NAMES_NUMBERS) ||
                    (s->kind == SYMBOL_MATERIAL && kinds & SDFC_NAMES_MATERIALS);
        if (fits && !(kinds == SDFC_NAMES_MATERIALS && s->kind == SYMBOL_DEF))
            consider(&g, c->text + s->offset, (int)s->length);
    }
    if (!g.best) sdfc_expected(c, token, "%s", what);
    sdfc_fail(c, token, "expected %s, found \"%.*s\": did you mean \"%.*s\"?", what,
              g.length < 40 ? g.length : 40, g.word, g.best_length, g.best);
}
