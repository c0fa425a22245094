#!/usr/bin/env bash
# Heads that nobody here made, from the file to the performance: a rig is drafted, checked and
# performed through three mappings by the demo hand and three recordings, as a table. A row that
# folds, tears, bends skin by more than 120 degrees or what is rigid at all, passes lips into each other, or whose first performance costs
# more than 30 s of a processor fails it (a busy machine needs twice what an idle one does).
# The table of the guide (rigs/README.md) must have the rows that it finds.
#   heads.sh [--quick] [NAME]...   of heads, mappings and hands: only rows that have all names
# --quick: the demo hand's first seconds alone, and of the mappings each head has one, in turn (MAROTTE_TEST_LONG: all). Contact sheets are kept in $SHEETS, where it is set.
source "$(dirname "$0")/../e2e/lib.sh"
heads=$shared/data/heads apart=${BUILD_DIR:-$SOURCE_DIR/build/release}/tests/bench/heads_apart
quick=${QUICK:-}
[ "${1:-}" = --quick ] && quick=1 && shift
if [ ! -d "$heads" ]; then
    echo "SKIPPED: no $heads (set MAROTTE_SHARED)"
    exit 77
fi
hands=("demo=$demo${quick:+,end=5}")
maps=(one_hand anchored unanchored)
if [ -n "${SANITIZED:-}" ]; then # the same code, ten times slower
    hands=("demo=$demo,end=2")
    maps=(one_hand)
fi
if [ -z "$quick" ]; then
    hands+=("subject1_calibration=$shared/data/hands/00_calib-rad-su01.txt")
    hands+=("subject1=$shared/data/hands/02_i_r_ex02-rad-021-grasp-su01.txt")
    hands+=("subject4=$shared/data/hands/10_ex01-rad-003-grasp-su04.txt")
fi

is_wanted() {
    local row=$1 name
    shift
    for name in "$@"; do
        case " $row " in *" $name "*) ;; *) return 1 ;; esac
    done
}

# FROM TO, two outputs of times: the processors' seconds of what ran between. A busy machine changes nothing.
spent() {
    awk 'FNR == 2 { gsub(/[ms]/, " "); was = sum; sum = $1 * 60 + $2 + $3 * 60 + $4 }
        END { printf "%.1f", sum - was }' "$1" "$2"
}

number() { fact "$1" "$scratch/facts.txt"; }

# HEAD, the draft's lines in $scratch/draft.txt: how far its mouth is from the mark, in per cent of the head's height; nothing without a mark.
off_the_mark() {
    local y
    y=$(sed -nE 's/^confirm  face: .* the mouth at (-?[0-9.]+) mm.*/\1/p' "$scratch/draft.txt")
    awk -v head="$1" -v y="$y" '$1 == head { d = 100 * (y - $2) / $3; printf "%.1f", d < 0 ? -d : d }' "$SOURCE_DIR/tests/bench/heads_marks.txt"
}
marked=0 right=0 likely=0 likely_right=0

# HEAD MARK: its row of the table in rigs/README.md: what found the face, the mouth's distance from the mark, how the mouth opens.
table_row() {
    local found=likely mouth="${2:+$2 %}" opens=clay
    grep -q '^confirm  face: .*(unsure)' "$scratch/draft.txt" && found=unsure
    grep -q '^confirm  face: .*(certain)' "$scratch/draft.txt" && found=certain
    grep -q '^confirm  face: no face' "$scratch/draft.txt" && found=none
    grep -q '"mouth": {' "$rig" && opens=lips
    grep -q '"cut_mouth"' "$rig" && opens="lips, cut"
    echo "| $1 | $found | ${mouth:-no mark} | $opens |"
}

