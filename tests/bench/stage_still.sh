#!/usr/bin/env bash
# stage_still.sh [SECONDS]: what the stage costs while nobody moves, while a hand rests, and while one performs:
# the CPU time of the process, of all its threads, in % of a core, in a real window drawn in software. Not a test: a
# figure of a quiet machine. MAROTTE=PROGRAM measures another build; that nothing is drawn is the test window/still.
#   ninja -C build/release marotte-program && tests/bench/stage_still.sh
here=$(cd "$(dirname "$0")/../.." && pwd)
seconds=${1:-20} warm_s=10
MAROTTE=$(realpath "${MAROTTE:-$here/build/release/marotte}")
export MAROTTE SOURCE_DIR=$here LIBGL_ALWAYS_SOFTWARE=1
source "$here/tests/window/xvfb.sh" "$seconds"

# A hand that holds the demo's first pose and trembles by up to so many degrees: a bent index finger would move a brow.
resting() { # DEGREES FILE
    awk -F, -v OFS=, -v degrees="$1" '
        /^#/ || !/^[0-9]/ { print; next }
        { n = split($0, v, ","); exit }
        END { srand(7); for (k = 0; k < 12000; ++k) { line = sprintf("%.2f", 0.01 * k); for (i = 2; i <= n; ++i) line = line OFS v[i] + (rand() - 0.5) * 2 * degrees / 57.2958; print line } }' \
        "$demo" >"$2"
}
ticks() { # of the process so far: user and system
    sed 's/.*) //' "/proc/$program_pid/stat" | awk '{ print $12 + $13 }'
}
# cost NAME ARGUMENTS...
cost() {
    local name=$1 before after
    shift
    open_window "$name.marotte" --face "$puppet" --map one_hand --settings "" "$@"
    sleep "$warm_s"
    before=$(ticks)
    sleep "$seconds"
    after=$(ticks)
    kill -TERM "$program_pid"
    ends 0
    awk -v name="$name" -v ticks=$((after - before)) -v hz="$(getconf CLK_TCK)" -v s="$seconds" -v frames="$(json frames)" \
        -v drawn="$(json drawn)" -v face="$(json face_drawn)" \
        'BEGIN { printf "%-16s %6.1f %% of a core   %5d frames, %5d drawn, %4d with the face\n", name, 100 * ticks / hz / s, frames, drawn, face }'
}
resting 0 same.csv
resting 0.3 trembles.csv
cost nobody
cost rests --input "log:same.csv,loop=1"
cost trembles --input "log:trembles.csv,loop=1"
cost performs --input "log:$demo,loop=1"
finish
