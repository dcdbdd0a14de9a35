/* make_font.c FONT.ttf: the font of masu-view as C: printable ASCII of a font of equal widths, as
 * coverage, in the heights of masu_font_sizes. Written to stdout; the result is gen/view_font.h.
 *
 * A font that is drawn when the program is built needs none where it runs. */
#define STB_TRUETYPE_IMPLEMENTATION
#define STBTT_STATIC
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wdouble-promotion"
#endif
#include <stb/stb_truetype.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#include <stdio.h>
#include <string.h>

enum { FIRST = 32, LAST = 126, SIDE_MAX = 64 };

static const int sizes[] = {11, 14, 18, 24, 30}; /* pixels from ascent to descent */

int main(int argc, char **argv) {
    static unsigned char file[4 << 20];
    FILE *in = argc == 2 ? fopen(argv[1], "rb") : NULL;
    size_t bytes = in ? fread(file, 1, sizeof file, in) : 0;
    if (in) fclose(in);
    stbtt_fontinfo font;
    if (!bytes || bytes == sizeof file || !stbtt_InitFont(&font, file, 0)) {
        fprintf(stderr, "make_font: %s: no font\n", argc == 2 ? argv[1] : "no file given");
        return 1;
    }
    printf("/* Made from %s by tools/generate/make_font.c. */\n", argv[1]);
    const int count = (int)(sizeof sizes / sizeof *sizes);
    int widths[sizeof sizes / sizeof *sizes], heights[sizeof sizes / sizeof *sizes];
    for (int s = 0; s < count; s++) {
        float scale = stbtt_ScaleForPixelHeight(&font, (float)sizes[s]);
        int ascent, descent, gap, advance, bearing;
        stbtt_GetFontVMetrics(&font, &ascent, &descent, &gap);
        stbtt_GetCodepointHMetrics(&font, 'M', &advance, &bearing);
        int w = (int)((float)advance * scale + 0.5f), h = sizes[s] + 1;
        int base = (int)((float)ascent * scale + 0.5f);
        widths[s] = w;
        heights[s] = h;
        printf("static const unsigned char masu_font_%d[] = {\n", s);
        for (int c = FIRST; c <= LAST; c++) {
            unsigned char cell[SIDE_MAX * SIDE_MAX];
            int x0, y0, x1, y1;
            memset(cell, 0, sizeof cell);
            stbtt_GetCodepointBitmapBox(&font, c, scale, scale, &x0, &y0, &x1, &y1);
            if (w > SIDE_MAX || h > SIDE_MAX) return 1;
            /* What reaches beyond its cell is cut off. */
            int left = x0 < 0 ? 0 : x0, top = base + y0 < 0 ? 0 : base + y0;
            int right = x1 > w ? w : x1, bottom = base + y1 > h ? h : base + y1;
            if (right > left && bottom > top) {
                stbtt_MakeCodepointBitmap(&font, cell + top * w + left, right - left, bottom - top, w,
                                          scale, scale, c);
            }
            for (int i = 0; i < w * h; i++) printf("%d,%s", cell[i], i % 32 == 31 ? "\n" : "");
            putchar('\n');
        }
        printf("};\n");
    }
    printf("static const masu_font masu_fonts[] = {\n");
    for (int s = 0; s < count; s++) printf("    {%d, %d, masu_font_%d},\n", widths[s], heights[s], s);
    printf("};\n");
    return ferror(stdout) != 0;
}
