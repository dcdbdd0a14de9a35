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
         .count = 8,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.875f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.75f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.625f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.5f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.4f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.5f, .easu = MASU_EASU_BILINEAR, .sharpness = 0.2f},
              {.scale = 0.4f, .sharpen = MASU_OFF, .sharpness = 0.2f},
         },
         .ratios = {1.22629f, 1.02623f, 0.845602f, 0.683702f,
              0.550177f, 0.461993f, 0.439007f, 0.408783f},
         .flips = {0.0246969f, 0.0279775f, 0.0323326f, 0.0420107f,
              0.0547941f, 0.0696983f, 0.120106f, 0.139972f},
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
         .ratios = {1.0747f, 0.813776f, 0.615321f, 0.444856f,
              0.295504f, 0.207284f, 0.195711f},
         .flips = {0.0115178f, 0.0131258f, 0.015067f, 0.017635f,
              0.0221269f, 0.02872f, 0.059466f},
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
              {.scale = 0.4375f, .sharpen = MASU_OFF, .sharpness = 0.2f},
              {.scale = 0.4f, .easu = MASU_EASU_FAST, .sharpen = MASU_OFF, .sharpness = 0.2f,
               .march_steps = 128},
         },
         .ratios = {1.21454f, 0.992302f, 0.785873f, 0.599466f,
              0.441184f, 0.352759f, 0.33259f, 0.277194f},
         .flips = {0.0129429f, 0.0140111f, 0.0149366f, 0.0169405f,
              0.0202426f, 0.0248512f, 0.0616195f, 0.0671139f},
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
         .ratios = {1.11141f, 0.924157f, 0.781281f, 0.660876f,
              0.539213f, 0.441098f, 0.367805f, 0.300276f},
         .flips = {0.0184178f, 0.0198828f, 0.021933f, 0.0247881f,
              0.0279234f, 0.0473875f, 0.0969826f, 0.103064f},
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
         .ratios = {1.11021f, 0.969047f, 0.816086f, 0.682815f,
              0.590445f, 0.500115f, 0.432067f, 0.342818f},
         .flips = {0.0475342f, 0.0511176f, 0.0524223f, 0.0546197f,
              0.0572794f, 0.0711042f, 0.0735669f, 0.0822436f},
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
         .ratios = {1.07866f, 0.885541f, 0.695238f, 0.515461f,
              0.376792f, 0.302608f, 0.234773f, 0.186405f},
         .flips = {0.0246744f, 0.026246f, 0.027737f, 0.0313948f,
              0.0368444f, 0.0475076f, 0.158416f, 0.161897f},
        },
};

#endif
