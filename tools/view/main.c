/* main.c: the program masu-view, which shows a scene of any supported file in a window.
 * docs/commands.md is its manual. */
#include "view/script.h"

#include "settings/setting.h"
#include "command/options.h"
#include "clock.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TEXT(x) #x
#define VERSION_TEXT(a, b, c) TEXT(a) "." TEXT(b) "." TEXT(c)

static const masu_option rows[] = {
    MASU_HEADING("Scene"),
    MASU_TEXT(masu_viewer_options, json, "json", "FILE.json",
              "description of the baked scene FILE; baked again when it or a file that it\n"
              "names (.sdf, .glsl, models) changes"),
    MASU_TEXT(masu_viewer_options, bake, "bake", "COMMAND",
              "shell command of the baker, run as COMMAND FILE -o OUT.masu\n"
              "(default: masu-bake in the folder of this program)"),
    MASU_TEXT(masu_viewer_options, gallery, "gallery", "DIR",
              "scenes of the start page, as pictures"),
    MASU_TEXT(masu_viewer_options, cache, "cache", "DIR",
              "folder of these pictures (default: one in TMPDIR)"),
    MASU_HEADING("Window"),
    MASU_SIZE(masu_viewer_options, size, "size", "size of the window in pixels"),
    MASU_FLAG(masu_viewer_options, no_vsync, "no-vsync",
              "present without waiting for vertical blanks"),
    MASU_HEADING("Quality"),
    MASU_UINT(masu_viewer_options, rung, "rung", 0, MASU_MAX_RUNGS - 1,
              "start with this rung, without the governor"),
    MASU_REAL(masu_viewer_options, target_ms, "target-ms", "MS", 1.0, 1000.0,
              "target of the governor: GPU time of a frame"),
    MASU_LADDER_ROW(masu_viewer_options, ladder, "scales 1, 0.8, 0.4 (default: auto)"),
    MASU_TEXT(masu_viewer_options, setting, "setting", "NAME",
              "render one rung with these knobs, named as by `masu bench`, for example\n"
              "scale=0.5+aa=fxaa"),
    MASU_HEADING("Scripts and tests"),
    MASU_TEXT(masu_viewer_options, script, "script", "FILE",
              "run a script of lines such as `frame 30 key F2` (docs/commands.md), with a\n"
              "fixed step of 1/60 s per frame"),
    MASU_REAL(masu_viewer_options, time, "time", "SECONDS", 0.0, 1e9,
              "time of the first frame (default 0)"),
    MASU_UINT(masu_viewer_options, frames, "frames", 1, 1000000000,
              "number of frames for --screenshot and --quit, with a fixed step of 1/60 s"),
    MASU_IMAGE(masu_viewer_options, screenshot, "screenshot",
               "write frame number --frames to a file: .png, or linear light as .pfm, .exr"),
    MASU_FLAG(masu_viewer_options, quit, "quit", "exit after --frames frames"),
    MASU_FLAG(masu_viewer_options, no_timestamps, "no-timestamps",
              "do not time passes, which avoids a barrier around each"),
    MASU_FLAG(masu_viewer_options, counters, "counters",
              "count SDF evaluations and visible instances; slower"),
    MASU_HEADING("Device"),
    MASU_RAYS_ROW(masu_viewer_options, rays),
    MASU_DEVICE_ROWS(masu_viewer_options, host),
    {.name = NULL}};

static void print_message(void *user, const char *text) {
    (void)user;
    masu_cli_warn("validation: %s", text);
}

/* Applies the command line to the description. */
static int describe(const masu_viewer_options *o, masu_viewer *v) {
    masu_desc *d = &v->given;
    char error[1024];
    int code = masu_use_ladder(o->ladder, d);
    if (code) return code;
    if (o->setting) {
        d->rung_count = 1;
        if (!masu_setting_parse(o->setting, &d->rungs[0], error, sizeof error))
            return masu_cli_usage_error("--setting: %s", error);
    } else {
        if (!o->ladder) d->ladder = MASU_ON;
        d->governor.mode = MASU_GOVERNOR_ON;
        d->governor.target_ms = (float)o->target_ms;
    }
    d->dither = MASU_ON;
    d->debug.timestamps = !o->no_timestamps;
    d->debug.counters = o->counters;
    masu_headless_desc ignored = {0};
    masu_use_rays(o->rays, &d->ray_query, &ignored);
    return MASU_CLI_OK;
}

