/* video.h: uncompressed video (YUV4MPEG2, 4:4:4, BT.709 limited range) to a file, a pipe or
 * stdout. */
#ifndef MASU_CMD_VIDEO_H
#define MASU_CMD_VIDEO_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef struct masu_video {
    FILE *file;
    const char *path;
    uint32_t width, height;
    uint8_t *planes; /* of one frame */
} masu_video;

/* path: "-" is stdout. seconds: between frames, above 0. */
bool masu_video_open(masu_video *v, const char *path, uint32_t width, uint32_t height,
                     double seconds, char *error, size_t error_size);
/* sRGB, 4 bytes per pixel. */
bool masu_video_frame(masu_video *v, const uint8_t *rgba, char *error, size_t error_size);
/* Returns false if a write failed. Harmless on a zeroed struct. */
bool masu_video_close(masu_video *v, char *error, size_t error_size);

#endif
