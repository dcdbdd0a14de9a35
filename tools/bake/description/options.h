/* options.h: the command line of masu-bake, for its three steps. main.c fills it in; the strings
 * belong to argv. */
#ifndef MASU_BAKE_OPTIONS_H
#define MASU_BAKE_OPTIONS_H

#include "bake/import/import.h"

typedef struct masu_bake_options {
    /* read */
    const char *input;            /* a scene's .json, or a model */
    const char *models_directory; /* what "@assimp/" stands for */
    /* No ground, shadows, occlusion or reflections unless requested. */
    bool bare;
    double turn;         /* degrees, added to the environment map's own */
    const char *variant; /* of the materials of a lone model; NULL: the file's own */
    /* build */
    masu_bake_textures textures; /* WANTED or OFF */
    const char *texture_path;    /* folders with ':' between, or NULL */
    bool variants;               /* with the baseline marches of the lab build */
    bool probes, probe_report;   /* even if the scene has none; compared with path tracing */
    uint32_t threads;            /* that trace probes; 0: all processors */
    bool strict; /* warnings are errors */
    bool describe; /* prints the scene description of the input and stops */
    /* write */
    const char *output; /* the blob, or the description; NULL: no blob, the description to stdout */
    const char *stats;  /* or NULL */
} masu_bake_options;

#endif
