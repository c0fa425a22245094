# Writes what a shell completes after "marotte", from `marotte help --options` and the help of each command.
#   awk -v shell=bash|zsh|fish -f completions.awk OPTIONS.txt HELP.txt
# HELP.txt has "=== COMMAND" before each help: its lines "  --fps N   text" explain the options.

BEGIN { FS = "\t" }
NR == FNR && /^[a-z]/ {
    name[++count] = $1
    summary[$1] = $2
    if ($1 ~ / /) { first = $1; sub(/ .*/, "", first); parts[first] = parts[first] "\n" substr($1, length(first) + 2) }
    else top[++top_count] = $1
    next
}
NR == FNR { options[name[count]] = options[name[count]] " " $2; follows[name[count], $2] = $3; next }
/^=== / { of = substr($0, 5); next }
of == "stage" && /^A script has/ { of = "" }
/^ +--/ {
    text = $0
    sub(/^ +/, "", text)
    option = text
    sub(/[ ,=].*/, "", option)
    if (match(text, /   ?[^ ]/) && !((of, option) in explained)) {
        rest = substr(text, RSTART)
        sub(/^ +/, "", rest)
        sub(/[;:,]$/, "", rest)
        explained[of, option] = rest
    }
}
function about(command, option,   base) {
    base = command
    sub(/ .*/, "", base)
    return (command, option) in explained ? explained[command, option] : explained[base, option]
}
function single(text) { gsub(/'/, "'\\''", text); return "'" text "'" }
# A word of zsh's _describe and _arguments.
function zsh_word(text) { gsub(/\\|:|\[|\]/, "\\\\&", text); return text }

END {
    if (shell == "bash") bash()
    else if (shell == "zsh") zsh()
    else fish()
}

function second_words(command,   list, i, n, word, seen, out) { # "layer" of "layer add", once
    n = split(parts[command], list, "\n")
    for (i = 1; i <= n; ++i) {
        word = list[i]
        sub(/ .*/, "", word)
        if (word != "" && !((command, word) in seen)) { seen[command, word] = 1; out = out " " word }
    }
    return substr(out, 2)
}
function third_words(command, word,   list, i, n, out) {
    n = split(parts[command], list, "\n")
    for (i = 1; i <= n; ++i)
        if (index(list[i], word " ") == 1) out = out " " substr(list[i], length(word) + 2)
    return substr(out, 2)
}
# Commands whose first word is followed by one more: "take layer", "take audio".
function groups(command,   word, i, n, out) {
    n = split(second_words(command), word, " ")
    for (i = 1; i <= n; ++i)
        if (third_words(command, word[i]) != "") out = out " " word[i]
    return substr(out, 2)
}

# Where nothing is offered, bash completes files.
function bash_words(indent, words) { print indent "mapfile -t COMPREPLY < <(compgen -W " single(words) " -- \"$cur\")" }
function bash(   i, n, word, k) {
    print "# bash completion for marotte, written by ui/manual/completions.awk from the tables of options"
    print "_marotte()"
    print "{"
    print "    local cur=${COMP_WORDS[COMP_CWORD]} options"
    print "    local words=(\"${COMP_WORDS[@]:1:COMP_CWORD-1}\")"
    print "    [ \"${words[0]}\" != help ] || words=(\"${words[@]:1}\")"
    print "    case \"${words[*]}\" in"
    print "    '')"
    bash_words("        ", join_top() " help --help --version" options["stage"])
    print "        mapfile -t -O \"${#COMPREPLY[@]}\" COMPREPLY < <(compgen -f -- \"$cur\")"
    print "        return ;;"
    for (i = 1; i <= top_count; ++i)
        if (top[i] in parts) {
            print "    " single(top[i]) ")"
            bash_words("        ", second_words(top[i]))
            print "        return ;;"
            n = split(groups(top[i]), word, " ")
            for (k = 1; k <= n; ++k) {
                print "    " single(top[i] " " word[k]) ")"
                bash_words("        ", third_words(top[i], word[k]))
                print "        return ;;"
            }
        }
    for (i = 1; i <= count; ++i)
        if (!(name[i] in parts))
            print "    " single(name[i]) " | " single(name[i] " ") "*) options=" single(substr(options[name[i]], 2)) " ;;"
    print "    *) options=" single(substr(options["stage"], 2)) " ;;"
    print "    esac"
    print "    [[ $cur != -* ]] || mapfile -t COMPREPLY < <(compgen -W \"$options --help\" -- \"$cur\")"
    print "}"
    print "complete -o filenames -o default -F _marotte marotte"
}
function join_top(   i, out) {
    for (i = 1; i <= top_count; ++i) out = out (i > 1 ? " " : "") top[i]
    return out
}

function zsh_options(command, indent,   n, word, k, text, kind) {
    n = split(options[command], word, " ")
    for (k = 1; k <= n; ++k) {
        kind = follows[command, word[k]]
        text = "*" word[k] "[" zsh_word(about(command, word[k])) "]"
        if (kind == "number") text = text ":number:"
        else if (kind == "value") text = text ":value:_files"
        print indent single(text) " \\"
    }
    print indent "'*:file:_files'"
}
function zsh(   i, n, word, k, m, third, list) {
    print "#compdef marotte"
    print "# zsh completion for marotte, written by ui/manual/completions.awk from the tables of options"
    print "_marotte() {"
    print "    local -a commands"
    print "    if (( CURRENT == 2 )); then"
    print "        commands=("
    for (i = 1; i <= top_count; ++i) print "            " single(top[i] ":" zsh_word(summary[top[i]]))
    print "            'help:explain a command'"
    print "        )"
    print "        _describe command commands"
    print "        _files"
    print "        return"
    print "    fi"
    print "    case \"$words[2] $words[3] $words[4]\" in"
    for (i = count; i >= 1; --i) {
        if (name[i] in parts) continue
        print "    (" zsh_pattern(name[i] " ") "*)"
        print "        _arguments -s \\"
        zsh_options(name[i], "            ")
        print "        ;;"
    }
    for (i = 1; i <= top_count; ++i)
        if (top[i] in parts) {
            print "    (" top[i] "*)"
            print "        commands=("
            n = split(parts[top[i]], list, "\n")
            for (k = 1; k <= n; ++k)
                if (list[k] != "") print "            " single(list[k] ":" zsh_word(summary[top[i] " " list[k]]))
            print "        )"
            print "        _describe command commands"
            print "        ;;"
        }
    print "    (help*) compadd " join_top() " -- --options ;;"
    print "    (*)"
    print "        _arguments -s \\"
    zsh_options("stage", "            ")
    print "        ;;"
    print "    esac"
    print "}"
    print "_marotte \"$@\""
}
function zsh_pattern(text) { gsub(/ /, "\\ ", text); return text }

function fish(   i, n, word, k, list, first, rest, condition, value) {
    print "# fish completion for marotte, written by ui/manual/completions.awk from the tables of options"
    for (i = 1; i <= top_count; ++i)
        print "complete -c marotte -n __fish_use_subcommand -a " top[i] " -d " fish_text(summary[top[i]])
    print "complete -c marotte -n __fish_use_subcommand -a help -d 'explain a command'"
    for (i = 1; i <= count; ++i) {
        first = name[i]
        rest = ""
        if (first ~ / /) { rest = first; sub(/ .*/, "", first); rest = substr(rest, length(first) + 2) }
        if (name[i] in parts) continue
        condition = "__fish_seen_subcommand_from " first
        if (rest != "") {
            n = split(rest, word, " ")
            print "complete -c marotte -f -n " single("__fish_seen_subcommand_from " first "; and not __fish_seen_subcommand_from " \
                second_words(first)) " -a " word[1] " -d " fish_text(n > 1 ? word[1] " ..." : summary[name[i]])
            if (n > 1)
                print "complete -c marotte -f -n " single("__fish_seen_subcommand_from " first "; and __fish_seen_subcommand_from " word[1]) \
                    " -a " word[2] " -d " fish_text(summary[name[i]])
            for (k = 1; k <= n; ++k) condition = condition "; and __fish_seen_subcommand_from " word[k]
        }
        n = split(options[name[i]], word, " ")
        for (k = 1; k <= n; ++k) {
            value = follows[name[i], word[k]]
            print "complete -c marotte -n " single(condition) " -l " substr(word[k], 3) \
                (value == "number" ? " -x" : value == "value" ? " -r -F" : "") " -d " fish_text(about(name[i], word[k]))
        }
    }
}
function fish_text(text) { gsub(/\\/, "\\\\", text); gsub(/'/, "\\'", text); return "'" text "'" }
