#!/bin/sh
# docs.sh FILE FILES...: prints the document FILE as make install installs it together with FILES, all as paths of the
# source tree: links to other files of the tree become text, and links to the public headers lead to PREFIX/include.
set -eu
file=$1
shift
printf '%s\n' "$@" | awk -v file="$file" '
    # "a/b/../c" as "a/c"
    function plain(path, parts, count, kept, i, out) {
        count = split(path, parts, "/")
        kept = 0
        for (i = 1; i <= count; i++) {
            if (parts[i] == "." || parts[i] == "") continue
            if (parts[i] == ".." && kept) { kept--; continue }
            out[++kept] = parts[i]
        }
        path = ""
        for (i = 1; i <= kept; i++) path = path (i > 1 ? "/" : "") out[i]
        return path
    }
    # Where the link whose "](" is at the end of text begins.
    function opening(text, i, depth, c) {
        for (i = length(text); i > 0; i--) {
            c = substr(text, i, 1)
            if (c == "]") depth++
            if (c == "[" && depth-- == 0) return i
        }
        return 0
    }
    { installed[$0] = 1; count = split($0, parts, "/"); folder = ""
      for (i = 1; i < count; i++) { folder = folder (i > 1 ? "/" : "") parts[i]; installed[folder] = 1 } }
    END {
        folder = file
        if (!sub("/[^/]*$", "", folder)) folder = "."
        up = folder == "." ? "" : folder "/"
        gsub("[^/]*/", "../", up)
        while ((getline line < file) > 0) text = text line "\n"
        while (match(text, /\]\([A-Za-z0-9_.\/-]+(#[^)]*)?\)/)) {
            before = before substr(text, 1, RSTART - 1)
            target = substr(text, RSTART + 2, RLENGTH - 3)
            text = substr(text, RSTART + RLENGTH)
            path = target
            sub("#.*", "", path)
            path = plain(folder "/" path)
            at = opening(before)
            if (at && path ~ "^include/") before = before "](" up "../../../" path ")"
            else if (!at || path in installed) before = before "](" target ")"
            else before = substr(before, 1, at - 1) substr(before, at + 1)
        }
        printf "%s", before text
    }'
