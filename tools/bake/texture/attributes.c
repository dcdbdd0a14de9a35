/* attributes.c: see attributes.h. */
#include "bake/texture/attributes.h"

void masu_bake_whiten(masu_bake_content *content) {
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_MATERIALS); i++) {
        masu_bake_maps *maps = &MASU_BAKE_MAPS_OF(content)[i];
        static const unsigned char white[4] = {255, 255, 255, 255};
        const masu_bake_image about = {.raw_width = 1, .raw_height = 1, .data_bytes = sizeof white};
        /* the grain is along u */
        bool needs = maps->colored || MASU_BAKE_MATERIALS(content)[i].anisotropy > 0;
        if (!needs || maps->image[MASU_BAKE_BASE] != MASU_BLOB_NONE) continue;
        maps->image[MASU_BAKE_BASE] = masu_bake_add_image(content, "white", &about, white);
    }
}

void masu_bake_finish_attributes(masu_bake_content *content) {
    bool colored = false, second = false;
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_MATERIALS); i++) {
        const masu_blob_material *m = &MASU_BAKE_MATERIALS(content)[i];
        bool maps = (m->flags & MASU_MATERIAL_HAS_MAPS) != 0;
        colored = colored || (maps && MASU_BAKE_MAPS_OF(content)[i].colored);
        second = second || m->more_layers >> 16;
    }
    masu_bake_pad_attributes(content);
    if (!colored) masu_bake_release(&content->section[MASU_BLOB_COLORS]);
    if (!second) masu_bake_release(&content->section[MASU_BLOB_TEXCOORDS_1]);
}
