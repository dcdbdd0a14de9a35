/* ladder_devices.h: what the rungs of ladder_tables.h cost on classes of GPUs, beside the first; part of ladder.c.
 * COMPUTED by the model sheet of the instructions that the GPUs' own compilers make (docs/design/33-model.md), not
 * measured on any of them. Written by `make ladder-devices`: not to be edited. */
/* clang-format off */
#ifndef MASU_LADDER_DEVICES_H
#define MASU_LADDER_DEVICES_H

static const float computed[MASU_SCENE_CLASSES][MASU_DEVICE_CLASSES][MASU_MAX_RUNGS] = {
    [MASU_SCENE_POLYGONS] = { /* textures.masu, ladder.json 4018678798 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.8019f, 0.6518f, 0.5154f, 0.3785f, 0.3318f, 0.2693f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.8048f, 0.6350f, 0.4919f, 0.3510f, 0.2994f, 0.2936f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.8138f, 0.6521f, 0.5156f, 0.4038f, 0.3322f, 0.2145f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7977f, 0.6217f, 0.4914f, 0.3519f, 0.3023f, 0.2763f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.8002f, 0.6264f, 0.4800f, 0.3515f, 0.2830f, 0.2538f},
    },
    [MASU_SCENE_SDF] = { /* city_shadows.masu, ladder.json 1871147433 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7699f, 0.5757f, 0.4075f, 0.2691f, 0.1858f, 0.1755f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7704f, 0.5735f, 0.4044f, 0.2655f, 0.1817f, 0.1787f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7735f, 0.5792f, 0.4124f, 0.2786f, 0.1926f, 0.1704f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7695f, 0.5719f, 0.4048f, 0.2660f, 0.1826f, 0.1770f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7682f, 0.5696f, 0.3991f, 0.2615f, 0.1745f, 0.1704f},
    },
    [MASU_SCENE_BOTH] = { /* engine.masu, ladder.json 2595543350 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7924f, 0.6041f, 0.4457f, 0.3085f, 0.2297f, 0.2256f, 0.1806f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7936f, 0.5994f, 0.4386f, 0.3005f, 0.2208f, 0.2269f, 0.1880f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7979f, 0.6093f, 0.4527f, 0.3261f, 0.2410f, 0.2122f, 0.1522f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7915f, 0.5954f, 0.4392f, 0.3016f, 0.2228f, 0.2279f, 0.1639f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7908f, 0.5928f, 0.4290f, 0.2944f, 0.2070f, 0.2261f, 0.1615f},
    },
    [MASU_SCENE_POLYGONS_TRACED] = { /* mirrors.masu, ladder.json 2277365684 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7822f, 0.5994f, 0.4466f, 0.3095f, 0.2366f, 0.1860f, 0.0870f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7834f, 0.5930f, 0.4344f, 0.2937f, 0.2428f, 0.1951f, 0.0916f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7917f, 0.6080f, 0.4548f, 0.3273f, 0.2206f, 0.1542f, 0.0638f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7798f, 0.5879f, 0.4344f, 0.2960f, 0.2426f, 0.1716f, 0.0710f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7794f, 0.5853f, 0.4239f, 0.2873f, 0.2260f, 0.1531f, 0.0626f},
    },
    [MASU_SCENE_WORLD_TRACED] = { /* forza.masu, ladder.json 784139473 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7854f, 0.6045f, 0.4483f, 0.3101f, 0.3677f, 0.2789f, 0.1603f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7851f, 0.5959f, 0.4365f, 0.2960f, 0.3857f, 0.2937f, 0.1708f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7934f, 0.6120f, 0.4586f, 0.3335f, 0.3077f, 0.2285f, 0.1223f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7840f, 0.5938f, 0.4396f, 0.3003f, 0.3451f, 0.2555f, 0.1355f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7815f, 0.5890f, 0.4268f, 0.2895f, 0.3443f, 0.2531f, 0.1308f},
    },
    [MASU_SCENE_BOTH_TRACED] = { /* wet_city.masu, ladder.json 477748929 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7941f, 0.6100f, 0.4523f, 0.3111f, 0.2352f, 0.1796f, 0.1381f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7951f, 0.6042f, 0.4445f, 0.3019f, 0.2248f, 0.1836f, 0.1432f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7978f, 0.6113f, 0.4540f, 0.3221f, 0.2380f, 0.1403f, 0.1040f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7912f, 0.5967f, 0.4410f, 0.2991f, 0.2219f, 0.1530f, 0.1141f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7920f, 0.5973f, 0.4346f, 0.2952f, 0.2105f, 0.1609f, 0.1185f},
    },
};

#endif
