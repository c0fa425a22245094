#!/usr/bin/env bash
# The face goes out: over VMC to liblo's oscdump and to the Blender add-on, live, from a take in its own time, and from the
# stage; and what is wrong with an output is said.
source "$(dirname "$0")/lib.sh"
cd "$scratch" || exit 1
show=$scratch/a.marotte
port=$((10000 + $$ % 20000)) # below those that the system gives to whoever asks for any
listeners=()
trap 'kill "${listeners[@]}" 2>/dev/null; rm -rf "$scratch"' EXIT

# ---- what is wrong ----
perform=("$MAROTTE" perform --verbose --face "$puppet" --input "log:$demo,end=1" --map one_hand)
refused 1 'there is no face output plugin "nobody". Loaded: ' "${perform[@]}" --output nobody
refused 1 'has no parameter "colour"' "${perform[@]}" --output vmc,colour=3
# shellcheck disable=SC2046 # many words
refused 2 '--output is given more than 8 times' "${perform[@]}" $(printf -- '--output vmc %.0s' 1 2 3 4 5 6 7 8 9)
refused 2 'expected SHOW TAKE' "$MAROTTE" take play "$show"
"${perform[@]}" --output vmc:nowhere.invalid:1 --output vmc:here --output "vmc:127.0.0.1:$port" --record "$show" >said 2>stderr ||
    fail "bad places end a performance: $(cat stderr)"
grep -q 'vmc:nowhere.invalid:1: failed: ' said || fail "$(cat said)"
grep -q 'vmc:here: failed: "here" is not an address to send to' said || fail "$(cat said)"
[ "$(grep -c 'Trying again every second' stderr)" -eq 2 ] || fail "not one line each: $(cat stderr)"
"$MAROTTE" take play "$show" last --output vmc:here --in 5 >said 2>stderr && fail "--in beyond the take"
grep -q 'is not a range of take' stderr || fail "$(cat stderr)"

# ---- heard by others ----
if command -v oscdump >/dev/null; then
    oscdump -L "$port" >heard 2>oscdump.log &
    listeners+=($!)
    # Again until it listens: oscdump does not say when it does.
    for try in $(seq 60); do
        "$MAROTTE" take play "$show" last --output "vmc:127.0.0.1:$port,names=arkit" >said 2>stderr || fail "take play: $(cat stderr)"
        [ -s heard ] && break
    done
    grep -q 'vmc.*: sent, [0-9]* faces' said || fail "$(cat said)"
    [ "$(awk '$2 == "/VMC/Ext/Blend/Val" { print $4 }' heard | sort -u | wc -l)" -eq 52 ] || fail "not the 52 names"
    grep -q '/VMC/Ext/OK i 1' heard && grep -q '/VMC/Ext/Bone/Pos sfffffff "Head"' heard && grep -q '/VMC/Ext/Blend/Apply' heard ||
        fail "not a whole face: $(head -5 heard)"
    # The take's own time: 100 samples a second, its last at 1 s.
    awk '$2 == "/VMC/Ext/T" { if ($4 < last - 1e-6 && last < 0.9) bad = 1; last = $4 } END { exit !(last > 0.98 && last < 1.001 && !bad) }' heard ||
        fail "not the take's time: $(grep '/VMC/Ext/T' heard | tail -3)"

    # A hand that stops: its last step, 0.3 ms after the one before, is sent too while nothing comes after it.
    awk -F, -v OFS=, '/^#/ || /^time_s/ || /^unit/ { print; next } { row[n++] = $0 }
        END { for (burst = 0; burst < 10; ++burst) for (i = 0; i <= 50; ++i) {
                  $0 = row[350 + 5 * burst + i % 5]; $1 = 0.4 * burst + (i < 50 ? 0.001 * i : 0.0493); print } }' "$demo" >stops.csv
    : >heard
    "$MAROTTE" perform --verbose --face "$puppet" --input "log:stops.csv" --map one_hand --realtime --output "vmc:127.0.0.1:$port" >said 2>stderr ||
        fail "$(cat stderr)"
    # All steps but the last of each burst are whole milliseconds apart: 0.7 ms are missing from a pause that began with that one.
    # (When the next is sent depends on how busy the machine is; after 0.4 s it may be the last of the next burst.)
    awk '$2 == "/VMC/Ext/T" { gap = ($4 - last) * 1000; part = gap - int(gap + 0.05)
            if (last > 0 && gap > 300 && gap < 399.9) { ++gaps; if (part < 0.6 || part > 0.8) ++bad }
            last = $4 }
         END { print 0 + gaps " pauses, " 0 + bad " begun too early"; exit gaps < 2 || 3 * bad > gaps }' heard >said ||
        fail "the last step before a pause is not sent: $(cat said)"

    # The stage starts with what was open when it ended.
    printf 'do panel_output\nframes 3\npress Start sending\nframes 3\n' >script
    stage=("$MAROTTE" "$scratch/stage.marotte" --hidden --settings "$scratch/window.json" --face "$puppet" --map one_hand --size 1200x760)
    timeout 120 "${stage[@]}" --script script >said 2>stderr || fail "the panel: $(tail -2 stderr)"
    grep -q '"0": "org.marotte.' window.json || fail "the output is not kept: $(cat window.json)"
    sed -i "s/\"0\": \"org.marotte[^\"]*\"/\"0\": \"org.marotte.vmc:127.0.0.1:$port\"/" window.json
    : >heard
    printf 'wait 300\n' >script
    "${stage[@]}" --script script >said 2>stderr &
    window=$!
    for _ in $(seq 1200); do
        grep -q '/VMC/Ext/Blend/Apply' heard && break
        kill -0 $window 2>/dev/null || break
        sleep 0.1
    done
    grep -q '/VMC/Ext/Blend/Apply' heard || fail "the stage does not send what was open: $(tail -2 stderr)"
    kill $window 2>/dev/null && wait $window
    kill "${listeners[@]}"
