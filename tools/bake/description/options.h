/* options.h: what the command line asks of masu-bake, for its three steps. main.c fills it in; the
 * texts are the command line's own. */
#ifndef MASU_BAKE_OPTIONS_H
#define MASU_BAKE_OPTIONS_H

#include "bake/import/import.h"

typedef struct masu_bake_options {
    /* read */
    const char *input;            /* a scene's .json, or a model */
    const char *models_directory; /* what "@assimp/" stands for */
    /* No ground, shadows, occlusion, reflections that are not asked for. */
    bool bare;
    double turn;         /* degrees, added to the environment map's own */
    const char *variant; /* of the materials of a lone model; NULL: the file's own */
    /* build */
    masu_bake_textures textures; /* WANTED or OFF */
    const char *texture_path;    /* folders with ':' between, or NULL */
    bool variants;               /* with the baseline marches of the lab build */
    bool probes, probe_report;   /* also if the scene asks for none; judged by path tracing */
    uint32_t threads;            /* that trace probes; 0: all processors */
    bool strict; /* warnings are errors */
    bool describe; /* stops at what a scene description of the input says */
    /* write */
    const char *output; /* the blob, or the description; NULL: no blob, the description to stdout */
    const char *stats;  /* or NULL */
} masu_bake_options;

#endif
