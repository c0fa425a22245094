#!/usr/bin/env bash
# Two hands on every face, through both of the paper's mappings with their defaults: what the surface
# that is shown looks like then, as a table. A row that folds, tears or hardly moves fails it.
#   two_hands.sh [--quick] [NAME]...   of faces, pairs and mappings: only rows that have all names
# --quick: short spans, without the mesh and the recordings that are not part of the repository.
source "$(dirname "$0")/../e2e/lib.sh"
least_mm=15 most_stretch=8
quick=
[ -z "${QUICK:-}" ] || quick=1
[ "${1:-}" = --quick ] && quick=1 && shift
second=$SOURCE_DIR/plugins/log/demo_left_hand.csv

# face NAME FILE: a row's face; missing ones are named once.
faces=("moai=$moai" "moai_rig=${moai%.glb}.rig.json" "puppet=$puppet")
pairs=("mirrored=$demo,$demo,mirror=1")
[ -f "$second" ] && pairs+=("second=$demo,$second")
if [ -n "$quick" ]; then
    :
elif [ -d "$shared/data" ]; then
    faces+=("ict=$scratch/ict.rig.json")
    cp "$SOURCE_DIR/tests/face/ict.rig.json" "$scratch"
    export MAROTTE_FILE_FOLDERS=$shared/data/faces # the rig names a mesh that lies elsewhere
    sed -i "s#\"mesh\": *\"[^\"]*\"#\"mesh\": \"$shared/data/faces/ict_face.glb\"#" "$scratch/ict.rig.json"
    su01=$shared/data/hands/00_calib-rad-su01.txt
    pairs+=("subject1=$su01,$shared/data/hands/02_i_r_ex02-rad-021-grasp-su01.txt,mirror=1")
    pairs+=("subject1_calibration=$su01,$su01,mirror=1")
    pairs+=("subject4=$shared/data/hands/10_ex01-rad-003-grasp-su04.txt,$shared/data/hands/10_ex01-rad-003-grasp-su04.txt,mirror=1")
else
    echo "SKIPPED: the ICT face and the recordings: no $shared/data (set MAROTTE_SHARED)"
fi

is_wanted() {
    local row=$1 name
    shift
    for name in "$@"; do
        case " $row " in *" $name "*) ;; *) return 1 ;; esac
    done
}

number() { fact "$1" "$scratch/facts.txt"; }

printf '%-9s %-10s %-20s %7s %5s %7s %6s %6s %7s %7s %8s %7s\n' face mapping pair motion folds \
    least 'inside' bent bend stretch held ms
[ -n "$quick" ] && least_mm=2 # a short span moves little
for face in "${faces[@]}"; do
    for map in anchored unanchored; do
        for pair in "${pairs[@]}"; do
            row="${face%%=*} $map ${pair%%=*}"
            is_wanted "$row" "$@" || continue
            hands=${pair#*=}
            first=${hands%%,*} other=${hands#*,}
            span=
            [ -n "$quick" ] && span=,end=5
            "$MAROTTE" perform --verbose --face "${face#*=}" --input "log:$first$span" \
                --input "log:$other$span" --map $map >"$scratch/facts.txt" 2>"$scratch/said" ||
                { fail "$row: $(cat "$scratch/said")"; continue; }
            printf '%-9s %-10s %-20s %7s %5s %7s %6s %6s %7s %7s %8s %7s\n' $row \
                "$(number 'range of motion')" "$(number folds)" "$(number 'least determinant')" \
                "$(number 'inside out')" "$(number 'bent edges')" "$(number 'greatest bend')" \
                "$(number 'greatest stretch')" "$(number 'held back')" "$(number 'median frame')"
            [ "$(number folds)" -eq 0 ] || fail "$row: folds"
            [ "$(number 'inside out')" -eq 0 ] || fail "$row: triangles inside out"
            [ "$(number 'bent edges')" -eq 0 ] || fail "$row: edges bent by more than 120 degrees"
            awk -v s="$(number 'greatest stretch')" -v most=$most_stretch \
                'BEGIN { exit !(s <= most) }' || fail "$row: stretched beyond $most_stretch times"
            awk -v mm="$(number 'range of motion')" -v least=$least_mm \
                'BEGIN { exit !(mm >= least) }' || fail "$row: moves by less than $least_mm mm"
        done
    done
done
finish
