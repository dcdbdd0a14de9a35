/* lex.c: text -> tokens; messages; and the growing arrays of a compilation. */
#include "sdfc/internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- messages ---- */

#define LINE_SHOWN 160u

static void append(char *out, size_t size, size_t *length, const char *text, size_t bytes) {
    for (size_t i = 0; i < bytes && *length + 1 < size; i++) {
        unsigned char b = (unsigned char)text[i];
        out[(*length)++] = b == '\n' || (b >= 0x20 && b < 0x7F) ? (char)b : b == '\t' ? ' ' : '?';
    }
    if (size) out[*length] = '\0';
}

/* "name:line:column: message", the line, and a caret below the column. */
static void report(const sdfc *c, uint32_t line, uint32_t column, uint32_t offset,
                   const char *message, char *out, size_t size) {
    char head[64];
    size_t length = 0;
    append(out, size, &length, c->name, strlen(c->name));
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
}

static void say(const sdfc *c, int token, const char *message, char *out, size_t size) {
    const sdfc_token *t = &c->tokens[token];
    report(c, t->line, t->column, t->offset - (t->kind == TOKEN_RAW), message, out, size);
}

void sdfc_fail(sdfc *c, int token, const char *format, ...) {
    char message[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    say(c, token, message, c->error, c->error_size);
    longjmp(c->failed, 1);
}

void sdfc_warn(sdfc *c, int token, const char *format, ...) {
    char message[512], whole[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    const sdfc_token *t = &c->tokens[token];
    size_t length = 0;
    append(whole, sizeof whole, &length, c->name, strlen(c->name));
    sdfc_put(c, &c->warnings, "%s:%u:%u: %s\n", whole, t->line, t->column, message);
}

void sdfc_expected(sdfc *c, int token, const char *format, ...) {
    char message[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    const sdfc_token *t = &c->tokens[token];
    int length = t->length < 40 ? (int)t->length : 40;
    switch (t->kind) {
    case TOKEN_END: sdfc_fail(c, token, "expected %s, found the end of the text", message);
    case TOKEN_RAW: sdfc_fail(c, token, "expected %s, found a block", message);
    default:
        sdfc_fail(c, token, "expected %s, found \"%.*s\"", message, length, c->text + t->offset);
    }
}

static SDFC_NORETURN void fail_at(sdfc *c, uint32_t line, uint32_t column, uint32_t offset,
                                  const char *message) {
    report(c, line, column, offset, message, c->error, c->error_size);
    longjmp(c->failed, 1);
}

/* ---- memory ---- */

static SDFC_NORETURN void out_of_memory(sdfc *c) {
    snprintf(c->error, c->error_size, "%s: out of memory", c->name);
    longjmp(c->failed, 1);
}

void *sdfc_grow(sdfc *c, void *array, int count, int *capacity, size_t size, int most,
                const char *what) {
    if (count < *capacity) return array;
    if (count >= most) {
        int token = c->at < c->token_count ? c->at : c->token_count - 1;
        sdfc_fail(c, token < 0 ? 0 : token, "more than %d %s", most, what);
    }
    int more = *capacity ? 2 * *capacity : 16;
    if (more > most) more = most;
    void *bigger = realloc(array, (size_t)more * size);
    if (!bigger) out_of_memory(c);
    memset((char *)bigger + (size_t)*capacity * size, 0, (size_t)(more - *capacity) * size);
    *capacity = more;
    return bigger;
}

void *sdfc_take(sdfc *c, size_t count, size_t size) {
    void *memory = calloc(count ? count : 1, size);
    if (!memory) out_of_memory(c);
    return memory;
}

void sdfc_put_bytes(sdfc *c, sdfc_text *text, const char *bytes, size_t length) {
    if (text->length + length + 1 > text->capacity) {
        size_t more = 2 * (text->length + length + 1) + 1024;
        char *bigger = realloc(text->data, more);
        if (!bigger) out_of_memory(c);
        text->data = bigger;
        text->capacity = more;
    }
    memcpy(text->data + text->length, bytes, length);
    text->length += length;
    text->data[text->length] = '\0';
}

void sdfc_put(sdfc *c, sdfc_text *text, const char *format, ...) {
    char line[2048];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    if (length < 0) length = 0;
    sdfc_put_bytes(c, text, line, (size_t)length < sizeof line ? (size_t)length : sizeof line - 1);
}

/* ---- tokens ---- */

typedef struct cursor {
    uint32_t at, line, line_start;
} cursor;

static bool is_name(int b, bool first) {
    return (b >= 'a' && b <= 'z') || (b >= 'A' && b <= 'Z') || b == '_' ||
           (!first && b >= '0' && b <= '9');
}

static int byte_at(const sdfc *c, uint32_t at) {
    return at < c->bytes ? (unsigned char)c->text[at] : -1;
}

static void advance(const sdfc *c, cursor *k) {
    if (byte_at(c, k->at) == '\n') {
        k->line++;
        k->line_start = k->at + 1;
    }
    k->at++;
}

static void skip_blanks(sdfc *c, cursor *k) {
    for (;;) {
        int b = byte_at(c, k->at), next = byte_at(c, k->at + 1);
        if (b == ' ' || b == '\t' || b == '\r' || b == '\n') {
            advance(c, k);
        } else if (b == '#' || (b == '/' && next == '/')) {
            while (byte_at(c, k->at) >= 0 && byte_at(c, k->at) != '\n') k->at++;
        } else {
            return;
        }
    }
}

static sdfc_token *add(sdfc *c, sdfc_token_kind kind, const cursor *k, uint32_t length) {
    c->at = 0;
    c->tokens = sdfc_grow(c, c->tokens, c->token_count, &c->token_capacity, sizeof *c->tokens,
                          (int)MASU_SDFC_SOURCE_MAX + 2, "tokens");
    sdfc_token *t = &c->tokens[c->token_count++];
    *t = (sdfc_token){.kind = kind,
                      .offset = k->at,
                      .length = length,
                      .line = k->line,
                      .column = k->at - k->line_start + 1};
    return t;
}

static bool digit(int b) { return b >= '0' && b <= '9'; }

/* strtod would take hexadecimal, "inf", and the locale's comma. */
static void read_number(sdfc *c, cursor *k) {
    uint32_t end = k->at;
    char text[64];
    while (digit(byte_at(c, end))) end++;
    if (byte_at(c, end) == '.' && byte_at(c, end + 1) != '.') {
        end++;
        while (digit(byte_at(c, end))) end++;
    }
    int b = byte_at(c, end), sign = byte_at(c, end + 1);
    if ((b == 'e' || b == 'E') &&
        (digit(sign) || ((sign == '+' || sign == '-') && digit(byte_at(c, end + 2))))) {
        end += digit(sign) ? 1 : 2;
        while (digit(byte_at(c, end))) end++;
    }
    uint32_t length = end - k->at, column = k->at - k->line_start + 1;
    if (length >= sizeof text) {
        fail_at(c, k->line, column, k->at, "expected a number of at most 63 characters");
    }
    memcpy(text, c->text + k->at, length);
    text[length] = '\0';
    double value = strtod(text, NULL);
    if (!isfinite(value) || value > 1e30) {
        fail_at(c, k->line, column, k->at, "expected a number of at most 1e30");
    }
    if (is_name(byte_at(c, end), true)) {
        fail_at(c, k->line, end - k->line_start + 1, end,
                "expected a blank or an operator after a number");
    }
    add(c, TOKEN_NUMBER, k, length)->number = value;
    k->at = end;
}

/* What is between the braces, as it stands. */
static void read_block(sdfc *c, cursor *k) {
    cursor open = *k;
    uint32_t column = k->at - k->line_start + 1;
    int depth = 0;
    do {
        int b = byte_at(c, k->at);
        if (b < 0) fail_at(c, open.line, column, open.at, "expected a \"}\" for this \"{\"");
        if (b == 0) fail_at(c, k->line, k->at - k->line_start + 1, k->at, "expected text");
        depth += b == '{' ? 1 : b == '}' ? -1 : 0;
        advance(c, k);
    } while (depth > 0);
    sdfc_token *t = add(c, TOKEN_RAW, &open, k->at - open.at - 2);
    t->offset = open.at + 1;
}

void sdfc_lex(sdfc *c) {
    cursor k = {0, 1, 0};
    for (;;) {
        skip_blanks(c, &k);
        int b = byte_at(c, k.at), next = byte_at(c, k.at + 1);
        if (b < 0) break;
        if (is_name(b, true)) {
            uint32_t end = k.at;
            while (is_name(byte_at(c, end), false)) end++;
            uint32_t length = end - k.at;
            if (length >= MASU_SDFC_NAME_MAX) {
                fail_at(c, k.line, k.at - k.line_start + 1, k.at,
                        "expected a name of at most 63 characters");
            }
            add(c, TOKEN_NAME, &k, length);
            bool raw = sdfc_token_is(c, c->token_count - 1, "glsl") ||
                       sdfc_token_is(c, c->token_count - 1, "c");
            k.at = end;
            if (raw) {
                skip_blanks(c, &k);
                if (byte_at(c, k.at) == '{') read_block(c, &k);
            }
        } else if (digit(b) || (b == '.' && digit(next))) {
            read_number(c, &k);
        } else if (b == '.' && next == '.') {
            add(c, TOKEN_MARK, &k, 2)->mark = TOKEN_DOTS;
            k.at += 2;
        } else if (b > 0 && strchr("+-*/^(){}[],;:=.", b)) {
            add(c, TOKEN_MARK, &k, 1)->mark = (char)b;
            k.at++;
        } else {
            char message[64];
            snprintf(message, sizeof message,
                     b > 0x20 && b < 0x7F ? "expected a statement, found \"%c\""
                                          : "expected a statement, found the byte %d",
                     b);
            fail_at(c, k.line, k.at - k.line_start + 1, k.at, message);
        }
    }
    add(c, TOKEN_END, &k, 0);
}
