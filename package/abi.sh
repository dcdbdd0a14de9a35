#!/bin/sh
# abi.sh: prints what the binary interface of masu.h is made of, a line each, sorted by kind and name: the ABI number,
# functions with their types, values of enums, sizes of structs, and offset, size and type of each of their members.
# tests/scripts/abi.sh compares it with tests/consumers/abi.txt, which `make abi` writes.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
package/cdef.sh "${1:-include}" | grep -v ' VkExtent2D { ' > "$folder/cdef.h"

# Members: "struct NAME.MEMBER", enumerators: "enum NAME", as arguments for the program below.
awk '
    # names(TEXT): the declared names of a declaration without its ;
    function names(text, list, n, i, part, count) {
        if (match(text, /\(\*[a-z_]+\)/)) { list[1] = substr(text, RSTART + 2, RLENGTH - 3); return 1 }
        gsub(/\[[^]]*\]/, "", text)
        count = split(text, part, ",")
        for (i = 1; i <= count; i++) { sub(/ *$/, "", part[i]); sub(/.*[ *]/, "", part[i]); list[i] = part[i] }
        return count
    }
    function members(text, prefix, list, base, i, n, inner, open, close_, head, tail) {
        while (text !~ /^[ ]*$/) {
            if (match(text, /^ *struct \{/)) {
                close_ = index(text, "}"); inner = substr(text, RLENGTH + 1, close_ - RLENGTH - 1)
                tail = substr(text, close_ + 1); head = substr(tail, 1, index(tail, ";") - 1)
                text = substr(tail, index(tail, ";") + 1)
                n = names(" " head, list)
                print "MEMBER(" type ", " prefix list[1] ", \"struct\")"
                members(inner, prefix list[1] (head ~ /\[/ ? "[0]." : "."))
                continue
            }
            head = substr(text, 1, index(text, ";") - 1); text = substr(text, index(text, ";") + 1)
            n = names(head, list)
            base = head; sub(/[a-z_0-9]+(\[[^]]*\])?( *,.*)?$/, "", base); gsub(/^ +| +$/, "", base)
            for (i = 1; i <= n; i++) print "MEMBER(" type ", " prefix list[i] ", \"" base "\")"
        }
    }
    { all = all " " $0 }
    END {
        while (match(all, /typedef (struct|enum) masu_[a-z_0-9]+ \{/)) {
            kind = substr(all, RSTART + 8, 4) == "enum" ? "enum" : "struct"
            type = substr(all, RSTART, RLENGTH); sub(/ \{$/, "", type); sub(/.* /, "", type)
            all = substr(all, RSTART + RLENGTH)
            end = index(all, "} " type ";"); body = substr(all, 1, end - 1); all = substr(all, end)
            if (kind == "struct") { print "STRUCT(" type ")"; members(body, ""); continue }
            count = split(body, value, ",")
            for (i = 1; i <= count; i++)
                if (match(value[i], /[A-Z][A-Z0-9_]+/)) print "ENUM(" substr(value[i], RSTART, RLENGTH) ")"
        }
    }' "$folder/cdef.h" > "$folder/rows"
{
    cat << 'END'
#include "masu.h"
#include <stdio.h>
#define STRUCT(type) printf("struct %s %zu\n", #type, sizeof(type));
#define MEMBER(type, name, of) printf("member %s.%s at %zu, %zu bytes, %s\n", #type, #name, offsetof(type, name), sizeof(((type *)0)->name), of);
#define ENUM(name) printf("value %s %d\n", #name, (int)name);
int main(void) {
    printf("abi %d.%d\n", MASU_VERSION_MAJOR, MASU_VERSION_MINOR);
END
    cat "$folder/rows"
    echo '    return 0; }'
} > "$folder/abi.c"
${CC:-cc} -std=c11 -I"${1:-include}" "$folder/abi.c" -o "$folder/abi"
"$folder/abi" > "$folder/all"
head -n 1 "$folder/all"
{
    sed 1d "$folder/all"
    tr '\n' ' ' < "$folder/cdef.h" | tr ';' '\n' | grep -E '(^| )[a-z_0-9]+ \*?masu_[a-z_0-9]+\(' | grep -v typedef |
        sed -E 's/ +/ /g; s/^ //; s/ $//; s/([(,] ?)([^,()]*[ *])[a-z_]+(\[[0-9]+\])?([,)])/\1\2\3\4/g; s/([(,] ?)([^,()]*[ *])[a-z_]+(\[[0-9]+\])?([,)])/\1\2\3\4/g; s/ ([,)])/\1/g' |
        sed 's/^/function /'
} | LC_ALL=C sort
