/* blob.h: small valid scene blobs in memory, for tests that damage them.
 *
 * A blob is written with every field in range. A test finds a section, changes it directly, seals
 * the blob again (length and hash) and passes it to the reader. The layout is that in
 * src/scene/blob.h: sections by rising kind, aligned to 16 bytes, zeros in the gaps, nothing after
 * the last section.
 *
 * Full content (SUPPORT_RASTER | SUPPORT_SDF):
 *
 *   vertices   0-3 square   4-6 triangle   7-10 square          materials    0 "steel"  1 "glow"
 *   primitives 0: square, 2 triangles  1: triangle  2: square   camera keys  at 0 s, 1.5 s, 4 s
 *   meshes     0 "plate": primitives 0-1   1 "lid": primitive 2 sdf params   0 "radius"  1 "bend"
 *   instances  0, 1 of mesh 0, 2 of mesh 1                      slots        three; parts: one
 *   groups     0: instance 0 and group 1  1: instance 1; instance 2 is in none
 *   occluders  one in each mesh: three in the scene
 *   textures   0: BC3, 8 x 8, 4 mips, 2 layers   1: BC5, 6 x 3, 3 mips   2: BC1, 4 x 4, 1 mip
 *   sets       0: base 0, normal 1, surface 1    1: emissive 2
 *
 *   meso       one, used by no material          lights  0 point "glow"  1 spot, on instance 1
 *   probes     2 x 1 x 1, sets 0 and 1           environment map: 8 texels, 2 mips
 *
 *   BVHs       nodes 0, 1: mesh 0, depth 2: 0 has node 1 and triangle 0,
 *              1 has triangles 1 and 2 in one leaf
 *              node 2: mesh 1: a leaf of one triangle       traced: instances 1 and 2
 *
 *   models     0: instance 0   1: instance 1, hidden, a copy of 0   2 "lid": a node "bend" without
 *              an instance, and its child "lid" with instance 2
 *
 *   skin       of mesh 1, at node 3: joints 0 "bend" (node 0 of model 2) and 1 "lid" (node 1)
 *   clips      of model 2: 0 "bend", 2 s: channels 0, 1 (linear)   1 "glow", 0.5 s: channel 2 (a step)
 *
 * SUPPORT_DETAIL adds primitive 3, a triangle of the last square: the LOD of mesh 1. */
#ifndef SUPPORT_BLOB_H
#define SUPPORT_BLOB_H

#include <stddef.h>
#include <stdint.h>

#include "scene/blob.h"

enum {
    SUPPORT_RASTER = 1, /* geometry, instances, materials */
    SUPPORT_SDF = 2,    /* field, parameters, slots, code */
    SUPPORT_CAMERA = 4,
    SUPPORT_VARIANTS = 8, /* with an SDF: the optional code */
    SUPPORT_SHADOW = 16, /* the sun's shadow map */
    SUPPORT_ALL = 31,
    SUPPORT_TEXTURES = 32, /* with SUPPORT_RASTER: "steel" has textures and is alpha-tested */
    SUPPORT_DETAIL = 64, /* with SUPPORT_RASTER: a LOD. Not in SUPPORT_ALL, like the next ones */
    SUPPORT_TRACE = 256, /* with SUPPORT_RASTER: BVHs for rays. Not in SUPPORT_ALL */
    SUPPORT_LIVE = 512, /* with SUPPORT_RASTER: movable models. Not in SUPPORT_ALL */
    SUPPORT_SKIN = 1024, /* with SUPPORT_LIVE, without SUPPORT_DETAIL: mesh 1 is skinned, no
                            occluder */
    SUPPORT_TRACE_MORE = 4096, /* with SUPPORT_TRACE: rays sample textures (SUPPORT_TEXTURES) and
                                  hit the SDF (SUPPORT_SDF) */
    SUPPORT_LONG_NAME = 2048, /* names are "", one of 255 bytes, "x" */
    SUPPORT_ATTRIBUTES = 8192, /* with SUPPORT_TEXTURES: vertex colours, second texture
                                  coordinates */
    SUPPORT_MORPH = 16384, /* with SUPPORT_SKIN: the skin has two morph targets */
    SUPPORT_LIGHTING = 128 /* with SUPPORT_RASTER: mesoscale detail, lights, probes, an environment
                              map */
};

#define SUPPORT_BLOB_ROOM 16384u

typedef struct support_blob {
    _Alignas(64) unsigned char bytes[SUPPORT_BLOB_ROOM];
    size_t size;
} support_blob;

/* Writes a valid blob with these parts, always with an environment. */
void support_blob_write(support_blob *blob, uint32_t parts);

/* Row of the section table, or NULL. */
masu_blob_section *support_blob_row(support_blob *blob, enum masu_blob_kind kind);

/* First element of a section; there must be one. */
void *support_blob_find(support_blob *blob, enum masu_blob_kind kind);

/* Writes the blob again without a section. Does not seal. */
void support_blob_drop(support_blob *blob, enum masu_blob_kind kind);

/* Updates the compilation records of the shader modules to match the rest of the blob. Does not
 * seal. */
void support_blob_recode(support_blob *blob);

/* Sets header.bytes and header.hash for `size` bytes. */
void support_blob_seal(unsigned char *bytes, size_t size);

#endif
