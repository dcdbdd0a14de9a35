/* fuzz_acc.c: any bytes as TORCS's dialect of AC3D. What comes out is no longer than what went in but for a line's end,
 * and the same when it is stripped again. */
#include "expect.h"

#include "bake/import/acc.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    masu_bake_buffer once = {0}, twice = {0};
    masu_bake_strip_acc((const char *)data, size, &once);
    EXPECT(once.bytes <= size + 1);
    masu_bake_strip_acc((const char *)once.data, once.bytes, &twice);
    EXPECT(twice.bytes == once.bytes &&
           (!once.bytes || !memcmp(once.data, twice.data, once.bytes)));
    masu_bake_release(&once);
    masu_bake_release(&twice);
    return 0;
}
