#!/usr/bin/env bash
# What becomes of an .mp4 when the encoder or the disk fails: the file is complete or absent, the message says why,
# and a program that stands still holds nobody. A stand-in plays the encoder, so that this needs no ffmpeg.
source "$(dirname "$0")/lib.sh"
cd "$scratch" || exit 1
export=("$MAROTTE" take export s.marotte 1 --size 160x90 --export)
large=("$MAROTTE" take export s.marotte 1 --out 1 --size 640x360 --export) # 20 KB

"$MAROTTE" perform --face moai --input "log:$demo,start=1.2,end=4" --map anchored --record s.marotte >said 2>&1 ||
    fail "record: $(cat said)"
if ! "${export[@]}" probe/ >said 2>&1; then
    grep -q EGL said && echo "SKIPPED: $(cat said)" && exit 77
    fail "pictures: $(cat said)"
    finish
fi

mkdir -p bin out
fake() { # what the encoder does: the rest of a script; the file that it writes is $out
    printf '#!%s\nfor out; do :; done\nout=${out#file:}\n%s\n' "$(command -v bash)" "$1" >bin/ffmpeg.new
    chmod +x bin/ffmpeg.new
    mv bin/ffmpeg.new bin/ffmpeg
}
faked=(env PATH="$scratch/bin:$PATH")

# ---- a disk that fills: ffmpeg says so, and exits with 0 ----
fake 'cat >/dev/null; head -c 9999 /dev/zero >"$out"
echo "Error writing trailer of file:$out: No space left on device" >&2
echo "Error closing file file:$out: No space left on device" >&2'
refused 1 'out/a.mp4: no space is left in out/' "${faked[@]}" "${export[@]}" out/a.mp4
fake 'cat >/dev/null; head -c 9999 /dev/zero >"$out"'
refused 1 'out/a.mp4: ffmpeg did not finish the file' "${faked[@]}" "${export[@]}" out/a.mp4
# A device that is always full, for the whole of what is written.
fake 'cat >/dev/null; head -c 9999 /dev/zero >/dev/full 2>/dev/null || echo "full: No space left on device" >&2; exit 1'
refused 1 'no space is left' "${faked[@]}" "${export[@]}" out/a.mp4
echo old >out/a.mp4
"${faked[@]}" "${export[@]}" out/a.mp4 >/dev/null 2>&1 && fail "a failed export succeeds"
[ "$(cat out/a.mp4)" = old ] || fail "a failed export took the file that was there"
rm -rf out && mkdir out

if command -v ffmpeg >/dev/null; then
    fake "trap '' XFSZ; ulimit -f 8; exec $(command -v ffmpeg) \"\$@\"" # 8 KB a file
    refused 1 'out/a.mp4: out/ takes no file of this size' "${faked[@]}" "${large[@]}" out/a.mp4
    if unshare -Urm true 2>/dev/null; then
        for size in 16k 24k; do
            unshare -Urm bash -c 'mount -t tmpfs -o size='$size' none out && "$@" out/a.mp4 >/dev/null 2>full.txt
                code=$?; ls -A out >left.txt; exit $code' - "${large[@]}" && fail "$size: a full disk is not noticed"
            grep -q 'out/a.mp4: no space is left in out/' full.txt || fail "$size: a full disk is not said: $(cat full.txt)"
            [ -s left.txt ] && fail "$size: left behind: $(cat left.txt)"
        done
    else
        echo "SKIPPED: no file system can be mounted here: nothing of a disk that is full"
    fi
else
    echo "SKIPPED: ffmpeg is not installed: only stand-ins were tried"
fi

# ---- an encoder that stands still ----
is_there() { # for up to a minute
    for _ in $(seq 600); do
        [ -e "$1" ] && return 0
        sleep 0.1
    done
    return 1
}
has_ended() { # a process, for up to a minute; it is ended else
    for _ in $(seq 600); do
        [ "$(ps -o stat= -p "$1" | cut -c1)" = Z ] || ! kill -0 "$1" 2>/dev/null && return 0
        sleep 0.1
    done
    kill -9 "$1"
    return 1
}
mark='echo $$ >encoder.new; mv encoder.new encoder'
for script in "$mark; trap '' TERM; exec sleep 1000" "head -c 100000 >/dev/null; $mark; kill -STOP \$\$" \
    "cat >/dev/null; $mark; exec sleep 1000"; do
    for signal in INT TERM; do
        fake "$script"
        rm -f encoder
        "${faked[@]}" "${export[@]}" out/a.mp4 >/dev/null 2>stderr &
        pid=$!
        is_there encoder || fail "the encoder does not start: $(cat stderr)"
        kill -$signal $pid
        has_ended $pid || fail "$signal does not end an export: $script"
        wait $pid && fail "an export that was stopped succeeds: $script"
        grep -q 'stopped' stderr || fail "stopped: $(cat stderr)"
        [ -z "$(ls -A out)" ] || fail "left behind: $(ls -A out)"
        kill -0 "$(cat encoder)" 2>/dev/null && fail "the encoder goes on: $script" && kill -9 "$(cat encoder)"
    done
done
finish
