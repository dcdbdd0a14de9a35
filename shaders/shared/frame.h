/* frame.h: uniforms of a frame. */
#ifndef MASU_SHARED_FRAME_H
#define MASU_SHARED_FRAME_H

#include "shared/sdf_limits.h"
#include "shared/types.h"

/* Bits of masu_frame_uniforms.temporal.z, for rung.temporal. Compared with >=: CHANGES is the
 * highest. */
#define MASU_TEMPORAL_MOVES 1u   /* the camera has moved or turned since the last frame */
#define MASU_TEMPORAL_CHANGES 2u /* the scene has changed of late, or the camera has moved */

/* Bits of masu_frame_uniforms.history.w. */
#define MASU_HISTORY_CUT 1u     /* a camera cut: the exposure adapts at once */
#define MASU_HISTORY_NO_FINE 2u /* the last frame wrote no full-resolution reflection history */

struct masu_frame_uniforms {
    masu_mat4 clip_from_rel; /* rel position -> clip; reversed Z, infinite far plane: depth = near /
                                view z */
    masu_vec4 eye_hi;        /* xyz camera position, rounded to float; w time, seconds */
    masu_vec4 eye_lo;        /* xyz camera position - eye_hi; w time step, seconds */
    masu_vec4 right;         /* xyz camera right * tan(fov_x / 2); w tan(fov_x / 2) */
    masu_vec4 up;            /* xyz camera up * tan(fov_y / 2); w tan(fov_y / 2) */
    masu_vec4 forward;       /* xyz unit view direction; w near distance */
    masu_vec4 sun_direction; /* xyz unit vector towards the sun; w exposure (linear factor) */
    masu_vec4 sun_color;     /* rgb irradiance of the sun at normal incidence / pi; w unused */
    masu_vec4 ambient;       /* rgb radiance of the ambient light; of a sky its mean */
    masu_vec4 sky_zenith;    /* rgb radiance straight up; w texels per edge of the sky map */
    masu_vec4 sky_horizon;   /* rgb radiance at and below the horizon; w mips of that map */
    masu_vec4 irradiance[9]; /* SH of irradiance / pi of the ambient light (light/ambient.glsl) */
    masu_vec4 fog;           /* rgb radiance of opaque fog; w density at the fog's height, 1/m */
    masu_vec4 air;           /* x camera height above the fog's; y 1/m of its decrease upwards; z
                                distance where it begins; w not 0: it has its own colour, else
                                the sky's */
    /* SDF space is world space minus the anchor: zero, or a point near the camera that only moves
     * when the camera has moved by MASU_ANCHOR_GRID. */
    masu_vec4 anchor;        /* xyz; w unused */
    masu_vec4 sdf_eye_hi;    /* xyz camera position - anchor, rounded to float; w 8 ulp of its
                                largest component */
    masu_vec4 sdf_eye_lo;    /* xyz remainder; w unused */
    masu_vec4 sdf_min;       /* xyz lower corner of the SDF bounds, SDF space; w 1 / Lipschitz
                                constant */
    masu_vec4 sdf_max;       /* xyz upper corner; w longest ray, world units */
    masu_vec4 sdf_low;       /* xyz both corners, camera-relative, for rays from the camera */
    masu_vec4 sdf_high;
    masu_uvec4 history;      /* x frame number modulo 2^32; yz render size of the last frame, 0: its
                                history is invalid; w MASU_HISTORY_* bits */
    masu_vec4 trace_anchor;  /* xyz origin of traced geometry; w longest ray */
    masu_vec4 trace_eye;     /* xyz camera position - trace_anchor; w unused */
    masu_vec4 jitter;        /* offset in normalised device coordinates: xy of jitter and off-centre
                                projection, zw of jitter only */
    masu_uvec4 temporal;     /* xy render size of the last frame of rung.temporal, 0: no history; z
                                MASU_TEMPORAL_* bits; w pixel to pick: x, and y from bit 16 on */
    masu_vec4 sdf_params[MASU_SDF_PARAM_VEC4S];
    /* Members of rung.temporal. Baked scene shaders read the members above: append new ones. */
    masu_vec4 shifts;        /* render pixels: xy offset of the samples from pixel centres; zw
                                difference of the jitter of both frames, which velocities must not
                                include */
    /* Output of twice the render size: between the centres of 2x2 texels there are 2x2 output
     * pixels. For the first 2x2 texels of the image: xy 2 + the coordinates of the upper left
     * output pixel, 1 or 2; zw coordinates of the upper left texel, -3 to 0, as the bits of an
     * int. */
    masu_uvec4 between;
    /* Of the first and second output pixel between texels, by column and by row: x distance from
     * the preceding texel; y static weight of the nearer texel; zw weights of the preceding and the
     * following texel in motion. */
    masu_vec4 columns[2];
    masu_vec4 rows[2];
    /* With desc.live_environment: */
    masu_vec4 environment[3]; /* xyz rows of the rotation world -> environment map; w factors on
                                 red, green and blue of the map */
    masu_vec4 background;     /* rgb radiance added to the visible sky; w factor on that sky */
};

#endif
