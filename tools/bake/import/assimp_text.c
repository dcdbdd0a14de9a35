/* assimp_text.c: strings of Assimp and lines of text; see assimp.h. */
#define _POSIX_C_SOURCE 200809L
#include "bake/import/assimp.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void masu_import_format(masu_bake_buffer *buffer, const char *format, ...) {
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (length > 0) masu_bake_append_text(buffer, text);
}

int masu_import_length(const struct aiString *s) {
    size_t most = s->length < sizeof s->data ? s->length : sizeof s->data;
    return (int)strnlen(s->data, most);
}

void masu_import_name(masu_bake_buffer *buffer, const char *text, int length) {
    size_t from = buffer->bytes;
    masu_bake_append(buffer, text, (size_t)length);
    for (size_t i = from; i < buffer->bytes; i++) {
        if (buffer->data[i] < 0x20) buffer->data[i] = '?';
    }
}

float masu_import_clamped(double value, double low, double high) {
    if (!(value >= low)) value = low; /* NaN too */
    return (float)(value > high ? high : value) + 0.0f;
}
