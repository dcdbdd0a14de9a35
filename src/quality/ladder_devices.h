/* ladder_devices.h: what the rungs of ladder_tables.h cost on classes of GPUs, beside the first; part of ladder.c.
 * COMPUTED by the model sheet of the instructions that the GPUs' own compilers make (docs/design/33-model.md), not
 * measured on any of them. Written by `make ladder-devices`: not to be edited. */
/* clang-format off */
#ifndef MASU_LADDER_DEVICES_H
#define MASU_LADDER_DEVICES_H

static const float computed[MASU_SCENE_CLASSES][MASU_DEVICE_CLASSES][MASU_MAX_RUNGS] = {
    [MASU_SCENE_POLYGONS] = { /* textures.masu, ladder.json 3662553962 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.8020f, 0.6500f, 0.5136f, 0.4019f, 0.3302f, 0.2699f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.8049f, 0.6352f, 0.4922f, 0.3750f, 0.2999f, 0.2957f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.8138f, 0.6521f, 0.5156f, 0.4038f, 0.3322f, 0.2145f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7979f, 0.6406f, 0.5001f, 0.3851f, 0.3112f, 0.2782f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.8034f, 0.6324f, 0.4883f, 0.3702f, 0.2944f, 0.2555f},
    },
    [MASU_SCENE_SDF] = { /* city_shadows.masu, ladder.json 1508924224 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7700f, 0.5754f, 0.4072f, 0.2723f, 0.1856f, 0.1734f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7704f, 0.5735f, 0.4044f, 0.2688f, 0.1817f, 0.1768f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7735f, 0.5792f, 0.4124f, 0.2786f, 0.1926f, 0.1613f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7696f, 0.5746f, 0.4060f, 0.2707f, 0.1838f, 0.1671f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7686f, 0.5702f, 0.3999f, 0.2633f, 0.1756f, 0.1670f},
    },
    [MASU_SCENE_BOTH] = { /* engine.masu, ladder.json 579879129 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7924f, 0.6035f, 0.4451f, 0.3159f, 0.2291f, 0.1889f, 0.1807f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7936f, 0.5994f, 0.4387f, 0.3085f, 0.2208f, 0.1961f, 0.1885f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7979f, 0.6093f, 0.4527f, 0.3261f, 0.2410f, 0.1761f, 0.1522f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7915f, 0.6018f, 0.4421f, 0.3129f, 0.2257f, 0.1922f, 0.1644f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7916f, 0.5943f, 0.4311f, 0.2991f, 0.2098f, 0.1759f, 0.1618f},
    },
    [MASU_SCENE_POLYGONS_TRACED] = { /* mirrors.masu, ladder.json 336695153 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.9111f, 0.5988f, 0.4460f, 0.3194f, 0.2375f, 0.1867f, 0.0873f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.9302f, 0.5930f, 0.4344f, 0.3033f, 0.2436f, 0.1962f, 0.0920f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.8658f, 0.6080f, 0.4548f, 0.3273f, 0.2206f, 0.1542f, 0.0638f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.9461f, 0.5952f, 0.4377f, 0.3089f, 0.2433f, 0.1728f, 0.0714f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.9830f, 0.5873f, 0.4266f, 0.2937f, 0.2265f, 0.1536f, 0.0628f},
    },
    [MASU_SCENE_WORLD_TRACED] = { /* forza.masu, ladder.json 193697804 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7854f, 0.6038f, 0.4477f, 0.3181f, 0.3680f, 0.2792f, 0.1604f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7851f, 0.5959f, 0.4365f, 0.3043f, 0.3871f, 0.2948f, 0.1713f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7934f, 0.6120f, 0.4586f, 0.3335f, 0.3077f, 0.2285f, 0.1223f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7840f, 0.6002f, 0.4424f, 0.3115f, 0.3463f, 0.2563f, 0.1359f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7824f, 0.5907f, 0.4293f, 0.2951f, 0.3450f, 0.2536f, 0.1311f},
    },
    [MASU_SCENE_BOTH_TRACED] = { /* wet_city.masu, ladder.json 434990834 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.8622f, 0.6557f, 0.5690f, 0.4013f, 0.3046f, 0.1930f, 0.1484f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.8715f, 0.6640f, 0.5768f, 0.4087f, 0.3067f, 0.1950f, 0.1521f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.8549f, 0.6489f, 0.5607f, 0.3932f, 0.3019f, 0.1573f, 0.1166f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.8617f, 0.6529f, 0.5652f, 0.3972f, 0.3027f, 0.1600f, 0.1193f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.8454f, 0.6369f, 0.5495f, 0.3802f, 0.2974f, 0.1643f, 0.1210f},
    },
};

#endif
