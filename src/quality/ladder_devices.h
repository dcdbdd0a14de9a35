/* ladder_devices.h: what the rungs of ladder_tables.h cost on classes of GPUs, beside the first; part of ladder.c.
 * COMPUTED by the model sheet of the instructions that the GPUs' own compilers make (docs/design/33-model.md), not
 * measured on any of them. Written by `make ladder-devices`: not to be edited. */
/* clang-format off */
#ifndef MASU_LADDER_DEVICES_H
#define MASU_LADDER_DEVICES_H

static const float computed[MASU_SCENE_CLASSES][MASU_DEVICE_CLASSES][MASU_MAX_RUNGS] = {
    [MASU_SCENE_POLYGONS] = { /* textures.masu, ladder.json 4116201092 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.8019f, 0.6556f, 0.5191f, 0.3793f, 0.3356f, 0.2236f, 0.2701f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.8057f, 0.6366f, 0.4942f, 0.3504f, 0.3026f, 0.2404f, 0.2934f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.8138f, 0.6521f, 0.5156f, 0.4038f, 0.3322f, 0.1831f, 0.2145f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7978f, 0.6356f, 0.4951f, 0.3521f, 0.3060f, 0.2400f, 0.2771f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.8015f, 0.6288f, 0.4833f, 0.3515f, 0.2875f, 0.2406f, 0.2542f},
    },
    [MASU_SCENE_SDF] = { /* city_shadows.masu, ladder.json 3926519162 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7699f, 0.5762f, 0.4080f, 0.2692f, 0.1863f, 0.1756f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7705f, 0.5737f, 0.4048f, 0.2655f, 0.1822f, 0.1787f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7735f, 0.5792f, 0.4124f, 0.2786f, 0.1926f, 0.1704f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7695f, 0.5738f, 0.4053f, 0.2660f, 0.1831f, 0.1770f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7684f, 0.5699f, 0.3994f, 0.2615f, 0.1750f, 0.1704f},
    },
    [MASU_SCENE_BOTH] = { /* engine.masu, ladder.json 1351788060 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7924f, 0.6053f, 0.4469f, 0.3087f, 0.2309f, 0.2259f, 0.1808f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7939f, 0.6000f, 0.4394f, 0.3004f, 0.2219f, 0.2269f, 0.1880f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7979f, 0.6093f, 0.4527f, 0.3261f, 0.2410f, 0.2122f, 0.1522f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7915f, 0.6001f, 0.4404f, 0.3017f, 0.2240f, 0.2282f, 0.1641f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7911f, 0.5934f, 0.4299f, 0.2944f, 0.2082f, 0.2263f, 0.1617f},
    },
    [MASU_SCENE_POLYGONS_TRACED] = { /* mirrors.masu, ladder.json 3503762734 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7822f, 0.6010f, 0.4481f, 0.3098f, 0.2368f, 0.1868f, 0.0872f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7837f, 0.5937f, 0.4354f, 0.2935f, 0.2428f, 0.1954f, 0.0916f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7916f, 0.6080f, 0.4548f, 0.3273f, 0.2206f, 0.1542f, 0.0638f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7798f, 0.5933f, 0.4358f, 0.2960f, 0.2429f, 0.1721f, 0.0712f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7798f, 0.5862f, 0.4251f, 0.2874f, 0.2262f, 0.1538f, 0.0628f},
    },
    [MASU_SCENE_WORLD_TRACED] = { /* forza.masu, ladder.json 679171526 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7854f, 0.6057f, 0.4496f, 0.3103f, 0.3684f, 0.2795f, 0.1605f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7854f, 0.5965f, 0.4373f, 0.2959f, 0.3859f, 0.2939f, 0.1708f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7934f, 0.6120f, 0.4586f, 0.3335f, 0.3077f, 0.2285f, 0.1223f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7840f, 0.5985f, 0.4408f, 0.3003f, 0.3457f, 0.2559f, 0.1357f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7818f, 0.5897f, 0.4278f, 0.2895f, 0.3448f, 0.2535f, 0.1310f},
    },
    [MASU_SCENE_BOTH_TRACED] = { /* wet_city.masu, ladder.json 2321982604 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7941f, 0.6112f, 0.4536f, 0.3113f, 0.2365f, 0.1799f, 0.1383f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7954f, 0.6048f, 0.4453f, 0.3018f, 0.2260f, 0.1837f, 0.1432f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7978f, 0.6113f, 0.4540f, 0.3221f, 0.2380f, 0.1403f, 0.1040f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7912f, 0.6012f, 0.4421f, 0.2991f, 0.2231f, 0.1533f, 0.1143f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7923f, 0.5979f, 0.4355f, 0.2953f, 0.2117f, 0.1611f, 0.1187f},
    },
};

#endif
