/* ladder_devices.h: what the rungs of ladder_tables.h cost on classes of GPUs, beside the first; part of ladder.c.
 * COMPUTED by the model sheet of the instructions that the GPUs' own compilers make (docs/design/33-model.md), not
 * measured on any of them. Written by `make ladder-devices`: not to be edited. */
/* clang-format off */
#ifndef MASU_LADDER_DEVICES_H
#define MASU_LADDER_DEVICES_H

static const float computed[MASU_SCENE_CLASSES][MASU_DEVICE_CLASSES][MASU_MAX_RUNGS] = {
    [MASU_SCENE_POLYGONS] = { /* textures.masu */
        [MASU_DEVICE_XE80] = {1.0000f, 0.9804f, 0.7929f, 0.7106f, 0.6367f, 0.5253f},
        [MASU_DEVICE_UHD620] = {1.0000f, 1.0084f, 0.8203f, 0.7378f, 0.6636f, 0.5565f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.9491f, 0.7617f, 0.6794f, 0.6055f, 0.3723f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.9679f, 0.7808f, 0.6987f, 0.6249f, 0.3808f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.9067f, 0.7184f, 0.6358f, 0.5615f, 0.3845f},
    },
    [MASU_SCENE_SDF] = { /* city_shadows.masu */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7787f, 0.5769f, 0.4043f, 0.3310f, 0.2653f, 0.2062f, 0.1724f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7804f, 0.5787f, 0.4062f, 0.3329f, 0.2672f, 0.2081f, 0.1740f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7794f, 0.5776f, 0.4052f, 0.3313f, 0.2661f, 0.2067f, 0.1685f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7794f, 0.5777f, 0.4053f, 0.3313f, 0.2662f, 0.2067f, 0.1683f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7746f, 0.5730f, 0.4006f, 0.3269f, 0.2616f, 0.2022f, 0.1675f},
    },
    [MASU_SCENE_BOTH] = { /* engine.masu */
        [MASU_DEVICE_XE80] = {1.0000f, 0.9258f, 0.8495f, 0.7509f, 0.6173f, 0.4459f, 0.3739f, 0.2813f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.9247f, 0.8474f, 0.7518f, 0.6191f, 0.4476f, 0.3755f, 0.2819f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.9270f, 0.8520f, 0.7394f, 0.6154f, 0.4442f, 0.3722f, 0.2806f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.9251f, 0.8481f, 0.7380f, 0.6165f, 0.4451f, 0.3731f, 0.2818f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.9246f, 0.8471f, 0.7391f, 0.6100f, 0.4385f, 0.3663f, 0.2797f},
    },
    [MASU_SCENE_POLYGONS_TRACED] = { /* mirrors.masu */
        [MASU_DEVICE_XE80] = {1.0000f, 0.8982f, 0.9246f, 0.3903f, 0.3279f, 0.2431f, 0.1618f, 0.0754f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.8982f, 0.9273f, 0.3913f, 0.3284f, 0.2434f, 0.1623f, 0.0765f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.8934f, 0.9200f, 0.3794f, 0.3171f, 0.2323f, 0.1459f, 0.0592f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.8809f, 0.9127f, 0.3712f, 0.3096f, 0.2261f, 0.1375f, 0.0570f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.8793f, 0.9201f, 0.3539f, 0.2914f, 0.2072f, 0.1109f, 0.0463f},
    },
    [MASU_SCENE_WORLD_TRACED] = { /* forza.masu */
        [MASU_DEVICE_XE80] = {1.0000f, 0.6529f, 0.5692f, 0.4383f, 0.2374f, 0.1799f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.6528f, 0.5780f, 0.4466f, 0.2453f, 0.1876f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.6236f, 0.5206f, 0.3960f, 0.2044f, 0.1496f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.6339f, 0.5293f, 0.4022f, 0.2070f, 0.1510f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.6154f, 0.5125f, 0.3882f, 0.1973f, 0.1426f},
    },
    [MASU_SCENE_BOTH_TRACED] = { /* wet_city.masu */
        [MASU_DEVICE_XE80] = {1.0000f, 0.8186f, 0.6187f, 0.5334f, 0.3683f, 0.3024f, 0.2218f, 0.1564f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.8229f, 0.6227f, 0.5374f, 0.3718f, 0.3059f, 0.2241f, 0.1589f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.8173f, 0.6168f, 0.5306f, 0.3656f, 0.2996f, 0.2001f, 0.1385f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.8188f, 0.6181f, 0.5321f, 0.3667f, 0.3006f, 0.2026f, 0.1403f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.8096f, 0.6089f, 0.5234f, 0.3574f, 0.2914f, 0.2101f, 0.1445f},
    },
};

#endif
