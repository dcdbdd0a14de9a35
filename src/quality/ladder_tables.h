/* ladder_tables.h: measured ladders, one per class of scenes; part of ladder.c. Written by
 * `make ladders` out of what `masu bench` has measured: not to be edited. */
/* clang-format off */
#ifndef MASU_LADDER_TABLES_H
#define MASU_LADDER_TABLES_H

static const masu_ladder measured[MASU_SCENE_CLASSES] = {
    [MASU_SCENE_POLYGONS] =
        {.from = "textures.masu, 640x360, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by timestamps, 2026-11-27",
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
         .ratios = {1.18344f, 0.988008f, 0.82403f, 0.659697f,
              0.523161f, 0.452096f, 0.408783f},
         .flips = {0.0247719f, 0.0282309f, 0.0327993f, 0.042704f,
              0.0558855f, 0.0712148f, 0.139972f},
        },
    [MASU_SCENE_SDF] =
        {.from = "city_shadows.masu, 640x360, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by timestamps, 2026-11-27",
         .count = 7,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.875f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.75f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.625f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.5f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.4f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.4f, .sharpen = MASU_OFF, .sharpness = 0.2f, .march_steps = 128},
         },
         .ratios = {1.06007f, 0.813443f, 0.61558f, 0.44378f,
              0.297741f, 0.20637f, 0.195711f},
         .flips = {0.0116924f, 0.0134014f, 0.0153756f, 0.0180455f,
              0.0226924f, 0.0295162f, 0.059466f},
        },
    [MASU_SCENE_BOTH] =
        {.from = "engine.masu, 640x360, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by timestamps, 2026-11-27",
         .count = 8,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.875f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.75f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.625f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.5f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.4f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.5f, .sharpen = MASU_OFF, .sharpness = 0.2f, .march_steps = 128},
              {.scale = 0.4f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .march_steps = 128},
         },
         .ratios = {1.23493f, 1.01088f, 0.790373f, 0.618873f,
              0.449948f, 0.359169f, 0.340615f, 0.277194f},
         .flips = {0.0130535f, 0.0142824f, 0.0153608f, 0.0175657f,
              0.0211816f, 0.0261933f, 0.0553822f, 0.0671139f},
        },
    [MASU_SCENE_POLYGONS_TRACED] =
        {.from = "mirrors.masu, 640x360, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by timestamps, 2026-11-27",
         .count = 8,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.875f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.75f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.625f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.5f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.4f, .sharpen = MASU_OFF, .sharpness = 0.2f},
              {.scale = 0.75f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .shadow_refresh = {2, 4, 8, 8}, .specular = MASU_OFF},
              {.scale = 0.4f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .shadow_refresh = {2, 4, 8, 8}, .specular = MASU_OFF},
         },
         .ratios = {1.12174f, 0.951152f, 0.797732f, 0.684756f,
              0.57864f, 0.441098f, 0.367805f, 0.300276f},
         .flips = {0.02404f, 0.0258925f, 0.0280079f, 0.0304219f,
              0.0332564f, 0.0473875f, 0.0969826f, 0.103064f},
        },
    [MASU_SCENE_WORLD_TRACED] =
        {.from = "forza.masu, 640x360, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by timestamps, 2026-11-27",
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
         .ratios = {1.08633f, 0.962637f, 0.83644f, 0.73101f,
              0.615315f, 0.500115f, 0.432067f, 0.342818f},
         .flips = {0.047759f, 0.051294f, 0.0526002f, 0.0548005f,
              0.0575079f, 0.0711042f, 0.0735669f, 0.0822436f},
        },
    [MASU_SCENE_BOTH_TRACED] =
        {.from = "wet_city.masu, 640x360, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by timestamps, 2026-11-27",
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
         .ratios = {1.10351f, 0.877278f, 0.691705f, 0.521784f,
              0.37615f, 0.293189f, 0.234773f, 0.186405f},
         .flips = {0.0332825f, 0.034589f, 0.036498f, 0.0402773f,
              0.0463559f, 0.0553028f, 0.158416f, 0.161897f},
        },
};

#endif
