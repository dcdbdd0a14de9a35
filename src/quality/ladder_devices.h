/* ladder_devices.h: what the rungs of ladder_tables.h cost on classes of GPUs, beside the first; part of ladder.c.
 * COMPUTED by the model sheet of the instructions that the GPUs' own compilers make (docs/design/33-model.md), not
 * measured on any of them. Written by `make ladder-devices`: not to be edited. */
/* clang-format off */
#ifndef MASU_LADDER_DEVICES_H
#define MASU_LADDER_DEVICES_H

static const float computed[MASU_SCENE_CLASSES][MASU_DEVICE_CLASSES][MASU_MAX_RUNGS] = {
    [MASU_SCENE_POLYGONS] = { /* textures.masu, ladder.json 4117717435 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.9562f, 0.7675f, 0.6847f, 0.6103f, 0.5090f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.9698f, 0.7811f, 0.6983f, 0.6239f, 0.5302f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.9331f, 0.7457f, 0.6634f, 0.5895f, 0.3743f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.9419f, 0.7536f, 0.6710f, 0.5968f, 0.3745f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.8751f, 0.6862f, 0.6032f, 0.5287f, 0.3665f},
    },
    [MASU_SCENE_SDF] = { /* city_shadows.masu, ladder.json 2377161052 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7889f, 0.5885f, 0.4153f, 0.3357f, 0.2647f, 0.2127f, 0.1797f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7918f, 0.5914f, 0.4182f, 0.3384f, 0.2656f, 0.2155f, 0.1825f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7893f, 0.5888f, 0.4156f, 0.3339f, 0.2655f, 0.2118f, 0.1714f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7897f, 0.5892f, 0.4161f, 0.3338f, 0.2654f, 0.2119f, 0.1711f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7792f, 0.5788f, 0.4056f, 0.3255f, 0.2612f, 0.2026f, 0.1682f},
    },
    [MASU_SCENE_BOTH] = { /* engine.masu, ladder.json 579879129 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7924f, 0.6035f, 0.4452f, 0.3159f, 0.2291f, 0.1889f, 0.1807f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7936f, 0.5994f, 0.4387f, 0.3085f, 0.2208f, 0.1962f, 0.1886f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7979f, 0.6093f, 0.4527f, 0.3261f, 0.2410f, 0.1761f, 0.1522f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7915f, 0.6018f, 0.4421f, 0.3129f, 0.2257f, 0.1922f, 0.1644f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7916f, 0.5943f, 0.4311f, 0.2991f, 0.2098f, 0.1759f, 0.1618f},
    },
    [MASU_SCENE_POLYGONS_TRACED] = { /* mirrors.masu, ladder.json 3870411933 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.8913f, 0.9244f, 0.3828f, 0.2807f, 0.2362f, 0.1733f, 0.0811f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.8929f, 0.9288f, 0.3820f, 0.2761f, 0.2348f, 0.1769f, 0.0829f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.8869f, 0.9212f, 0.3795f, 0.2861f, 0.2330f, 0.1484f, 0.0614f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.8738f, 0.9135f, 0.3660f, 0.2704f, 0.2217f, 0.1489f, 0.0615f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.8713f, 0.9209f, 0.3473f, 0.2623f, 0.2012f, 0.1279f, 0.0525f},
    },
    [MASU_SCENE_WORLD_TRACED] = { /* forza.masu, ladder.json 268414473 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.6422f, 0.5807f, 0.4519f, 0.2548f, 0.1983f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.6550f, 0.5997f, 0.4678f, 0.2662f, 0.2085f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.6116f, 0.5224f, 0.4006f, 0.2136f, 0.1602f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.6373f, 0.5444f, 0.4165f, 0.2206f, 0.1644f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.6238f, 0.5292f, 0.4029f, 0.2095f, 0.1540f},
    },
    [MASU_SCENE_BOTH_TRACED] = { /* wet_city.masu, ladder.json 434990834 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.8622f, 0.6558f, 0.5691f, 0.4013f, 0.3047f, 0.1931f, 0.1485f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.8716f, 0.6641f, 0.5769f, 0.4087f, 0.3068f, 0.1951f, 0.1521f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.8550f, 0.6489f, 0.5608f, 0.3933f, 0.3019f, 0.1573f, 0.1166f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.8617f, 0.6530f, 0.5652f, 0.3972f, 0.3028f, 0.1601f, 0.1193f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.8455f, 0.6370f, 0.5495f, 0.3803f, 0.2975f, 0.1644f, 0.1211f},
    },
};

#endif
