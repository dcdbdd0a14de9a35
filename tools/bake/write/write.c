/* write.c: see write.h. */
#include "bake/write/write.h"
#include "bake/base/file.h"
#include "bake/base/process.h"
#include "bake/write/blob.h"
#include "bake/write/stats.h"
#include "cli/cli.h"
#include "plan/draws.h"
#include "scene/scene.h"

/* Validates the blob with the runtime's own reader, so that no blob is written that it or every
 * renderer would reject. */
static bool accepted(const char *input, const masu_bake_buffer *blob) {
    masu_scene scene;
    masu_detail detail = {0};
    if (masu_scene_bind(blob->data, blob->bytes, &scene, &detail) != MASU_OK)
        return masu_cli_error("%s: %s", input, detail.text), false;
    const masu_scene_data *s = masu_scene_data_of(&scene);
    uint64_t draws = (uint64_t)s->transparents * s->transparent_sets;
    if (s->transparents > MASU_TRANSPARENTS_MAX) {
        masu_cli_error("%s: found %u transparent draws, expected at most %u", input,
                       s->transparents, MASU_TRANSPARENTS_MAX);
        return false;
    }
    if (s->transparent_sets > MASU_TRANSPARENT_SETS_MAX) {
        masu_cli_error("%s: transparent draws use more than %u texture sets", input,
                       MASU_TRANSPARENT_SETS_MAX);
        return false;
    }
    if (draws <= MASU_TRANSPARENT_DRAWS_MAX) return true;
    masu_cli_error("%s: %u transparent draws times %u texture sets are %llu, expected at most %u",
                   input, s->transparents, s->transparent_sets, (unsigned long long)draws,
                   MASU_TRANSPARENT_DRAWS_MAX);
    return false;
}

bool masu_bake_write(const masu_bake_options *options, const masu_bake_content *content,
                     const masu_bake_report *report, double started) {
    if (!options->output) return true;
    masu_bake_buffer blob = {0};
    masu_bake_make_blob(content, &blob);
    masu_cli_progress("writing %s", options->output);
    bool good = accepted(options->input, &blob) &&
                masu_bake_write_file(options->output, blob.data, blob.bytes) &&
                (!options->stats || masu_bake_write_stats(options, content, &blob, report,
                                                          masu_bake_seconds() - started));
    masu_cli_progress_clear();
    if (good && !masu_cli_quiet()) masu_bake_print_summary(options->output, content, blob.bytes);
    masu_bake_release(&blob);
    return good;
}
