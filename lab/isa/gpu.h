/* gpu.h: GPUs whose shader compilers can run without the GPU, and the environments for them.
 *
 * These drivers of Mesa compile for an absent GPU: RADV with a null device (RADV_FORCE_FAMILY;
 * included in Debian's package), and ANV, hasvk, Turnip, V3DV and PanVK with Mesa's no-op kernel
 * shims (drm-shim). The folder $MASU_ISA_DRIVERS (make isa-drivers) has a
 * libX_noop_drm_shim.so for each, and a libvulkan_X.so but for hasvk, which Debian's package
 * includes. The loader and the drivers read the environment at their start, and a shim replaces
 * the C library's open and ioctl: so each GPU needs a separate process, started with that
 * environment.
 *
 * `make isa-drivers` builds Intel's and Adreno's from Mesa 22.3.6. The committed rows of V3DV and
 * PanVK are from Mesa 25.0.7 (-Dvulkan-drivers=broadcom,panfrost -Dtools=drm-shim), whose V3D shim
 * needs the identity registers of 7.1 for v3d71 (CORE0_IDENT0 0x07443356, IDENT1 0x81001431). */
#ifndef MASU_ISA_GPU_H
#define MASU_ISA_GPU_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum masu_isa_driver {
    MASU_ISA_RADV,
    MASU_ISA_ANV,
    MASU_ISA_TURNIP,
    MASU_ISA_HASVK, /* Intel before Gen 9 */
    MASU_ISA_V3DV,
    MASU_ISA_PANVK
} masu_isa_driver;

typedef struct masu_isa_gpu {
    const char *name, *what; /* "vangogh", "Steam Deck: RDNA 2" */
    masu_isa_driver driver;
    uint32_t waves; /* maximum per SIMD (RADV) or core (Turnip), in waves of 64; 0: unknown */
} masu_isa_gpu;

extern const masu_isa_gpu masu_isa_gpus[];
extern const uint32_t masu_isa_gpu_count;

const masu_isa_gpu *masu_isa_gpu_find(const char *name); /* NULL: no such GPU */

/* Sets the environment of later child processes for this GPU; the file at `icd`, a new one,
 * describes drivers that are not installed to the loader. On false its driver is missing, and
 * `error` holds the reason. */
bool masu_isa_gpu_environment(const masu_isa_gpu *gpu, const char *icd, char *error,
                              size_t error_size);

/* Restores the environment. */
void masu_isa_gpu_leave(void);

#endif
