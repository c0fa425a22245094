# awk -f summary.awk TESTS.xml: what ctest --output-junit wrote, as three tables: the rooms, the ten longest tests, and what was
# skipped, whole or in part, with the reason that each test printed: a line with SKIPPED in it.
function plain(text) {
    gsub(/&lt;/, "<", text); gsub(/&gt;/, ">", text); gsub(/&quot;/, "\"", text); gsub(/&apos;/, "'", text)
    gsub(/&amp;/, "\\&", text)
    return text
}
function value(key, text) {
    if (!match($0, key "=\"[^\"]*\"")) return ""
    text = substr($0, RSTART + length(key) + 2, RLENGTH - length(key) - 3)
    return text
}
/<testcase / {
    name = value("name"); room = name; sub(/\/.*/, "", room)
    if (!(room in tests)) rooms[++room_count] = room
    ++tests[room]; seconds[room] += value("time"); took[name] = value("time"); state = value("status")
    if (state == "fail") { ++failed[room]; failures = failures "  " name "\n" }
    if (state == "notrun") ++skipped[room]
    whole = state == "notrun"; reasons = 0
}
/SKIPPED/ {
    line = plain($0)
    sub(/.*<system-out>/, "", line); sub(/^.*SKIPPED *[]:]* */, "", line)
    if (line ~ /(test\(s\)|TEST\(S\))/) next # the counts with which cmocka ends
    if ((name, line) in told) next              # and its list
    told[name, line] = 1
    ++reasons
    skips = skips sprintf("  %s%s: %s\n", name, whole ? "" : " (a part)", line)
}
/<\/testcase>/ && whole && !reasons { skips = skips sprintf("  %s: no reason was printed\n", name) }
END {
    printf "\n%-10s %6s %8s %7s %9s\n", "room", "tests", "skipped", "failed", "seconds"
    for (i = 1; i <= room_count; ++i) {
        room = rooms[i]
        printf "%-10s %6d %8d %7d %9.1f\n", room, tests[room], skipped[room], failed[room], seconds[room]
    }
    print "\nThe ten longest, in seconds:"
    for (n = 1; n <= 10; ++n) {
        longest = ""
        for (name in took) if (longest == "" || took[name] + 0 > took[longest] + 0) longest = name
        if (longest == "") break
        printf "%8.1f  %s\n", took[longest], longest
        delete took[longest]
    }
    if (skips != "") printf "\nSkipped, and why:\n%s", skips
    if (failures != "") printf "\nFailed:\n%s", failures
    print ""
}
