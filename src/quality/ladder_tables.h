/* ladder_tables.h: measured ladders, one per class of scenes; part of ladder.c. Written by
 * `make ladders` out of what `masu bench` has measured: not to be edited. */
/* clang-format off */
#ifndef MASU_LADDER_TABLES_H
#define MASU_LADDER_TABLES_H

static const masu_ladder measured[MASU_SCENE_CLASSES] = {
    [MASU_SCENE_POLYGONS] =
        {.from = "textures.masu, 640x360, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by timestamps, 2026-11-26",
         .count = 7,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.875f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.75f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.625f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.5f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.4f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.4f, .sharpen = MASU_OFF, .sharpness = 0.2f},
         },
         .ratios = {1.24644f, 1.00933f, 0.846639f, 0.675509f,
              0.545193f, 0.401772f, 0.309966f},
         .flips = {0.0306609f, 0.0357831f, 0.0471836f, 0.0661899f,
              0.0829395f, 0.0993268f, 0.139972f},
        },
    [MASU_SCENE_SDF] =
        {.from = "city_shadows.masu, 640x360, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by timestamps, 2026-11-26",
         .count = 7,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.875f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.75f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.625f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.5f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.4f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.4f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .march_steps = 128},
         },
         .ratios = {1.06715f, 0.819459f, 0.593735f, 0.448073f,
              0.303522f, 0.199781f, 0.186123f},
         .flips = {0.0133598f, 0.0149222f, 0.0168316f, 0.0204754f,
              0.0261631f, 0.034719f, 0.0577082f},
        },
    [MASU_SCENE_BOTH] =
        {.from = "engine.masu, 640x360, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by timestamps, 2026-11-26",
         .count = 8,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.875f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.75f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.625f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.5f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.4f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.4f, .sharpen = MASU_OFF, .sharpness = 0.2f},
              {.scale = 0.4f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .march_steps = 128},
         },
         .ratios = {1.18022f, 1.08284f, 0.768263f, 0.722285f,
              0.532873f, 0.401722f, 0.318513f, 0.280738f},
         .flips = {0.017201f, 0.0183728f, 0.0208237f, 0.0240288f,
              0.0278374f, 0.0332718f, 0.0664416f, 0.0671139f},
        },
    [MASU_SCENE_POLYGONS_TRACED] =
        {.from = "mirrors.masu, 640x360, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by timestamps, 2026-11-26",
         .count = 8,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 1.0f, .sharpness = 0.2f, .specular_reuse = MASU_OFF},
              {.scale = 0.75f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.625f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.5f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.4f, .sharpen = MASU_OFF, .sharpness = 0.2f},
              {.scale = 0.75f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .shadow_refresh = {2, 4, 8, 8}, .specular = MASU_OFF},
              {.scale = 0.4f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .shadow_refresh = {2, 4, 8, 8}, .specular = MASU_OFF},
         },
         .ratios = {1.11643f, 0.957092f, 0.798656f, 0.686047f,
              0.580691f, 0.441098f, 0.367805f, 0.300276f},
         .flips = {0.0255625f, 0.0269655f, 0.0291794f, 0.0316105f,
              0.0355723f, 0.0473875f, 0.0969826f, 0.103064f},
        },
    [MASU_SCENE_WORLD_TRACED] =
        {.from = "forza.masu, 640x360, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by timestamps, 2026-11-26",
         .count = 8,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.875f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.75f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.625f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.5f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.75f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .lod_error = 2.0f, .ao = MASU_OFF, .shadow_refresh = {2, 4, 8, 8},
               .specular = MASU_OFF},
              {.scale = 0.625f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .lod_error = 2.0f, .ao = MASU_OFF, .shadow_refresh = {2, 4, 8, 8},
               .specular = MASU_OFF},
              {.scale = 0.4f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .lod_error = 2.0f, .ao = MASU_OFF, .shadow_refresh = {2, 4, 8, 8},
               .specular = MASU_OFF},
         },
         .ratios = {1.07503f, 0.926448f, 0.802054f, 0.694563f,
              0.613536f, 0.500115f, 0.432067f, 0.342818f},
         .flips = {0.0479375f, 0.0517871f, 0.0541106f, 0.0559339f,
              0.0583431f, 0.0711042f, 0.0735669f, 0.0822436f},
        },
    [MASU_SCENE_BOTH_TRACED] =
        {.from = "wet_city.masu, 640x360, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by timestamps, 2026-11-26",
         .count = 8,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.875f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.75f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.625f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.5f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.4f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.5f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .march_steps = 128, .specular = MASU_OFF},
              {.scale = 0.4f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .march_steps = 128, .specular = MASU_OFF},
         },
         .ratios = {1.09699f, 0.878247f, 0.688163f, 0.525322f,
              0.383441f, 0.296163f, 0.234773f, 0.186405f},
         .flips = {0.0334933f, 0.0351852f, 0.0380783f, 0.0397872f,
              0.0464491f, 0.0553451f, 0.158416f, 0.161897f},
        },
};

#endif
