#!/usr/bin/env bash
# The stage ends when it is asked to, though an encoder takes no picture and does not end by itself.
source "$(dirname "$0")/../e2e/lib.sh"
cd "$scratch" || exit 1
cp -r "$SOURCE_DIR/rigs/puppet" puppet # it may be painted
mkdir bin
printf '#!%s\n%s\n' "$(command -v bash)" 'echo $$ >encoder.$$.new; mv encoder.$$.new encoder.$$; trap "" TERM; exec sleep 1000' >bin/ffmpeg
chmod +x bin/ffmpeg

streams=(--stream 'srt://127.0.0.1:9999?mode=listener' --stream udp://127.0.0.1:9998 --stream srt://127.0.0.1:9997)
PATH=$scratch/bin:$PATH "$MAROTTE" stage --hidden --size 640x400 s.marotte --face puppet/puppet.rig.json --settings "" --seconds 600 \
    --input "log:$demo,loop=1" "${streams[@]}" >said 2>&1 &
pid=$!
encoders() {
    find . -name 'encoder.*' -not -name '*.new' | wc -l
}
until_true() { # for up to two minutes
    for _ in $(seq 1200); do
        "$@" && return 0
        sleep 0.1
    done
    return 1
}
are_there() { [ "$(encoders)" -eq 3 ] || ! kill -0 $pid 2>/dev/null; }
has_ended() { [ "$(ps -o stat= -p $pid | cut -c1)" = Z ] || ! kill -0 $pid 2>/dev/null; }
until_true are_there
if [ "$(encoders)" -ne 3 ]; then
    kill -9 $pid 2>/dev/null
    wait $pid 2>/dev/null
    grep -q 'OpenGL\|EGL' said && { echo "SKIPPED: nothing can be drawn here: $(head -n 1 said)"; exit 77; }
    fail "$(encoders) encoders of 3 were started: $(tail -n 3 said)"
    finish
fi
kill -TERM $pid
until_true has_ended || { fail "SIGTERM does not end the stage"; kill -9 $pid; }
wait $pid || fail "the stage fails: $(tail -n 3 said)"
for file in encoder.*; do
    kill -0 "$(cat "$file")" 2>/dev/null && fail "an encoder goes on" && kill -9 "$(cat "$file")"
done
finish
