#!/usr/bin/env bash
# `marotte deform` itself: every golden file within its tolerances, in both precisions; and bad
# input gives exit code 1 or 2, one clear line on stderr, and nothing on stdout.
set -u
cases=$SOURCE_DIR/tests/golden
[ -x "$MAROTTE" ] || { echo "SKIPPED: $MAROTTE is not built"; exit 77; }
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
failed=0
complain() { echo "FAILED: $1"; failed=1; }

# All numbers of standard input, one a line.
numbers() { tr -c '0-9.eE+-' '\n' | grep -E '^[-+]?[0-9]'; }
# The value of a golden file's key that stands on one line.
value_of() { sed -n "s/^ *\"$2\": *//p" "$1"; }

compare() { # FILE PRECISION
    value_of "$1" expected | numbers >"$scratch/expected"
    "$MAROTTE" deform "$1" --precision "$2" >"$scratch/out" 2>"$scratch/err" ||
        complain "$1 $2: exit $?: $(cat "$scratch/err")"
    [ -s "$scratch/err" ] && complain "$1 $2: says $(cat "$scratch/err")"
    grep -q '^{"frames": \[' "$scratch/out" || complain "$1 $2: the output is not {\"frames\": ..."
    numbers <"$scratch/out" >"$scratch/got"
    paste "$scratch/expected" "$scratch/got" | awk -v tol="$(value_of "$1" "tol_$2" | tr -d ,)" '
        NF != 2 { wrong = 1 }
        { d = $1 - $2; if (d < 0) d = -d; if (d > worst) worst = d }
        END { exit !(NR >= 90 && !wrong && tol > 0 && worst <= tol) }' ||
        complain "$1 $2: differs from the expected positions"
}

count=0
for file in "$cases"/o*.json; do
    compare "$file" f64
    compare "$file" f32
    count=$((count + 1))
done
[ "$count" -ge 15 ] || complain "only $count golden files"

"$MAROTTE" deform - <"$cases/o01_single_tip.json" >"$scratch/piped" || complain "- as input"
"$MAROTTE" deform --json "$cases/o01_single_tip.json" >"$scratch/direct" || complain "--json"
cmp -s "$scratch/piped" "$scratch/direct" || complain "- and the file differ"
"$MAROTTE" deform --help >"$scratch/out" || complain "--help"
grep -q 'usage: marotte deform' "$scratch/out" || complain "--help says nothing"

refuse() { # CODE WORDS ARGUMENT...
    local code=$1 words=$2
    shift 2
    "$MAROTTE" deform "$@" >"$scratch/out" 2>"$scratch/err" </dev/null
    local got=$?
    [ $got = "$code" ] || complain "deform $*: exit $got instead of $code"
    grep -qF -- "$words" "$scratch/err" || complain "deform $*: '$(cat "$scratch/err")' lacks '$words'"
    [ "$(wc -l <"$scratch/err")" = 1 ] || complain "deform $*: not one line on stderr"
    [ -s "$scratch/out" ] && complain "deform $*: writes to stdout"
}
edit() { sed "$1" "$cases/o01_single_tip.json" >"$scratch/bad.json"; }

refuse 2 'expected a case file'
refuse 2 'there is no option' --fast "$cases/o01_single_tip.json"
refuse 2 'expected f32 or f64' "$cases/o01_single_tip.json" --precision f16
refuse 2 'needs a value' "$cases/o01_single_tip.json" --precision
refuse 2 'unexpected argument' "$cases/o01_single_tip.json" "$cases/o02_two_tips.json"
refuse 1 "$scratch/missing.json" "$scratch/missing.json"
refuse 1 "$scratch" "$scratch"
refuse 1 '-: ' -
edit 's/"radius": 1.0/"radius": -1.0/'
refuse 1 "$scratch/bad.json: \$.radius: expected a number > 0" "$scratch/bad.json"
edit 's/"radius": 1.0/"radius": 1e999/'
refuse 1 "$scratch/bad.json: line 5, column" "$scratch/bad.json"
edit 's/"radius": 1.0/"radius": 1.0, "radius": 2.0/'
refuse 1 'duplicate object key' "$scratch/bad.json"
edit 's/"frames": \[\[\[/"frames": [[[null, /'
refuse 1 "$scratch/bad.json: \$.frames[0][0]: expected three numbers" "$scratch/bad.json"
edit '/"points"/d'
refuse 1 "$scratch/bad.json: \$.points: expected an array" "$scratch/bad.json"
edit 's/wendland_c2/gauss/'
refuse 1 "\$.kernel: expected \"wendland_c2\"" "$scratch/bad.json"
head -c 1000 "$cases/o03_ten_tips_anchored.json" >"$scratch/bad.json"
refuse 1 "$scratch/bad.json: line " "$scratch/bad.json"
head -c 200000 /dev/zero | tr '\0' '[' >"$scratch/bad.json"
refuse 1 "$scratch/bad.json: line 1" "$scratch/bad.json"
{ printf '{"kernel":"wendland_c2","radius":1,"polynomial":"none","mode":"anchored","starts":['
    yes '[0,0,0],' | head -n 9000
    printf '[0,0,0]],"frames":[[]],"points":[]}'; } >"$scratch/bad.json"
refuse 1 "\$.starts: 9001 points are too many" "$scratch/bad.json"
[ ! -e /dev/full ] || {
    "$MAROTTE" deform "$cases/o01_single_tip.json" >/dev/full 2>"$scratch/err"
    [ $? = 1 ] && grep -q 'cannot write' "$scratch/err" || complain "a full disk goes unnoticed"
}
exit $failed
