#!/bin/sh
# tables.sh KIND: derives what shaders need from the rows of src/plan/{passes,axes,buffers}.inc. Writes to stdout:
#
#   permutations  permutations.h, for C: the axes of each shader, and its packed SPIR-V for every combination
#   parts         lines NAME:PARTS for make: permutations that some classes of scenes do not need. PARTS: traced (passes
#                 that access images and buffers of reflections), polygons (passes that draw polygons or access draws)
#   builds        lines NAME:FILE:MACRO+MACRO for make: each permutation, its source and its macros
#   pushes        the names of the push-constant headers
#   passes        the table of docs/passes.md
#
#   headers DIR   writes DIR/bindings.h (MASU_BIND_* of descriptor set 0), DIR/push/NAME.h (the struct of push constants
#                 of a pass, for GLSL and C) and DIR/push_constants.h (all of them, for C). A file whose content would
#                 not change keeps its time, so that nothing is compiled again.
#
# make reads it before anything is compiled, on machines that have only make: it needs only a shell and awk.
set -eu
cd "$(dirname "$0")/.."

case ${1:-}:$# in
    headers:2) dir=$2 && mkdir -p "$dir/push" ;;
    permutations:1 | parts:1 | builds:1 | pushes:1 | passes:1) dir= ;;
    *) echo "usage: tables.sh permutations|parts|builds|pushes|passes, tables.sh headers DIR" >&2; exit 2 ;;
esac

# Rows may span lines and hold comments: one row per line, without comments. Passes within #ifdef MASU_LAB are like any
# other, but not part of the documentation.
kind=$1
rows() {
    sed -e "$([ "$kind" != passes ] || echo '/^#ifdef/,/^#endif/d')" -e '/^#/d' "$1" | awk '
    { line = line " " $0 }
    END {
        while ((from = index(line, "/*")) > 0) {
            rest = substr(line, from)
            line = substr(line, 1, from - 1) substr(rest, index(rest, "*/") + 2)
        }
        depth = 0; quoted = 0; row = ""
        for (i = 1; i <= length(line); i++) {
            c = substr(line, i, 1)
            if (c == "\"") quoted = !quoted
            if (!quoted && c == "(") depth++
            if (depth || c != " ") row = row c
            if (!quoted && c == ")" && !--depth) { gsub(/ +/, " ", row); print row; row = "" }
        }
    }'
}

if [ "$1" = passes ]; then
    cat << 'END'
# Render passes

[`src/plan/passes.inc`](../src/plan/passes.inc) lists the passes of a frame in execution order, one row per pass.
`make docs-tables` writes this page from those rows. Barriers, image layouts, descriptor sets, lifetimes, memory
aliasing, labels and timestamps are derived from the same rows ([frame plan](design/01-frame.md)).
`masu plan SCENE.masu` prints the passes that run for a scene, and why each of the others does not run.

*Latest depth* (*color*, *specular*) is the image of that class that the most recent pass of the rung has written;
*previous* is the one before that. The last pass that writes color writes the target: it rounds to the target's steps,
dithers if `desc.dither` is on, and encodes to sRGB, scRGB or HDR10.

| pass | what it does | runs if | reads | writes |
|---|---|---|---|---|
END
fi
{
    rows src/plan/axes.inc
    rows src/plan/buffers.inc
    rows src/plan/passes.inc
} | awk -v kind="$1" -v dir="$dir" '
function fail(text) { print "tables.sh: " text > "/dev/stderr"; failed = 1; exit 1 }
function trim(s) { gsub(/^ +| +$/, "", s); return s }

# Writes the file unless it has that content.
function write(file, text,    old, line) {
    old = ""
    while ((getline line < file) > 0) old = old line "\n"
    close(file)
    if (old == text) return
    printf "%s", text > file
    close(file)
}

# What stands in the brackets that follow `word`, from the first place where it does.
function inside(s, word,    from, i, c, depth, quoted) {
    from = index(s, word "(")
    if (!from) return ""
    from += length(word) + 1
    for (i = from; i <= length(s); i++) {
        c = substr(s, i, 1)
        if (c == "\"") quoted = !quoted
        if (quoted) continue
        if (c == "(") depth++
        if (c == ")" && !depth--) return substr(s, from, i - from)
    }
    return ""
}

# The parts of s between commas that are in no brackets and no quotes.
function split_list(s, out,    n, i, c, depth, quoted) {
    n = 1; out[1] = ""
    for (i = 1; i <= length(s); i++) {
        c = substr(s, i, 1)
        if (c == "\"") quoted = !quoted
        if (!quoted && c == "(") depth++
        if (!quoted && c == ")") depth--
        if (!quoted && !depth && c == ",") { out[++n] = ""; continue }
        out[n] = out[n] c
    }
    return n
}

