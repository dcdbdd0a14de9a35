/* compute.h: runs one compute shader of tests/gpu on storage buffers of set 0, without a frame. For
 * functions of the shader library. */
#ifndef MASU_TEST_SUPPORT_COMPUTE_H
#define MASU_TEST_SUPPORT_COMPUTE_H

#include <stddef.h>
#include <stdint.h>

#define COMPUTE_BUFFERS_MAX 5u

typedef struct compute_buffer {
    uint32_t binding;
    void *data; /* content, before and after the run */
    size_t bytes;
} compute_buffer;

/* `groups` workgroups, under the validation layer; fails the test on any error or message. The shader
 * may have 16 bytes of push constants. */
void compute_run(const uint32_t *spirv, size_t spirv_bytes, const compute_buffer *buffers,
                 uint32_t count, const uint32_t push[4], uint32_t groups);

#endif
