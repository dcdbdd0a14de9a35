/* ladder_devices.h: what the rungs of ladder_tables.h cost on classes of GPUs, relative to the
 * first rung; part of ladder.c. COMPUTED by the cost model from the instructions that the GPUs'
 * own compilers emit (masu-lab model --isa), not measured on any of them. Written by `make
 * ladder-devices`: not to be edited. */
/* clang-format off */
#ifndef MASU_LADDER_DEVICES_H
#define MASU_LADDER_DEVICES_H

static const float computed[MASU_SCENE_CLASSES][MASU_DEVICE_CLASSES][MASU_MAX_RUNGS] = {
    [MASU_SCENE_POLYGONS] = { /* textures.masu, ladder.json 171153736 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.8064f, 0.6388f, 0.4968f, 0.3457f, 0.3064f, 0.2756f, 0.2486f, 0.2391f, 0.2261f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.8038f, 0.6338f, 0.4899f, 0.3400f, 0.2969f, 0.2657f, 0.2386f, 0.2287f, 0.2155f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7954f, 0.6181f, 0.4680f, 0.3453f, 0.2668f, 0.2341f, 0.2057f, 0.1956f, 0.1818f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.8059f, 0.6293f, 0.4798f, 0.3371f, 0.2793f, 0.2468f, 0.2184f, 0.2084f, 0.1947f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7997f, 0.6261f, 0.4792f, 0.3454f, 0.2822f, 0.2502f, 0.2224f, 0.2125f, 0.1990f},
    },
    [MASU_SCENE_SDF] = { /* city_shadows.masu, ladder.json 4262586788 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7699f, 0.5724f, 0.4041f, 0.2634f, 0.1809f, 0.1440f, 0.1132f, 0.0867f, 0.0728f, 0.0642f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7698f, 0.5722f, 0.4038f, 0.2631f, 0.1805f, 0.1437f, 0.1128f, 0.0863f, 0.0724f, 0.0639f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7694f, 0.5715f, 0.4028f, 0.2663f, 0.1791f, 0.1422f, 0.1113f, 0.0847f, 0.0708f, 0.0623f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7700f, 0.5715f, 0.4023f, 0.2627f, 0.1780f, 0.1409f, 0.1099f, 0.0833f, 0.0693f, 0.0607f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7677f, 0.5685f, 0.3987f, 0.2600f, 0.1737f, 0.1365f, 0.1054f, 0.0788f, 0.0648f, 0.0561f},
    },
    [MASU_SCENE_BOTH] = { /* engine.masu, ladder.json 1585820934 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7915f, 0.5983f, 0.4360f, 0.2963f, 0.2177f, 0.1810f, 0.1480f, 0.1222f, 0.1072f, 0.0980f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7912f, 0.5980f, 0.4357f, 0.2957f, 0.2174f, 0.1808f, 0.1479f, 0.1221f, 0.1071f, 0.0980f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7887f, 0.5944f, 0.4311f, 0.3009f, 0.2116f, 0.1749f, 0.1419f, 0.1160f, 0.1010f, 0.0920f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7920f, 0.5966f, 0.4324f, 0.2950f, 0.2116f, 0.1745f, 0.1412f, 0.1160f, 0.1011f, 0.0920f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7886f, 0.5917f, 0.4266f, 0.2918f, 0.2042f, 0.1667f, 0.1331f, 0.1068f, 0.0916f, 0.0822f},
    },
    [MASU_SCENE_POLYGONS_TRACED] = { /* mirrors.masu, ladder.json 1097263507 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7828f, 0.5936f, 0.4376f, 0.2947f, 0.2244f, 0.1895f, 0.1593f, 0.1482f, 0.1336f, 0.1205f, 0.1087f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7827f, 0.5919f, 0.4328f, 0.2884f, 0.2170f, 0.1821f, 0.1519f, 0.1407f, 0.1263f, 0.1133f, 0.1024f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7830f, 0.5919f, 0.4323f, 0.2995f, 0.2134f, 0.1773f, 0.1464f, 0.1349f, 0.1198f, 0.1062f, 0.0931f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7831f, 0.5893f, 0.4261f, 0.2888f, 0.2110f, 0.1755f, 0.1449f, 0.1335f, 0.1187f, 0.1054f, 0.0934f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7789f, 0.5845f, 0.4227f, 0.2843f, 0.2030f, 0.1675f, 0.1370f, 0.1256f, 0.1108f, 0.0975f, 0.0867f},
    },
    [MASU_SCENE_BOTH_TRACED] = { /* wet_city.masu, ladder.json 2154761971 */
        [MASU_DEVICE_XE80] = {1.0000f, 0.7932f, 0.6044f, 0.4434f, 0.2981f, 0.2235f, 0.1870f, 0.1557f, 0.1432f, 0.1290f, 0.1131f, 0.1033f},
        [MASU_DEVICE_UHD620] = {1.0000f, 0.7925f, 0.6034f, 0.4425f, 0.2970f, 0.2221f, 0.1856f, 0.1542f, 0.1420f, 0.1277f, 0.1120f, 0.1022f},
        [MASU_DEVICE_VEGA8] = {1.0000f, 0.7886f, 0.5982f, 0.4348f, 0.2984f, 0.2112f, 0.1745f, 0.1423f, 0.1302f, 0.1157f, 0.0999f, 0.0904f},
        [MASU_DEVICE_DECK] = {1.0000f, 0.7910f, 0.5989f, 0.4355f, 0.2923f, 0.2116f, 0.1749f, 0.1430f, 0.1307f, 0.1162f, 0.1004f, 0.0906f},
        [MASU_DEVICE_MOBILE] = {1.0000f, 0.7897f, 0.5974f, 0.4336f, 0.2929f, 0.2089f, 0.1716f, 0.1397f, 0.1271f, 0.1125f, 0.0964f, 0.0864f},
    },
};

#endif
