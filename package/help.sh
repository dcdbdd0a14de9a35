# help.sh: functions that parse the programs' --help texts, sourced by man.sh and completion.sh.
# The help texts are the only source of the manual pages and completions.

# Prints the commands listed in a help text (stdin), one name per line.
commands_of() {
    sed -n '/^Commands:/,/^$/s/^  \([a-z][a-z-]*\)  .*/\1/p'
}

# Prints the options in a help text (stdin), "--NAME" and "-x", one per line.
options_of() {
    grep -oE '^ +(-[a-z], )?--[a-z][a-z0-9-]*' | tr -d ' ' | tr ',' '\n' | sort -u
}

# Prints every command of a program, one per line: "masu", "masu render", ...; "masu-lab study rays".
# $1: path of the program, $2: its name, $3...: the command so far.
all_commands() {
    path=$1 name=$2
    shift 2
    echo "$name${*:+ $*}"
    for command in $("$path" "$@" --help | commands_of); do
        (all_commands "$path" "$name" "$@" "$command")
    done
}
