#!/bin/sh
# man.sh PROGRAM VERSION: the manual page of a program, on stdout: what it and its commands say for --help.
set -eu
folder=$(dirname "$0")
# shellcheck source=package/help.sh
. "$folder/help.sh"
program=$1 version=$2
name=$(basename "$program")

# As roff shows it letter by letter.
plain() {
    sed -e 's/\\/\\e/g' -e 's/-/\\-/g' -e "s/^\\([.']\\)/\\\\\&\\1/" -e "s/'/\\\\(aq/g" -e 's/`/\\(ga/g'
}

# A help text without its first line, which says the name; headings ("Options:") become the macro $1.
body() {
    sed 1,2d | plain | awk -v macro="$1" '
        /^[A-Z][a-z ]*:$/ { print ".fi"; sub(/:$/, ""); print macro " " toupper($0); print ".nf"; next }
        /^Usage: / { print ".fi"; print macro " SYNOPSIS"; print ".nf"; sub(/^Usage: /, "") }
        /^[^ ]/ && last == "" && options { print ".fi"; print macro " NOTES"; print ".nf"; options = 0 }
        /^ / { options = 1 }
        { print; last = $0 }'
}

upper=$(echo "$name" | tr '[:lower:]' '[:upper:]')
echo ".\\\" Made by package/man.sh of $name --help."
echo ".TH $upper 1 \"\" \"Masu $version\" \"Masu\""
echo '.SH NAME'
"$program" --help | sed -n "1s/^\([a-z-]*\): /\1 - /p" | plain | sed 's/ \\- / \\- /'
echo '.nf'
"$program" --help | body .SH
echo '.fi'
all_commands "$program" "$name" | sed 1d | while read -r line; do
    echo ".SH \"$(echo "$line" | tr '[:lower:]' '[:upper:]' | plain)\""
    # shellcheck disable=SC2086
    set -- ${line#"$name "}
    "$program" "$@" --help | sed -n '1s/^[a-z -]*: //p' | plain
    echo '.nf'
    "$program" "$@" --help | body .SS
    echo '.fi'
done
