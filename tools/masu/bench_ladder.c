/* bench_ladder.c: `masu bench --ladder`: prints results of `masu bench` as a table. */
#include "masu/bench.h"

#include "settings/ladder_file.h"

#include <stdio.h>

static void print_table(const char *path, const masu_ladder_file *l) {
    printf("%s: %s at %ux%u, by %s%s%s\n  %s\n", path, l->scene, l->width, l->height, l->clock,
           l->date[0] ? ", " : "", l->date, l->driver);
    printf("  rung   time    FLIP    RMSE  step  setting\n");
    for (uint32_t r = 0; r < l->count; r++) {
        char rmse[24] = "-", step[24] = "-";
        if (l->rmses[r] >= 0.0) snprintf(rmse, sizeof rmse, "%.2f", l->rmses[r]);
        if (l->steps[r] >= 0.0) snprintf(step, sizeof step, "%.2f", l->steps[r]);
        printf("  %4u  %.3f  %.4f  %6s  %4s  %s\n", r, l->ratios[r], l->flips[r], rmse, step,
               l->settings[r]);
    }
}

int masu_bench_ladder(const masu_given *given) {
    if (!given->count) return masu_cli_usage_error("no ladder given: expected LADDER.json");
    for (uint32_t i = 0; i < given->count; i++) {
        static masu_ladder_file ladder;
        char error[1024];
        if (!masu_ladder_read(given->arguments[i], &ladder, error, sizeof error))
            return masu_cli_error("%s", error);
        print_table(given->arguments[i], &ladder);
    }
    return MASU_CLI_OK;
}
