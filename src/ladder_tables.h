/* ladder_tables.h: measured ladders, one per class of scenes; part of ladder.c. Written by
 * `make ladders` out of what `masu bench` has measured: not to be edited. */
/* clang-format off */
#ifndef MASU_LADDER_TABLES_H
#define MASU_LADDER_TABLES_H

#include "ladder.h"

static const masu_ladder measured[MASU_SCENE_CLASSES] = {
    [MASU_SCENE_POLYGONS] =
        {.from = "textures.masu, 320x180, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by timestamps, 2026-11-22",
         .count = 5,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f},
              {.scale = 0.75f, .sharpen = MASU_OFF, .sharpness = 0.2f},
              {.scale = 0.625f, .sharpen = MASU_OFF, .sharpness = 0.2f},
              {.scale = 0.5625f, .sharpen = MASU_OFF, .sharpness = 0.2f},
              {.scale = 0.4f, .sharpen = MASU_OFF, .sharpness = 0.2f},
         },
         .ratios = {1.0f, 0.747958f, 0.718918f, 0.66155f,
              0.530321f},
         .flips = {0.12547f, 0.131078f, 0.133885f, 0.139956f,
              0.162285f},
        },
    [MASU_SCENE_SDF] =
        {.from = "city_shadows.masu, 320x180, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by timestamps, 2026-11-22",
         .count = 8,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f, .aa = MASU_AA_SMAA_ULTRA},
              {.scale = 0.875f, .sharpen = MASU_OFF, .sharpness = 0.2f, .aa = MASU_AA_SMAA_HIGH},
              {.scale = 0.75f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .march_steps = 128},
              {.scale = 0.625f, .sharpen = MASU_OFF, .sharpness = 0.2f, .aa = MASU_AA_SMAA_HIGH},
              {.scale = 0.5625f, .sharpen = MASU_OFF, .sharpness = 0.2f},
              {.scale = 0.5f, .sharpen = MASU_OFF, .sharpness = 0.2f, .aa = MASU_AA_SMAA_HIGH},
              {.scale = 0.4375f, .sharpen = MASU_OFF, .sharpness = 0.2f},
              {.scale = 0.4f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .march_steps = 128},
         },
         .ratios = {1.0395f, 0.799494f, 0.585194f, 0.428409f,
              0.349806f, 0.288668f, 0.23918f, 0.197693f},
         .flips = {0.0293173f, 0.040855f, 0.0519315f, 0.0578781f,
              0.0704565f, 0.074186f, 0.0875745f, 0.0951214f},
        },
    [MASU_SCENE_BOTH] =
        {.from = "engine.masu, 320x180, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by timestamps, 2026-11-22",
         .count = 8,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f, .march_steps = 512},
              {.scale = 1.0f, .sharpness = 0.2f, .march_steps = 64},
              {.scale = 0.75f, .sharpen = MASU_OFF, .sharpness = 0.2f, .march_steps = 128},
              {.scale = 0.625f, .sharpen = MASU_OFF, .sharpness = 0.2f, .march_steps = 128},
              {.scale = 0.5625f, .sharpen = MASU_OFF, .sharpness = 0.2f},
              {.scale = 0.5f, .sharpen = MASU_OFF, .sharpness = 0.2f, .march_steps = 128},
              {.scale = 0.4375f, .sharpen = MASU_OFF, .sharpness = 0.2f},
              {.scale = 0.4f, .sharpen = MASU_OFF, .sharpness = 0.2f, .march_steps = 128},
         },
         .ratios = {0.964241f, 0.817864f, 0.763283f, 0.709128f,
              0.641884f, 0.586362f, 0.556394f, 0.53088f},
         .flips = {0.0341456f, 0.0417077f, 0.0560837f, 0.0668947f,
              0.0772771f, 0.0862805f, 0.0959016f, 0.107077f},
        },
    [MASU_SCENE_POLYGONS_TRACED] =
        {.from = "mirrors.masu, 320x180, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by timestamps, 2026-11-22",
         .count = 8,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f, .aa = MASU_AA_SMAA_HIGH},
              {.scale = 1.0f, .sharpness = 0.2f, .specular_taa = MASU_OFF},
              {.scale = 1.0f, .sharpness = 0.2f, .shadow_refresh = {4, 4, 4, 4}},
              {.scale = 0.5f, .sharpness = 2.0f},
              {.scale = 0.4f, .sharpen = MASU_OFF, .sharpness = 0.2f},
              {.scale = 0.625f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .shadow_refresh = {2, 4, 8, 8}, .specular = MASU_OFF},
              {.scale = 0.5f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .shadow_refresh = {2, 4, 8, 8}, .specular = MASU_OFF},
              {.scale = 0.4f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .shadow_refresh = {2, 4, 8, 8}, .specular = MASU_OFF},
         },
         .ratios = {1.04251f, 0.98466f, 0.757022f, 0.665804f,
              0.584f, 0.5495f, 0.510808f, 0.47433f},
         .flips = {0.0356638f, 0.0367341f, 0.0389825f, 0.0611152f,
              0.0709953f, 0.106023f, 0.110344f, 0.115492f},
        },
    [MASU_SCENE_WORLD_TRACED] =
        {.from = "forza.masu, 320x180, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by timestamps, 2026-11-22",
         .count = 7,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f, .shadow_resolution = 512},
              {.scale = 1.0f, .sharpness = 0.2f, .lod_error = 2.0f, .ao = MASU_OFF,
               .shadow_refresh = {2, 4, 8, 8}, .specular = MASU_OFF},
              {.scale = 0.875f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .lod_error = 2.0f, .ao = MASU_OFF, .shadow_refresh = {2, 4, 8, 8},
               .specular = MASU_OFF},
              {.scale = 0.75f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .lod_error = 2.0f, .ao = MASU_OFF, .shadow_refresh = {2, 4, 8, 8},
               .specular = MASU_OFF},
              {.scale = 0.625f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .lod_error = 2.0f, .ao = MASU_OFF, .shadow_refresh = {2, 4, 8, 8},
               .specular = MASU_OFF},
              {.scale = 0.5f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .lod_error = 2.0f, .ao = MASU_OFF, .shadow_refresh = {2, 4, 8, 8},
               .specular = MASU_OFF},
              {.scale = 0.4f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .lod_error = 2.0f, .ao = MASU_OFF, .shadow_refresh = {2, 4, 8, 8},
               .specular = MASU_OFF},
         },
         .ratios = {0.824066f, 0.60106f, 0.518491f, 0.471545f,
              0.437865f, 0.39042f, 0.37007f},
         .flips = {0.0874263f, 0.0930473f, 0.097315f, 0.101597f,
              0.109163f, 0.120299f, 0.137232f},
        },
    [MASU_SCENE_BOTH_TRACED] =
        {.from = "wet_city.masu, 320x180, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by timestamps, 2026-11-22",
         .count = 8,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f, .specular_taa = MASU_OFF},
              {.scale = 0.875f, .sharpen = MASU_OFF, .sharpness = 0.2f, .march_steps = 128},
              {.scale = 0.75f, .sharpen = MASU_OFF, .sharpness = 0.2f, .march_steps = 128},
              {.scale = 0.6875f, .sharpen = MASU_OFF, .sharpness = 0.2f},
              {.scale = 0.5625f, .sharpen = MASU_OFF, .sharpness = 0.2f},
              {.scale = 0.5f, .sharpen = MASU_OFF, .sharpness = 0.2f, .march_steps = 128},
              {.scale = 0.4f, .sharpen = MASU_OFF, .sharpness = 0.2f, .march_steps = 128},
              {.scale = 0.4f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .march_steps = 128, .specular = MASU_OFF},
         },
         .ratios = {0.992582f, 0.830924f, 0.66193f, 0.608589f,
              0.442662f, 0.387097f, 0.309581f, 0.249585f},
         .flips = {0.0603801f, 0.070317f, 0.0798309f, 0.0866085f,
              0.0882799f, 0.109213f, 0.126813f, 0.202486f},
        },
};

#endif
