#!/usr/bin/env bash
# Takes: recorded, listed, edited, performed anew, compared, exported at true frame rates, read back;
# and whatever is wrong with what marotte take is given.
source "$(dirname "$0")/lib.sh"
show=$scratch/a.marotte
cd "$scratch" || exit 1

take() { # words of marotte take
    "$MAROTTE" take "$@" 2>"$scratch/stderr" || fail "take $*: $(cat "$scratch/stderr")"
}
says() { # words, then those of marotte take
    local words=$1
    shift
    take "$@" >"$scratch/said"
    grep -qF -- "$words" "$scratch/said" || fail "take $* does not say \"$words\": $(cat "$scratch/said")"
}
sum_of() { # show take [more]
    take show "$@" --hash | sed -n 's/^SHA-256 *//p'
}
record() { # show face map [more]
    local to=$1 face=$2 map=$3
    shift 3
    "$MAROTTE" perform --face "$face" --input "log:$demo,start=1.2,end=3.2" --map "$map" \
        --record "$to" "$@" >/dev/null 2>"$scratch/stderr" || fail "record: $(cat "$scratch/stderr")"
}
number() { # a number of JSON: key
    sed -nE "s/^ *\"$1\": ([-0-9.e+]+),?$/\1/p" "$scratch/said" | head -n 1
}

# Every subcommand says what it is.
"$MAROTTE" take --help | sed -nE 's/^  ((layer |audio )?[a-z]+) SHOW.*/\1/p' >"$scratch/verbs"
[ "$(wc -l <"$scratch/verbs")" -gt 40 ] || fail "the list of subcommands is short"
while read -r verb; do
    # shellcheck disable=SC2086
    "$MAROTTE" take $verb --help | grep -q "^marotte take $verb SHOW" || fail "take $verb --help"
done <"$scratch/verbs"

