#!/usr/bin/env bash
# The camera's page as a headset's browser has it: a headless Chromium with a headset that is none
# (camera_headset.js). What its hands do is what the samples say.
source "$(dirname "$0")/lib.sh"
chromium=$(command -v chromium || command -v chromium-browser || command -v google-chrome)
skip() { echo "SKIPPED: $1"; exit 77; }
[ -n "$chromium" ] || skip "chromium is not installed"
command -v node >/dev/null || skip "node is not installed"
export MAROTTE_TRACE=$scratch/trace.txt
port=$((20000 + $$ % 20000))
out=$BUILD_DIR/out
mkdir -p "$out"

"$MAROTTE" perform --verbose --face puppet --input "camera:$port,hand=right" --input "camera:$port,hand=left" --map one_hand \
    --seconds 25 --record "$scratch/hands.marotte" >"$scratch/facts.txt" 2>&1 &
performing=$!
token=$XDG_CONFIG_HOME/marotte/plugins/org.marotte.camera/token
for _ in $(seq 600); do
    [ -e "$token" ] && "$MAROTTE" camera --port $port | grep -q '^state *open' && break
    sleep 0.1
done
url=$("$MAROTTE" camera --port $port | sed -n 's/^address *//p')
here=$(dirname "$0")
node "$here/camera_browser.mjs" "$chromium" "$url" none 8 "$out/camera_headset.png" "$scratch/profile" headset \
    "$here/camera_headset.js" >"$scratch/page.txt" || fail "the browser: $(cat "$scratch/page.txt")"
wait $performing || fail "perform: $(cat "$scratch/facts.txt")"
grep -E '^(exception|foreign):' "$scratch/page.txt" && fail "the page is not by itself"
tail -n 2 "$scratch/page.txt"

# Both tracks: 0 at first, 1 rad at the end in the joint that bent, and nothing in the others.
# last TRACK COLUMN: least, most and last value, and how many
column() {
    "$MAROTTE" take log "$scratch/hands.marotte" last --track "$1" --out "$scratch/$1.csv" >/dev/null || fail "track $1"
    awk -F, -v name="$2" '/^#/ { next } !at { for (i = 1; i <= NF; ++i) if ($i == name) at = i; next }
        { n += 1; v = $at + 0; if (n == 1 || v < low) low = v; if (n == 1 || v > high) high = v }
        END { printf "%.3f %.3f %.3f %d\n", low, high, v, n }' "$scratch/$1.csv"
    rm -f "$scratch/$1.csv"
}
check() { # track column least most: within 0.03 rad
    read -r low high last n <<<"$(column "$1" "$2")"
    echo "$2: $low to $high rad, $last at the end, $n samples"
    awk "BEGIN { exit !(($low - $3)^2 < 0.0009 && ($high - $4)^2 < 0.0009) }" || fail "$2 is $low to $high rad, not $3 to $4"
}
check 1 right.index.pij 0 1
check 2 left.little.pij 0 1
check 1 right.middle.pij 0 0
finish
