/* gpu.h: the GPUs whose own shader compilers run without them, and how a process gets at them.
 *
 * Three drivers of Mesa compile for a GPU that is not here: RADV by a null device (RADV_FORCE_FAMILY; Debian's
 * package has it), ANV and Turnip on Mesa's no-op kernel shims (drm-shim), which are a libvulkan_X.so and a
 * libX_noop_drm_shim.so each in the folder $MASU_ISA_DRIVERS (make isa-drivers). The loader and the drivers
 * read the environment when they start, and a shim takes the place of the C library's open and ioctl: so each
 * GPU gets a process of its own, which is started with that environment. */
#ifndef MASU_ISA_GPU_H
#define MASU_ISA_GPU_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum masu_isa_driver { MASU_ISA_RADV, MASU_ISA_ANV, MASU_ISA_TURNIP } masu_isa_driver;

typedef struct masu_isa_gpu {
    const char *name, *what; /* "vangogh", "Steam Deck: RDNA 2" */
    masu_isa_driver driver;
    uint32_t waves; /* that a SIMD (RADV) or a core (Turnip) holds at most, in waves of 64; 0: not said */
} masu_isa_gpu;

extern const masu_isa_gpu masu_isa_gpus[];
extern const uint32_t masu_isa_gpu_count;

const masu_isa_gpu *masu_isa_gpu_find(const char *name); /* NULL: none of that name */

/* Sets the environment for it, for processes that are started from now on; the file at `icd`, a new one, tells
 * the loader about drivers that are not installed. False: its driver is not here, and `error` says what is
 * missing. */
bool masu_isa_gpu_environment(const masu_isa_gpu *gpu, const char *icd, char *error, size_t error_size);

/* Takes it back. */
void masu_isa_gpu_leave(void);

#endif
