/* ladder_devices.h: what the rungs of ladder_tables.h cost on classes of GPUs, beside the first; part of ladder.c.
 * COMPUTED by the model sheet of the instructions that the GPUs' own compilers make (docs/design/33-model.md), not
 * measured on any of them. Written by `make ladder-devices`: not to be edited. */
/* clang-format off */
#ifndef MASU_LADDER_DEVICES_H
#define MASU_LADDER_DEVICES_H

static const float computed[MASU_SCENE_CLASSES][MASU_DEVICE_CLASSES][MASU_MAX_RUNGS] = {
    [MASU_SCENE_POLYGONS] = { /* textures.masu */
        [MASU_DEVICE_XE80] = {1.0000f, 0.9606f, 0.7732f, 0.6909f, 0.6171f, 0.5066f},
        [MASU_DEVICE_UHD620] = {1.0000f, 1.0244f, 0.8370f, 0.7548f, 0.6809f, 0.5815f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.8945f, 0.7072f, 0.6249f, 0.5511f, 0.3343f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.9536f, 0.7667f, 0.6846f, 0.6109f, 0.3734f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.9128f, 0.7254f, 0.6432f, 0.5693f, 0.3948f},
    },
    [MASU_SCENE_SDF] = { /* city_shadows.masu */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7747f, 0.5729f, 0.4003f, 0.3275f, 0.2613f, 0.2025f, 0.1693f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7760f, 0.5743f, 0.4018f, 0.3290f, 0.2628f, 0.2040f, 0.1706f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7752f, 0.5734f, 0.4009f, 0.3275f, 0.2619f, 0.2027f, 0.1665f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7753f, 0.5736f, 0.4011f, 0.3279f, 0.2621f, 0.2030f, 0.1666f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7720f, 0.5704f, 0.3980f, 0.3248f, 0.2589f, 0.1999f, 0.1660f},
    },
    [MASU_SCENE_BOTH] = { /* engine.masu */
        [MASU_DEVICE_XE80] = {1.0000f, 0.9237f, 0.8454f, 0.7406f, 0.6066f, 0.4352f, 0.3633f, 0.2739f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.9220f, 0.8419f, 0.7406f, 0.6081f, 0.4367f, 0.3647f, 0.2743f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.9259f, 0.8499f, 0.7331f, 0.6047f, 0.4334f, 0.3615f, 0.2757f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.9229f, 0.8437f, 0.7312f, 0.6061f, 0.4348f, 0.3628f, 0.2743f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.9215f, 0.8409f, 0.7312f, 0.6017f, 0.4303f, 0.3583f, 0.2734f},
    },
    [MASU_SCENE_POLYGONS_TRACED] = { /* mirrors.masu */
        [MASU_DEVICE_XE80] = {1.0000f, 0.9027f, 0.9339f, 0.4071f, 0.3440f, 0.2587f, 0.1556f, 0.0705f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.8997f, 0.9351f, 0.4037f, 0.3396f, 0.2537f, 0.1468f, 0.0691f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.9033f, 0.9337f, 0.4018f, 0.3384f, 0.2530f, 0.1571f, 0.0602f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.8878f, 0.9258f, 0.3919f, 0.3283f, 0.2441f, 0.1330f, 0.0543f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.8772f, 0.9274f, 0.3612f, 0.2979f, 0.2127f, 0.0958f, 0.0408f},
    },
    [MASU_SCENE_WORLD_TRACED] = { /* forza.masu */
        [MASU_DEVICE_XE80] = {1.0000f, 0.5506f, 0.4794f, 0.3694f, 0.2006f, 0.1522f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.5483f, 0.4840f, 0.3741f, 0.2055f, 0.1572f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.5241f, 0.4364f, 0.3322f, 0.1727f, 0.1266f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.5293f, 0.4410f, 0.3353f, 0.1729f, 0.1263f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.4991f, 0.4166f, 0.3161f, 0.1619f, 0.1177f},
    },
    [MASU_SCENE_BOTH_TRACED] = { /* wet_city.masu */
        [MASU_DEVICE_XE80] = {1.0000f, 0.8117f, 0.6122f, 0.5272f, 0.3615f, 0.2957f, 0.2216f, 0.1544f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.8154f, 0.6155f, 0.5305f, 0.3644f, 0.2986f, 0.2234f, 0.1565f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.8107f, 0.6106f, 0.5246f, 0.3592f, 0.2933f, 0.2022f, 0.1388f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.8127f, 0.6122f, 0.5263f, 0.3604f, 0.2944f, 0.2043f, 0.1404f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.8058f, 0.6054f, 0.5202f, 0.3537f, 0.2878f, 0.2131f, 0.1457f},
    },
};

#endif
