/* spirv_interface.h: what a SPIR-V module declares of the interface of its pipeline. The build
 * notes it for each module of the library (tools/generate/pack_spirv.c); of a scene's code
 * masu_init reads it. */
#ifndef MASU_SPIRV_INTERFACE_H
#define MASU_SPIRV_INTERFACE_H

#include <stdint.h>

typedef struct masu_interface {
    uint32_t constants; /* specialisation constants: bit n is constant_id n, below 32 */
    uint64_t bindings;  /* of descriptor set 0: bit n is binding n, below 64 */
} masu_interface;

/* Total: nothing outside of the words is read, whatever they are. Linear in the decorations. A
 * module with more than 128 variables in set 0 counts as one that declares each of its bindings
 * there. */
masu_interface masu_interface_of(const uint32_t *words, uint64_t count);

#endif
