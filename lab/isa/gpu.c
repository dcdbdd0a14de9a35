/* gpu.c: see gpu.h. */
#define _XOPEN_SOURCE 700 /* realpath */
#include "lab/isa/gpu.h"

#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const masu_isa_gpu masu_isa_gpus[] = {
    {"raven", "Vega APU, GCN 5: Vega 8", MASU_ISA_RADV, 10},
    {"renoir", "Vega APU, GCN 5: Ryzen 4000", MASU_ISA_RADV, 10},
    {"polaris10", "GCN 4", MASU_ISA_RADV, 8},
    {"navi14", "RDNA 1", MASU_ISA_RADV, 20},
    {"vangogh", "Steam Deck: RDNA 2", MASU_ISA_RADV, 16},
    {"rembrandt", "RDNA 2: Radeon 680M", MASU_ISA_RADV, 16},
    {"bdw", "Gen 8: HD 5500", MASU_ISA_HASVK, 0},
    {"skl", "Gen 9: HD 530", MASU_ISA_ANV, 0},
    {"kbl", "Gen 9.5: UHD 620", MASU_ISA_ANV, 0},
    {"icl", "Gen 11: Iris Plus", MASU_ISA_ANV, 0},
    {"tgl", "Xe: Iris Xe", MASU_ISA_ANV, 0},
    {"a630", "Adreno 630", MASU_ISA_TURNIP, 16},
    {"a660", "Adreno 660", MASU_ISA_TURNIP, 16},
    {"v3d42", "Raspberry Pi 4", MASU_ISA_V3DV, 0},
    {"v3d71", "Raspberry Pi 5", MASU_ISA_V3DV, 0},
    {"g52", "Mali-G52, Bifrost", MASU_ISA_PANVK, 0},
    {"g610", "Mali-G610, Valhall", MASU_ISA_PANVK, 0},
};
const uint32_t masu_isa_gpu_count = sizeof masu_isa_gpus / sizeof *masu_isa_gpus;

const masu_isa_gpu *masu_isa_gpu_find(const char *name) {
    for (uint32_t i = 0; i < masu_isa_gpu_count; i++)
        if (!strcmp(masu_isa_gpus[i].name, name)) return &masu_isa_gpus[i];
    return NULL;
}

static const char *const variables[] = {"VK_ICD_FILENAMES",
                                        "VK_DRIVER_FILES",
                                        "RADV_FORCE_FAMILY",
                                        "INTEL_STUB_GPU_PLATFORM",
                                        "FD_GPU_ID",
                                        "V3D_SHIM_VER",
                                        "PAN_GPU_ID",
                                        "PAN_I_WANT_A_BROKEN_VULKAN_DRIVER",
                                        "MESA_VK_VERSION_OVERRIDE",
                                        "BIFROST_MESA_DEBUG",
                                        "LD_PRELOAD",
                                        "MESA_SHADER_CACHE_DISABLE",
                                        "NODEVICE_SELECT"};
enum { VARIABLES = sizeof variables / sizeof *variables };

/* Previous values; NULL: not set. */
static struct {
    bool entered;
    char *was[VARIABLES];
} before;

static void enter(void) {
    if (before.entered) return;
    before.entered = true;
    for (int i = 0; i < VARIABLES; i++) {
        const char *is = getenv(variables[i]);
        before.was[i] = is ? strdup(is) : NULL;
    }
}

void masu_isa_gpu_leave(void) {
    if (!before.entered) return;
    for (int i = 0; i < VARIABLES; i++) {
        if (before.was[i])
            setenv(variables[i], before.was[i], 1);
        else
            unsetenv(variables[i]);
        free(before.was[i]);
        before.was[i] = NULL;
    }
    before.entered = false;
}

static void use_icd(const char *path) {
    setenv("VK_ICD_FILENAMES", path, 1);
    setenv("VK_DRIVER_FILES", path, 1);
}

/* Uses a driver that Debian's package mesa-vulkan-drivers installs. */
static bool use_installed(const char *gpu, const char *driver, const char *file, char *error,
                          size_t size) {
    glob_t found;
    char pattern[128];
    snprintf(pattern, sizeof pattern, "/usr/share/vulkan/icd.d/%s.*.json", file);
    if (glob(pattern, 0, NULL, &found)) {
        snprintf(error, size, "%s: %s is not installed: no %s (package mesa-vulkan-drivers)", gpu,
                 driver, pattern);
        return false;
    }
    use_icd(found.gl_pathv[0]);
    globfree(&found);
    return true;
}

