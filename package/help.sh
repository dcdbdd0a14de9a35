# help.sh: what the programs say of themselves, for man.sh and completion.sh, which read this. Their texts stand
# once, in the programs.

# Commands that a help text lists: "NAME" a line.
commands_of() {
    sed -n '/^Commands:/,/^$/s/^  \([a-z][a-z-]*\)  .*/\1/p'
}

# Options: "--NAME", or "-x" beside it, a line.
options_of() {
    grep -oE '^ +(-[a-z], )?--[a-z][a-z0-9-]*' | tr -d ' ' | tr ',' '\n' | sort -u
}

# Every command of a program as a line of words, the program itself first: "masu", "masu render".
# $1 the program's path, $2 its name, $3... the words so far.
all_commands() {
    path=$1 name=$2
    shift 2
    echo "$name${*:+ $*}"
    for command in $("$path" "$@" --help | commands_of); do
        (all_commands "$path" "$name" "$@" "$command")
    done
}
