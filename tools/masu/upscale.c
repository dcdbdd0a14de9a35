/* upscale.c: `masu upscale`: anti-aliasing and FSR1 of a PNG, with the last passes of a frame. */
#include "masu/cmd.h"
#include "command/options.h"

#include "file_kind.h"
#include "image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct options {
    masu_session_desc d;
    const char *output;
    bool no_rcas;
} options;

/* Runs the passes over `rgba` and leaves the result in the session's target. */
static bool upscale(const masu_session_desc *given, const uint8_t *rgba, uint32_t width,
                    uint32_t height, uint8_t *out, char *error, size_t size) {
    /* The source image needs the device and the renderer needs the source image: so the session
     * stops before masu_init and continues when the source exists. */
    static masu_session s;
    masu_session_desc d = *given;
    masu_headless_source source;
    bool done = false;
    memset(&source, 0, sizeof source);
    d.no_renderer = true;
    if (!masu_session_open(&d, &s, error, size)) return false;
    uint32_t most = s.host.properties.limits.maxImageDimension2D;
    if (width > most || height > most) {
        snprintf(error, size,
                 "input: found %ux%u pixels, expected at most %u per side on this device", width,
                 height, most);
    } else if (masu_headless_source_create(&s.host, rgba, width, height, width, height, 0, &source,
                                           error, size)) {
        s.desc.source = (masu_source){source.view, width, height,
                                       VK_FORMAT_R8G8B8A8_UNORM};
        masu_frame_desc frame = {0};
        masu_commands commands;
        done = masu_session_start(&s, error, size) &&
               masu_session_frame(&s, &frame, true, &commands, error, size) &&
               masu_headless_target_read(&s.host, &s.targets[0], error, size);
        if (done)
            memcpy(out, s.targets[0].mapped,
                   (size_t)s.desc.output.width * s.desc.output.height * 4);
        if (done && s.host.messages) {
            snprintf(error, size, "the validation layer reported %u messages", s.host.messages);
            done = false;
        }
        if (s.host.device) masu_destroy(s.m);
        s.m = NULL;
        masu_headless_source_destroy(&s.host, &source);
    }
    masu_session_close(&s);
    return done;
}

static bool has_alpha(const struct masu_image *image) {
    for (size_t i = 0; i < (size_t)image->width * image->height; i++) {
        if (image->rgba[4 * i + 3] != 255) return true;
    }
    return false;
}

/* The colour of a pixel with alpha 0 is invisible, but filters would mix it into neighbouring
 * edges. Each such pixel gets the mean of its coloured neighbours, repeated for the reach of EASU
 * and RCAS. Returns false if there is no memory. */
static bool fill_transparent(struct masu_image *image) {
    enum { REACH = 4, NONE = REACH + 1 };
    int width = (int)image->width, height = (int)image->height;
    uint8_t *filled_in = malloc((size_t)width * (size_t)height); /* round in which it was filled;
                                                                  * NONE: not filled */
    if (!filled_in) return false;
    for (int i = 0; i < width * height; i++) filled_in[i] = image->rgba[4 * i + 3] ? 0 : NONE;
    for (int at = 0; at < REACH * width * height; at++) {
        int round = at / (width * height) + 1, i = at % (width * height), x = i % width,
            y = i / width;
        unsigned sum[3] = {0}, count = 0;
        if (filled_in[i] != NONE) continue;
        for (int k = 0; k < 9; k++) {
            int u = x + k % 3 - 1, v = y + k / 3 - 1;
            if (u < 0 || v < 0 || u >= width || v >= height || filled_in[v * width + u] >= round)
                continue;
            for (int c = 0; c < 3; c++) sum[c] += image->rgba[4 * (v * width + u) + c];
            count++;
        }
        if (!count) continue;
        for (int c = 0; c < 3; c++)
            image->rgba[4 * i + c] = (uint8_t)((sum[c] + count / 2) / count);
        filled_in[i] = (uint8_t)round;
    }
    free(filled_in);
    return true;
}

/* FSR1 has three channels. Alpha is processed by the same passes as a separate grey image. */
static bool upscale_alpha(const masu_session_desc *d, const struct masu_image *image, uint8_t *out,
                          char *error, size_t size) {
    size_t in_pixels = (size_t)image->width * image->height;
    size_t out_pixels = (size_t)d->desc.output.width * d->desc.output.height;
    uint8_t *grey = malloc(in_pixels * 4), *grey_out = malloc(out_pixels * 4);
    bool done = grey && grey_out;
    if (!done) snprintf(error, size, "out of memory for the alpha channel");
    for (size_t i = 0; i < in_pixels && done; i++) {
        memset(grey + 4 * i, image->rgba[4 * i + 3], 3);
        grey[4 * i + 3] = 255;
    }
    done = done && upscale(d, grey, image->width, image->height, grey_out, error, size);
    for (size_t i = 0; i < out_pixels && done; i++) out[4 * i + 3] = grey_out[4 * i];
    free(grey);
    free(grey_out);
    return done;
}

