#!/bin/sh
# completion.sh PROGRAM: completes the program's commands and options in bash, on stdout: those that --help lists.
set -eu
folder=$(dirname "$0")
# shellcheck source=package/help.sh
. "$folder/help.sh"
program=$1
name=$(basename "$program")
function=_$(echo "$name" | tr - _)

echo "# Made by package/completion.sh of $name --help."
echo "$function() {"
echo "    local command=$name words= i"
echo '    for ((i = 1; i < COMP_CWORD; i++)); do'
echo '        case "$command ${COMP_WORDS[i]}" in'
all_commands "$program" "$name" | sed 1d | while read -r line; do
    echo "            '$line') command='$line' ;;"
done
echo '            *) break ;;'
echo '        esac'
echo '    done'
echo '    case $command in'
all_commands "$program" "$name" | while read -r line; do
    arguments=${line#"$name"}
    # shellcheck disable=SC2086
    words=$("$program" $arguments --help | { text=$(cat); echo "$text" | commands_of; echo "$text" | options_of; })
    # shellcheck disable=SC2086
    echo "        '$line') words='"$words"' ;;"
done
echo '    esac'
echo '    mapfile -t COMPREPLY < <(compgen -W "$words" -- "${COMP_WORDS[COMP_CWORD]}")'
echo '}'
echo "complete -o default -F $function $name"
