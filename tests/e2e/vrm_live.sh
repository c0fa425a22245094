#!/usr/bin/env bash
# A take that plays into --output vmc moves the mouth of a VRM that three-vrm shows in a headless Chromium, by ARKit's names and by
# VRM's presets: its picture with the jaw closed is another than with the jaw open, at the mouth. Packages as e2e/three has them.
source "$(dirname "$0")/lib.sh"
skip() { echo "SKIPPED: $1"; exit 77; }
packages=${MAROTTE_NODE_MODULES:-$SOURCE_DIR/tests/e2e/node_modules}
chromium=$(command -v chromium || command -v chromium-browser || command -v google-chrome)
avatar=$shared/data/heads/rpm_arkit.glb
[ -n "$chromium" ] || skip "chromium is not installed"
command -v node >/dev/null || skip "node is not installed"
for package in three @pixiv/three-vrm osc-min; do
    [ -e "$packages/$package/package.json" ] || skip "no $package in $packages: bash tests/e2e/setup_packages.sh"
done
[ -e "$avatar" ] || skip "no $avatar (set MAROTTE_SHARED)"
cd "$scratch" || exit 1
listener=
trap '[ -z "$listener" ] || kill "$listener" 2>/dev/null; rm -rf "$scratch"' EXIT
out=$BUILD_DIR/out
mkdir -p "$out"
"$MAROTTE" perform --face "$puppet" --input "log:$demo,end=3" --map one_hand --record a.marotte >/dev/null 2>stderr &&
    "$MAROTTE" take export a.marotte last --export a.livelink.csv >/dev/null 2>stderr || { fail "no take: $(cat stderr)"; finish; }
jaw=$(awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == "JawOpen") at = i; next } $at > most { most = $at } END { print most }' a.livelink.csv)

timeout 550 node "$SOURCE_DIR/tests/e2e/vrm_listen.mjs" "$chromium" "$scratch/profile" "$packages" "$avatar" port \
    "arkit=$out/vrm_live_arkit.png" "presets=$out/vrm_live_presets.png" >said 2>stderr &
listener=$!
for _ in $(seq 1800); do
    [ -s port ] || ! kill -0 "$listener" 2>/dev/null || { sleep 0.1; continue; }
    break
done
[ -s port ] || { fail "the avatar does not listen: $(tail -n 3 stderr said)"; finish; }
for names in arkit presets; do
    "$MAROTTE" take play a.marotte last --output "vmc:127.0.0.1:$(cat port),names=$names" >played 2>&1 || fail "take play: $(cat played)"
    until grep -q "^$names: rest" said || ! kill -0 "$listener" 2>/dev/null; do sleep 0.1; done
done
wait "$listener" || fail "$(tail -n 5 stderr said)"
listener=
cat said
is() { awk "/^$1: $2 / { there = 1; if (!(\$3 $3)) wrong = 1 } END { exit wrong || !there }" said; }
for names in arkit presets; do
    is $names bones ">= 3" || fail "$names: head and eyes are not heard"
    is $names jaw_closed "< 0.1" || fail "$names: the jaw never closes"
    is $names mouth "> 5" || fail "$names: the mouth's picture hardly moves"
done
is arkit names "== 52" || fail "not the 52 names"
is arkit jaw_open "> $jaw - 0.02" && is arkit jaw_open "< $jaw + 0.02" || fail "the take's jaw opens to $jaw, not so far there"
grep -q '^arkit: .*unknown there: none$' said || fail "the avatar does not know all names: $(head -n 1 said)"
finish
