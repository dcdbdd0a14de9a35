/* main.c: whole_vectors IN.spv OUT.spv, for the build: see whole_vectors.h. */
#include "spirv/whole_vectors.h"

#include "spirv/spirv.h"

#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv) {
    spirv_module m;
    size_t count = 0;
    if (argc != 3) {
        fputs("usage: whole_vectors IN.spv OUT.spv\n", stderr);
        return 2;
    }
    if (!spirv_from_file(argv[1], &m)) {
        fprintf(stderr, "whole_vectors: %s: not a SPIR-V module\n", argv[1]);
        return 1;
    }
    uint32_t *words = masu_whole_vectors(m.words, m.word_count, &count);
    FILE *out = words ? fopen(argv[2], "wb") : NULL;
    int good = out && fwrite(words, sizeof *words, count, out) == count;
    if (out && fclose(out)) good = 0;
    if (!good) fprintf(stderr, "whole_vectors: %s: cannot be written\n", argv[2]);
    free(words);
    spirv_free(&m);
    return !good;
}
