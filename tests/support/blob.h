/* blob.h: small valid scene blobs in memory, for tests that damage them.
 *
 * A blob is written with every field in range; a test finds a section, changes what it likes in
 * place, seals the blob again (length and hash) and hands it to the reader. The blobs are laid out
 * as blob.h says: sections in rising kind, 16-byte aligned, gaps zero; nothing follows the last.
 *
 * Full content (SUPPORT_RASTER | SUPPORT_SDF):
 *
 *   vertices   0-3 square   4-6 triangle   7-10 square          materials    0 "steel"  1 "glow"
 *   primitives 0: square, 2 triangles  1: triangle  2: square   camera keys  at 0 s, 1.5 s, 4 s
 *   meshes     0 "plate": primitives 0-1   1 "lid": primitive 2 sdf params   0 "radius"  1 "bend"
 *   instances  0, 1 of mesh 0, 2 of mesh 1                      slots        three; parts: one
 *   groups     0: instance 0 and group 1  1: instance 1; instance 2 is in none
 *   occluders  one in each mesh: three are placed
 *   textures   0: BC3, 8 x 8, 4 mips, 2 layers   1: BC5, 6 x 3, 3 mips   2: BC1, 4 x 4, 1 mip
 *   sets       0: base 0, normal 1, surface 1    1: emissive 2
 *
 *   meso       one, of no material                lights  0 point "glow"  1 spot, carried by instance 1
 *   probes     2 x 1 x 1, sets 0 and 1            environment map: 8 texels, 2 mips
 *
 *   trees      nodes 0, 1: mesh 0, depth 2: 0 has node 1 and triangle 0, 1 has triangles 1 and 2 in one leaf
 *              node 2: mesh 1: a leaf of one triangle       traced: instances 1 and 2
 *
 *   models     0: instance 0   1: instance 1, hidden, of the kind of 0   2 "lid": a node "bend" without an
 *              instance, and below it "lid" with instance 2
 *
 *   skin       of mesh 1, shown by node 3: joints 0 "bend" (node 0 of model 2) and 1 "lid" (node 1)
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
    SUPPORT_VARIANTS = 8, /* with an SDF: the code that a blob may have or lack */
    SUPPORT_SHADOW = 16, /* the sun's shadow map */
    SUPPORT_ALL = 31,
    SUPPORT_TEXTURES = 32, /* with SUPPORT_RASTER: "steel" has maps, and is a mask */
    SUPPORT_DETAIL = 64, /* with SUPPORT_RASTER: a LOD. Not part of SUPPORT_ALL, nor is the next */
    SUPPORT_TRACE = 256, /* with SUPPORT_RASTER: trees for rays. Not part of SUPPORT_ALL */
    SUPPORT_LIVE = 512, /* with SUPPORT_RASTER: models that move. Not part of SUPPORT_ALL */
    SUPPORT_SKIN = 1024, /* with SUPPORT_LIVE, without SUPPORT_DETAIL: mesh 1 bends, and has no occluder */
    SUPPORT_TRACE_MORE = 4096, /* with SUPPORT_TRACE: rays sample textures, with SUPPORT_TEXTURES; they hit the SDF, with SUPPORT_SDF */
    SUPPORT_LONG_NAME = 2048, /* names are "", one of 255 bytes, "x" */
    SUPPORT_ATTRIBUTES = 8192, /* with SUPPORT_TEXTURES: colours of vertices, second texture coordinates */
    SUPPORT_MORPH = 16384, /* with SUPPORT_SKIN: it has two morph targets */
    SUPPORT_LIGHTING = 128 /* with SUPPORT_RASTER: a small relief, lights, probes, a sky from a picture */
};

#define SUPPORT_BLOB_ROOM 16384u

typedef struct support_blob {
    _Alignas(64) unsigned char bytes[SUPPORT_BLOB_ROOM];
    size_t size;
} support_blob;

/* Writes a valid blob of those parts; the environment is always there. */
void support_blob_write(support_blob *blob, uint32_t parts);

/* Row of the section table, or NULL. */
masu_blob_section *support_blob_row(support_blob *blob, enum masu_blob_kind kind);

/* First element of a section; there must be one. */
void *support_blob_find(support_blob *blob, enum masu_blob_kind kind);

/* Writes the blob again without a section. Does not seal. */
void support_blob_drop(support_blob *blob, enum masu_blob_kind kind);

/* What the modules say that they were compiled for made to fit the rest of the blob. Does not seal. */
void support_blob_recode(support_blob *blob);

/* Header.bytes and header.hash made to fit `size` bytes. */
void support_blob_seal(unsigned char *bytes, size_t size);

#endif