else
    echo "SKIPPED: oscdump (liblo-tools) is not installed"
fi

# ---- VTube Studio: asked once whether it may, then never again; a name that is refused stops nothing ----
if command -v python3 >/dev/null; then
    python3 "$SOURCE_DIR/tests/e2e/vts_server.py" vts.port vts.json 2>vts.log &
    listeners+=($!)
    until_s=$((SECONDS + 60))
    until [ -s vts.port ] || [ $SECONDS -gt $until_s ]; do sleep 0.1; done
    vts() { # what the server has seen, once this program has gone
        rm -f vts.json
        "$MAROTTE" take play "$show" last --output "vts:127.0.0.1:$(cat vts.port)" >said 2>stderr || fail "$(cat stderr)"
        until_s=$((SECONDS + 60))
        until [ -s vts.json ] || [ $SECONDS -gt $until_s ]; do sleep 0.1; done
    }
    vts
    vts
    python3 - <<'PYTHON' || fail "VTube Studio: $(cat vts.json vts.log said)"
import json
r = json.load(open("vts.json"))
print("vts:", r)
assert "wrong" not in r and r["tokens"] == 1 and r["logins"] == 2, r
assert r["created"] == 51 and r["refused"] == 0, r
assert r["injected"] > 10 and r["values"] == 51 + 7 and 0.0 <= r["worst"] <= 1.0, r
PYTHON
    [ "$(stat -c %a "$XDG_CONFIG_HOME"/marotte/*/org.marotte.vts/token 2>/dev/null || find "$scratch" -name token -exec stat -c %a {} +)" = 600 ] ||
        fail "the token is not for this person alone"
    "$MAROTTE" take play "$show" last --output vts:127.0.0.1:9 >said 2>stderr || fail "$(cat stderr)"
    grep -q 'vts:127.0.0.1:9: nobody listened' said || fail "$(cat said)"
else
    echo "SKIPPED: python3 is not installed"
fi

# ---- the Blender add-on hears both ----
if command -v blender >/dev/null; then
    "$MAROTTE" perform --verbose --face "$puppet" --input "log:$demo,end=3" --map one_hand --record "$show" >said 2>stderr || fail "$(cat stderr)"
    for by in "vmc names=all" "face_osc contacts=off"; do
        read -r name with <<<"$by"
        rm -f port
        blender -b --factory-startup -noaudio --python-exit-code 1 -P "$SOURCE_DIR/tests/e2e/blender_live.py" -- port >blender.log 2>&1 &
        blender=$!
        listeners+=("$blender")
        for _ in $(seq 600); do [ -s port ] && break; sleep 0.1; done
        [ -s port ] || { fail "Blender does not listen: $(tail -3 blender.log)"; break; }
        "$MAROTTE" take play "$show" last --output "$name:127.0.0.1:$(cat port),$with" >said 2>stderr || fail "$(cat stderr)"
        wait "$blender" || fail "$name: $(tail -4 blender.log)"
        grep "^heard: " blender.log
    done
else
    echo "SKIPPED: Blender is not installed"
fi
finish
