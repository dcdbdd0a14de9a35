/* ladder_devices.h: what the rungs of ladder_tables.h cost on classes of GPUs, beside the first; part of ladder.c.
 * COMPUTED by the model sheet of the instructions that the GPUs' own compilers make (docs/design/33-model.md), not
 * measured on any of them. Written by `make ladder-devices`: not to be edited. */
/* clang-format off */
#ifndef MASU_LADDER_DEVICES_H
#define MASU_LADDER_DEVICES_H

static const float computed[MASU_SCENE_CLASSES][MASU_DEVICE_CLASSES][MASU_MAX_RUNGS] = {
    [MASU_SCENE_POLYGONS] = { /* textures.masu, ladder.json 3498025246 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.8058f, 0.6370f, 0.4946f, 0.3442f, 0.3032f, 0.2323f, 0.2806f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.8033f, 0.6321f, 0.4879f, 0.3381f, 0.2939f, 0.2431f, 0.2967f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7952f, 0.6173f, 0.4671f, 0.3442f, 0.2654f, 0.2014f, 0.2359f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.8057f, 0.6283f, 0.4788f, 0.3366f, 0.2778f, 0.2552f, 0.2947f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7988f, 0.6238f, 0.4763f, 0.3426f, 0.2779f, 0.2438f, 0.2576f},
    },
    [MASU_SCENE_SDF] = { /* city_shadows.masu, ladder.json 2122705926 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7703f, 0.5733f, 0.4042f, 0.2640f, 0.1813f, 0.1765f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7701f, 0.5730f, 0.4038f, 0.2636f, 0.1808f, 0.1790f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7697f, 0.5723f, 0.4028f, 0.2668f, 0.1794f, 0.1732f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7704f, 0.5723f, 0.4023f, 0.2632f, 0.1782f, 0.1786f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7681f, 0.5693f, 0.3986f, 0.2605f, 0.1739f, 0.1707f},
    },
    [MASU_SCENE_BOTH] = { /* engine.masu, ladder.json 14503325 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7935f, 0.5988f, 0.4384f, 0.2969f, 0.2195f, 0.2171f, 0.1830f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7930f, 0.5983f, 0.4371f, 0.2961f, 0.2187f, 0.2217f, 0.1887f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7904f, 0.5948f, 0.4324f, 0.3011f, 0.2129f, 0.2070f, 0.1578f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7940f, 0.5970f, 0.4340f, 0.2955f, 0.2130f, 0.2220f, 0.1676f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7904f, 0.5920f, 0.4279f, 0.2919f, 0.2054f, 0.2029f, 0.1622f},
    },
    [MASU_SCENE_POLYGONS_TRACED] = { /* mirrors.masu, ladder.json 3176203228 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7835f, 0.5925f, 0.4370f, 0.2944f, 0.2406f, 0.1897f, 0.0886f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7827f, 0.5916f, 0.4326f, 0.2882f, 0.2439f, 0.1963f, 0.0921f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7832f, 0.5921f, 0.4327f, 0.3000f, 0.2295f, 0.1605f, 0.0664f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7824f, 0.5895f, 0.4282f, 0.2887f, 0.2488f, 0.1763f, 0.0729f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7788f, 0.5842f, 0.4223f, 0.2840f, 0.2272f, 0.1546f, 0.0631f},
    },
    [MASU_SCENE_WORLD_TRACED] = { /* forza.masu, ladder.json 4142276850 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7865f, 0.5988f, 0.4404f, 0.2976f, 0.3732f, 0.2831f, 0.1626f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7845f, 0.5948f, 0.4349f, 0.2914f, 0.3874f, 0.2950f, 0.1715f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7859f, 0.5980f, 0.4390f, 0.3093f, 0.3189f, 0.2368f, 0.1268f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7863f, 0.5953f, 0.4343f, 0.2942f, 0.3529f, 0.2612f, 0.1385f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7809f, 0.5880f, 0.4255f, 0.2866f, 0.3462f, 0.2545f, 0.1315f},
    },
    [MASU_SCENE_BOTH_TRACED] = { /* wet_city.masu, ladder.json 3287154286 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7953f, 0.6045f, 0.4447f, 0.2990f, 0.2246f, 0.1822f, 0.1401f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7946f, 0.6031f, 0.4430f, 0.2973f, 0.2227f, 0.1844f, 0.1438f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7909f, 0.5979f, 0.4352f, 0.2988f, 0.2118f, 0.1451f, 0.1076f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7936f, 0.5982f, 0.4360f, 0.2932f, 0.2125f, 0.1564f, 0.1166f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7916f, 0.5965f, 0.4334f, 0.2927f, 0.2089f, 0.1617f, 0.1191f},
    },
};

#endif
