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
         .ratios = {1.23756f, 1.03792f, 0.859997f, 0.708048f,
              0.548207f, 0.47407f, 0.439007f, 0.408783f},
         .flips = {0.0246752f, 0.0280268f, 0.0324095f, 0.0421738f,
              0.0550984f, 0.0701996f, 0.120106f, 0.139972f},
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
         .ratios = {1.09133f, 0.826173f, 0.630276f, 0.44893f,
              0.304782f, 0.212505f, 0.195711f},
         .flips = {0.0115017f, 0.0131337f, 0.0150845f, 0.0176594f,
              0.0221633f, 0.0289038f, 0.059466f},
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
         .ratios = {1.25269f, 1.03128f, 0.818103f, 0.654018f,
              0.457717f, 0.398954f, 0.340615f, 0.277194f},
         .flips = {0.0129289f, 0.0140372f, 0.0149724f, 0.0169762f,
              0.0203266f, 0.0251631f, 0.0553822f, 0.0671139f},
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
         .ratios = {1.14956f, 0.94806f, 0.816198f, 0.675359f,
              0.581381f, 0.441098f, 0.367805f, 0.300276f},
         .flips = {0.0213933f, 0.022773f, 0.0246498f, 0.027063f,
              0.0302638f, 0.0473875f, 0.0969826f, 0.103064f},
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
         .ratios = {1.19018f, 0.985118f, 0.885445f, 0.756865f,
              0.623981f, 0.500115f, 0.432067f, 0.342818f},
         .flips = {0.0476541f, 0.051184f, 0.0525093f, 0.0546708f,
              0.0573085f, 0.0711042f, 0.0735669f, 0.0822436f},
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
         .ratios = {1.10293f, 0.88211f, 0.699863f, 0.530134f,
              0.379055f, 0.295728f, 0.234773f, 0.186405f},
         .flips = {0.0288194f, 0.0299626f, 0.0319801f, 0.0355119f,
              0.041634f, 0.0506004f, 0.158416f, 0.161897f},
        },
};

#endif
