/* assimp_file.h: the files that Assimp opens: the model, and what that names as far as it may
 * (bake/base/inside.h). What lies elsewhere is not there for it, and one warning names the
 * first. */
#ifndef MASU_BAKE_ASSIMP_FILE_H
#define MASU_BAKE_ASSIMP_FILE_H

#include "bake/base/buffer.h"

#include <assimp/cfileio.h>
#include <stdbool.h>

typedef struct masu_import_files {
    struct aiFileIO io; /* for aiImportFileEx */
    const char *model;
    masu_bake_buffer *warnings;
    bool warned;
} masu_import_files;

/* The rest is the caller's to fill in; the struct outlives the import. */
void masu_import_use_files(masu_import_files *files);

#endif
