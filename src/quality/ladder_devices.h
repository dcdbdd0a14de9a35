/* ladder_devices.h: what the rungs of ladder_tables.h cost on classes of GPUs, beside the first; part of ladder.c.
 * COMPUTED by the model sheet of the instructions that the GPUs' own compilers make (docs/design/33-model.md), not
 * measured on any of them. Written by `make ladder-devices`: not to be edited. */
/* clang-format off */
#ifndef MASU_LADDER_DEVICES_H
#define MASU_LADDER_DEVICES_H

static const float computed[MASU_SCENE_CLASSES][MASU_DEVICE_CLASSES][MASU_MAX_RUNGS] = {
    [MASU_SCENE_POLYGONS] = { /* textures.masu, ladder.json 3662553962 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.8020f, 0.6500f, 0.5137f, 0.4019f, 0.3302f, 0.2699f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.8050f, 0.6353f, 0.4924f, 0.3752f, 0.3001f, 0.2960f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.8139f, 0.6522f, 0.5158f, 0.4040f, 0.3324f, 0.2146f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7979f, 0.6407f, 0.5003f, 0.3853f, 0.3115f, 0.2784f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.8035f, 0.6325f, 0.4885f, 0.3704f, 0.2947f, 0.2557f},
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
    [MASU_SCENE_POLYGONS_TRACED] = { /* mirrors.masu, ladder.json 3870411933 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.8920f, 0.9249f, 0.3806f, 0.2791f, 0.2348f, 0.1722f, 0.0806f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.8930f, 0.9288f, 0.3819f, 0.2760f, 0.2347f, 0.1767f, 0.0828f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.8870f, 0.9213f, 0.3794f, 0.2860f, 0.2329f, 0.1483f, 0.0614f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.8738f, 0.9135f, 0.3659f, 0.2703f, 0.2216f, 0.1487f, 0.0615f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.8719f, 0.9211f, 0.3471f, 0.2622f, 0.2009f, 0.1285f, 0.0525f},
    },
    [MASU_SCENE_WORLD_TRACED] = { /* forza.masu, ladder.json 268414473 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.6470f, 0.5831f, 0.4533f, 0.2546f, 0.1977f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.6597f, 0.6020f, 0.4691f, 0.2659f, 0.2078f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.6166f, 0.5255f, 0.4026f, 0.2140f, 0.1601f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.6425f, 0.5476f, 0.4186f, 0.2210f, 0.1643f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.6278f, 0.5314f, 0.4043f, 0.2096f, 0.1537f},
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
