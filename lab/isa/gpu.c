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
    {"skl", "Gen 9: HD 530", MASU_ISA_ANV, 0},
    {"kbl", "Gen 9.5: UHD 620", MASU_ISA_ANV, 0},
    {"icl", "Gen 11: Iris Plus", MASU_ISA_ANV, 0},
    {"tgl", "Xe: Iris Xe", MASU_ISA_ANV, 0},
    {"a630", "Adreno 630", MASU_ISA_TURNIP, 16},
    {"a660", "Adreno 660", MASU_ISA_TURNIP, 16},
};
const uint32_t masu_isa_gpu_count = sizeof masu_isa_gpus / sizeof *masu_isa_gpus;

const masu_isa_gpu *masu_isa_gpu_find(const char *name) {
    for (uint32_t i = 0; i < masu_isa_gpu_count; i++)
        if (!strcmp(masu_isa_gpus[i].name, name)) return &masu_isa_gpus[i];
    return NULL;
}

static const char *const variables[] = {"VK_ICD_FILENAMES",        "VK_DRIVER_FILES",
                                        "RADV_FORCE_FAMILY",       "INTEL_STUB_GPU_PLATFORM",
                                        "FD_GPU_ID",               "LD_PRELOAD",
                                        "MESA_SHADER_CACHE_DISABLE", "NODEVICE_SELECT"};
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

static bool use_radv(const char *family, char *error, size_t size) {
    glob_t found;
    if (glob("/usr/share/vulkan/icd.d/radeon_icd.*.json", 0, NULL, &found)) {
        snprintf(error, size,
                 "%s: RADV is not installed: no /usr/share/vulkan/icd.d/radeon_icd.*.json (package "
                 "mesa-vulkan-drivers)",
                 family);
        return false;
    }
    use_icd(found.gl_pathv[0]);
    globfree(&found);
    setenv("RADV_FORCE_FAMILY", family, 1);
    return true;
}

/* Uses a driver and its shim from the folder. */
static bool use_shim(const char *gpu, const char *driver, const char *shim, const char *icd, char *error,
                     size_t size) {
    const char *folder = getenv("MASU_ISA_DRIVERS");
    const char *const names[] = {driver, shim};
    char path[2][1024], preload[2100];
    if (!folder || !*folder) {
        snprintf(error, size,
                 "%s: its compiler is in no Debian package: MASU_ISA_DRIVERS is to name the folder with %s and "
                 "%s (make isa-drivers builds it)",
                 gpu, driver, shim);
        return false;
    }
    char *whole = realpath(folder, NULL);
    for (int i = 0; i < 2; i++) {
        snprintf(path[i], sizeof path[i], "%s/%s", whole ? whole : folder, names[i]);
        if (!access(path[i], R_OK)) continue;
        snprintf(error, size, "%s: MASU_ISA_DRIVERS has no %s", gpu, path[i]);
        free(whole);
        return false;
    }
    free(whole);
    FILE *f = fopen(icd, "w");
    bool good = f && fprintf(f,
                             "{\"file_format_version\": \"1.0.0\", \"ICD\": {\"library_path\": \"%s\", "
                             "\"api_version\": \"1.3.0\"}}\n",
                             path[0]) > 0;
    if (f && fclose(f)) good = false;
    if (!good) {
        snprintf(error, size, "%s: cannot write %s", gpu, icd);
        return false;
    }
    use_icd(icd);
    const char *also = getenv("LD_PRELOAD");
    snprintf(preload, sizeof preload, "%s%s%s", path[1], also && *also ? ":" : "", also ? also : "");
    setenv("LD_PRELOAD", preload, 1);
    return true;
}

bool masu_isa_gpu_environment(const masu_isa_gpu *gpu, const char *icd, char *error, size_t error_size) {
    masu_isa_gpu_leave();
    enter();
    /* A cached shader has no statistics. */
    setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
    setenv("NODEVICE_SELECT", "1", 1);
    bool good = false;
    if (gpu->driver == MASU_ISA_RADV) {
        good = use_radv(gpu->name, error, error_size);
    } else if (gpu->driver == MASU_ISA_ANV) {
        setenv("INTEL_STUB_GPU_PLATFORM", gpu->name, 1);
        good = use_shim(gpu->name, "libvulkan_intel.so", "libintel_noop_drm_shim.so", icd, error, error_size);
    } else {
        setenv("FD_GPU_ID", gpu->name + 1, 1);
        good = use_shim(gpu->name, "libvulkan_freedreno.so", "libfreedreno_noop_drm_shim.so", icd, error,
                        error_size);
    }
    if (!good) masu_isa_gpu_leave();
    return good;
}
