/* heap.c: the proof that nothing is allocated once the game runs. The linker sends each malloc,
 * calloc and realloc of the game and of libmasu here (--wrap in tools/tools.mk); those of SDL,
 * driver and X libraries are theirs and do not come by. */
#include <stdbool.h>
#include <stdlib.h>
#include <unistd.h>

bool heap_closed; /* from here on an allocation ends the program */

void *__real_malloc(size_t bytes);
void *__real_calloc(size_t count, size_t bytes);
void *__real_realloc(void *block, size_t bytes);

static void check(void) {
    static const char text[] = "drive: the heap is closed: unexpected allocation\n";
    if (!heap_closed) return;
    (void)!write(2, text, sizeof text - 1); /* printf might allocate */
    abort();
}

void *__wrap_malloc(size_t bytes) { return check(), __real_malloc(bytes); }
void *__wrap_calloc(size_t count, size_t bytes) { return check(), __real_calloc(count, bytes); }
void *__wrap_realloc(void *block, size_t bytes) { return check(), __real_realloc(block, bytes); }
