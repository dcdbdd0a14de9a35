/* file_kind.h: recognises the files of Masu's programs, for hints when a file is passed to the
 * wrong program. */
#ifndef MASU_PLATFORM_FILE_KIND_H
#define MASU_PLATFORM_FILE_KIND_H

#include <stdbool.h>
#include <stddef.h>

typedef enum masu_file_kind {
    MASU_FILE_UNKNOWN,
    MASU_FILE_BLOB,        /* a baked scene, .masu */
    MASU_FILE_DESCRIPTION, /* of a scene, .json */
    MASU_FILE_SDF,
    MASU_FILE_GLSL,
    MASU_FILE_MODEL,
    MASU_FILE_IMAGE,
    MASU_FILE_SUITE, /* of masu conform */
    MASU_FILE_LADDER /* of masu bench */
} masu_file_kind;

/* By content if it is given, otherwise by the end of the name. `bytes` NULL: reads the start of the
 * file. */
masu_file_kind masu_file_kind_of(const char *path, const void *bytes, size_t count);

/* "; a scene description: `masu-bake FILE.json -o X.masu` bakes it, ...", the end of a message that
 * rejects the file; "" for the expected kind and for unknown ones. */
const char *masu_file_hint(const char *path, const void *bytes, size_t count,
                           masu_file_kind expected);

/* Whether a file of these formats, ".png .pfm", may be written under that name: it has one of these
 * extensions or none, or is a device or a pipe. On false `error` has one line. */
bool masu_file_named(const char *path, const char *ends_of, char *error, size_t error_size);

#endif
