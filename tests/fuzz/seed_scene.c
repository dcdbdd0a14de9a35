/* seed_scene.c: writes the blobs that fuzz_scene starts from, small enough that most mutations hit
 * something that is looked at:  seed_scene FILE PARTS, parts as in tests/support/blob.h. */
#include <stdio.h>
#include <stdlib.h>

#include "support/blob.h"

int main(int argc, char **argv) {
    static support_blob blob;
    if (argc != 3) return 2;
    support_blob_write(&blob, (uint32_t)strtoul(argv[2], NULL, 10));
    FILE *file = fopen(argv[1], "wb");
    int good = file && fwrite(blob.bytes, 1, blob.size, file) == blob.size;
    if (file && fclose(file) != 0) good = 0;
    if (!good) perror(argv[1]);
    return !good;
}
