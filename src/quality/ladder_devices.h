/* ladder_devices.h: what the rungs of ladder_tables.h cost on classes of GPUs, beside the first; part of ladder.c.
 * COMPUTED by the model sheet of the instructions that the GPUs' own compilers make (docs/design/33-model.md), not
 * measured on any of them. Written by `make ladder-devices`: not to be edited. */
/* clang-format off */
#ifndef MASU_LADDER_DEVICES_H
#define MASU_LADDER_DEVICES_H

static const float computed[MASU_SCENE_CLASSES][MASU_DEVICE_CLASSES][MASU_MAX_RUNGS] = {
    [MASU_SCENE_POLYGONS] = { /* textures.masu, ladder.json 4117717435 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.9705f, 0.7819f, 0.6990f, 0.6246f, 0.5103f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.9863f, 0.7976f, 0.7147f, 0.6403f, 0.5292f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.9491f, 0.7617f, 0.6794f, 0.6055f, 0.3723f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.9574f, 0.7691f, 0.6865f, 0.6123f, 0.3713f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.8873f, 0.6983f, 0.6153f, 0.5408f, 0.3649f},
    },
    [MASU_SCENE_SDF] = { /* city_shadows.masu, ladder.json 2377161052 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7864f, 0.5864f, 0.4130f, 0.3350f, 0.2744f, 0.2115f, 0.1775f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7899f, 0.5899f, 0.4166f, 0.3382f, 0.2779f, 0.2148f, 0.1804f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7875f, 0.5875f, 0.4142f, 0.3343f, 0.2755f, 0.2115f, 0.1709f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7878f, 0.5878f, 0.4145f, 0.3342f, 0.2758f, 0.2116f, 0.1705f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7777f, 0.5778f, 0.4045f, 0.3263f, 0.2658f, 0.2027f, 0.1680f},
    },
    [MASU_SCENE_BOTH] = { /* engine.masu, ladder.json 2986949055 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.9365f, 0.8785f, 0.7878f, 0.6529f, 0.4793f, 0.4087f, 0.2944f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.9369f, 0.8793f, 0.7981f, 0.6645f, 0.4908f, 0.4200f, 0.2982f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.9392f, 0.8838f, 0.7688f, 0.6540f, 0.4808f, 0.4104f, 0.2947f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.9369f, 0.8793f, 0.7687f, 0.6580f, 0.4843f, 0.4137f, 0.2977f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.9335f, 0.8728f, 0.7572f, 0.6274f, 0.4535f, 0.3828f, 0.2869f},
    },
    [MASU_SCENE_POLYGONS_TRACED] = { /* mirrors.masu, ladder.json 3870411933 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.8979f, 0.9240f, 0.3895f, 0.3271f, 0.2422f, 0.1600f, 0.0746f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.8990f, 0.9277f, 0.3902f, 0.3272f, 0.2422f, 0.1626f, 0.0762f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.8934f, 0.9200f, 0.3794f, 0.3171f, 0.2323f, 0.1373f, 0.0568f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.8810f, 0.9125f, 0.3707f, 0.3090f, 0.2254f, 0.1372f, 0.0567f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.8806f, 0.9207f, 0.3533f, 0.2907f, 0.2064f, 0.1143f, 0.0471f},
    },
    [MASU_SCENE_WORLD_TRACED] = { /* forza.masu, ladder.json 268414473 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.6486f, 0.5663f, 0.4360f, 0.2361f, 0.1788f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.6534f, 0.5779f, 0.4463f, 0.2444f, 0.1866f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.6119f, 0.5117f, 0.3895f, 0.2015f, 0.1478f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.6312f, 0.5277f, 0.4009f, 0.2061f, 0.1503f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.6190f, 0.5152f, 0.3899f, 0.1977f, 0.1425f},
    },
    [MASU_SCENE_BOTH_TRACED] = { /* wet_city.masu, ladder.json 434990834 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.8533f, 0.6468f, 0.5606f, 0.3931f, 0.3257f, 0.1820f, 0.1384f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.8621f, 0.6547f, 0.5682f, 0.4003f, 0.3327f, 0.1854f, 0.1426f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.8480f, 0.6410f, 0.5539f, 0.3871f, 0.3196f, 0.1529f, 0.1125f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.8529f, 0.6452f, 0.5582f, 0.3903f, 0.3226f, 0.1556f, 0.1148f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.8370f, 0.6290f, 0.5425f, 0.3736f, 0.3058f, 0.1586f, 0.1158f},
    },
};

#endif
