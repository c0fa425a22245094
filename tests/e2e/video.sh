#!/usr/bin/env bash
# Pictures and .mp4 of performances and takes: as many frames as there are, twice the same, in sync with
# the sound; and what becomes of them when ffmpeg, the folder or the person does not play along.
source "$(dirname "$0")/lib.sh"
cd "$scratch" || exit 1
small=(--size 160x90)
performed=(--face moai --input "log:$demo,start=1.2,end=3.2" --map one_hand)

perform() {
    "$MAROTTE" perform --verbose "${performed[@]}" "$@" >"$scratch/said" 2>"$scratch/stderr" ||
        fail "perform $*: $(cat "$scratch/stderr")"
}
take() {
    "$MAROTTE" take "$@" >"$scratch/said" 2>"$scratch/stderr" || fail "take $*: $(cat "$scratch/stderr")"
}
says() {
    grep -qF -- "$1" "$scratch/said" || fail "\"$1\" is not said: $(cat "$scratch/said")"
}
probe() { # file stream-kind entry: its value
    ffprobe -v error -select_streams "$2" -show_entries "stream=$3" -of default=nk=1:nw=1 "$1"
}
sums() { # the pictures of a folder
    (cd "$1" && sha256sum ./*.png | sha256sum)
}
decoded() { # file [filter]: the sum of all its pixels
    ffmpeg -v error -i "$1" ${2:+-vf "$2"} -pix_fmt rgba -f md5 - </dev/null
}
pixel() { # picture x y: its bytes
    ffmpeg -v error -i "$1" -vf "crop=1:1:$2:$3" -pix_fmt rgba -f rawvideo - </dev/null | od -An -tu1 | xargs
}

# ---- pictures ----
if ! "$MAROTTE" perform --verbose "${performed[@]}" "${small[@]}" --export frames/ >"$scratch/said" 2>"$scratch/stderr"; then
    grep -q EGL "$scratch/stderr" && echo "SKIPPED: $(cat "$scratch/stderr")" && exit 77
    fail "pictures: $(cat "$scratch/stderr")"
    finish
fi
says 'pictures           61'
says 'wrote              frames/'
[ "$(find frames -name '*.png' | wc -l)" -eq 61 ] || fail "$(find frames -name '*.png' | wc -l) pictures"
[ -f frames/00001.png ] && [ -f frames/00061.png ] || fail "the pictures are not 00001 to 00061"
grep -q '"rate": "30/1"' frames/frames.json || fail "frames.json: $(cat frames/frames.json)"
cmp -s frames/00001.png frames/00047.png && fail "the pictures do not move"
perform "${small[@]}" --export again/
[ "$(sums frames)" = "$(sums again)" ] || fail "two performances are not the same pictures"

# A contact sheet has the size that is asked for, or its own.
png_size() { od -An -tu1 -j16 -N8 "$1" | awk '{ print $3 * 256 + $4 "x" $7 * 256 + $8 }'; }
perform --size 640x360 --seconds 0.2 --export sheet.png
[ "$(png_size sheet.png)" = 640x360 ] || fail "a sheet of $(png_size sheet.png) instead of 640x360"
perform --seconds 0.2 --export sheet.png
[ "$(png_size sheet.png)" = 1920x960 ] || fail "a sheet of $(png_size sheet.png)"
"$MAROTTE" rig show "$puppet" --poses --only joy,anger --size 500x400 --out poses.png >/dev/null || fail "rig show --poses --size"
[ "$(png_size poses.png)" = 500x400 ] || fail "poses on $(png_size poses.png)"
refused 1 'at least 294 by 196' "$MAROTTE" rig show "$puppet" --size 160x90 --out out/rig.png

# A shorter one in its place leaves none of the longer one, and what is not ours.
echo mine >again/notes.txt
before=$(sums frames)
perform "${small[@]}" --seconds 1 --export again/
[ "$(find again -name '*.png' | wc -l)" -le 31 ] || fail "old pictures are among the new ones"
[ "$(find again -mindepth 1 | wc -l)" -le 33 ] || fail "left behind: $(ls -A again)"
[ -f again/notes.txt ] || fail "a file that is not ours is gone"
mkdir others && touch others/00001.png
refused 1 'Choose an empty or a new folder' "$MAROTTE" perform "${performed[@]}" --export others/
touch frames/00099.png
refused 1 '00099.png is not one of the 61 pictures' "$MAROTTE" perform "${performed[@]}" --export frames/
rm frames/00099.png
printf x >nowhere
refused 1 'nowhere: cannot create this folder' "$MAROTTE" perform "${performed[@]}" --export nowhere/frames/
[ "$(sums frames)" = "$before" ] || fail "a refusal changed the pictures that were there"
# The limit is on every file: as if the disk were full.
(trap '' XFSZ; ulimit -f 8; "$MAROTTE" perform "${performed[@]}" --export out/full/ >/dev/null 2>full.txt) &&
    fail "a full disk is not noticed"
grep -q 'full/0000.*cannot write' full.txt || fail "a full disk is not said: $(cat full.txt)"
[ -e out/full ] && fail "a failed export leaves a folder"

# What the person asks for.
refused 2 'WIDTHxHEIGHT' "$MAROTTE" perform "${performed[@]}" --export out/a/ --size 640
refused 2 'front, side or' "$MAROTTE" perform "${performed[@]}" --export out/a/ --view back
refused 2 'transparent, or a colour' "$MAROTTE" perform "${performed[@]}" --export out/a/ --background green
refused 2 'even number of pixels on each side: --size 640x482' "$MAROTTE" perform "${performed[@]}" --export out/a.mp4 --size 640x481
refused 2 'cannot be transparent' "$MAROTTE" perform "${performed[@]}" --export out/a.mp4 --background transparent
refused 1 'EGL' env __EGL_VENDOR_LIBRARY_FILENAMES=/nowhere.json "$MAROTTE" perform "${performed[@]}" --export out/a/
refused 1 'package ffmpeg' env PATH=/nowhere "$MAROTTE" perform "${performed[@]}" --export out/a.mp4

command -v ffmpeg >/dev/null && command -v ffprobe >/dev/null || {
    echo "SKIPPED: ffmpeg and ffprobe are not installed: nothing of .mp4"
    finish
}
perform "${small[@]}" --seconds 0.1 --mirror --export mirrored/ --background '#00b140'
perform "${small[@]}" --seconds 0.1 --export plain/ --background '#00b140'
[ "$(decoded mirrored/00003.png)" = "$(decoded plain/00003.png hflip)" ] || fail "--mirror does not mirror"
[ "$(decoded mirrored/00003.png)" != "$(decoded plain/00003.png)" ] || fail "the face is symmetric"
[ "$(pixel plain/00001.png 1 1)" = '0 177 64 255' ] || fail "--background: $(pixel plain/00001.png 1 1)"
perform "${small[@]}" --seconds 0.1 --view side --export side/ --background transparent
[ "$(pixel side/00001.png 1 1)" = '0 0 0 0' ] || fail "nothing is not transparent: $(pixel side/00001.png 1 1)"
[ "$(pixel side/00001.png 80 45 | cut -d' ' -f4)" = 255 ] || fail "the face is transparent"

# ---- .mp4 ----
perform "${small[@]}" --fps 29.97 --seconds 1 --export a.mp4
[ "$(probe a.mp4 v codec_name,pix_fmt | xargs)" = 'h264 yuv420p' ] || fail "a.mp4: $(probe a.mp4 v codec_name,pix_fmt)"
[ "$(probe a.mp4 v r_frame_rate)" = 30000/1001 ] || fail "frame rate: $(probe a.mp4 v r_frame_rate)"
[ "$(probe a.mp4 v nb_frames)" -eq "$(fact frames said)" ] || fail "frames of a.mp4: $(probe a.mp4 v nb_frames)"
[ -z "$(probe a.mp4 a codec_name)" ] || fail "there is sound from nowhere"
perform "${small[@]}" --fps 29.97 --seconds 1 --export b.mp4
[ "$(decoded a.mp4)" = "$(decoded b.mp4)" ] || fail "two performances are not the same .mp4"

# ---- a take: its range, its time code, its sound where the timeline has it ----
"$MAROTTE" perform "${performed[@]}" --record s.marotte >/dev/null 2>&1 || fail "record"
take timecode s.marotte 1 --fps 29.97df --start 01:00:00\;00
take export s.marotte 1 --in 0.5 --out 1.5 "${small[@]}" --export t.mp4 --export t/
says 'pictures           30'
[ "$(probe t.mp4 v r_frame_rate,nb_frames | xargs)" = '30000/1001 30' ] || fail "t.mp4: $(probe t.mp4 v r_frame_rate,nb_frames)"
[ "$(probe t.mp4 d codec_tag_string)" = tmcd ] || fail "no track of time code"
ffprobe -v error -show_entries stream_tags=timecode -of default=nk=1:nw=1 t.mp4 | grep -qF '01:00:00;15' ||
    fail "time code: $(ffprobe -v error -show_entries stream_tags=timecode t.mp4)"
grep -qF '"timecode": "01:00:00;15"' t/frames.json || fail "frames.json: $(cat t/frames.json)"
[ "$(find t -name '*.png' | wc -l)" -eq 30 ] || fail "pictures of a take"
# What perform shows at an instant is what the take shows then.
take timecode s.marotte 1 --fps 30 --start 00:00:00:00
take export s.marotte 1 --out 1 "${small[@]}" --export u/
for i in 00001 00015 00030; do
    cmp -s "u/$i.png" "frames/$i.png" || fail "picture $i of the take is not that of the performance"
done

# A click 1 s into the sound, which is laid 0.25 s late: 0.75 s into a video from 0.5 s on.
{
    printf '.snd\0\0\0\30\377\377\377\377\0\0\0\3\0\0\273\200\0\0\0\1'
    head -c 96000 /dev/zero
    for _ in $(seq 240); do printf '\100\0\100\0\300\0\300\0'; done
    head -c 96000 /dev/zero
} >click.au
take audio attach s.marotte 1 click.au --offset 0.25
take export s.marotte 1 --in 0.5 "${small[@]}" --export c.mp4 --wav
[ "$(probe c.mp4 a codec_name)" = aac ] || fail "no sound in c.mp4: $(probe c.mp4 a codec_name)"
[ -f c.wav ] || fail "--wav beside an .mp4"
loudest() { # file: the first ms at which it is loud
    ffmpeg -v error -i "$1" -vn -ac 1 -ar 48000 -f s16le - </dev/null |
        od -An -v -td2 -w2 | awk '($1 > 4000 || $1 < -4000) && !at { at = NR } END { printf "%d\n", at / 48 }'
}
at=$(loudest c.mp4)
[ "$at" -ge 747 ] && [ "$at" -le 753 ] || fail "the click comes at $at ms instead of 750"
[ "$(loudest c.wav)" -eq 750 ] || fail "the click of the .wav comes at $(loudest c.wav) ms"
length=$(probe c.mp4 a duration) pictures=$(probe c.mp4 v duration)
awk -v a="$length" -v v="$pictures" 'BEGIN { exit !(a - v < 0.05 && v - a < 0.05) }' ||
    fail "sound of $length s to pictures of $pictures s"
[ "$(find . -name '*.wav' | sort | xargs)" = ./c.wav ] || fail "sound is left behind: $(ls -- *.wav)"

# ---- bad luck ----
mkdir -p bin out
fake() { # what an ffmpeg does: the rest of a script
    printf '#!%s\n%s\n' "$(command -v bash)" "$1" >bin/ffmpeg
    chmod +x bin/ffmpeg
}
fake 'head -c 2000000 >/dev/null; kill -9 $$'
refused 1 'out/a.mp4: ffmpeg was ended (Killed) after' env PATH="$scratch/bin:$PATH" "$MAROTTE" perform \
    "${performed[@]}" "${small[@]}" --export out/a.mp4
fake 'head -c 2000000 >/dev/null; echo "something else" >&2; echo "av_interleaved_write_frame(): No space left on device" >&2; exit 1'
refused 1 'out/a.mp4: no space is left in out/' env PATH="$scratch/bin:$PATH" "$MAROTTE" take export s.marotte 1 "${small[@]}" --export out/a.mp4
fake 'exit 3'
refused 1 'it gives no reason' env PATH="$scratch/bin:$PATH" "$MAROTTE" perform "${performed[@]}" "${small[@]}" --export out/a.mp4
echo old >out/a.mp4
PATH="$scratch/bin:$PATH" "$MAROTTE" take export s.marotte 1 "${small[@]}" --export out/a.mp4 >/dev/null 2>&1
[ "$(cat out/a.mp4)" = old ] || fail "a failed export took the file that was there"
rm -rf out && mkdir out

# Ctrl-C: a performance ends and is whole; an export of a take is given up and leaves nothing.
wait_for_pictures() { # folder with unfinished.* in it
    for _ in $(seq 600); do
        [ "$(find "$1" -name '0000*.png' 2>/dev/null | wc -l)" -ge 3 ] && return 0
        sleep 0.1
    done
    fail "no pictures come into $1"
}
"$MAROTTE" perform --face moai --input "log:$demo,loop=1" --map one_hand "${small[@]}" --export out/f/ \
    --export out/p.mp4 >/dev/null 2>"$scratch/stderr" &
pid=$!
wait_for_pictures out/f
kill -INT $pid
wait $pid || fail "an interrupted performance fails: $(cat "$scratch/stderr")"
count=$(find out/f -name '*.png' | wc -l)
[ "$(probe out/p.mp4 v nb_frames)" -eq "$count" ] || fail "an interrupted .mp4 has $(probe out/p.mp4 v nb_frames) frames of $count"
[ "$(find out -mindepth 1 -maxdepth 1 | wc -l)" -eq 2 ] || fail "left behind: $(ls -A out)"
rm -rf out && mkdir out
"$MAROTTE" take export s.marotte 1 --fps 1000 "${small[@]}" --export out/f/ --export out/p.mp4 >/dev/null 2>"$scratch/stderr" &
pid=$!
wait_for_pictures out/f
kill -INT $pid
wait $pid && fail "an interrupted export succeeds"
grep -q 'stopped at frame' "$scratch/stderr" || fail "interrupted: $(cat "$scratch/stderr")"
[ -z "$(ls -A out)" ] || fail "an interrupted export leaves $(ls -A out)"

# A stream is received by somebody else's program while it is performed.
port=$((20000 + RANDOM % 30000))
# It looks at half a second before it writes: else it waits for five, and then for the end of its patience.
ffmpeg -nostdin -v error -y -analyzeduration 500000 -i "udp://127.0.0.1:$port?timeout=100000000" -frames:v 10 -c copy \
    got.ts 2>"$scratch/got" &
pid=$!
for _ in $(seq 600); do
    grep -qi ":$(printf %04X "$port") " /proc/net/udp && break
    sleep 0.1
done
perform "${small[@]}" --fps 25 --export "udp://127.0.0.1:$port"
says "udp://127.0.0.1:$port"
wait $pid || fail "the stream is not received: $(cat "$scratch/got")"
[ "$(probe got.ts v width | head -n 1)" = 160 ] || fail "what is received is $(probe got.ts v width) wide"

# Ten times as many frames take no more memory: 133 more, at most 15 KB each.
perform --size 32x32 --seconds 0.5 --fps 30 --export m/
few=$(fact 'peak memory' said)
perform --size 32x32 --seconds 0.5 --fps 300 --export m/
many=$(fact 'peak memory' said)
[ -n "${SANITIZED:-}" ] || awk -v a="$few" -v b="$many" 'BEGIN { exit !(b - a < 2) }' || fail "memory grows with length: $few to $many MiB"
finish
