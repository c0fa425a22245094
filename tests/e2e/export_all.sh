#!/usr/bin/env bash
# Every take of a show into files, resumed where it stopped; a video in shares that join into the whole.
source "$(dirname "$0")/lib.sh"
cd "$scratch" || exit 1
cp "$(dirname "$puppet")/../moai/moai.glb" face.glb
for shot in a b ä; do
    "$MAROTTE" perform --face face.glb --input "log:$demo,start=1.2,end=2.2" --map anchored --record s.marotte \
        --scene 1 --shot "$shot" >/dev/null 2>stderr || fail "record: $(cat stderr)"
done

all() { # how many are exported, how many kept, more words
    local done_now=$1 kept=$2
    shift 2
    "$MAROTTE" take export s.marotte --all --export 'out/{scene}/{slate}.pc2' --export 'out/{scene}/{take}.csv' "$@" \
        >said 2>stderr || fail "--all $*: $(cat stderr)"
    [ "$(fact 'takes exported' said)" = "$done_now" ] || fail "--all $*: $(fact 'takes exported' said) instead of $done_now"
    [ "$(fact 'complete already' said)" = "$kept" ] || fail "--all $*: $(fact 'complete already' said) kept instead of $kept"
}

# Twice the same, however many at a time; and what is complete is not done again.
all 3 0 --jobs 2
[ "$(cd out/1 && echo ./*.pc2)" = './1-a-1.pc2 ./1-b-1.pc2 ./1-ä-1.pc2' ] || fail "files: $(ls out/1)"
"$MAROTTE" take export s.marotte 2 --export one.pc2 >/dev/null 2>&1
cmp one.pc2 out/1/1-b-1.pc2 || fail "--all is another file than the take by itself"
before=$(stat -c %Y.%i out/1/*)
all 0 3
[ "$(stat -c %Y.%i out/1/*)" = "$before" ] || fail "what is complete was written again"

# What is not true any more is done again, and only that.
"$MAROTTE" take trim s.marotte 2 --out 0.5 >/dev/null
all 1 2
"$MAROTTE" take undo s.marotte 2 >/dev/null
all 1 2
rm out/1/1-a-1.pc2
printf x >>out/1/3.csv
all 2 1
all 3 0 --fps 24
all 3 0 --jobs 3
"$MAROTTE" take delete s.marotte 3 >/dev/null && all 0 2 && "$MAROTTE" take undo s.marotte 3 >/dev/null
cp face.glb other.glb && sed -i 's/"stone"/"stonf"/' face.glb && ! cmp -s face.glb other.glb || fail "face.glb is as it was"
all 3 0
grep -q 'changed since take 1 was recorded' stderr || fail "a source that changed is not told: $(cat stderr)"
cp other.glb face.glb
all 3 0

# ---- what is wrong ----
bad() { # code words, then those of the export
    refused "$1" "$2" "$MAROTTE" take export s.marotte "${@:3}"
}
bad 2 'have the same file name' --all --export 'out/{scene}.pc2'
bad 2 'needs {take} or {slate}' --all --export out/x.pc2
bad 2 'a name can contain only' --all --export 'out/{face}.pc2'
bad 2 'give a TAKE, or --all' --export out/x.pc2
bad 2 'give a TAKE, or --all' 1 --all --export 'out/{take}.pc2'
bad 2 'for parts of one take' 1 --jobs 2 --export out/x.pc2
bad 2 'not a number from 1 to 64' --all --jobs 0 --export 'out/{take}.pc2'
bad 2 'is not FIRST-LAST' 1 --frames 0-3 --export out/x.pc2
bad 2 'is not FIRST-LAST' 1 --frames 5-3 --export out/x.pc2
bad 1 'there are only 31 frames' 1 --frames 5-32 --export out/x.pc2
touch file
bad 1 'file: cannot create this folder' --all --export 'file/{take}.pc2'
echo '{}' >mine.json && mkdir mine && echo '{}' >mine/marotte_exports.json
bad 1 'not a list of marotte' --all --export 'mine/{take}.pc2'

# What the disk has no room for is said before it is performed.
if mkdir small && mount -t tmpfs -o size=1m tmpfs small 2>/dev/null; then
    bad 1 'GB, but only' 1 --fps 120 --export small/x.pc2
    [ -z "$(ls -A small)" ] || fail "begun although there is no room: $(ls small)"
    umount small
else
    echo "SKIPPED: no small disk can be made here: whether an export that does not fit is told before"
fi

# One take that cannot be written costs no other; a full disk leaves no half file.
mkdir -p part/2.pc2
"$MAROTTE" take export s.marotte --all --export 'part/{take}.pc2' >said 2>stderr && fail "a folder in the place of a file"
grep -q '1 of 3 takes could not be exported' stderr && grep -q 'take 2 .*2.pc2: is a directory' stderr || fail "$(cat stderr)"
[ -s part/1.pc2 ] && [ -s part/3.pc2 ] || fail "the takes beside a bad one are not there: $(ls part)"
(trap '' XFSZ; ulimit -f 64; "$MAROTTE" take export s.marotte --all --jobs 2 --export 'full/{take}.pc2' >/dev/null 2>stderr) &&
    fail "a full disk is not noticed"
[ "$(find full -type f ! -name marotte_exports.json | wc -l)" -eq 0 ] || fail "half files on a full disk: $(ls full)"

# Ended in the middle, all of it ends, no half file stays, and Run the same command again.
"$MAROTTE" take export s.marotte --all --jobs 2 --fps 1000 --export 'stop/{take}.glb' >said 2>stderr &
first=$!
for _ in $(seq 3000); do
    [ "$(pgrep -P $first | wc -l)" -eq 2 ] && break
    kill -0 $first 2>/dev/null || break
    sleep 0.02
done
children=$(pgrep -P $first)
[ -n "$children" ] || fail "no process for a take"
kill -TERM $first
wait $first && fail "it was not stopped"
grep -q 'Run the same command again' stderr || fail "stopped: $(cat stderr)"
for child in $children; do kill -0 "$child" 2>/dev/null && fail "process $child goes on"; done
[ -z "$(find stop -name '*.??????' 2>/dev/null)" ] || fail "left behind: $(ls -A stop)"
"$MAROTTE" take export s.marotte --all --export 'stop/{take}.csv' >/dev/null 2>&1 || fail "it does not go on"

# ---- a video in shares ----
small=(--size 160x90)
if ! "$MAROTTE" take export s.marotte 1 "${small[@]}" --export whole/ >said 2>stderr; then
    grep -q EGL stderr && echo "SKIPPED: no pictures: $(cat stderr)" && finish
    fail "pictures: $(cat stderr)"
fi
"$MAROTTE" take export s.marotte 1 --frames 1-12 "${small[@]}" --export a/ >/dev/null 2>&1 || fail "--frames"
"$MAROTTE" take export s.marotte 1 --frames 13-31 "${small[@]}" --export b/ >/dev/null 2>&1 || fail "--frames"
for i in $(seq 31); do
    part=$([ "$i" -le 12 ] && printf 'a/%05d.png' "$i" || printf 'b/%05d.png' $((i - 12)))
    cmp -s "$(printf 'whole/%05d.png' "$i")" "$part" || fail "frame $i is another picture in a share"
done
command -v ffmpeg >/dev/null && command -v ffprobe >/dev/null || {
    echo "SKIPPED: ffmpeg and ffprobe are not installed: shares are not joined"
    finish
}
for frames in 1-12 13-31; do
    "$MAROTTE" take export s.marotte 1 --frames $frames "${small[@]}" --export "share.$frames.mp4" >/dev/null 2>&1 ||
        fail "share $frames"
done
printf "file '%s'\n" share.1-12.mp4 share.13-31.mp4 >shares.txt
ffmpeg -v error -f concat -safe 0 -i shares.txt -c copy joined.mp4 </dev/null || fail "ffmpeg does not join them"
[ "$(ffprobe -v error -count_frames -select_streams v -show_entries stream=nb_read_frames,r_frame_rate -of default=nk=1:nw=1 joined.mp4 | xargs)" = '30/1 31' ] ||
    fail "joined: $(ffprobe -v error -count_frames -select_streams v -show_entries stream=nb_read_frames,r_frame_rate joined.mp4 | xargs)"
frames_of() { ffmpeg -v error -i "$1" -pix_fmt rgba -f framemd5 - </dev/null | awk -F, '!/^#/ { print $NF }'; }
[ "$(frames_of joined.mp4)" = "$(frames_of share.1-12.mp4; frames_of share.13-31.mp4)" ] || fail "joined: other pictures than the shares'"
finish
