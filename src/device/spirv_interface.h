/* spirv_interface.h: the part of a pipeline's interface that a SPIR-V module declares. The build
 * computes it for each module of the library (tools/generate/pack_spirv.c), masu_init for the code
 * of a scene. */
#ifndef MASU_SPIRV_INTERFACE_H
#define MASU_SPIRV_INTERFACE_H

#include <stdint.h>

typedef struct masu_interface {
    uint32_t constants; /* specialisation constants: bit n is constant_id n, below 32 */
    uint64_t bindings;  /* of descriptor set 0: bit n is binding n, below 64 */
} masu_interface;

/* Accepts arbitrary input: reads only the `count` values. Linear in the number of decorations. For
 * a module with more than 128 variables in set 0, all bindings that it decorates there are
 * reported. */
masu_interface masu_interface_of(const uint32_t *words, uint64_t count);

/* Changes the binding of set 0's variables from `from` to `to`, in place. */
void masu_rebind(uint32_t *words, uint64_t count, uint32_t from, uint32_t to);

#endif
