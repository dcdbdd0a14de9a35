/* lex.c: text -> tokens, with included files expanded in place; and the growing arrays of a
 * compilation. */
#include "sdfc/internal.h"
#include "image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static SDFC_NORETURN void fail_at(sdfc *c, uint32_t line, uint32_t column, uint32_t offset,
                                  const char *message) {
    sdfc_report(c, line, column, offset, message);
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
        c->in_statement = false; /* the following statements would exceed the limit too */
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
    return at < c->file_end ? (unsigned char)c->text[at] : -1;
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

/* The text between the braces, unchanged. */
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

static void lex_file(sdfc *c, int file, int depth);

/* The path relative to the folder of the including file. */
static void path_beside(const char *from, const char *name, int length, char out[256]) {
    const char *slash = strrchr(from, '/');
    int folder = slash ? (int)(slash - from) + 1 : 0;
    snprintf(out, 256, "%.*s%.*s", folder, from, length, name);
}

/* include "NAME"; each file once, its tokens replace this statement. */
static void read_include(sdfc *c, cursor *k, int file, int depth) {
    uint32_t column = k->at - k->line_start + 1;
    skip_blanks(c, k);
    if (byte_at(c, k->at) != '"')
        fail_at(c, k->line, k->at - k->line_start + 1, k->at, "expected a file's name in quotes");
    uint32_t from = ++k->at, start = from;
    while (byte_at(c, k->at) >= 0x20 && byte_at(c, k->at) != '"') k->at++;
    uint32_t length = k->at - from;
    if (byte_at(c, k->at) != '"' || !length || length > 120) {
        fail_at(c, k->line, start - k->line_start, start - 1,
                "expected a file's name of at most 120 bytes in quotes");
    }
    k->at++;
    skip_blanks(c, k);
    if (byte_at(c, k->at) == ';') k->at++;
    char name[256], error[512], message[640];
    path_beside(file ? c->files[file].name : c->name, c->text + from, (int)length, name);
    for (int i = 0; i < c->file_count; i++) {
        if (strcmp(c->files[i].name, name) == 0) return;
    }
    uint8_t *bytes = NULL;
    size_t count = 0;
    if (depth >= 8)
        fail_at(c, k->line, column, from, "expected at most 8 files that include each other");
    if (!masu_file_read(name, MASU_SDFC_SOURCE_MAX, &bytes, &count, error, sizeof error)) {
        snprintf(message, sizeof message, "include: %s", error);
        fail_at(c, k->line, start - k->line_start, start - 1, message);
    }
    char *joined =
        c->bytes + count + 1 > 4 * MASU_SDFC_SOURCE_MAX ? NULL : malloc(c->bytes + count + 2);
    if (!joined) {
        free(bytes);
        fail_at(c, k->line, column, from, "expected files of at most 4 MiB in all");
    }
    memcpy(joined, c->text, c->bytes);
    joined[c->bytes] = '\n';
    memcpy(joined + c->bytes + 1, bytes, count);
    free(bytes);
    free(c->joined);
    c->text = c->joined = joined;
    uint32_t begin = (uint32_t)c->bytes + 1, end = c->file_end;
    c->bytes += count + 1;
    c->files =
        sdfc_grow(c, c->files, c->file_count, &c->file_capacity, sizeof *c->files, 64, "files");
    c->files[c->file_count].begin = begin;
    memcpy(c->files[c->file_count++].name, name, sizeof name);
    c->file_end = (uint32_t)c->bytes;
    lex_file(c, c->file_count - 1, depth + 1);
    c->file_end = end;
}

static void lex_file(sdfc *c, int file, int depth) {
    uint32_t begin = c->files[file].begin;
    cursor k = {begin, 1, begin};
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
            if (length == 7 && memcmp(c->text + k.at, "include", 7) == 0) {
                k.at = end;
                read_include(c, &k, file, depth);
                continue;
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
        } else if (b > 0 && strchr("+-*/^(){}[],;:=.<>?", b)) {
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
    if (file == 0) add(c, TOKEN_END, &k, 0);
}

void sdfc_lex(sdfc *c) {
    c->files = sdfc_grow(c, c->files, 0, &c->file_capacity, sizeof *c->files, 64, "files");
    snprintf(c->files[0].name, sizeof c->files[0].name, "%s", c->name);
    c->file_count = 1;
    c->file_end = (uint32_t)c->bytes;
    c->open_kind = c->call_token = -1;
    lex_file(c, 0, 0);
}
