# What the scripts with a real window share: an X server of their own, the window in it, hands on its
# keyboard and mouse. Sourced first, with the script's arguments; starts the script again within Xvfb.
# shellcheck shell=bash
for program in Xvfb xdotool; do
    command -v "$program" >/dev/null && continue
    echo "SKIPPED: $program is not installed (packages xvfb, xdotool)"
    exit 77
done
if [ -z "${MAROTTE_WITHIN_XVFB:-}" ]; then
    # -noreset: else the server starts anew when its last client leaves, and refuses the window that opens just then.
    # A display of its own, whatever else runs. Not the lowest free one, as the server would choose: a server that
    # ends just then takes the socket of that number away with it.
    numbers=$(mktemp -d) && mkfifo "$numbers/number" || exit 1
    trap 'kill "$server" 2>/dev/null; wait "$server" 2>/dev/null; rm -rf "$numbers"' EXIT
    for _ in 1 2 3 4 5; do
        number=
        Xvfb ":$((1000 + RANDOM))" -displayfd 3 -screen 0 "${MAROTTE_SCREEN:-1280x720x24}" -nolisten tcp -noreset \
            3>"$numbers/number" >"$numbers/said" 2>&1 </dev/null &
        server=$!
        read -r number <"$numbers/number" && break
    done
    [ -n "$number" ] || { echo "Xvfb does not start:"; cat "$numbers/said"; exit 1; }
    MAROTTE_WITHIN_XVFB=yes DISPLAY=:$number bash "$0" "$@"
    exit $?
fi
source "$(dirname "$0")/../e2e/lib.sh"
export HOME=$scratch XDG_DOCUMENTS_DIR=$scratch DBUS_SESSION_BUS_ADDRESS=unix:path=/nonexistent # what is left open there is nobody's
cd "$scratch" || exit 1
program_pid=
trap '[ -z "$program_pid" ] || kill -9 "$program_pid" 2>/dev/null; rm -rf "$scratch"' EXIT

# until_true COMMAND...: asks ten times a second until it is so, for as long as a program on a busy machine may take.
patience_s=$((300 * (${SANITIZED:+9} + 1)))
until_true() {
    local ends=$((SECONDS + patience_s))
    while ! "$@" >/dev/null 2>&1; do
        [ $SECONDS -lt $ends ] || return 1
        sleep 0.1
    done
}

windows() { # of the program, those that are seen
    xdotool search --onlyvisible --name '^marotte|marotte$' 2>/dev/null
}
has_windows() { # how many
    [ "$(windows | wc -l)" -eq "$1" ]
}
is_gone() {
    ! kill -0 "$program_pid" 2>/dev/null
}

has_ended_or_window() {
    is_gone || has_windows 1
}

# open_window ARGUMENTS...: the program in its window, with the keyboard. The face keeps still.
open_window() {
    "$MAROTTE" stage --size "${window_size:-1280x720}" --life off --json "$@" >facts.json 2>stderr.txt &
    program_pid=$!
    until_true has_ended_or_window # one that says why is not waited for
    if ! has_windows 1; then
        fail "no window opens: $(cat stderr.txt)"
        finish
    fi
    xdotool windowfocus "$(windows)"
}

# The driver of OpenGL leaks, and is unloaded by then: its frames have no names. Ours have.
only_driver_leaks() {
    [ -n "${SANITIZED:-}" ] && grep -q 'LeakSanitizer: detected' stderr.txt &&
        ! grep -v '__interceptor' stderr.txt | grep -qE '^ *#[0-9]+ .* in '
}

# ends CODE: it ends by itself, with that code.
ends() {
    local code
    until_true is_gone || fail "it does not end"
    is_gone || kill -9 "$program_pid"
    wait "$program_pid"
    code=$?
    program_pid=
    ! only_driver_leaks || code=0
    [ $code -eq "$1" ] || fail "exit $code: $(tail -c 2000 stderr.txt)"
}

json() { # the number of a fact
    sed -nE "s/^ *\"$1\": ([-0-9.e+]+),?$/\1/p" facts.json | head -n 1
}

drag() { # X Y X Y STEPS
    xdotool mousemove "$1" "$2" mousedown 1
    for i in $(seq "$5"); do
        xdotool mousemove $(($1 + ($3 - $1) * i / $5)) $(($2 + ($4 - $2) * i / $5))
        sleep 0.03 # a hand takes its time
    done
    xdotool mouseup 1
}
