/* ladder_tables.h: measured ladders, one per class of scenes; part of ladder.c. Written by
 * `make ladders` out of what `masu bench` has measured: not to be edited. */
/* clang-format off */
#ifndef MASU_LADDER_TABLES_H
#define MASU_LADDER_TABLES_H

#include "ladder.h"

static const masu_ladder measured[MASU_SCENE_CLASSES] = {
    [MASU_SCENE_POLYGONS] =
        {.from = "textures.masu, 160x90, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by wall, 2026-11-22",
         .count = 3,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f},
              {.scale = 0.5f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f},
              {.scale = 0.4f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f},
         },
         .ratios = {1.0f, 0.782669f, 0.678277f},
         .flips = {0.127877f, 0.155337f, 0.171307f},
        },
    [MASU_SCENE_SDF] =
        {.from = "city_shadows.masu, 160x90, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by timestamps, 2026-11-22",
         .count = 5,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f, .aa = MASU_AA_FXAA},
              {.scale = 0.75f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .march_steps = 128},
              {.scale = 0.75f, .sharpness = 0.2f},
              {.scale = 0.5f, .sharpness = 0.2f, .aa = MASU_AA_FXAA},
              {.scale = 0.4f, .sharpness = 0.2f},
         },
         .ratios = {0.976212f, 0.779343f, 0.588114f, 0.27713f,
              0.200285f},
         .flips = {0.0531208f, 0.0824956f, 0.0954145f, 0.124573f,
              0.156847f},
        },
    [MASU_SCENE_BOTH] =
        {.from = "engine.masu, 320x180, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by timestamps, 2026-11-22",
         .count = 8,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f},
              {.scale = 1.0f, .sharpness = 0.2f, .march_steps = 128},
              {.scale = 0.875f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .march_steps = 128},
              {.scale = 0.75f, .sharpen = MASU_OFF, .sharpness = 0.2f},
              {.scale = 0.75f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .march_steps = 128},
              {.scale = 0.5f, .sharpness = 2.0f},
              {.scale = 0.4f, .sharpen = MASU_OFF, .sharpness = 0.2f},
              {.scale = 0.4f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .march_steps = 128},
         },
         .ratios = {1.0f, 0.902991f, 0.838333f, 0.767844f,
              0.694593f, 0.61107f, 0.534703f, 0.483996f},
         .flips = {0.0341412f, 0.034565f, 0.0505464f, 0.0550697f,
              0.0570408f, 0.086237f, 0.106675f, 0.107651f},
        },
    [MASU_SCENE_POLYGONS_TRACED] =
        {.from = "mirrors.masu, 160x90, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by timestamps, 2026-11-22",
         .count = 6,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f},
              {.scale = 0.75f, .sharpness = 0.2f},
              {.scale = 0.5f, .sharpen = MASU_OFF, .sharpness = 0.2f},
              {.scale = 0.5f, .sharpness = 0.2f, .aa = MASU_AA_FXAA},
              {.scale = 1.0f, .sharpness = 0.2f, .shadow_refresh = {2, 4, 8, 8},
               .specular = MASU_OFF},
              {.scale = 0.5f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .shadow_refresh = {2, 4, 8, 8}, .specular = MASU_OFF},
         },
         .ratios = {1.0f, 0.8568f, 0.810742f, 0.775386f,
              0.700107f, 0.492839f},
         .flips = {0.050452f, 0.0724377f, 0.0853257f, 0.0892481f,
              0.102072f, 0.119917f},
        },
    [MASU_SCENE_BOTH_TRACED] =
        {.from = "wet_city.masu, 160x90, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by timestamps, 2026-11-22",
         .count = 5,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f},
              {.scale = 0.75f, .sharpness = 0.2f},
              {.scale = 0.5f, .sharpen = MASU_OFF, .sharpness = 0.2f},
              {.scale = 0.5f, .easu = MASU_EASU_FAST, .sharpness = 0.2f},
              {.scale = 0.5f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .march_steps = 128, .specular = MASU_OFF},
         },
         .ratios = {1.0f, 0.734968f, 0.439647f, 0.399366f,
              0.342728f},
         .flips = {0.0941172f, 0.125637f, 0.151038f, 0.155859f,
              0.221023f},
        },
};

#endif
