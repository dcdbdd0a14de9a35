/* whole_vectors.h: loads of single components of vectors in buffers become loads of the vectors,
 * and the module becomes SPIR-V 1.0, so that Vulkan 1.0 devices accept it.
 *
 * Where a shader reads more than one component of a vector in a uniform or storage block, or a
 * component and the vector, each component is read by an access chain of its own. Turnip of Mesa
 * 22.3 (Adreno) dies of that: its nir_opt_load_store_vectorize divides by zero where a component is
 * loaded first and then something at a lower offset of the same vector. Whole loads mean the same,
 * and are one instruction on GPUs that load vectors. A vector of which one component alone is read
 * stays as it is: there the rest would be read for nothing.
 *
 * On what `spirv-opt -O` leaves, both in the build (tools/spirv/main.c) and in masu-bake. */
#ifndef MASU_WHOLE_VECTORS_H
#define MASU_WHOLE_VECTORS_H

#include <stddef.h>
#include <stdint.h>

/* The module so changed, to be freed; NULL: no module, or no memory. Modules with row-major
 * matrices, whose columns are no vectors in memory, come back as they are. */
uint32_t *masu_whole_vectors(const uint32_t *words, size_t count, size_t *changed_count);

typedef enum masu_whole_vectors_result {
    MASU_WHOLE_VECTORS_OK,
    MASU_WHOLE_VECTORS_NO_MODULE,
    MASU_WHOLE_VECTORS_NOT_WRITTEN /* out of memory, too */
} masu_whole_vectors_result;

/* The same from file to file, which may be one. */
masu_whole_vectors_result masu_whole_vectors_file(const char *from, const char *to);

#endif
