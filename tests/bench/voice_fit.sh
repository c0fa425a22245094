#!/usr/bin/env bash
# voice_fit.sh OUT.h - fits the weights of core/stage/voice/hearing_weights.h: to voices of espeak-ng and,
# because a voice of rules is no voice of a person, to four voices of flite, which were made from recordings
# of people. Both say the sentences of voice_fit.c. Needs flite, ffmpeg and libespeak-ng-dev; takes minutes.
set -eu
source_dir=$(cd "$(dirname "$0")/../.." && pwd)
fit=${BUILD_DIR:-$source_dir/build/release}/tests/bench/voice_fit
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
files=()
while read -r sentence; do
    for voice in kal16 awb rms slt; do
        name=$work/${#files[@]}
        flite -voice "$voice" -psdur -t "$sentence" -o "$name.16.wav" </dev/null | tr ' ' '\n' | awk -F: '
            NF == 2 {
                sound = toupper($1)
                if (sound == "PAU" || sound == "SSIL") sound = "_"
                if (sound == "AX") sound = "AH"
                printf "%.3f,%.3f,%s\n", from, $2, sound
                from = $2
            }' >"$name.csv"
        ffmpeg -v error -i "$name.16.wav" -ar 22050 -ac 1 "$name.wav" </dev/null
        files+=("$name.wav" "$name.csv")
    done
done < <("$fit" --sentences)
"$fit" "${files[@]}" >"$1"
