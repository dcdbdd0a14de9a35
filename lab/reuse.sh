#!/bin/sh
# reuse.sh OBJECT TO FLAGS: copies an object of the main build to TO if it is up to date, was compiled with FLAGS, and
# none of its sources contains MASU_LAB. Exit 1: it must be compiled.
other=$1 object=$2
[ -e "$other" ] && [ "$(cat "${other%%/obj/*}/flags")" = "$3" ] || exit 1
sources=$(sed '1s/^[^:]*://; /:$/d; s/\\$//' "${other%.o}.d") || exit 1
# shellcheck disable=SC2086
newer=$(find $sources "${other%%/obj/*}/flags" -newer "$other") && [ -z "$newer" ] && ! grep -q MASU_LAB $sources &&
    sed "1s|^[^:]*:|$object:|" "${other%.o}.d" > "${object%.o}.d" && cp "$other" "$object"