turn=0
row='%-13s %-11s %-21s %7s %6s %7s %7s %7s %8s %8s %7s %5s %6s\n'
printf "$row" head mapping hand motion folds least inside held parted bent overlap bend s
for file in "$heads"/*.{glb,gltf,obj,vrm} "$shared/data/heads2"/*.{glb,obj,vrm,ply,stl} "$shared/data/faces/ict_face.glb"; do
    [ -f "$file" ] || continue
    name=$(basename "$file")
    head=${name%.*} rig=$scratch/${name%.*}.rig.json
    # shellcheck disable=SC2194 # the list is constant
    case " one_hand anchored unanchored demo subject1 subject4 subject1_calibration " in
        *" ${1:-demo} "*) ;;
        *) [ "$1" = "$head" ] || continue ;;
    esac
    cp "$file" "$scratch" && chmod u+w "$scratch/$name"
    times >"$scratch/begun"
    if ! "$MAROTTE" rig new "$scratch/$name" --force >"$scratch/said" 2>&1; then
        [ "$(wc -l <"$scratch/said")" -eq 1 ] || fail "$head: $(cat "$scratch/said")"
        printf '%-13s %s\n' "$head" "$(cat "$scratch/said")"
        continue
    fi
    cp "$scratch/said" "$scratch/draft.txt"
    mark=$(off_the_mark "$head")
    if [ -n "$mark" ]; then
        is_right=0 is_likely=0
        awk -v off="$mark" 'BEGIN { exit !(off <= 5) }' && is_right=1
        grep -q '^confirm  face: .*(unsure)' "$scratch/draft.txt" || is_likely=1
        marked=$((marked + 1)) right=$((right + is_right))
        likely=$((likely + is_likely)) likely_right=$((likely_right + is_likely * is_right))
        [ $is_right -eq 1 ] || echo "$head: the mouth is $mark % of the height from its mark"
    fi
    grep -qxF "$(table_row "$head" "$mark")" "$SOURCE_DIR/rigs/README.md" ||
        fail "rigs/README.md lacks this row: $(table_row "$head" "$mark")"
    "$MAROTTE" rig check "$rig" >"$scratch/said" || fail "$head: $(grep ^error "$scratch/said")"
    if grep -q '"lid_upper' "$rig"; then # no performance need blink within the seconds that are tried
        "$MAROTTE" rig show "$rig" --poses --only eyeBlinkLeft,eyeBlinkRight,wink_left,wink_right >"$scratch/said" 2>&1
        grep -q 'least determinant *-' "$scratch/said" && fail "$head: closed lids fold: $(grep 'determinant *-' "$scratch/said")"
    fi
    first=1 turn=$((turn + 1)) tried=("${maps[@]}")
    [ -z "$quick" ] || [ -n "${MAROTTE_TEST_LONG:-}" ] || [ $# -gt 0 ] || tried=("${maps[turn % ${#maps[@]}]}")
    for map in "${tried[@]}"; do
        for hand in "${hands[@]}"; do
            is_wanted "$head $map ${hand%%=*}" "$@" || continue
            "$MAROTTE" perform --verbose --face "$rig" --input "log:${hand#*=}" --map $map \
                --export "$scratch/frames.pc2" >"$scratch/facts.txt" 2>"$scratch/said" ||
                { fail "$head $map: $(cat "$scratch/said")"; continue; }
            took=
            times >"$scratch/now"
            [ -n "$first" ] && took=$(spent "$scratch/begun" "$scratch/now")
            first=
            read -r parted bent overlap < <("$apart" "$rig" "$scratch/frames.pc2")
            printf "$row" "$head" "$map" "${hand%%=*}" "$(number 'range of motion')" \
                "$(number folds)" "$(number 'least determinant')" "$(number 'inside out')" \
                "$(number 'held back')" "$parted" "$bent" "$overlap" \
                "$(number 'greatest bend')" "$took"
            case $head in
            pviz_head) continue ;; # a hollow pumpkin: the edges of its carved mouth fold by up to 154 degrees; shown, not judged
            esac
            [ "$(number folds)" -eq 0 ] || fail "$head $map ${hand%%=*}: folds"
            awk -v bend="$(number 'greatest bend')" 'BEGIN { exit !(bend <= 120) }' ||
                fail "$head $map ${hand%%=*}: an edge is bent too far"
            awk -v mm="${parted:-1}" 'BEGIN { exit !(mm <= 0.05) }' ||
                fail "$head $map ${hand%%=*}: parts by $parted mm"
            awk -v mm="${bent:-1}" 'BEGIN { exit !(mm <= 0.05) }' ||
                fail "$head $map ${hand%%=*}: what is rigid bends by $bent mm"
            most=0.3
            grep -q '"cut_mouth"' "$rig" && most=0.6 # rims of a cut touch at rest: 0.57 in planck
            awk -v mm="${overlap:-1}" -v most="$most" 'BEGIN { exit !(mm <= most) }' ||
                fail "$head $map ${hand%%=*}: lips pass into each other by $overlap mm"
            [ -z "$took" ] || [ -n "${SANITIZED:-}" ] || awk -v s="$took" 'BEGIN { exit !(s < 30) }' ||
                fail "$head: $took s of a processor from the file to the first performance"
            if [ -n "${SHEETS:-}" ] && [ "${hand%%=*}" = demo ]; then
                mkdir -p "$SHEETS"
                "$MAROTTE" perform --face "$rig" --input "log:${hand#*=}" --map $map \
                    --export "$SHEETS/$head.$map.png" >/dev/null 2>&1 || fail "$head $map: no sheet"
            fi
        done
    done
done
echo "mouths: $right of $marked within 5 % of the head's height from their marks; of those called likely $likely_right of $likely"
[ $# -gt 0 ] || [ $marked -lt 20 ] || [ $right -ge 16 ] || fail "mouths: 16 were right"
[ $((10 * likely_right)) -ge $((9 * likely)) ] || [ $# -gt 0 ] || fail "a face is called likely where it is not right in nine of ten"
finish
