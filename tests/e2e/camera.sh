#!/usr/bin/env bash
# marotte camera, and a performance by landmarks that a client sends as the page would: what was
# recorded performs again, bit for bit.
source "$(dirname "$0")/lib.sh"
exec 9>/tmp/marotte_test_camera_port && flock 9 # as the window's tests: of two builds one has the port at a time
port=$((20000 + $$ % 20000))
said() { grep -qF -- "$1" "$2" || fail "\"$1\" is not said: $(cat "$2")"; }

# ---- what is there, and fetching it ----
"$MAROTTE" camera --port $port >"$scratch/state.txt" || fail "marotte camera"
said "is missing: marotte camera --setup" "$scratch/state.txt"
said "not open" "$scratch/state.txt"
refused 2 "is not a number" "$MAROTTE" camera --port 70000
refused 1 "was never opened" "$MAROTTE" camera --show
mkdir -p "$scratch/bin" "$scratch/none"
cat >"$scratch/bin/npm" <<'NPM'
#!/bin/sh
while [ "$1" != --prefix ]; do shift; done
mkdir -p "$2/node_modules/@mediapipe/hands"
for file in full lite; do echo other >"$2/node_modules/@mediapipe/hands/hand_landmark_$file.tflite"; done
NPM
chmod +x "$scratch/bin/npm"
PATH=$scratch/bin:$PATH "$MAROTTE" camera --setup >"$scratch/setup.txt" 2>&1 && fail "a package of somebody else is taken"
said "not the file of @mediapipe/hands" "$scratch/setup.txt"
[ ! -e "$XDG_DATA_HOME/marotte/camera" ] || fail "a package that is not whole lies where the page looks"

# ---- a performance ----
frames=$shared/data/camera/asl_hand_3d.full.json
if [ ! -e "$frames" ] || ! command -v node >/dev/null; then
    [ "$failures" -eq 0 ] || finish
    echo "SKIPPED: no $frames, or no node"
    exit 77
fi
"$MAROTTE" perform --verbose --face puppet --input "camera:$port" --map one_hand \
    --record "$scratch/hand.marotte" --export "$scratch/hand.png" >"$scratch/facts.txt" 2>&1 &
performing=$!
token=$XDG_CONFIG_HOME/marotte/plugins/org.marotte.camera/token
for _ in $(seq 600); do
    [ -e "$token" ] && "$MAROTTE" camera --port $port | grep -q '^state *open' && break
    sleep 0.1
done
node "$(dirname "$0")/camera_client.mjs" $port 0123456789abcdef0123456789abcdef "$frames" 50 3 2>"$scratch/refused.txt" &&
    fail "a client without the token is heard"
said "404" "$scratch/refused.txt"
node "$(dirname "$0")/camera_client.mjs" $port "$(cat "$token")" "$frames" 50 || fail "the client"
is_recorded() { # the take lasts as long as what was sent, but for the end that may be late
    "$MAROTTE" take list "$scratch/hand.marotte" --json 2>/dev/null |
        awk '/"duration_s"/ { gsub(/[^0-9.]/, "", $2); if ($2 > 6.3) found = 1 } END { exit !found }'
}
for _ in $(seq 600); do
    is_recorded && break
    sleep 0.1
done
kill -INT $performing
wait $performing || fail "perform: $(cat "$scratch/facts.txt")"
samples=$(fact "samples recorded" "$scratch/facts.txt")
moved=$(fact "range of motion" "$scratch/facts.txt")
echo "$samples of 325 frames performed, $moved mm of motion"
[ "${samples:-0}" -ge 309 ] || fail "only $samples samples: $(cat "$scratch/facts.txt")"
[ "${moved%.*}" -ge 10 ] || fail "the face moved by $moved mm only"
for i in 1 2; do
    "$MAROTTE" take export "$scratch/hand.marotte" last --export "$scratch/$i.pc2" >/dev/null 2>&1 || fail "export"
done
cmp "$scratch/1.pc2" "$scratch/2.pc2" || fail "a take of the camera does not perform again bit for bit"
"$MAROTTE" take log "$scratch/hand.marotte" last --out "$scratch/hand.csv" >/dev/null || fail "take log"
grep -q '^unit,rad landmarks,' "$scratch/hand.csv" || fail "the track does not name the filter of landmarks"

# ---- a newcomer at a stage that was never opened before: one click, and the browser's own "Allow" ----
cat >"$scratch/bin/browser" <<BROWSER
#!/bin/sh
token=\$(expr "\$1" : 'http://127.0.0.1:9130/\([0-9a-f]*\)/\$')
exec node "$(dirname "$0")/camera_client.mjs" 9130 "\$token" "$frames" 50 </dev/null >/dev/null 2>&1
BROWSER
chmod +x "$scratch/bin/browser"
mkdir -p "$scratch/tracker" && : >"$scratch/tracker/hands.js" # what it needs is there (window/camera_scene downloads it)
for seconds in 2 5 15 60; do # however long it takes to begin
    rm -rf "$XDG_CONFIG_HOME" "$XDG_DATA_HOME"
    printf 'wait %d\npress Camera\nwait %d\n' $seconds $seconds >"$scratch/newcomer.txt"
    MAROTTE_CAMERA_PACKAGE=$scratch/tracker MAROTTE_BROWSER=$scratch/bin/browser "$MAROTTE" stage --hidden --size 1280x720 --script "$scratch/newcomer.txt" \
        --picture "$scratch/newcomer.png" >"$scratch/stage.txt" 2>&1 || continue # not drawn yet
    samples=$(fact 'samples performed' "$scratch/stage.txt")
    [ "${samples:-0}" -ge 20 ] && break
done
[ "${samples:-0}" -ge 20 ] ||
    fail "an empty stage does not offer \"Camera\", or no hand moves the face after one click: ${samples:-no} samples, $(tail -n 40 "$scratch/stage.txt")"
finish