static int view(const masu_viewer_options *o) {
    masu_viewer *v = calloc(1, sizeof *v);
    if (!v) return masu_cli_error("out of memory");
    v->o = o;
    v->scripted = o->script || o->frames;
    v->rung = o->rung;
    v->time = o->time;
    v->split = 0.5;
    v->hud = MASU_HUD_SHORT;
    v->fly.speed = 4.0;
    masu_script script = {0};
    masu_viewer_catch_signals();
    int code = describe(o, v);
    bool read =
        code || !o->script || masu_script_read(o->script, &script, v->error, sizeof v->error);
    if (!code && read && masu_viewer_open(v)) code = masu_viewer_run(v, &script);
    else if (!code) code = masu_cli_error("%s", v->error);
    masu_script_free(&script);
    uint64_t frames = v->frames, turns = v->turns;
    masu_viewer_settle(v);
    uint32_t messages = v->host.messages;
    masu_viewer_close(v);
    free(v);
    if (code) return code;
    if (messages)
        return masu_cli_error("the validation layer reported %u message%s", messages,
                              messages == 1 ? "" : "s");
    if (!masu_cli_quiet() && (o->script || o->frames))
        fprintf(stderr, "masu-view: %llu frames in %llu loop iterations\n",
                (unsigned long long)frames, (unsigned long long)turns);
    return MASU_CLI_OK;
}

static int run(masu_cli *cli) {
    masu_viewer_options o = {
        .size = {1280, 720}, .target_ms = 16.67, .host.message = print_message};
    masu_given given = {.most = 1, .excess = "expected one file"};
    int code;
    if (!masu_options_read(cli, rows, &o, &given, &code)) return code;
    o.scene = given.count ? given.arguments[0] : NULL;
    o.rung_given = masu_is_given(&given, rows, "rung");
    masu_switch ignored;
    masu_use_rays(o.rays, &ignored, &o.host);
    if (o.setting && (o.ladder || o.rung_given || masu_is_given(&given, rows, "target-ms")))
        return masu_cli_usage_error(
            "--setting cannot be combined with --ladder, --rung or --target-ms");
    if ((o.screenshot || o.quit) && !o.frames)
        return masu_cli_usage_error("%s needs --frames", o.screenshot ? "--screenshot" : "--quit");
    if (!masu_clock_advances()) return masu_cli_error("%s", MASU_CLOCK_STOPPED);
    return view(&o);
}

int main(int argc, char **argv) {
    static const masu_cli_command command = {
        .arguments = "[FILE] [options]",
        .summary = "show a scene in a window",
        .details =
            "FILE is a baked scene (.masu), a scene description (.json), an SDF (.sdf) or a model "
            "(.glb, .gltf,\n"
            ".obj, ...); all but the first are baked, and baked again when they or files that they "
            "name change.\n"
            "Without it the start page opens. A file that is dropped on the window is opened.\n\n"
            "Keys:\n"
            "  W A S D, Q E          move the camera; Shift: faster; mouse wheel: speed\n"
            "  right mouse button    turn the camera\n"
            "  P, Space              camera path on, off; pause\n"
            "  Left, Right, Home     time backward, forward, 0; Shift: larger steps\n"
            "  Tab or M              panels: arrow keys move, Space changes, Enter types a value, "
            "Esc ends\n"
            "  F4                    start page\n"
            "  F5 to F8, F10         panels: scene, light, quality, camera; capture\n"
            "  F9, F12               video on, off; screenshot\n"
            "  1 to 8                rung 0 to 7 of the ladder\n"
            "  Page Up, Page Down    the next better, the next cheaper rung\n"
            "  0; G; + and -         governor on; governor on, off; its target\n"
            "  F1                    numbers: off, short, full\n"
            "  F2                    split screen: A, the current setting, and B, a stored one\n"
            "  [ ], left mouse       move the dividing line; without split screen: pick an object\n"
            "  B                     store the current setting as B (at first the best rung)\n"
            "  F3                    FLIP of A against B\n"
            "  F11, Esc              full screen; close panels, exit\n"
            "A game controller also moves the camera.\n\n"
            "Exit codes:\n"
            "  0  success\n"
            "  1  the scene, the device or a file failed, or --validate reported a message\n"
            "  2  the command line is wrong\n\n"
            "Examples:\n"
            "  masu-view engine.masu\n"
            "  masu-view model.glb\n"
            "  masu-view scenes/engine.json --setting scale=0.5\n",
        .run = run};
    static const masu_cli_command *const commands[] = {&command, NULL};
    static const masu_cli_program program = {
        .name = "masu-view",
        .version = VERSION_TEXT(MASU_VERSION_MAJOR, MASU_VERSION_MINOR, MASU_VERSION_PATCH),
        .commands = commands};
    return masu_cli_main(&program, argc, argv);
}
