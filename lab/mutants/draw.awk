# draw.awk: prints the mutants that run.sh tries, one a line: number, operator, file, line, its text, the mutated text,
# separated by tabs. Reads the sources; -v seed=N -v each=N: as many of each operator, in turns.
#
# Operators: arithmetic (+ and -, * and / exchanged), comparison (turned round, || and && exchanged), bound (< and <=,
# > and >= exchanged), constant (doubled), statement (removed). Comments, texts, preprocessor lines and what only the
# lab's build compiles have no sites.
function random() { state = state * 16807 % 2147483647; return state }

# Keeps the sites with the smallest random numbers.
function site(op, text,    key, i) {
    sites[op]++
    key = random()
    if (kept[op] == each && key > keys[op, each]) return
    if (kept[op] < each) kept[op]++
    for (i = kept[op]; i > 1 && keys[op, i - 1] > key; i--) {
        keys[op, i] = keys[op, i - 1]
        rows[op, i] = rows[op, i - 1]
    }
    keys[op, i] = key
    rows[op, i] = FILENAME "\t" FNR "\t" $0 "\t" text
}

# Blanks comments and quoted texts; the length stays.
function blank(line,    out, i, c, two, quote) {
    out = ""
    quote = ""
    for (i = 1; i <= length(line); i++) {
        c = substr(line, i, 1)
        two = substr(line, i, 2)
        if (comment || quote != "") {
            if (comment && two == "*/") { comment = 0; i++; out = out " " }
            else if (quote != "" && c == "\\") { i++; out = out " " }
            else if (c == quote) quote = ""
            out = out " "
        }
        else if (two == "/*") { comment = 1; i++; out = out "  " }
        else if (two == "//") return out
        else if (c == "\"" || c == "'") { quote = c; out = out " " }
        else out = out c
    }
    return out
}

# Sites of an operator between blanks.
function exchange(op, old, new,    from, p) {
    old = " " old " "
    for (from = 1; (p = index(substr(code, from), old)); from += p + length(old) - 2)
        site(op, substr($0, 1, from + p - 1) new substr($0, from + p + length(old) - 2))
}

function constants(    from, number, p) {
    for (from = 1; match(substr(code, from), /[0-9]+(\.[0-9]+)?(e-?[0-9]+)?/); from = p + length(number)) {
        p = from + RSTART - 1
        number = substr(code, p, RLENGTH)
        if (number + 0 == 0 || substr(code, p, 2) ~ /^0[xX]/ || (p > 1 && substr(code, p - 1, 1) ~ /[A-Za-z0-9_.]/)) {
            match(substr(code, p), /^[A-Za-z0-9_.]+/)
            number = substr(code, p, RLENGTH)
        } else
            site("constant", substr($0, 1, p - 1) (number ~ /[.e]/ ? sprintf("%.9g", number * 2) \
                (number * 2 == int(number * 2) && number * 2 < 1e9 ? ".0" : "") : sprintf("%d", number * 2)) \
                substr($0, p + length(number)))
    }
}

function statement(    text, open, close_) {
    text = code
    sub(/^ +/, "", text)
    sub(/ +$/, "", text)
    if (text !~ /;$/ || !(before ~ /[;{}]$/ || before ~ /^ *(if|for|while|} else if) \(.*\)$/)) return
    if (text ~ /^(const |static |struct |unsigned )*[A-Za-z_][A-Za-z0-9_]* \**[A-Za-z_][A-Za-z0-9_]*( =|;|\[|,)/) return
    if (text !~ /^[A-Za-z_*(]/ || text ~ /^(return|break|continue|goto|else|case|default|layout|do)[^A-Za-z0-9_]/) return
    open = gsub(/[({]/, "&", text)
    close_ = gsub(/[)}]/, "&", text)
    if (open == close_) site("statement", substr($0, 1, match($0, /[^ ]/) - 1) "{}")
}

BEGIN { state = seed }
FNR == 1 { comment = lab = 0; before = ";" }
/^#ifdef MASU_LAB/ { lab = 1 }
/^#(else|endif)/ { lab = 0 }
{
    code = blank($0)
    if (lab || code ~ /^#/ || code !~ /[^ ]/ || index($0, "\t")) next
    exchange("arithmetic", "+", "-")
    exchange("arithmetic", "-", "+")
    exchange("arithmetic", "*", "/")
    exchange("arithmetic", "/", "*")
    exchange("comparison", "==", "!=")
    exchange("comparison", "!=", "==")
    exchange("comparison", "<", ">=")
    exchange("comparison", ">", "<=")
    exchange("comparison", "<=", ">")
    exchange("comparison", ">=", "<")
    exchange("comparison", "&&", "||")
    exchange("comparison", "||", "&&")
    exchange("bound", "<", "<=")
    exchange("bound", "<=", "<")
    exchange("bound", ">", ">=")
    exchange("bound", ">=", ">")
    constants()
    statement()
    sub(/ +$/, "", code)
    before = code
}
END {
    n = split("arithmetic comparison bound constant statement", names, " ")
    for (i = 1; i <= each; i++)
        for (k = 1; k <= n; k++)
            if (i <= kept[names[k]]) print ++number "\t" names[k] "\t" rows[names[k], i]
    for (k = 1; k <= n; k++) print sites[names[k]], names[k] > "/dev/stderr"
}
