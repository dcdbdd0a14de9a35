/* assimp_file.h: the files that Assimp opens: the model, and the files that it names if they are
 * allowed (bake/base/inside.h). Other files appear as missing, and one warning names the first. */
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

/* Sets the callbacks; the caller fills the other members. The struct outlives the import. */
void masu_import_use_files(masu_import_files *files);

#endif