# The texts of an expression, which are its possible values.
function texts(s,    n, quoted, i, all) {
    n = split(s, quoted, "\"")
    for (i = 2; i <= n; i += 2) all = all (all == "" ? "" : "; or: ") quoted[i]
    return all
}

# An access as docs/passes.md has it: READ_LATEST(DEPTH) becomes "latest depth".
function resource(access,    name) {
    name = access; sub(/^[A-Z_]*\(/, "", name); sub(/\).*/, "", name)
    return (access ~ /_LATEST\(/ ? "latest " : access ~ /_BEFORE\(/ ? "previous " : "") tolower(name)
}

function describe_pass(row,    n, part, i, when, reads, writes, code) {
    n = split_list(substr(row, 6, length(row) - 6), part)
    split_list(inside(part[6], "WHEN"), when)
    for (i = 9; i <= n; i++) {
        code = trim(part[i])
        if (code !~ /^(WRITE|WRITES|UPDATE|UPDATE_LATEST|COLOR|COLOR_PART|BLEND|DEPTH|DEPTH_PART|DEPTH_KEPT|COPY_TO|BUILDS|HOST_COLOR)\(/)
            reads = reads (reads == "" ? "" : ", ") resource(code)
        if (code ~ /^(WRITE|WRITES|UPDATE|UPDATE_LATEST|COLOR|COLOR_PART|BLEND|DEPTH|DEPTH_PART|DEPTH_KEPT|COPY_TO|COPY_BACK|COPY_BACK_LATEST|BUILDS|HOST_COLOR|PING_PONG)\(/)
            writes = writes (writes == "" ? "" : ", ") (code ~ /^COPY_BACK/ ? "host memory" : resource(code))
    }
    while (sub(/host memory, host memory/, "host memory", writes)) {}
    described[++describe_count] = "| `" trim(part[2]) "` | " texts(part[3]) " | " texts(when[2]) " | " reads " | " writes " |"
}

# A shader of several rows is of a part that all of them are of.
function add_shader(name, list,    n, words, i) {
    list = trim(list)
    elsewhere[name] += !traced
    without[name] += !polygons
    if (name in shader_axes) {
        if (shader_axes[name] != list) fail("two rows give " name " different axes: \"" shader_axes[name] "\", \"" list "\"")
        return
    }
    n = split(list, words, " ")
    for (i = 1; i <= n; i++)
        if (!(words[i] in forms)) fail(name " has an axis " words[i] ", which is not in axes.inc")
    shader_axes[name] = list
    shaders[++shader_count] = name
}

/^AXIS\(/ {
    id = substr($0, 6); sub(/,.*/, "", id)
    n = split($0, quoted, "\"")
    forms[id] = 1
    suffix[id, 0] = ""; macros[id, 0] = ""
    for (i = 2; i <= n; i += 2) {
        split(quoted[i], part, ":")
        suffix[id, forms[id]] = part[1]
        macros[id, forms[id]] = part[2]
        forms[id]++
    }
    next
}

/^BUFFER\(/ {
    rest = $0
    while (match(rest, /BIND(_PREVIOUS|_STRUCTURE)?\([A-Z_]+/)) {
        bind = substr(rest, RSTART, RLENGTH)
        sub(/.*\(/, "", bind)
        binds[++bind_count] = bind
        rest = substr(rest, RSTART + RLENGTH)
    }
    next
}

/^PASS\(/ {
    if (kind == "passes") describe_pass($0)
    split(substr($0, 6), head, ",")
    name = trim(head[2])
    file = name
    traced = $0 ~ /\(SPECULAR[_)]/ || $0 ~ /WRITES\(TRACE\)/
    polygons = $0 ~ /DRAW\((POLYGONS|CASCADE|CASTERS|BOXES|BLENDED),/ || $0 ~ /\((DRAWS|SEEN)\)/ || $0 ~ /WRITES\((VERTICES|PREVIOUS_VERTICES|MESH_INDICES|TRACE)\)/
    tail = substr($0, index($0, "PUSH("))
    tail = substr(tail, length(inside(tail, "PUSH")) + 6) # what stands behind it
    if (tail ~ /^\)?, *COMP\(/) {
        split(inside(tail, "COMP"), part, ",")
        file = trim(part[1])
        add_shader(file "_comp", part[2])
    } else if (tail ~ /^\)?, *DRAW\(/) {
        split(inside(tail, "DRAW"), part, ",")
        file = trim(part[2])
        add_shader(file "_vert", part[3])
        add_shader(trim(part[4]) "_frag", part[5])
    } else if (tail ~ /^\)?, *SCENE\(/) {
        split(inside(tail, "SCENE"), part, ",")
        file = trim(part[1])
    }
    members = ""
    rest = inside($0, "PUSH")
    while (match(rest, /(UINT|FLOAT)\([a-z_0-9]+/)) {
        word = substr(rest, RSTART, RLENGTH)
        type = word ~ /^UINT/ ? "masu_uint" : "float"
        sub(/.*\(/, "", word)
        members = members "    " type " " word ";\n"
        rest = substr(rest, RSTART + RLENGTH)
    }
    if (members == "") next
    if (file in push) {
        if (push[file] != members) fail("two rows give " file " different push constants: PUSH of " name)
        next
    }
    push[file] = members
    pushes[++push_count] = file
    next
}

END {
    if (failed) exit 1
    note = "/* Generated by shaders/tables.sh from src/plan/"
    if (kind == "passes") {
        for (i = 1; i <= describe_count; i++) print described[i]
        exit
    }
    if (kind == "pushes") {
        for (i = 1; i <= push_count; i++) print pushes[i]
        exit
    }
    if (kind == "headers") {
        text = note "buffers.inc: bindings of descriptor set 0. */\n#ifndef MASU_BINDINGS_H\n#define MASU_BINDINGS_H\n\n"
        for (i = 1; i <= bind_count; i++) text = text "#define MASU_BIND_" binds[i] " " i - 1 "\n"
        write(dir "/bindings.h", text "#define MASU_BIND_COUNT " bind_count "\n\n#endif\n")
        all = note "passes.inc: the push constants of every pass. */\n#ifndef MASU_PUSH_CONSTANTS_H\n" \
            "#define MASU_PUSH_CONSTANTS_H\n\n"
        for (i = 1; i <= push_count; i++) {
            name = pushes[i]
            guard = "MASU_PUSH_" toupper(name) "_H"
            write(dir "/push/" name ".h", note "passes.inc: push constants of " name ". */\n#ifndef " guard "\n#define " \
                guard "\n\n#include \"shared/types.h\"\n\nstruct masu_push_" name " {\n" push[name] "};\n\n" \
                "#ifdef VULKAN\n#define MASU_PUSH masu_push_" name "\n#endif\n\n#endif\n")
            all = all "#include \"push/" name ".h\"\n"
        }
        write(dir "/push_constants.h", all "\n#endif\n")
        exit
    }
    for (s = 1; s <= shader_count; s++) {
        name = shaders[s]
        stage = name; sub(/.*_/, "", stage)
        file = substr(name, 1, length(name) - length(stage) - 1)
        n = split(shader_axes[name], axis, " ")
        total = 1
        for (i = 1; i <= n; i++) total *= forms[axis[i]]
        codes[s] = total
        for (k = 0; k < total; k++) {
            rest = k; ending = ""; flags = ""
            for (i = 1; i <= n; i++) {
                form = rest % forms[axis[i]]
                rest = (rest - form) / forms[axis[i]]
                ending = ending suffix[axis[i], form]
                if (form) flags = flags (flags == "" ? "" : "+") macros[axis[i], form]
            }
            build[s, k] = file ending "_" stage
            parts = (elsewhere[name] ? "" : " traced") (without[name] ? "" : " polygons")
            if (kind == "parts" && parts != "") {
                sub(/^ /, "", parts); sub(/ /, "+", parts)
                print build[s, k] ":" parts
            }
            if (kind == "builds") print file ending "_" stage ":" file "." stage ":" flags
        }
    }
    if (kind != "permutations") exit
    print note "{passes,axes}.inc: the SPIR-V of every permutation. */"
    print "enum {\n    MASU_SHADER_NONE,"
    for (s = 1; s <= shader_count; s++) print "    MASU_SHADER_" shaders[s] ","
    print "    MASU_SHADER_COUNT\n};\n"
    print "/* By the forms of its axes, the first axis fastest. */"
    for (s = 1; s <= shader_count; s++) {
        print "static const masu_packed codes_of_" shaders[s] "[] = {"
        for (k = 0; k < codes[s]; k++)
            print "    MASU_PACKED_" build[s, k] ","
        print "};"
    }
    print "\nstatic const masu_shader shaders[MASU_SHADER_COUNT] = {"
    for (s = 1; s <= shader_count; s++) {
        n = split(shader_axes[shaders[s]], axis, " ")
        list = ""
        for (i = 1; i <= n; i++) list = list (i > 1 ? ", " : "") "{MASU_AXIS_" axis[i] ", " forms[axis[i]] "}"
        if (list == "") list = "{0, 0}"
        print "    [MASU_SHADER_" shaders[s] "] = {\"" shaders[s] "\", " n ", {" list "}, codes_of_" shaders[s] "},"
    }
    print "};"
}'
