/* main.c: whole_vectors IN.spv OUT.spv, for the build: see whole_vectors.h. */
#include "spirv/whole_vectors.h"

#include <stdio.h>

int main(int argc, char **argv) {
    if (argc != 3) {
        fputs("usage: whole_vectors IN.spv OUT.spv\n", stderr);
        return 2;
    }
    switch (masu_whole_vectors_file(argv[1], argv[2])) {
        case MASU_WHOLE_VECTORS_OK: return 0;
        case MASU_WHOLE_VECTORS_NO_MODULE:
            fprintf(stderr, "whole_vectors: %s: not a SPIR-V module\n", argv[1]);
            return 1;
        default: fprintf(stderr, "whole_vectors: %s: cannot be written\n", argv[2]); return 1;
    }
}