static int upscale_file(const masu_session_desc *given, const char *from, const char *to) {
    struct masu_image image;
    char error[1024];
    masu_session_desc copy = *given, *d = &copy;
    if (!masu_image_load_png(from, &image, error, sizeof error)) return masu_cli_error("%s", error);
    if (!d->desc.output.width) d->desc.output = (VkExtent2D){image.width, image.height};
    masu_rung *rung = &d->desc.rungs[0];
    if (rung->sharpness == 0.0f) rung->sharpness = -1.0f; /* 0 stops, not the default */
    int same = d->desc.output.width == image.width && d->desc.output.height == image.height;
    if (rung->aa > MASU_AA_OFF && same) rung->upscale = rung->sharpen = MASU_OFF;
    uint32_t width = d->desc.output.width, height = d->desc.output.height;
    uint8_t *out = malloc((size_t)width * height * 4);
    int code = MASU_CLI_OK;
    if (!out || !fill_transparent(&image)) {
        code = masu_cli_error("out of memory for %ux%u pixels", width, height);
    } else if (!upscale(d, image.rgba, image.width, image.height, out, error, sizeof error) ||
               (has_alpha(&image) && !upscale_alpha(d, &image, out, error, sizeof error)) ||
               !masu_image_save_png(to, out, width, height, 0, error, sizeof error)) {
        code = masu_cli_error("%s", error);
    } else if (width > 2 * image.width || height > 2 * image.height) {
        masu_cli_warn("%s: FSR1 is designed for at most 2x per axis: found %ux%u to %ux%u", from,
                      image.width, image.height, width, height);
    }
    free(out);
    masu_image_free(&image);
    return code;
}

/* ---- Command line ---------------------------------------------------------------------------- */

static const masu_option rows[] = {
    MASU_HEADING("Output"),
    {MASU_ROW(options, output, MASU_TAKE_PNG, "output", "FILE.png",
              "write the result there, instead of the second argument"),
     .letter = 'o'},
    MASU_OUTPUT_SIZE_ROW(options, d.desc.output),
    MASU_HEADING("Filters"),
    MASU_KNOB(options, d.desc.rungs[0], "sharpness", "STOPS", "sharpness",
              "RCAS sharpening: 0 is sharpest, each stop halves it (default 0.2)"),
    MASU_FLAG(options, no_rcas, "no-rcas", "run EASU without RCAS"),
    MASU_KNOB(options, d.desc.rungs[0], "easu", "MODE", "easu",
              "upscaling filter (default full). MODE is one of\n"
              " " MASU_EASU_WORDS(MASU_WORD_LIST) "\n"
              "fast samples edges once; bilinear is for comparison"),
    MASU_KNOB(options, d.desc.rungs[0], "aa", "MODE", "aa",
              "anti-aliasing before the upscaling (default off). MODE is one of\n"
              " " MASU_AA_WORDS(MASU_WORD_LIST)),
    MASU_HEADING("Device"),
    MASU_DEVICE_ROWS(options, d.host),
    {.name = NULL}};

static int run(masu_cli *cli) {
    options o = {.d = {.desc = {.targets = {.storage = 1},
                                .rung_count = 1,
                                .rungs = {{.upscale = MASU_ON,
                                           .sharpen = MASU_ON,
                                           .sharpness = 0.2f}}},
                       .host = {.message = masu_print_message}}};
    masu_rung *rung = &o.d.desc.rungs[0];
    masu_given given = {.most = 2, .excess = "expected one input and one output"};
    int code;
    if (!masu_options_read(cli, rows, &o, &given, &code)) return code;
    const char *to = o.output ? o.output : given.arguments[1];
    if (o.output && given.count > 1)
        return masu_cli_usage_error("unexpected argument '%s': the output is --output",
                                    given.arguments[1]);
    if (!given.count || !to)
        return masu_cli_usage_error("expected an input and an output file: IN.png OUT.png");
    if (!o.d.desc.output.width && rung->aa <= MASU_AA_OFF)
        return masu_cli_usage_error("expected --size WxH or --aa MODE");
    char error[4096];
    if (!o.output && !masu_file_named(to, ".png", error, sizeof error))
        return masu_cli_usage_error("%s", error);
    if (!masu_file_writable(to, error, sizeof error)) return masu_cli_error("%s", error);
    if (o.no_rcas) rung->sharpen = MASU_OFF;
    return upscale_file(&o.d, given.arguments[0], to);
}

const masu_cli_command masu_cmd_upscale = {
    .name = "upscale",
    .arguments = "IN.png OUT.png --size WxH|--aa MODE [options]",
    .summary = "upscale an image with FSR1 (EASU, RCAS) or anti-alias it with SMAA or FXAA",
    .details = "The input must be display-encoded (sRGB), as FSR1 expects. Alpha goes through the "
               "same passes\n"
               "as a separate image; pixels with alpha 0 take the colours beside them. With --aa "
               "and no --size, or with --size equal to the input's size, only\n"
               "anti-aliasing runs.\n\n"
               "Exit codes:\n"
               "  0  success\n"
               "  1  a pass failed, or a file could not be read or written\n"
               "  2  the command line is wrong\n\n"
               "Examples:\n"
               "  masu upscale small.png large.png --size 1920x1080\n"
               "  masu upscale jagged.png smooth.png --aa smaa-high\n",
    .run = run};
