/* standalone_main.c: runs a fuzz target without a fuzzer, for `make check`: the same inputs on
 * every machine and with every compiler.
 *
 *     fuzz_NAME [--runs N] [--only I] [SEED_FILE...]
 *
 * Input 0 of each seed is the seed itself. The next ones are its truncations: every length below
 * 256 bytes, then 256 lengths spread over the rest. After these come N (default 2000) mutations: a
 * few bytes replaced, flipped, set to a value that arithmetic likes to trip over, or copied from
 * elsewhere in the file. Input I depends on the seed and on I alone, so `--only I` repeats the one
 * that failed; its number is printed when the target dies. Without a seed file, inputs are noise.
 *
 * Each input is a heap block of exactly its size (16-byte aligned, as malloc gives it), so that the
 * address sanitizer sees the first byte that is read past the end. Exit 0: nothing died. 1: a seed
 * that cannot be read. */
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Present when a sanitizer is linked: it ends the process without a signal. */
extern void __sanitizer_set_death_callback(void (*callback)(void)) __attribute__((weak));

#define SHORT_LENGTHS 256u
#define LONG_LENGTHS 256u
#define NOISE_BYTES 4096u

static volatile sig_atomic_t current_seed;
static volatile sig_atomic_t current_input;

/* Only what a signal handler may call: no printf. */
static void say_where(void) {
    char text[64] = "died on input ";
    char digits[16];
    size_t length = strlen(text), count = 0;
    unsigned long value = (unsigned long)current_input;
    do {
        digits[count++] = (char)('0' + value % 10);
        value /= 10;
    } while (value);
    while (count) text[length++] = digits[--count];
    const char tail[] = " of seed ";
    memcpy(text + length, tail, sizeof tail - 1);
    length += sizeof tail - 1;
    text[length++] = (char)('0' + current_seed % 10);
    text[length++] = '\n';
    if (write(STDERR_FILENO, text, length) < 0) _exit(3);
}

static void on_signal(int number) {
    say_where();
    signal(number, SIG_DFL);
    raise(number);
}

/* splitmix64: any state gives a good sequence, so the input's number serves as the state. */
static uint64_t next_random(uint64_t *state) {
    uint64_t z = *state += 0x9E3779B97F4A7C15u;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return z ^ z >> 31;
}

static void mutate(uint8_t *data, size_t size, uint64_t *random) {
    static const uint32_t awkward[] = {
        0,          1,          0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0xFFFFFFF0,
        0x7F800000, 0xFF800000, 0x7FC00000, 0x00000001, 0x7F7FFFFF, 0x00010000,
    };
    /* Headers are where a loader decides; half of the changes go to the first bytes. */
    size_t reach = next_random(random) % 2 && size > 512 ? 512 : size;
    size_t at = (size_t)(next_random(random) % reach);
    switch (next_random(random) % 4) {
    case 0: data[at] = (uint8_t)next_random(random); break;
    case 1: data[at] ^= (uint8_t)(1u << next_random(random) % 8); break;
    case 2: {
        uint32_t value = awkward[next_random(random) % (sizeof awkward / sizeof awkward[0])];
        at &= ~(size_t)3;
        memcpy(data + at, &value, size - at < 4 ? size - at : 4);
        break;
    }
    default: {
        size_t from = (size_t)(next_random(random) % size);
        size_t most = size - (from > at ? from : at);
        memmove(data + at, data + from, most < 16 ? most : 16);
        break;
    }
    }
}

/* Length of input `i` of a seed of `size` bytes; only truncations are shorter. */
static size_t input_size(size_t size, unsigned long i) {
    if (i == 0 || i > SHORT_LENGTHS + LONG_LENGTHS) return size;
    if (i <= SHORT_LENGTHS) return i - 1 < size ? i - 1 : size;
    return size <= SHORT_LENGTHS
               ? size
               : size - 1 - (size - SHORT_LENGTHS) / LONG_LENGTHS * (i - SHORT_LENGTHS - 1);
}

static void run_input(const uint8_t *seed, size_t seed_size, unsigned long i) {
    size_t size = input_size(seed_size, i);
    uint8_t *data = malloc(size ? size : 1);
    if (!data) {
        fprintf(stderr, "out of memory for %zu bytes\n", size);
        exit(1);
    }
    memcpy(data, seed, size);
    if (i > SHORT_LENGTHS + LONG_LENGTHS && size) {
        uint64_t random = i;
        for (uint64_t changes = 1 + next_random(&random) % 8; changes; --changes)
            mutate(data, size, &random);
    }
    LLVMFuzzerTestOneInput(data, size);
    free(data);
}

static uint8_t *read_seed(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    uint8_t *data = NULL;
    long length = -1;
    if (file && fseek(file, 0, SEEK_END) == 0) length = ftell(file);
    if (length > 0 && fseek(file, 0, SEEK_SET) == 0 && (data = malloc((size_t)length)) &&
        fread(data, 1, (size_t)length, file) != (size_t)length) {
        free(data);
        data = NULL;
    }
    if (file) fclose(file);
    *size = data ? (size_t)length : 0;
    return data;
}

int main(int argc, char **argv) {
    unsigned long runs = 2000, only = 0, inputs = 0;
    int have_only = 0, seeds = 0;
    signal(SIGSEGV, on_signal);
    signal(SIGBUS, on_signal);
    signal(SIGFPE, on_signal);
    signal(SIGILL, on_signal);
    signal(SIGABRT, on_signal);
    signal(SIGTERM, on_signal); /* a time limit: which input was it? */
    if (__sanitizer_set_death_callback) __sanitizer_set_death_callback(say_where);

    for (int a = 1; a <= argc; ++a) {
        if (a + 1 < argc && !strcmp(argv[a], "--runs")) {
            runs = strtoul(argv[++a], NULL, 10);
            continue;
        }
        if (a + 1 < argc && !strcmp(argv[a], "--only")) {
            only = strtoul(argv[++a], NULL, 10);
            have_only = 1;
            continue;
        }
        size_t size = NOISE_BYTES;
        uint8_t *seed = NULL;
        if (a < argc) {
            seed = read_seed(argv[a], &size);
            if (!seed) {
                fprintf(stderr, "cannot read the seed %s\n", argv[a]);
                return 1;
            }
        } else if (seeds == 0) { /* no seed at all */
            uint64_t random = 1;
            seed = malloc(size);
            for (size_t i = 0; seed && i < size; ++i) seed[i] = (uint8_t)next_random(&random);
        }
        if (!seed) continue;
        current_seed = seeds++;
        unsigned long first = have_only ? only : 0;
        unsigned long end = have_only ? only + 1 : 1 + SHORT_LENGTHS + LONG_LENGTHS + runs;
        for (unsigned long i = first; i < end; ++i, ++inputs) {
            current_input = (sig_atomic_t)i;
            run_input(seed, size, i);
        }
        free(seed);
    }
    printf("%lu inputs from %d seeds\n", inputs, seeds);
    return 0;
}
