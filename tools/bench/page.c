/* page.c: see page.h. */
#include "bench/page.h"

#include "cli/markup.h"

#include <math.h>

double masu_row_ms(const masu_row *row) {
    return row->plausible >= 0.9 ? row->gpu_p50 : row->wall_p50;
}

bool masu_verdict_find(const masu_row *const *rungs, uint32_t count, masu_verdict *out) {
    bool found = false;
    for (uint32_t i = 0; i < count && !(found && out->holds); i++) {
        const double ms = masu_row_ms(rungs[i]);
        const bool holds = ms <= MASU_PAGE_BUDGET_MS;
        if (!isfinite(ms) || (found && !holds && ms >= out->ms)) continue;
        *out = (masu_verdict){holds, i, ms, masu_row_error(rungs[i])};
        found = true;
    }
    return found;
}

/* The script has no '<' or '&', which XHTML would escape. */
static const char script[] =
    "<script>\n"
    "document.querySelectorAll('table.sort').forEach(function (table) {\n"
    "  Array.from(table.rows[0].cells).forEach(function (head, k) {\n"
    "    var button = document.createElement('button');\n"
    "    button.textContent = head.textContent;\n"
    "    head.textContent = '';\n"
    "    head.appendChild(button);\n"
    "    function key(row) {\n"
    "      var text = row.cells[k].textContent, value = parseFloat(text);\n"
    "      return isNaN(value) ? text : value;\n"
    "    }\n"
    "    button.onclick = function () {\n"
    "      var up = head.getAttribute('aria-sort') != 'ascending';\n"
    "      Array.from(table.rows[0].cells).forEach(function (other) {\n"
    "        other.removeAttribute('aria-sort');\n"
    "      });\n"
    "      head.setAttribute('aria-sort', up ? 'ascending' : 'descending');\n"
    "      Array.from(table.rows).slice(1).sort(function (a, b) {\n"
    "        var x = key(a), y = key(b);\n"
    "        if (x === '-' || y === '-') return (x === '-') - (y === '-');\n"
    "        var numbers = typeof x == 'number' ? typeof y == 'number' : false;\n"
    "        var order = numbers ? x - y : String(x).localeCompare(String(y));\n"
    "        return up ? order : -order;\n"
    "      }).forEach(function (row) { row.parentNode.appendChild(row); });\n"
    "    };\n"
    "  });\n"
    "});\n"
    "var shots = Array.from(document.querySelectorAll('img.shot'));\n"
    "var section = document.getElementById('ab');\n"
    "if (section) {\n"
    "  var stage = section.querySelector('div'), range = section.querySelector('input');\n"
    "  var lists = section.querySelectorAll('select'), images = [new Image(), new Image()];\n"
    "  function show() {\n"
    "    images.forEach(function (image, i) {\n"
    "      var shot = shots[lists[i].selectedIndex];\n"
    "      image.src = shot.src;\n"
    "      image.alt = shot.alt;\n"
    "    });\n"
    "    images[1].style.clipPath = 'inset(0 0 0 ' + range.value + '%)';\n"
    "    stage.style.setProperty('--at', range.value + '%');\n"
    "  }\n"
    "  images.forEach(function (image, i) {\n"
    "    stage.appendChild(image);\n"
    "    shots.forEach(function (shot) { lists[i].add(new Option(shot.alt)); });\n"
    "    lists[i].selectedIndex = i ? Math.min(1, shots.length - 1) : 0;\n"
    "    lists[i].onchange = show;\n"
    "  });\n"
    "  range.oninput = show;\n"
    "  section.hidden = false;\n"
    "  show();\n"
    "}\n"
    "</script>\n";

