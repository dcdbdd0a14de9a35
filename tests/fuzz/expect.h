/* expect.h: what must hold for any input of a fuzzer: else the process ends, which libFuzzer and run.sh notice. */
#ifndef FUZZ_EXPECT_H
#define FUZZ_EXPECT_H

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define EXPECT(condition)                                                                          \
    do {                                                                                           \
        if (!(condition)) expected(__FILE__, __LINE__, #condition);                                \
    } while (0)

/* Not by stderr, which in_file.h catches. */
static inline void expected(const char *file, int line, const char *what) {
    dprintf(STDERR_FILENO, "%s:%d: expected: %s\n", file, line, what);
    abort();
}

#endif
