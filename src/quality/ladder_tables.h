/* ladder_tables.h: measured ladders, one per class of scenes; part of ladder.c. Written by
 * `make ladders` out of what `masu bench` has measured: not to be edited. */
/* clang-format off */
#ifndef MASU_LADDER_TABLES_H
#define MASU_LADDER_TABLES_H

static const masu_ladder measured[MASU_SCENE_CLASSES] = {
    [MASU_SCENE_POLYGONS] =
        {.from = "textures.masu, 640x360, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by computed costs, 2026-11-28",
         .count = 10,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.875f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.75f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.625f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.5f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.4f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.35f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.3f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.28f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.25f, .sharpness = 0.2f, .temporal = MASU_ON},
         },
         .ratios = {1.48788f, 1.19362f, 0.936178f, 0.718084f,
              0.50988f, 0.425499f, 0.378024f, 0.336628f,
              0.321806f, 0.301756f},
         .flips = {0.0242142f, 0.0282966f, 0.0317206f, 0.0423167f,
              0.0535685f, 0.0684168f, 0.0800478f, 0.0980399f,
              0.107431f, 0.123323f},
        },
    [MASU_SCENE_SDF] =
        {.from = "city_shadows.masu, 640x360, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by computed costs, 2026-11-28",
         .count = 11,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.875f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.75f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.625f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.5f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.4f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.35f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.3f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.25f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.22f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.2f, .sharpness = 0.2f, .temporal = MASU_ON},
         },
         .ratios = {1.05604f, 0.812456f, 0.603204f, 0.42489f,
              0.277825f, 0.188414f, 0.149365f, 0.116695f,
              0.0886084f, 0.073888f, 0.0648196f},
         .flips = {0.0108876f, 0.0127294f, 0.0143037f, 0.0173312f,
              0.0214066f, 0.0272012f, 0.031357f, 0.0387377f,
              0.0472198f, 0.0565669f, 0.0654268f},
        },
    [MASU_SCENE_BOTH] =
        {.from = "engine.masu, 640x360, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by computed costs, 2026-11-28",
         .count = 11,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.875f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.75f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.625f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.5f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.4f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.35f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.3f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.25f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.22f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.2f, .sharpness = 0.2f, .temporal = MASU_ON},
         },
         .ratios = {1.2929f, 1.0219f, 0.770277f, 0.558955f,
              0.382595f, 0.274641f, 0.226914f, 0.184001f,
              0.150566f, 0.131124f, 0.119272f},
         .flips = {0.0116567f, 0.0135282f, 0.0140012f, 0.0162626f,
              0.0193592f, 0.0236795f, 0.0276709f, 0.0351681f,
              0.0481449f, 0.0603725f, 0.0694412f},
        },
    [MASU_SCENE_POLYGONS_TRACED] =
        {.from = "mirrors.masu, 640x360, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by computed costs, 2026-11-28",
         .count = 12,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.875f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.75f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.625f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.5f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.4f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.35f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.3f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.28f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.25f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.22f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.2f, .sharpness = 0.2f, .temporal = MASU_ON,
               .shadow_refresh = {2, 4, 8, 8}, .specular_reuse_taps = 4,
               .specular_filter_taps = 6},
         },
         .ratios = {0.940547f, 0.735573f, 0.555154f, 0.404679f,
              0.273767f, 0.200944f, 0.167618f, 0.138942f,
              0.12826f, 0.114381f, 0.101849f, 0.0908218f},
         .flips = {0.0259274f, 0.0270633f, 0.028007f, 0.0295256f,
              0.0322233f, 0.0364932f, 0.0392966f, 0.0423581f,
              0.0429915f, 0.0473286f, 0.0549161f, 0.0592886f},
        },
    [MASU_SCENE_BOTH_TRACED] =
        {.from = "wet_city.masu, 640x360, "
         "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230, "
         "by computed costs, 2026-11-28",
         .count = 12,
         .rungs = {
              {.scale = 1.0f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.875f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.75f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.625f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.5f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.4f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.35f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.3f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.28f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.25f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.22f, .sharpness = 0.2f, .temporal = MASU_ON},
              {.scale = 0.2f, .sharpness = 0.2f, .temporal = MASU_ON},
         },
         .ratios = {1.02603f, 0.811586f, 0.616063f, 0.449348f,
              0.303428f, 0.220992f, 0.183247f, 0.150661f,
              0.137973f, 0.123158f, 0.106829f, 0.0967801f},
         .flips = {0.027809f, 0.0294918f, 0.0317711f, 0.0342505f,
              0.0405795f, 0.048544f, 0.0549395f, 0.0638566f,
              0.0686275f, 0.0757643f, 0.0849418f, 0.0956694f},
        },
};

#endif
