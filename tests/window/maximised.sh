#!/usr/bin/env bash
# The window under a window manager: it has its icon; maximised it comes back maximised, and as it was it comes back as it was.
for program in openbox wmctrl xprop; do
    command -v "$program" >/dev/null && continue
    echo "SKIPPED: $program is not installed (packages openbox, wmctrl, x11-utils)"
    exit 77
done
MAROTTE_SCREEN=1600x900x24
source "$(dirname "$0")/xvfb.sh"
openbox >openbox.txt 2>&1 &
manager_pid=$!
trap 'kill "$manager_pid" 2>/dev/null; [ -z "$program_pid" ] || kill -9 "$program_pid" 2>/dev/null; rm -rf "$scratch"' EXIT
manages() {
    wmctrl -m
}
until_true manages || { echo "SKIPPED: openbox does not start: $(cat openbox.txt)"; exit 77; }

state() { # of the window
    xprop -id "$(windows | head -n 1)" _NET_WM_STATE
}
is_maximised() {
    state | grep -q MAXIMIZED_VERT
}
is_as_it_was() {
    ! is_maximised
}
open_again() { # without --size, which would be obeyed
    "$MAROTTE" stage "$scratch/night.marotte" --face "$puppet" --map one_hand --settings "$scratch/window.json" \
        --json >facts.json 2>stderr.txt &
    program_pid=$!
    until_true has_windows 1 || fail "no window opens: $(cat stderr.txt)"
    xdotool windowfocus "$(windows)"
}
quit() { # the key comes after what the window was told before
    xdotool key ctrl+q
    ends 0
}

open_again
if command -v rsvg-convert >/dev/null; then # the build made the icons
    xprop -id "$(windows | head -n 1)" -len 64 32c _NET_WM_ICON >icon.txt
    grep -q '= 16, 16' icon.txt || fail "it has no icon: $(cat icon.txt)"
fi
is_maximised && fail "it begins maximised"
wmctrl -r marotte -b add,maximized_vert,maximized_horz
until_true is_maximised || fail "it cannot be maximised: $(state)"
quit
open_again
until_true is_maximised || fail "it was left maximised and comes back as: $(state)"
wmctrl -r marotte -b remove,maximized_vert,maximized_horz
until_true is_as_it_was || fail "it stays maximised: $(state)"
quit
open_again
is_maximised && fail "it was left small and comes back maximised"
wmctrl -lG | awk '/marotte/ { exit !($5 == 1280 && $6 == 720) }' || fail "it comes back as $(wmctrl -lG)"
quit
finish
