#!/usr/bin/env bash
# three.js with three-vrm, in a headless Chromium, plays what is exported: at three times its weights are those of the file, its
# vertices those of the point cache, and its picture is that of the cache's vertices. MAROTTE_NODE_MODULES names the folder
# of the packages where it is not tests/e2e/node_modules (setup_packages.sh fills that).
source "$(dirname "$0")/lib.sh"
skip() { echo "SKIPPED: $1"; exit 77; }
packages=${MAROTTE_NODE_MODULES:-$SOURCE_DIR/tests/e2e/node_modules}
chromium=$(command -v chromium || command -v chromium-browser || command -v google-chrome)
[ -n "$chromium" ] || skip "chromium is not installed"
command -v node >/dev/null || skip "node is not installed"
for package in three @pixiv/three-vrm; do
    [ -e "$packages/$package/package.json" ] || skip "no $package in $packages: bash tests/e2e/setup_packages.sh"
done
out=$BUILD_DIR/out
mkdir -p "$out"

play() { # name face mapping ending most_mm
    local face=$2 map=$3 file=$scratch/$1.$4
    perform() { "$MAROTTE" perform --verbose --face "$face" --input "log:$demo,start=11,end=13" --map "$map" --fps 30 --tolerance 0.2 "$@"; }
    perform --export "$file" --export "$scratch/$1.pc2" >"$scratch/told" 2>"$scratch/stderr" &&
        perform --bare --export "$scratch/$1.bare.glb" >/dev/null 2>"$scratch/stderr" ||
        { fail "$1: $(cat "$scratch/stderr")"; return; }
    timeout 240 node "$SOURCE_DIR/tests/e2e/three_play.mjs" "$chromium" "$scratch/profile" "$packages" "$file" \
        "$scratch/$1.bare.glb" "$scratch/$1.pc2" 30 "$out/three_$1.png" "${@:6}" >"$scratch/said" 2>"$scratch/stderr" ||
        { fail "$1: $(tail -n 5 "$scratch/stderr" "$scratch/said")"; return; }
    sed "s/^/$1: /" "$scratch/said"
    is() { awk "/^$1 / { exit !(\$2 $2) }" "$scratch/said"; }
    is off "<= $5" || fail "$1: three.js shows it $(sed -n 's/^off //p' "$scratch/said") mm off"
    is known ">= 1000" || fail "$1: its vertices are not found"
    is weights_off "< 1e-5" || fail "$1: three.js plays other weights than the file has"
    is picture "< 0.5" || fail "$1: its picture is another"
    is moved "> 0.5" || fail "$1: its picture hardly moves"
}
play puppet "$puppet" one_hand glb 0.21
play moai "$moai" unanchored glb 0.21
if [ -d "$shared/data/heads" ]; then
    cp "$shared/data/heads/cryptovoxels.vrm" "$scratch/head.vrm"
    play vrm "$scratch/head.vrm" unanchored vrm 0.21
    grep -q ', a VRM' "$scratch/said" || fail "three-vrm does not see a VRM"
    # Its head's bone by a .vrma: a rig says which that is.
    "$MAROTTE" rig new "$scratch/head.vrm" --out "$scratch/head.rig.json" >/dev/null 2>"$scratch/stderr" &&
        "$MAROTTE" perform --face "$scratch/head.rig.json" --input "log:$demo,start=11,end=13" --map one_hand \
            --export "$scratch/head.vrma" >/dev/null 2>"$scratch/stderr" || fail "a .vrma: $(cat "$scratch/stderr")"
    play turned "$scratch/head.rig.json" one_hand vrm 0.21 "$scratch/head.vrma"
    is head_turns "> 1" || fail "the .vrma turns no head"
    is head_off "< 0.1" || fail "three-vrm turns the head $(sed -n 's/^head_off //p' "$scratch/said") degrees off"
else
    echo "SKIPPED: a VRM: no $shared/data (set MAROTTE_SHARED)"
fi
finish
