#!/usr/bin/env bash
# The camera's page in a real browser: a headless Chromium whose webcam is a file of a hand. Every
# other host is blocked. MAROTTE_CAMERA_PACKAGE names the package where it is not in the person's data.
package=${MAROTTE_CAMERA_PACKAGE:-${XDG_DATA_HOME:-$HOME/.local/share}/marotte/camera/node_modules/@mediapipe/hands}
source "$(dirname "$0")/lib.sh"
chromium=$(command -v chromium || command -v chromium-browser || command -v google-chrome)
film=$shared/data/camera/asl_hand.25fps.mp4
skip() { echo "SKIPPED: $1"; exit 77; }
[ -n "$chromium" ] || skip "chromium is not installed"
command -v ffmpeg >/dev/null || skip "ffmpeg is not installed"
command -v node >/dev/null || skip "node is not installed"
[ -e "$package/hands.js" ] || skip "no @mediapipe/hands: marotte camera --setup"
[ -e "$film" ] || skip "no $film"
export MAROTTE_CAMERA_PACKAGE=$package MAROTTE_TRACE=$scratch/trace.txt
port=$((20000 + $$ % 20000))
out=$BUILD_DIR/out
mkdir -p "$out"

ffmpeg -loglevel error -i "$film" -vf "scale=-2:480,pad=640:480:(ow-iw)/2:0" -pix_fmt yuvj420p -q:v 3 \
    -f mjpeg "$scratch/hand.mjpeg" || fail "ffmpeg"
"$MAROTTE" perform --verbose --face puppet --input "camera:$port" --map one_hand --seconds 40 \
    --record "$scratch/hand.marotte" --export "$out/camera_browser.png" >"$scratch/facts.txt" 2>&1 &
performing=$!
token=$XDG_CONFIG_HOME/marotte/plugins/org.marotte.camera/token
for _ in $(seq 600); do
    [ -e "$token" ] && "$MAROTTE" camera --port $port | grep -q '^state *open' && break
    sleep 0.1
done
url=$("$MAROTTE" camera --port $port | sed -n 's/^address *//p')
node "$(dirname "$0")/camera_browser.mjs" "$chromium" "$url" "$scratch/hand.mjpeg" 30 "$out/camera_page.png" \
    "$scratch/profile" >"$scratch/page.txt" || fail "the browser: $(cat "$scratch/page.txt")"
wait $performing || fail "perform: $(cat "$scratch/facts.txt")"
grep -E '^(exception|foreign):' "$scratch/page.txt" && fail "the page is not by itself"
tail -n 3 "$scratch/page.txt"
node "$(dirname "$0")/camera_compare.mjs" "$scratch/trace.txt" "$shared/data/camera/asl_hand_3d.full.json" >"$scratch/compare.txt" ||
    fail "compare"
cat "$scratch/compare.txt"
value() { sed -n "s/^$1 //p" "$scratch/compare.txt"; }
samples=$(fact "samples recorded" "$scratch/facts.txt")
echo "$samples samples, $(fact "range of motion" "$scratch/facts.txt") mm of motion; $out/camera_page.png, $out/camera_browser.png"
[ "$(value hands)" -ge 20 ] || fail "hardly any picture was looked at"
awk "BEGIN { exit !($(value share) >= 95) }" || fail "the hand is found in $(value share) % of the pictures"
awk "BEGIN { exit !($(value median_mm) <= 5) }" || fail "landmarks are $(value median_mm) mm off"
moved=$(fact "range of motion" "$scratch/facts.txt")
[ "${moved%.*}" -ge 5 ] || fail "the face moved by $moved mm only"
[ "${samples:-0}" -ge $(($(value hands) * 9 / 10)) ] || fail "of $(value hands) hands only $samples became samples"
finish
