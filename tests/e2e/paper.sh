#!/usr/bin/env bash
# `marotte paper`: one whole page, its figures within what they promise, nothing half left behind.
source "$(dirname "$0")/lib.sh"
cd "$SOURCE_DIR" || exit 1
out=$scratch/page

"$MAROTTE" paper --quick --json --out "$out" >"$scratch/said" 2>"$scratch/stderr" ||
    fail "exit $?: $(cat "$scratch/stderr")"
cmp -s "$scratch/said" "$out/paper.json" || fail "--json is not paper.json"
for file in paper.html paper.md paper.json figure1_tree.svg figure2_data.svg figure3_frames.svg solver_fill.svg; do
    [ -s "$out/$file" ] || fail "$file is not there"
done
[ -z "$(find "$out" -name '.*' -mindepth 1)" ] || fail "left behind: $(ls -A "$out")"

# Every picture that the page names is there, and the two pages name the same.
pictures=$(grep -oE 'src="[^"]+"' "$out/paper.html" | cut -d'"' -f2)
[ "$pictures" = "$(grep -oE '\]\([^)]+\)' "$out/paper.md" | tr -d '])(')" ] || fail "the pages show other pictures"
for picture in $pictures; do
    [ -s "$out/$picture" ] || fail "the page shows $picture, which is not there"
done
for heading in 'Table 1' 'Figure 1' 'Figure 2' 'Figure 3' 'Figure' 'The solver' 'Misprints' 'Defaults'; do
    grep -q "^##* $heading" "$out/paper.md" || fail "nothing is said of $heading"
    grep -q "<h[23]>$heading" "$out/paper.html" || fail "nothing is said of $heading"
done

for default in 'Polynomial' 'Gain, anchored' 'Gain, unanchored' 'Radius, anchored' 'Soft end of a pull'; do
    grep -q "^| $default | [^|]" "$out/paper.md" || fail "nothing is said of the default: $default"
done

# All 40 cells; pairs within 2 % of the paper's; its largest model is faster anchored at each radius.
awk -F'[:,]' '
    function value() { v = $2; gsub(/[ "]/, "", v); return v }
    /"method"/ { method = value(); ++cells }
    /"vertices"/ { vertices = value() }
    /"radius_mm"/ { radius = value() }
    /"pairs_off"/ { off = value() + 0; if (off < 0) off = -off; if (off > 0.02) print "pairs off by " off " at " vertices ", R = " radius }
    /"engine_fps"/ { fps[method, vertices, radius] = value() + 0 }
    END {
        if (cells != 40) print cells " cells instead of 40"
        for (r = 10; r <= 80; r += r == 10 ? 10 : 20) {
            a = fps["anchored", 33025, r ".0"]; u = fps["unanchored", 33025, r ".0"]
            if (!(a > u && u > 0)) print "R = " r ": " a " frames a second anchored, " u " unanchored"
        }
    }' "$out/paper.json" >"$scratch/wrong"
[ -s "$scratch/wrong" ] && fail "$(cat "$scratch/wrong")"
fact_of() { sed -nE "s/^ *\"$1\": ([-0-9.e]+),?$/\1/p" "$out/paper.json"; }
awk -v off="$(fact_of worst_reference_off_mm)" 'BEGIN { exit !(off > 0 && off < 1e-9) }' ||
    fail "the engine is $(fact_of worst_reference_off_mm) mm off the reference"

# An earlier page of ours is replaced, and what is not ours stays.
echo mine >"$out/notes.txt"
echo old >"$out/paper.md"
stamp=$(stat -c %i "$out/paper.html")
(ulimit -f 8; __EGL_VENDOR_LIBRARY_FILENAMES=/nowhere.json "$MAROTTE" paper --quick --out "$out" >/dev/null 2>"$scratch/full") && fail "a full disk is not noticed"
grep -q 'marotte paper: .*cannot' "$scratch/full" || fail "a full disk is not said: $(cat "$scratch/full")"
[ "$(cat "$out/paper.md")" = old ] && [ "$(stat -c %i "$out/paper.html")" = "$stamp" ] ||
    fail "a page that failed has changed the earlier one"
[ -f "$out/notes.txt" ] || fail "a file that is not ours is gone"
[ -z "$(find "$out" -name '.*' -mindepth 1)" ] || fail "left behind by a failure: $(ls -A "$out")"

# Bad folders.
mkdir "$scratch/others" && touch "$scratch/others/thesis.html"
refused 1 'contains thesis.html and no page' "$MAROTTE" paper --quick --out "$scratch/others"
refused 1 'not a folder' "$MAROTTE" paper --quick --out "$scratch/others/thesis.html"
printf x >"$scratch/nowhere"
refused 1 'cannot create this folder' "$MAROTTE" paper --quick --out "$scratch/nowhere/page"
refused 2 '--out needs a value' "$MAROTTE" paper --out
refused 2 'is no option' "$MAROTTE" paper --fast
[ "$(ls -A "$scratch/others")" = thesis.html ] || fail "a refusal left something behind"
finish