static const char head[] =
    "<!DOCTYPE html>\n<html xmlns=\"http://www.w3.org/1999/xhtml\" lang=\"en\">\n<head>\n"
    "<meta charset=\"utf-8\"/>\n"
    "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<style>\n"
    ":root { color-scheme: light dark; --text: #222; --back: #fff; --line: #ddd; --rung: #fff3e6;\n"
    "        --link: #0b57a4; --good: #e3f4e6; --bad: #fbe6e3; }\n"
    "@media (prefers-color-scheme: dark) {\n"
    "  :root { --text: #ddd; --back: #16181b; --line: #3a3d42; --rung: #3a2b18; --link: #8ab8ff;\n"
    "          --good: #17351f; --bad: #43201c; }\n"
    "  img.plot { filter: invert(.91) hue-rotate(180deg) brightness(1.35); } }\n"
    "body { font: 15px/1.5 sans-serif; max-width: 75em; margin: 2em auto; padding: 0 1em;\n"
    "       color: var(--text); background: var(--back); overflow-wrap: anywhere; }\n"
    "a { color: var(--link); }\n"
    ".verdict { padding: .6em 1em; border-radius: 6px; background: var(--bad); font-size: 17px; }\n"
    ".holds { background: var(--good); }\n"
    "table { border-collapse: collapse; font-size: 12px; }\n"
    ".wide { overflow-x: auto; }\n"
    "th, td { padding: 2px 6px; text-align: right; border-bottom: 1px solid var(--line);\n"
    "         white-space: nowrap; }\n"
    "th { border-bottom: 2px solid #888; }\n"
    "th button { all: unset; cursor: pointer; }\n"
    "th button:focus-visible { outline: 2px solid var(--link); }\n"
    "th[aria-sort=ascending] button::after { content: ' \\2191'; }\n"
    "th[aria-sort=descending] button::after { content: ' \\2193'; }\n"
    "td:first-child, th:first-child { text-align: left; }\n"
    "th.text, td.text { text-align: left; }\n"
    "td.text { white-space: normal; min-width: 16em; }\n"
    "td.bad { background: var(--bad); }\n"
    ".rung td { background: var(--rung); }\n"
    "img { max-width: 100%; height: auto; }\n"
    "img.plot { max-width: none; width: 100%; min-width: 720px; }\n"
    ".pair { display: flex; flex-wrap: wrap; align-items: flex-start; gap: 8px; }\n"
    ".pair img { flex: 1 1 320px; min-width: 0; max-width: 640px; image-rendering: pixelated; }\n"
    "label { display: inline-block; max-width: 100%; }\n"
    "select { max-width: 100%; }\n"
    "#ab div { position: relative; max-width: 900px; }\n"
    "#ab div img { display: block; width: 100%; image-rendering: pixelated; }\n"
    "#ab div img + img { position: absolute; top: 0; height: 100%; }\n"
    "#ab div::after { content: ''; position: absolute; top: 0; bottom: 0; left: var(--at);\n"
    "                 border-left: 2px solid #fff; mix-blend-mode: difference; }\n"
    "#ab input { width: 100%; max-width: 900px; margin: 0; }\n"
    "</style>\n";

void masu_page_begin(FILE *f, const char *what, const char *scene) {
    fputs(head, f);
    masu_markup(f, "<title>masu bench: %s</title>\n</head>\n<body>\n<h1>%s%s</h1>\n", scene, what,
                scene);
}

void masu_page_verdict(FILE *f, const masu_row *const *rungs, uint32_t count) {
    masu_verdict v;
    if (!masu_verdict_find(rungs, count, &v)) {
        fputs("<p class=\"verdict\"><b>No rung was found.</b></p>\n", f);
        return;
    }
    masu_markup(
        f,
        v.holds
            ? "<p class=\"verdict holds\"><b>Holds %.2f ms (60 Hz) at rung %u</b>"
            : "<p class=\"verdict\"><b>No rung holds %.2f ms (60 Hz).</b> The fastest is rung %u",
        MASU_PAGE_BUDGET_MS, v.rung);
    masu_markup(f, ", %s: %.2f ms a frame (median), error %.4f.</p>\n", rungs[v.rung]->setting,
                v.ms, v.error);
}

void masu_page_slider(FILE *f) {
    fputs("<section id=\"ab\" hidden=\"hidden\">\n<h2>Comparison of two images</h2>\n"
          "<p><label>Left: <select></select></label> <label>right: <select></select></label></p>\n"
          "<div></div>\n<input type=\"range\" min=\"0\" max=\"100\" value=\"50\" "
          "aria-label=\"position of the border between the images\"/>\n</section>\n",
          f);
}

void masu_page_end(FILE *f) {
    fputs(script, f);
    fputs("</body>\n</html>\n", f);
}

void masu_page_base64(FILE *f, const uint8_t *bytes, size_t count) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < count; i += 3) {
        uint32_t left = count - i < 3 ? (uint32_t)(count - i) : 3, v = 0;
        for (uint32_t k = 0; k < 3; k++) v = v << 8 | (k < left ? bytes[i + k] : 0);
        for (uint32_t k = 0; k < 4; k++) fputc(k <= left ? digits[v >> (18 - 6 * k) & 63] : '=', f);
    }
}