# Recorded, and what is there.
record "$show" "$puppet" one_hand --scene 1 --shot a
says 'takes              1' list "$show"
says '1/a/1' list "$show"
says 'org.marotte.one_hand' show "$show" last
# A program that only reads leaves nothing beside the show.
mkdir "$scratch/still"
cp "$show" "$scratch/still/a.marotte"
take list "$scratch/still/a.marotte" >"$scratch/said"
take export "$scratch/still/a.marotte" 1 --export "$scratch/still.csv" --out 0.1 >"$scratch/said"
[ "$(ls -A "$scratch/still")" = a.marotte ] || fail "left beside a show that was read: $(ls -A "$scratch/still")"
take list "$show" --json >"$scratch/said"
[ "$(number take_count)" = 1 ] || fail "list --json: $(cat "$scratch/said")"
first=$(sum_of "$show" 1/a/1)
[ ${#first} -eq 64 ] || fail "no sum: $first"

# Edits change what is shown, undo brings the very same vertices back.
says 'trim the take to 0.5 .. 1.5 s' trim "$show" 1 --in 0.5 --out 1.5
[ "$(sum_of "$show" 1)" != "$first" ] || fail "a trim changes nothing"
take undo "$show" 1 >/dev/null
[ "$(sum_of "$show" 1)" = "$first" ] || fail "undo does not bring the take back"
says 'trim the take' redo "$show" 1
take undo "$show" 1 >/dev/null
says '(undone)' history "$show" 1
take split "$show" 1 --at 0.8 >/dev/null
[ "$(sum_of "$show" 1)" = "$first" ] || fail "a split moves the face"
take timecode "$show" 1 --fps 25 --start 01:00:00:00 >/dev/null
says 'mark 1 s' mark "$show" 1 here --at 01:00:01:00
take note "$show" 1 'a note' >/dev/null
take rate "$show" 1 4 >/dev/null
take rename "$show" 1 best >/dev/null
says 'rating             4 of 5' show "$show" 1
says 'best' list "$show"
take mute "$show" 1 --layer performance >/dev/null
take mute "$show" 1 --layer performance --off >/dev/null
[ "$(sum_of "$show" 1 --fps 30)" = "$first" ] || fail "a mute that ended has left something"
take delete "$show" 1 >/dev/null
says 'deleted' list "$show"
take restore "$show" 1 >/dev/null
take edit "$show" 1 '{"op":"take.rate","rating":2}' >/dev/null
says 'rating             2 of 5' show "$show" 1

# Performed anew: another take; the old one is untouched; the difference is told in mm.
take remap "$show" 1 --filter min_cutoff=0.5,beta=0.01 >"$scratch/said"
grep -q '^face .*max [0-9.]* mm' "$scratch/said" || fail "remap tells no mm: $(cat "$scratch/said")"
[ "$(sum_of "$show" 1 --fps 30)" = "$first" ] || fail "a remap changes the old take"
second=$(sum_of "$show" 2 --fps 30)
[ "$second" != "$first" ] || fail "a remap through another filter changes nothing"
take diff "$show" 1 1 --json >"$scratch/said"
[ "$(number max_mm)" = 0.0 ] || fail "a take differs from itself: $(cat "$scratch/said")"
take diff "$show" 1 2 --region mouth --csv "$scratch/d.csv" >"$scratch/said"
grep -q '^mouth' "$scratch/said" || fail "diff --region mouth: $(cat "$scratch/said")"
! grep -q '^brows' "$scratch/said" || fail "diff --region tells others"
[ "$(wc -l <"$scratch/d.csv")" -gt 40 ] || fail "diff --csv is short"

# The mouth of another take: where it is comped, the brows stay.
take comp "$show" 1 --from 2 --region mouth --in 0.5 --out 1.5 --fade 0.2 >/dev/null
take diff "$show" 1 2 --in 0.9 --out 1.1 --json >"$scratch/said"
[ "$(sum_of "$show" 1 --fps 30)" != "$first" ] || fail "a comp changes nothing"
take undo "$show" 1 >/dev/null
[ "$(sum_of "$show" 1 --fps 30)" = "$first" ] || fail "an undone comp has left something"

# Exports at true rates, with time code.
rates=(24 29.97 60)
[ -z "${MAROTTE_TEST_LONG:-}" ] || rates=(24 25 29.97 30 50 60)
for rate in "${rates[@]}"; do
    take export "$show" 1 --export "$scratch/r.csv" --fps $rate --out 0.2 >"$scratch/said"
    head -n 1 "$scratch/r.csv" | grep -q '^# first frame 01:00:00:00' ||
        fail "$rate fps: $(head -n 1 "$scratch/r.csv")"
done
head -n 1 "$scratch/r.csv" | grep -q '60/1 frames a second' || fail "$(head -n 1 "$scratch/r.csv")"
take export "$show" 1 --export "$scratch/o.glb" --export "$scratch/o.pc2" --export "$scratch/o.mdd" \
    --export "$scratch/o.png" --size 640x320 --in 0.5 --out 1.5 >"$scratch/said"
[ "$(fact frames "$scratch/said")" = 25 ] || fail "not 25 frames of 25 fps in a second"
grep -q 'first frame        01:00:00:13' "$scratch/said" || fail "first frame: $(cat "$scratch/said")"
grep -aq '"timecode":"01:00:00:13"' "$scratch/o.glb" || fail "no time code in the glTF"

[ "$(od -An -tf4 -j 20 -N 4 "$scratch/o.pc2" | tr -d ' ')" = 90013 ] || fail "PC2 does not begin at its frame"
if command -v node >/dev/null; then
    node "$SOURCE_DIR/tests/e2e/validate.mjs" "$scratch/o.glb" >"$scratch/said" 2>&1
    [ $? -ne 1 ] || fail "the glTF validator has objections: $(cat "$scratch/said")"
fi

# Recordings that were performed faster than life lie over each other in time: what is kept of them can
# be edited like any take.
for _ in 1 2 3 4 5 6; do record "$scratch/k.marotte" "$moai" anchored; done
take keep "$scratch/k.marotte" --last 3 --scene kept >/dev/null
says 'trim the take' trim "$scratch/k.marotte" last --in 0.5 --out 1
rm "$scratch/k.marotte"

# A show that is deleted while somebody records into it is copied when the recording ends.
"$MAROTTE" perform --face "$moai" --input "log:$demo,start=1.2,end=3.2" --map anchored --realtime \
    --record "$scratch/d.marotte" >/dev/null 2>"$scratch/deleted" &
until "$MAROTTE" take list "$scratch/d.marotte" 2>/dev/null | grep -q 'being recorded'; do
    kill -0 $! 2>/dev/null || break
done
rm -f "$scratch/d.marotte"
wait $! || fail "a deleted show ends the performance: $(cat "$scratch/deleted")"
grep -q "all of it is in $scratch/d.rescued.marotte" "$scratch/deleted" || fail "deleted: $(cat "$scratch/deleted")"
says 'damaged places     0' check "$scratch/d.rescued.marotte"
says '2.0' list "$scratch/d.rescued.marotte"

# Where its folder is removed, too, the copy lies with the person's data, and the exit code says that it is
# not where it was to be. Without a place for it, the recording is lost.
for home in "$scratch/home" /dev/null; do
    mkdir "$scratch/gone"
    XDG_DATA_HOME=$home "$MAROTTE" perform --face "$moai" --input "log:$demo,start=1.2,end=3.2" --map anchored \
        --realtime --record "$scratch/gone/d.marotte" >/dev/null 2>"$scratch/deleted" &
    until "$MAROTTE" take list "$scratch/gone/d.marotte" 2>/dev/null | grep -q 'being recorded'; do
        kill -0 $! 2>/dev/null || break
    done
    rm -rf "$scratch/gone"
    wait $!
    code=$?
    [ $code -eq 1 ] || fail "exit $code for a show whose folder is removed: $(cat "$scratch/deleted")"
    grep -q "$scratch/gone/d.marotte" "$scratch/deleted" || fail "removed: $(cat "$scratch/deleted")"
    if [ "$home" = /dev/null ]; then
        grep -q 'is lost' "$scratch/deleted" || fail "removed: $(cat "$scratch/deleted")"
    else
        grep -q "all of it is in $home/marotte/rescued/d.rescued.marotte" "$scratch/deleted" || fail "removed: $(cat "$scratch/deleted")"
        says '2.0' list "$home/marotte/rescued/d.rescued.marotte"
    fi
done

# Stopped in a pass that is shorter than its fades: kept; so many steps of undo take it back.
record "$scratch/p.marotte" "$puppet" one_hand
bare=$(sum_of "$scratch/p.marotte" 1)
take record "$scratch/p.marotte" 1 --input "log:$demo,start=1.2,end=2.3" --map one_hand --own mouth \
    --in 0.5 --out 1.5 --passes 3 --fade 0.4 --json >"$scratch/said"
[ "$(number layers)" = 2 ] || fail "passes kept: $(cat "$scratch/said")"
take undo "$scratch/p.marotte" 1 --steps "$(number edits)" >/dev/null
[ "$(sum_of "$scratch/p.marotte" 1)" = "$bare" ] || fail "undo leaves something of what was performed over it"

# A track as a log performs the same vertices.
for map in one_hand unanchored; do
    take log "$show" 1 --out "$scratch/t.csv" >/dev/null
    "$MAROTTE" perform --face "$puppet" --input "log:$scratch/t.csv" --map $map \
        --record "$scratch/t_$map.marotte" >/dev/null 2>&1 || fail "the log is not performed"
    record "$scratch/u_$map.marotte" "$puppet" $map
    [ "$(sum_of "$scratch/t_$map.marotte" 1)" = "$(sum_of "$scratch/u_$map.marotte" 1)" ] ||
        fail "$map: a track written as a log performs otherwise"
done

# Sound: a second at 8 kHz, in, and out again.
{
    printf 'RIFF\xa4\x3e\x00\x00WAVEfmt \x10\x00\x00\x00\x01\x00\x01\x00\x40\x1f\x00\x00\x80\x3e\x00\x00'
    printf '\x02\x00\x10\x00data\x80\x3e\x00\x00'
    head -c 16000 "$MAROTTE"
} >"$scratch/v.wav"
says 'attach' audio attach "$show" 1 "$scratch/v.wav" --offset 0.25
says 'starts at        0.250 s' show "$show" 1
take export "$show" 1 --export "$scratch/s.glb" --wav --fps 25 --in 0 --out 1 >"$scratch/said"
[ "$(fact 'sound frames' "$scratch/said")" = 8000 ] || fail "sound: $(cat "$scratch/said")"
[ -s "$scratch/s.wav" ] || fail "no sound beside the glTF"
take audio detach "$show" 1 >/dev/null

# Kept from what nobody recorded; everything is whole.
says 'duration           1.000 s' keep "$show" --last 1
says 'damaged places     0' check "$show"
take recover "$show" --out "$scratch/recovered.marotte" >/dev/null
[ "$(sum_of "$scratch/recovered.marotte" 2 --fps 30)" = "$second" ] || fail "recovered: plays otherwise"

# A show travels: what it was performed on is gone, or another face lies there now.
mkdir -p packed/rig elsewhere
cp "$(dirname "$puppet")"/puppet.{rig.json,glb} packed/rig/
record packed/t.marotte packed/rig/puppet.rig.json one_hand
whole=$(sum_of packed/t.marotte 1)
says 'faces packed now   1' pack packed/t.marotte
says 'faces packed now   0' pack packed/t.marotte
mv packed/t.marotte packed/t.pack elsewhere/
cp "$(dirname "$puppet")/../moai/moai.glb" packed/rig/puppet.glb
[ "$(sum_of elsewhere/t.marotte 1)" = "$whole" ] || fail "packed: another face lies where it was, and is opened"
rm -r packed
[ "$(sum_of elsewhere/t.marotte 1)" = "$whole" ] || fail "packed: plays otherwise elsewhere"
says 'packed faces       1' check elsewhere/t.marotte
says 'max 0.000 mm' diff elsewhere/t.marotte 1 1
says 'wrote              elsewhere/u.marotte' recover elsewhere/t.marotte --out elsewhere/u.marotte
[ "$(sum_of elsewhere/u.marotte 1)" = "$whole" ] || fail "packed and recovered: plays otherwise"
printf x >>"$(echo elsewhere/t.pack/*/puppet.glb)"
refused 1 'differs from the packed file' "$MAROTTE" take show elsewhere/t.marotte 1 --hash
refused 1 'damaged in 1 places' "$MAROTTE" take check elsewhere/t.marotte
rm -r elsewhere/t.pack/*/
refused 1 'does not have the performed face' "$MAROTTE" take show elsewhere/t.marotte 1 --hash
[ "$(sum_of elsewhere/t.marotte 1 --face "$puppet")" = "$whole" ] || fail "packed: --face does not help"

# ---- what is wrong ----
bad() { # code words, then those of marotte take
    local code=$1 words=$2
    shift 2
    refused "$code" "$words" "$MAROTTE" take "$@"
}
printf 'hello' >"$scratch/text.marotte"
mkdir "$scratch/folder.marotte"
bad 1 'none.marotte: No such file' list "$scratch/none.marotte"
bad 1 'is not a file' list "$scratch/folder.marotte"
bad 1 'not a database' list "$scratch/text.marotte"
bad 1 'not a database' show "$moai" 1
bad 1 'has no take "9"' show "$show" 9
bad 1 'has no take "x/y/1"' show "$show" x/y/1
bad 1 'expected a range' trim "$show" 2 --in 1 --out 1
bad 2 '--in "x" is not a number' trim "$show" 2 --in x
bad 2 '--in or --out is missing' trim "$show" 2
bad 2 'expected SHOW TAKE' trim "$show"
bad 2 'is no option' trim "$show" 2 --speed 2
bad 2 'there is no command "take waltz"' waltz
bad 1 'is not a range of take 2' export "$show" 2 --export "$scratch/out/a.glb" --in 3
printf x >"$scratch/nowhere"
bad 1 "$scratch/nowhere: cannot create this folder" export "$show" 2 --export "$scratch/nowhere/a.glb"
bad 2 'does not end in' export "$show" 2 --export "$scratch/out/a.fbx"
bad 1 'none.glb' export "$show" 2 --export "$scratch/out/a.glb" --face "$scratch/none.glb"
bad 1 'has no sound' export "$show" 2 --export "$scratch/out/a.wav"
bad 1 'there is no mapping plugin "waldo"' remap "$show" 2 --map waldo
bad 2 'nothing to change' remap "$show" 2
bad 1 'nothing to redo' redo "$show" 2
bad 1 'expected a whole number from 0 to 5' edit "$show" 2 '{"op":"take.rate","rating":9}'
bad 1 'File exists' recover "$show" --out "$scratch/text.marotte"
record "$scratch/mixed.marotte" "$moai" anchored
record "$scratch/mixed.marotte" "$puppet" one_hand
bad 1 'not one mesh' diff "$scratch/mixed.marotte" 1 2

# Somebody writes it: it can be read, and not edited.
"$MAROTTE" perform --face "$moai" --input "log:$demo,loop=1" --map anchored --realtime \
    --record "$scratch/busy.marotte" >/dev/null 2>&1 &
writer=$!
for _ in $(seq 600); do
    "$MAROTTE" take list "$scratch/busy.marotte" 2>/dev/null | grep -q 'being recorded' && break
    sleep 0.1
done
says 'being recorded' list "$scratch/busy.marotte"
bad 1 "$scratch/busy.marotte" rate "$scratch/busy.marotte" 1 3
{
    kill -KILL "$writer"
    wait "$writer"
} 2>/dev/null
take rate "$scratch/busy.marotte" 1 3 >/dev/null
says 'recovered' show "$scratch/busy.marotte" 1

# A small show may say that a take lasts for days; nobody fills a disk with that by accident.
cp "$show" "$scratch/days.marotte"
take insert "$scratch/days.marotte" 1 --at 0 --length 900000 >"$scratch/said"
bad 1 'Limit it with --out' export "$scratch/days.marotte" 1 --export "$scratch/days.pc2"
bad 1 'Limit it with --out' show "$scratch/days.marotte" 1 --hash
take export "$scratch/days.marotte" 1 --in 899999 --out 900000 --export "$scratch/days.pc2" >"$scratch/said"
[ -s "$scratch/days.pc2" ] || fail "a range of a long take is not exported"
rm -f "$scratch"/days.*

# A show that was damaged, or made with other things than are there now.
# What is exported of a take says of the surface what was said when it was performed.
for map in anchored unanchored,preset=paper; do
    "$MAROTTE" perform --verbose --face "$moai" --input "log:$demo,start=1.2,end=3.2" --map $map \
        --record "$scratch/j.marotte" >"$scratch/performed" 2>"$scratch/stderr" || fail "record: $(cat "$scratch/stderr")"
    take export "$scratch/j.marotte" 1 --export "$scratch/j.pc2" >"$scratch/said"
    for name in 'range of motion' folds 'least determinant' 'greatest stretch' 'greatest bend' 'bent edges' 'inside out' 'held back'; do
        performed=$(fact "$name" "$scratch/performed") exported=$(fact "$name" "$scratch/said")
        [ -n "$performed" ] && [ "$performed" = "$exported" ] ||
            fail "$map: $name is \"$exported\" in the export of a take, and was \"$performed\""
    done
    rm -f "$scratch"/j.*
done

# How a show solves holds for every command that performs its takes, or records into it.
if command -v sqlite3 >/dev/null; then
    solved=$scratch/s.marotte
    record "$solved" "$moai" anchored
    take export "$solved" 1 --export "$scratch/rigs.pc2" >"$scratch/said"
    rigs=$(sum_of "$solved" 1)
    sqlite3 "$solved" "INSERT INTO meta(key, value) VALUES('note.solver', 'wendland_c6 constant 90')"
    take export "$solved" 1 --export "$scratch/kept.pc2" >"$scratch/said"
    ! cmp -s "$scratch/rigs.pc2" "$scratch/kept.pc2" || fail "take export solves otherwise than its show"
    [ "$(sum_of "$solved" 1)" != "$rigs" ] || fail "take show --hash solves otherwise than its show"
    record "$solved" "$moai" anchored --export "$scratch/performed.pc2"
    take export "$solved" 2 --export "$scratch/played.pc2" >"$scratch/said"
    cmp -s "$scratch/performed.pc2" "$scratch/played.pc2" || fail "a take shows another face than was performed"
    rm -f "$scratch"/s.marotte*
fi

if command -v sqlite3 >/dev/null; then
    changed() { # SQL: $scratch/c.marotte is $show after it
        cp "$scratch/recovered.marotte" "$scratch/c.marotte"
        sqlite3 "$scratch/c.marotte" "$1" >/dev/null
    }
    for value in 1e300 -1e300 9e999; do # of what a choice is set to: there is no such choice
        changed "UPDATE performance_param SET value = $value"
        "$MAROTTE" take export "$scratch/c.marotte" 1 --export "$scratch/out/a.pc2" --out 0.2 >"$scratch/said" 2>&1
        [ $? -le 1 ] || fail "a parameter of $value ends take export: $(tail -n 1 "$scratch/said")"
        rm -f "$scratch/out/a.pc2"
    done
    changed "UPDATE chunk SET bytes = zeroblob(length(bytes)) WHERE id = 2"
    take show "$scratch/c.marotte" 1 --hash >"$scratch/said"
    grep -q '^SHA-256' "$scratch/said" || fail "what is whole of a damaged take is not played"
    [ "$(grep -c 'warning: take: .*damaged' "$scratch/stderr")" -eq 1 ] ||
        fail "a damaged chunk is not said once: $(cat "$scratch/stderr")"
    "$MAROTTE" take check "$scratch/c.marotte" >"$scratch/said" 2>"$scratch/stderr" &&
        fail "check finds no damage"
    grep -q '^damaged ' "$scratch/said" || fail "check does not say what: $(cat "$scratch/said")"
    grep -q 'take recover' "$scratch/stderr" || fail "check does not say what to do"
    changed "UPDATE plugin SET identity = 'org.none.waldo 1 00' WHERE identity LIKE '%one_hand%'"
    bad 1 'org.none.waldo' export "$scratch/c.marotte" 1 --export "$scratch/out/a.glb"
    changed "UPDATE plugin SET identity = 'org.marotte.one_hand 0.0.1 00' WHERE identity LIKE '%one_hand%'"
    take show "$scratch/c.marotte" 1 --hash >/dev/null
    grep -q 'the recording used another library' "$scratch/stderr" ||
        fail "another version of a plugin is not said: $(cat "$scratch/stderr")"
    changed "UPDATE rig SET path = '/nowhere/a.rig.json'"
    bad 1 'cannot find the face of take' export "$scratch/c.marotte" 1 --export "$scratch/out/a.glb"
    [ "$(sum_of "$scratch/c.marotte" 1 --face "$puppet" --fps 30)" = "$first" ] ||
        fail "--face does not play it as it was"
    changed "UPDATE rig SET mesh_hash = '00'"
    take show "$scratch/c.marotte" 1 --hash >/dev/null
    grep -q 'The current file is used' "$scratch/stderr" || fail "a changed face is not said"
    changed "DELETE FROM take"
    bad 1 'has no takes' show "$scratch/c.marotte" last
    changed "DELETE FROM span; DELETE FROM edit; UPDATE take SET edit_head = 0"
    bad 1 'is empty' export "$scratch/c.marotte" 1 --export "$scratch/out/a.glb"
    changed "UPDATE edit SET json = 'x' WHERE n = 1"
    bad 1 'is damaged' rate "$scratch/c.marotte" 1 3
else
    echo "SKIPPED: damaged shows: there is no sqlite3"
fi
finish
