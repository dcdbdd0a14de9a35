/* ladder_devices.h: what the rungs of ladder_tables.h cost on classes of GPUs, relative to the first rung; part of
 * ladder.c. COMPUTED by the cost model from the instructions that the GPUs' own compilers emit (masu-lab model
 * --isa), not measured on any of them. Written by `make ladder-devices`: not to be edited. */
/* clang-format off */
#ifndef MASU_LADDER_DEVICES_H
#define MASU_LADDER_DEVICES_H

static const float computed[MASU_SCENE_CLASSES][MASU_DEVICE_CLASSES][MASU_MAX_RUNGS] = {
    [MASU_SCENE_POLYGONS] = { /* textures.masu, ladder.json 487624802 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.8058f, 0.6370f, 0.4945f, 0.3442f, 0.3032f, 0.2323f, 0.2806f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.8032f, 0.6322f, 0.4878f, 0.3381f, 0.2943f, 0.2431f, 0.2967f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7952f, 0.6173f, 0.4670f, 0.3442f, 0.2654f, 0.2014f, 0.2359f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.8057f, 0.6284f, 0.4787f, 0.3366f, 0.2777f, 0.2552f, 0.2947f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7988f, 0.6238f, 0.4761f, 0.3426f, 0.2778f, 0.2438f, 0.2576f},
    },
    [MASU_SCENE_SDF] = { /* city_shadows.masu, ladder.json 1859136946 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7698f, 0.5738f, 0.4036f, 0.2640f, 0.1818f, 0.1765f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7696f, 0.5735f, 0.4032f, 0.2636f, 0.1813f, 0.1790f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7692f, 0.5728f, 0.4023f, 0.2668f, 0.1799f, 0.1732f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7698f, 0.5728f, 0.4017f, 0.2632f, 0.1787f, 0.1786f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7675f, 0.5698f, 0.3980f, 0.2605f, 0.1744f, 0.1707f},
    },
    [MASU_SCENE_BOTH] = { /* engine.masu, ladder.json 2153595100 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7845f, 0.6016f, 0.4399f, 0.2969f, 0.2173f, 0.2171f, 0.1830f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7843f, 0.6010f, 0.4386f, 0.2961f, 0.2166f, 0.2217f, 0.1887f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7824f, 0.5972f, 0.4337f, 0.3011f, 0.2110f, 0.2070f, 0.1578f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7851f, 0.5997f, 0.4354f, 0.2955f, 0.2109f, 0.2220f, 0.1676f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7809f, 0.5949f, 0.4295f, 0.2919f, 0.2032f, 0.2029f, 0.1622f},
    },
    [MASU_SCENE_POLYGONS_TRACED] = { /* mirrors.masu, ladder.json 4132835036 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7828f, 0.5906f, 0.4351f, 0.2933f, 0.2394f, 0.1887f, 0.0881f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7825f, 0.5918f, 0.4320f, 0.2880f, 0.2433f, 0.1953f, 0.0916f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7831f, 0.5924f, 0.4324f, 0.3000f, 0.2293f, 0.1601f, 0.0663f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7831f, 0.5898f, 0.4262f, 0.2876f, 0.2475f, 0.1753f, 0.0725f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7787f, 0.5845f, 0.4219f, 0.2838f, 0.2264f, 0.1540f, 0.0629f},
    },
    [MASU_SCENE_WORLD_TRACED] = { /* forza.masu, ladder.json 2002020833 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7863f, 0.5997f, 0.4407f, 0.2977f, 0.3732f, 0.2831f, 0.1626f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7842f, 0.5956f, 0.4352f, 0.2914f, 0.3873f, 0.2949f, 0.1715f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7858f, 0.5989f, 0.4394f, 0.3094f, 0.3188f, 0.2367f, 0.1267f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7862f, 0.5964f, 0.4346f, 0.2942f, 0.3528f, 0.2612f, 0.1385f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7807f, 0.5889f, 0.4257f, 0.2866f, 0.3461f, 0.2544f, 0.1315f},
    },
    [MASU_SCENE_BOTH_TRACED] = { /* wet_city.masu, ladder.json 2470204372 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7946f, 0.6045f, 0.4449f, 0.2985f, 0.2227f, 0.1817f, 0.1397f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7940f, 0.6034f, 0.4438f, 0.2972f, 0.2211f, 0.1839f, 0.1434f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7904f, 0.5983f, 0.4360f, 0.2988f, 0.2106f, 0.1450f, 0.1075f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7930f, 0.5989f, 0.4368f, 0.2930f, 0.2108f, 0.1560f, 0.1163f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7910f, 0.5968f, 0.4344f, 0.2926f, 0.2073f, 0.1615f, 0.1189f},
    },
};

#endif
