#!/usr/bin/env bash
# soak.sh SECONDS [SEED]: the real window, clicked, dragged and typed at without sense, while a glove is
# unplugged and plugged in again. It must not crash, leave nothing damaged, and its memory must not grow.
# ./test runs it for a moment, ./test --long for an hour, and under the address sanitizer for ten minutes.
seconds=${1:-5} seed=${2:-1}
source "$(dirname "$0")/xvfb.sh"
grown_mb_max=5 judged_from_s=600 # what is opened for the first time takes memory too
rounds=10                        # at whose ends the program is left alone with the live hands, and says what it has
away_s=4 away_more_s=12          # a cable is pulled after so long, and that much at the most
[ "$seconds" -ge 60 ] || rounds=3 away_s=1 away_more_s=2 window_size=800x500 # fewer pixels, as many clicks
emulator=$BUILD_DIR/tests/device/glove_emulator
[ -x "$emulator" ] || { echo "SKIPPED: $emulator is not built"; exit 77; }
trap '[ -z "$program_pid" ] || kill -9 "$program_pid" 2>/dev/null; [ -z "${hand_pid:-}" ] || kill "$hand_pid" 2>/dev/null; rm -rf "$scratch"' EXIT

# A glove whose cable somebody pulls, every few seconds.
pull_cable() {
    RANDOM=$seed
    while sleep $((away_s + RANDOM % away_more_s)); do
        echo unplug
        sleep $((1 + RANDOM % 4))
        echo plug
    done
}
pull_cable | "$emulator" --link "$scratch/glove" --control >/dev/null 2>glove.txt &
hand_pid=$!
until_true test -e "$scratch/glove" || { echo "SKIPPED: no terminal for a glove: $(cat glove.txt)"; exit 77; }

cp -r "$SOURCE_DIR/rigs/puppet" puppet # it may be painted
# All that a day has on: faces are sent to programs that may not be there, a remote control is let in, a click counts.
cat >window.json <<'END'
{"looks": {}, "outputs": {"0": "vmc:127.0.0.1:39539", "1": "face_osc:127.0.0.1:39540"},
 "remote": {"place": "127.0.0.1:39541"}, "click": {"when": 3, "bpm": 140, "bar": 3},
 "record": {"count_in_s": 1, "preroll_s": 1}, "timecode": {"chase": 1}}
END
# Where memory is judged, what is made when it is asked for the first time, and kept, is asked for before.
warm_up() {
    for panel in devices mapping rig engine log patch output scene; do
        printf '%s\n' "do panel_$panel" 'frames 10'
    done
    printf '%s\n' 'do panel_poses' 'wait 30' # its thumbnails
    printf '%s\n' 'do record' 'wait 4' 'do record' 'wait 1' 'do take_before' 'frames 20' 'do play' 'wait 3' 'do stop' \
        'do record' 'wait 5' 'do record' 'wait 1' 'do export' 'frames 20' 'key Escape' 'do open' 'frames 20' 'key Escape' \
        'do output' 'wait 1' 'do output' 'frames 20' 'do live' 'key Escape' 'calm'
}
[ "$seconds" -lt "$judged_from_s" ] || warm_up >script.txt
for ((round = 1; round <= rounds; ++round)); do
    printf '%s\n' "random $((seed * 100 + round)) $(awk "BEGIN { print $seconds / $rounds }")" \
        'key Escape' 'key Escape' 'key Escape' 'calm' 'frames 20' "memory round $round"
done >>script.txt
ulimit -c 0
is_sanitized() { # by the address sanitizer, which keeps what was freed
    nm -D "$MAROTTE" 2>/dev/null | grep -q __asan_init
}
# Mesa's driver forgets two small things when it is unloaded: it stays loaded.
driver=$(find /usr/lib -name swrast_dri.so 2>/dev/null | head -n 1)
if is_sanitized && [ -n "$driver" ]; then
    export LD_PRELOAD=$driver ASAN_OPTIONS=verify_asan_link_order=0
fi
open_window s.marotte --face "$scratch/puppet/puppet.rig.json" --map one_hand --settings "$scratch/window.json" \
    --input "cyberglove:serial:$scratch/glove" --input "log:$demo,loop=1" --script script.txt
unset LD_PRELOAD ASAN_OPTIONS

begun=$SECONDS
# A round ends when what was clicked has been drawn: that takes time on a busy machine.
while ! is_gone && [ $((SECONDS - begun)) -lt $((seconds * 2 + 2 * patience_s)) ]; do sleep 0.2; done
ends 0
grep -E 'AddressSanitizer|LeakSanitizer|ThreadSanitizer|runtime error|Assertion' stderr.txt && fail "a sanitizer found something"
"$MAROTTE" take check s.marotte >said 2>&1 || fail "the show: $(cat said)"
[ "$(json frames)" -gt $((seconds / 4)) ] || fail "only $(json frames) frames were drawn"
[ "$(json samples)" -gt $((seconds * 5)) ] || fail "only $(json samples) samples were performed"

# What is kept to scrub from, and what is kept to undo, have bounds of their own: they are no growth.
used_mb() { # from to: the least of these rounds
    awk -v from="$1" -v to="$2" \
        '/^memory round/ && $3 + 0 >= from && $3 + 0 <= to { mb = $4 - $11 - $16; if (!n++ || mb < least) least = mb }
         END { printf "%d\n", least }' stderr.txt
}
grep '^memory round' stderr.txt
[ "$(grep -c '^memory round' stderr.txt)" -eq $rounds ] || fail "it did not say $rounds times what it has"
echo "$seconds s, seed $seed: $(json frames) frames, $(json samples) samples"
if [ "$seconds" -ge $judged_from_s ] && ! is_sanitized; then
    warm=$(used_mb 3 5) late=$(used_mb 8 10)
    echo "memory $warm MB in rounds 3 to 5, $late MB in rounds 8 to 10"
    [ $((late - warm)) -lt $grown_mb_max ] || fail "memory grew by $((late - warm)) MB"
fi
[ -z "${MAROTTE_SOAK_KEEP:-}" ] || cp stderr.txt facts.json s.marotte "$MAROTTE_SOAK_KEEP"
finish
