#!/usr/bin/env bash
# The real window, by the real keyboard and mouse of an X server: a corner of the mouth is dragged while a
# take is recorded, played, shown on a second window; the window is closed while recording.
source "$(dirname "$0")/xvfb.sh"
show=$scratch/night.marotte

take_count() { # of the show, by now
    "$MAROTTE" take list "$show" --json 2>/dev/null | sed -nE 's/^ *"take_count": ([0-9]+),?$/\1/p'
}
has_takes() {
    [ "$(take_count)" = "$1" ]
}
is_recorded() { # take: it lasts longer than this (s)
    "$MAROTTE" take list "$show" --json 2>/dev/null |
        awk -v least="$2" '/"duration_s"/ { gsub(/[^0-9.]/, "", $2); if ($2 + 0 > least) found = 1 } END { exit !found }'
}

# ---- a corner of the mouth, with nothing but the mouse ----
open_window "$show" --face "$puppet" --map one_hand --settings "$scratch/window.json"
xdotool key r
until_true has_takes 1 || fail "R begins no take: $("$MAROTTE" take list "$show" 2>&1)"
drag 544 319 575 285 20
xdotool key r
until_true is_recorded 1 0.2 || fail "R ends no take: $("$MAROTTE" take list "$show" --json 2>&1)"
"$MAROTTE" take export "$show" 1 --export drag.csv >said 2>stderr2.txt || fail "the take: $(cat stderr2.txt)"
awk -v moved="$(fact 'range of motion' said)" 'BEGIN { exit !(moved > 4) }' ||
    fail "the corner of the mouth moves by $(fact 'range of motion' said) mm"
before=$("$MAROTTE" take show "$show" 1 --hash 2>&1 | sed -n 's/^SHA-256 *//p')

# ---- every view and panel, the take played, the face on a second window ----
for key in question Escape F2 F3 F4 F5 F6 F2 d g f h v c j w w w w w x x; do
    xdotool key "$key"
done
xdotool key Page_Up space Home space
xdotool key F11
until_true has_windows 2 || fail "F11 opens no output"
output_is_before_the_stage() { # windows are listed from the top
    xwininfo -root -tree | grep marotte | head -n 1 | grep -q 'marotte: output'
}
! command -v xwininfo >/dev/null || until_true output_is_before_the_stage || fail "the output opens behind the stage"
xdotool key F11 # the output has the keyboard, and passes it on
until_true has_windows 1 || fail "F11 again leaves the output open"
xdotool windowfocus "$(windows)"
xdotool key 4
rated() {
    "$MAROTTE" take list "$show" --json | grep -q '"rating": 4'
}
until_true rated || fail "4 rates nothing: $("$MAROTTE" take list "$show" --json)"
xdotool key ctrl+z
unrated() {
    ! rated
}
until_true unrated || fail "Ctrl+Z takes nothing back"
xdotool key l k
until_true has_takes 2 || fail "K keeps nothing"
xdotool key ctrl+q
ends 0
[ -s window.json ] || fail "how the window was left is not kept"
[ "$("$MAROTTE" take show "$show" 1 --hash 2>&1 | sed -n 's/^SHA-256 *//p')" = "$before" ] ||
    fail "playing a take has changed it"
[ "$(json frames)" -gt 5 ] || fail "$(json frames) frames"

# ---- closed while it records: the take is there ----
open_window "$show" --face "$puppet" --map one_hand --settings "" --input "log:$demo,loop=1"
xdotool key r
until_true has_takes 3 || fail "R begins no take over a running hand"
until_true is_recorded 3 0.5
kill -TERM "$program_pid"
ends 0
has_takes 3 || fail "the take that was being recorded is gone"
"$MAROTTE" take show "$show" 3 --hash >said 2>&1 || fail "the take that was being recorded: $(cat said)"
"$MAROTTE" take check "$show" >said 2>&1 || fail "the show: $(cat said)"
[ "$(json samples)" -gt 20 ] || fail "$(json samples) samples were performed"

# ---- a picture of it is of what was drawn ----
printf 'frames 3\npicture window.png\n' >script.txt
open_window "$show" --face "$puppet" --settings "" --input "log:$demo,loop=1" --script script.txt
ends 0
[ "$(stat -c %s window.png)" -gt 60000 ] || fail "a picture of the window has nothing on it" # a black one: 18 KB
finish
