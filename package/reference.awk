# reference.awk: a header of include/ as Doxygen reads it, for `make reference`: comments before a declaration and behind
# a member become documentation comments, lists of errors become lists, the manual at the head stays as it is laid out.
function text(line) {
    if (line ~ /^ \*     / && line !~ /^ \*          /) return line # code
    gsub(/ \.\. /, "..", line)
    gsub(/&/, "\\&amp;", line); gsub(/</, "\\&lt;", line); gsub(/#/, "\\#", line); gsub(/@/, "\\@", line)
    if (match(line, /^ \*   MASU_[A-Z_]+(, _[A-Z_]+)?  +/)) {
        item = substr(line, 6, RLENGTH - 5); sub(/ +$/, "", item)
        line = " *  - " item ": " substr(line, RLENGTH + 1)
        items = 1
    } else if (items && line ~ /^ \* [^ ]/) {
        line = " *\n" line
        items = 0
    } else if (line ~ /^ \*          /) sub(/^ \* +/, " *   ", line)
    return line
}
FNR == 1 { # the head
    sub(/^\/\* /, ""); print "/** @file"; print "@verbatim"
    head = 1
}
head {
    if (/\*\/$/) { sub(/ *\*\/$/, ""); sub(/^ \* ?/, ""); print; print "@endverbatim */"; head = 0 }
    else { sub(/^ \* ?/, ""); print }
    next
}
# Lines of macros stay.
/\\$/ || macro { macro = /\\$/; print; next }
/^ *\/\* (----|written by|end of|clang-format)/ { print ""; next }
!inside && /^ *\/\* / {
    match($0, / *\/\*/); line = substr($0, 1, RLENGTH) "*" text(substr($0, RLENGTH + 1)); print line
    inside = !/\*\/$/; next
}
!inside && /[;,{]? +\/\* / {
    at = index($0, "/* "); print substr($0, 1, at - 1) "/**<" text(substr($0, at + 2))
    inside = !/\*\/$/; next
}
inside { print text($0); if (/\*\/$/) inside = items = 0; next }
{ print }
