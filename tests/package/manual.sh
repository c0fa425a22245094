#!/usr/bin/env bash
# The manual pages and the completions have every command and every option of the tables; each option is explained in its command's
# help. man and mandoc find nothing to complain about, and the shells can read their completions.
source "$(dirname "$0")/../e2e/lib.sh"
cd "$scratch" || exit 1
skipped=""
has() { # PROGRAM PACKAGE
    command -v "$1" >/dev/null || { skipped+=" $2"; return 1; }
}
bash "$SOURCE_DIR/ui/manual/manual.sh" "$SOURCE_DIR" made 1.2.3 "$MAROTTE" || { fail "manual.sh"; finish; }
"$MAROTTE" help --options >options || fail "help --options"
[ "$(grep -c '^[a-z]' options)" -gt 50 ] || fail "help --options lists $(grep -c '^[a-z]' options) commands"

# ---- every option is explained, and is where people look for it ----
bash_text=$(cat made/completions/marotte.bash) zsh_text=$(cat made/completions/marotte.zsh) fish_text=$(cat made/completions/marotte.fish)
holds() { # TEXT WORD: as a whole word
    [[ $1 =~ (^|[^a-z-])$2($|[^a-z-]) ]]
}
while IFS= read -r line; do
    if [[ $line != $'\t'* ]]; then
        command=${line%%$'\t'*}
        # shellcheck disable=SC2086 # two words of a subcommand
        help=$("$MAROTTE" help $command) || fail "help $command"
        page=marotte-${command%% *}.1
        page_text=$(sed 's/\\-/-/g' "made/man/man1/$page") || fail "no page for $command"
        continue
    fi
    read -r option _ <<<"$line"
    holds "$help" "$option" || fail "marotte help $command does not explain $option"
    holds "$page_text" "$option" || fail "$page lacks $option of $command"
    holds "$bash_text" "$option" || fail "marotte.bash lacks $option of $command"
    holds "$zsh_text" "$option" || fail "marotte.zsh lacks $option of $command"
    holds "$fish_text" "-l ${option#--}" || fail "marotte.fish lacks $option of $command"
done <options
for page in marotte.1 marotte-show.5 marotte-rig.5 marotte-log.5 marotte-patch.5; do
    [ "$(wc -l <"made/man/man${page##*.}/$page")" -gt 20 ] || fail "$page is nearly empty"
done
grep -q '"marotte 1.2.3"' made/man/man1/marotte.1 || fail "the pages have another version"

# ---- the pages are read ----
pages=(made/man/man?/*)
if has man man-db; then
    for page in "${pages[@]}"; do
        said=$(LC_ALL=C.UTF-8 MANWIDTH=80 man --warnings -l "$page" 2>&1 >/dev/null)
        [ -z "$said" ] || fail "man: $said"
    done
fi
if has mandoc mandoc; then
    mandoc -T lint -W warning "${pages[@]}" || fail "mandoc"
fi

# ---- the shells ----
complete_bash() { # WORDS...: what bash offers for the last one
    bash -c 'source made/completions/marotte.bash; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); COMPREPLY=(); _marotte; printf "%s\n" "${COMPREPLY[@]}"' - "$@"
}
complete_bash marotte pe | grep -qx perform || fail "bash does not complete pe"
complete_bash marotte take tr | grep -qx trim || fail "bash does not complete take tr"
complete_bash marotte take layer a | grep -qx add || fail "bash does not complete take layer a"
complete_bash marotte take layer add s.marotte 1 --pl | grep -qx -- --place || fail "bash does not complete take layer add --pl"
complete_bash marotte perform --face x --exp | grep -qx -- --export || fail "bash does not complete perform --exp"
complete_bash marotte s.marotte --hid | grep -qx -- --hidden || fail "bash does not complete --hid of the stage"
complete_bash marotte help ta | grep -qx take || fail "bash does not complete help ta"
if has shellcheck shellcheck; then
    shellcheck --shell=bash --severity=warning made/completions/marotte.bash || fail "shellcheck"
fi
if has zsh zsh; then
    zsh -n made/completions/marotte.zsh || fail "zsh"
fi
if has fish fish; then
    fish --no-execute made/completions/marotte.fish || fail "fish"
    offered=$(XDG_CONFIG_HOME=$scratch XDG_DATA_HOME=$scratch fish --no-config -c 'source made/completions/marotte.fish; complete -C "marotte take trim x --cl"')
    grep -q '^--clip' <<<"$offered" || fail "fish does not complete take trim --cl: $offered"
fi
[ -z "$skipped" ] || echo "SKIPPED: parts of this test need the packages$skipped"
[ -z "$skipped" ] || [ "$failures" -gt 0 ] || exit 77
finish
