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
        [MASU_DEVICE_XE80] = {1.0000f, 0.7788f, 0.5771f, 0.4046f, 0.3288f, 0.2656f, 0.2048f, 0.1712f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7805f, 0.5789f, 0.4065f, 0.3307f, 0.2675f, 0.2067f, 0.1729f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7794f, 0.5777f, 0.4053f, 0.3285f, 0.2664f, 0.2050f, 0.1671f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7794f, 0.5778f, 0.4055f, 0.3285f, 0.2665f, 0.2050f, 0.1669f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7747f, 0.5733f, 0.4010f, 0.3245f, 0.2621f, 0.2006f, 0.1662f},
    },
    [MASU_SCENE_BOTH] = { /* engine.masu, ladder.json 2986949055 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.9262f, 0.8503f, 0.7516f, 0.6174f, 0.4460f, 0.3739f, 0.2813f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.9254f, 0.8487f, 0.7522f, 0.6188f, 0.4473f, 0.3751f, 0.2817f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.9270f, 0.8520f, 0.7394f, 0.6154f, 0.4442f, 0.3722f, 0.2806f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.9255f, 0.8490f, 0.7388f, 0.6165f, 0.4451f, 0.3730f, 0.2818f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.9255f, 0.8490f, 0.7399f, 0.6097f, 0.4381f, 0.3659f, 0.2795f},
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
        [MASU_DEVICE_XE80] = {1.0000f, 0.8224f, 0.6226f, 0.5377f, 0.3716f, 0.3058f, 0.2112f, 0.1504f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.8264f, 0.6263f, 0.5414f, 0.3750f, 0.3090f, 0.2137f, 0.1530f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.8204f, 0.6201f, 0.5342f, 0.3685f, 0.3025f, 0.1888f, 0.1319f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.8223f, 0.6217f, 0.5360f, 0.3697f, 0.3036f, 0.1915f, 0.1338f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.8128f, 0.6123f, 0.5271f, 0.3602f, 0.2941f, 0.1977f, 0.1372f},
    },
};

#endif
