/* markup.c: see markup.h. */
#include "cli/markup.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* Length in bytes of the character at `p` if XML 1.0 allows it, else 0. Overlong forms, surrogates
 * and codes above U+10FFFF are not UTF-8 (RFC 3629). */
static size_t character(const unsigned char *p) {
    if (*p < 0x80) return *p >= ' ' || *p == '\t' || *p == '\n' || *p == '\r';
    size_t n = *p >= 0xF0 ? 4 : *p >= 0xE0 ? 3 : 2;
    uint32_t code = *p & (0x7Fu >> n);
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    if (*p < 0xC0 || *p > 0xF4) return 0;
    for (size_t i = 1; i < n; i++) {
        if ((p[i] & 0xC0) != 0x80) return 0; /* also for the terminating 0 */
        code = code << 6 | (p[i] & 0x3Fu);
    }
    bool good = code >= least[n] && code <= 0x10FFFF && !(code >= 0xD800 && code <= 0xDFFF) &&
                code != 0xFFFE && code != 0xFFFF;
    return good ? n : 0;
}

void masu_markup_text(FILE *f, const char *text) {
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
        case '\r': fprintf(f, "&#%u;", *p); break; /* otherwise attributes would contain spaces */
        default: fwrite(p, 1, n, f);
        }
        p += n ? n : 1;
    }
}

/* Prints one conversion of the format, starting at its %; returns the text after it. */
static const char *put(FILE *f, const char *at, va_list *arguments) {
    size_t n = 1 + strspn(at + 1, "+-# 0123456789.");
    char one[24], letter[2] = {0};
    if (n + 2 > sizeof one) abort();
    memcpy(one, at, n + 1);
    one[n + 1] = '\0';
    switch (at[n]) {
    case '%': fputc('%', f); break;
    case 's': masu_markup_text(f, va_arg(*arguments, const char *)); break;
    case 'c':
        letter[0] = (char)va_arg(*arguments, int);
        masu_markup_text(f, letter);
        break;
    case 'd': fprintf(f, one, va_arg(*arguments, int)); break;
    case 'u': fprintf(f, one, va_arg(*arguments, unsigned)); break;
    case 'e':
    case 'f':
    case 'g': fprintf(f, one, va_arg(*arguments, double)); break;
    default: abort();
    }
    return at + n + 1;
}

void masu_markup(FILE *f, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    while (*format) {
        size_t plain = strcspn(format, "%");
        fwrite(format, 1, plain, f);
        format += plain;
        if (*format) format = put(f, format, &arguments);
    }
    va_end(arguments);
}