/* Writes the path of a file in $MASU_ISA_DRIVERS. */
static bool find_file(const char *gpu, const char *name, char path[1024], char *error,
                      size_t size) {
    const char *folder = getenv("MASU_ISA_DRIVERS");
    if (!folder || !*folder) {
        snprintf(error, size,
                 "%s: its compiler is in no Debian package: MASU_ISA_DRIVERS is to name the folder "
                 "with %s (make isa-drivers)",
                 gpu, name);
        return false;
    }
    char *whole = realpath(folder, NULL);
    snprintf(path, 1024, "%s/%s", whole ? whole : folder, name);
    free(whole);
    if (!access(path, R_OK)) return true;
    snprintf(error, size, "%s: MASU_ISA_DRIVERS has no %s", gpu, path);
    return false;
}

/* Preloads a shim from the folder. */
static bool use_shim(const char *gpu, const char *shim, char *error, size_t size) {
    const char *also = getenv("LD_PRELOAD");
    char path[1024], preload[2100];
    if (!find_file(gpu, shim, path, error, size)) return false;
    snprintf(preload, sizeof preload, "%s%s%s", path, also && *also ? ":" : "", also ? also : "");
    setenv("LD_PRELOAD", preload, 1);
    return true;
}

/* Uses a driver from the folder. */
static bool use_built(const char *gpu, const char *driver, const char *icd, char *error,
                      size_t size) {
    char path[1024];
    if (!find_file(gpu, driver, path, error, size)) return false;
    FILE *f = fopen(icd, "w");
    bool good = f && fprintf(f,
                             "{\"file_format_version\": \"1.0.0\", \"ICD\": {\"library_path\": "
                             "\"%s\", \"api_version\": \"1.3.0\"}}\n",
                             path) > 0;
    if (f && fclose(f)) good = false;
    if (good) use_icd(icd);
    else snprintf(error, size, "%s: cannot write %s", gpu, icd);
    return good;
}

static bool use_driver(const masu_isa_gpu *gpu, const char *icd, char *error, size_t size) {
    const char *name = gpu->name;
    switch (gpu->driver) {
    case MASU_ISA_RADV:
        setenv("RADV_FORCE_FAMILY", name, 1);
        return use_installed(name, "RADV", "radeon_icd", error, size);
    case MASU_ISA_HASVK:
        setenv("INTEL_STUB_GPU_PLATFORM", name, 1);
        return use_installed(name, "hasvk", "intel_hasvk_icd", error, size) &&
               use_shim(name, "libintel_noop_drm_shim.so", error, size);
    case MASU_ISA_ANV:
        setenv("INTEL_STUB_GPU_PLATFORM", name, 1);
        return use_built(name, "libvulkan_intel.so", icd, error, size) &&
               use_shim(name, "libintel_noop_drm_shim.so", error, size);
    case MASU_ISA_TURNIP:
        setenv("FD_GPU_ID", name + 1, 1);
        return use_built(name, "libvulkan_freedreno.so", icd, error, size) &&
               use_shim(name, "libfreedreno_noop_drm_shim.so", error, size);
    case MASU_ISA_V3DV:
        setenv("V3D_SHIM_VER", name + 3, 1);
        return use_built(name, "libvulkan_broadcom.so", icd, error, size) &&
               use_shim(name, "libv3d_noop_drm_shim.so", error, size);
    default:
        setenv("PAN_GPU_ID", strcmp(name, "g52") ? "a867" : "7212", 1);
        setenv("PAN_I_WANT_A_BROKEN_VULKAN_DRIVER", "1", 1);
        setenv("MESA_VK_VERSION_OVERRIDE", "1.1", 1); /* PanVK has 1.0 for Bifrost */
        setenv("BIFROST_MESA_DEBUG", "shaderdb,nocache", 1); /* statistics, to standard error */
        return use_built(name, "libvulkan_panfrost.so", icd, error, size) &&
               use_shim(name, "libpanfrost_noop_drm_shim.so", error, size);
    }
}

bool masu_isa_gpu_environment(const masu_isa_gpu *gpu, const char *icd, char *error,
                              size_t error_size) {
    masu_isa_gpu_leave();
    enter();
    /* A cached shader has no statistics. */
    setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
    setenv("NODEVICE_SELECT", "1", 1);
    bool good = use_driver(gpu, icd, error, error_size);
    if (!good) masu_isa_gpu_leave();
    return good;
}
