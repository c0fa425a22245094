# A glove of 18 sensors in counts: a right hand goes through the ten poses of the guided calibration,
# holding each for 2 s, with 0.6 s from one to the next, at 100 Hz. Every sensor: raw = zero + angle
# in degrees * counts. Writes a log table. -v poses=N: only the first N poses; -v broken=NAME: that
# sensor stays where it is; -v tail=1: then the relaxed pose again, and the index finger bends.
function pose(step, sensor) { return (step, sensor) in angle ? angle[step, sensor] : 0 }
function bend(step, names, degrees,    list, i, n) {
    n = split(names, list, " ")
    for (i = 1; i <= n; ++i) angle[step, list[i]] = degrees
}
function row(t, from, to, share,    i, value, line) {
    line = sprintf("%.2f", t)
    for (i = 1; i <= count; ++i) {
        value = pose(from, name[i]) + share * (pose(to, name[i]) - pose(from, name[i]))
        if (name[i] == broken) value = 0
        line = line sprintf(",%d", zero[i] + value * counts[i] + 0.5)
    }
    print line
}
BEGIN {
    count = split("thumb.roll thumb.mpj thumb.ij thumb.abd index.mpj index.pij middle.mpj middle.pij middle.abd ring.mpj ring.pij ring.abd little.mpj little.pij little.abd palm.arch wrist.pitch wrist.yaw", name, " ")
    split("40 80 100 200 90 65 95 60 150 92 70 155 88 62 148 103 134 90", zero, " ")
    split("1.1 1.2 1 -2 1 1.2 0.9 1.1 -2.5 0.8 1 -2 0.7 1.1 -1.8 1 1 -2", counts, " ")
    if (poses == "") poses = 10
    knuckles = "index.mpj middle.mpj ring.mpj little.mpj"
    middles = "index.pij middle.pij ring.pij little.pij"
    bend(0, knuckles, 35); bend(0, middles, 30); bend(0, "thumb.roll", 40); bend(0, "palm.arch", 10)
    bend(2, knuckles, 90); bend(2, middles, 100)
    bend(3, "thumb.roll thumb.ij", 80); bend(3, "thumb.mpj", 50)
    bend(4, "middle.abd", 17); bend(4, "ring.abd", 14); bend(4, "little.abd", 32); bend(4, "thumb.abd", 53)
    bend(5, "thumb.mpj", 45); bend(5, "thumb.ij", 70)
    bend(6, "index.mpj", 80); bend(6, "index.pij", 90); bend(6, "middle.mpj", 16)
    bend(7, "middle.mpj", 80); bend(7, "middle.pij", 90); bend(7, "ring.mpj", 40); bend(7, "index.mpj", 16)
    bend(8, "ring.mpj", 80); bend(8, "ring.pij", 90); bend(8, "little.mpj", 40); bend(8, "middle.mpj", 24)
    bend(9, "little.mpj", 80); bend(9, "little.pij", 90); bend(9, "ring.mpj", 32)
    header = "time_s"; unit = "unit"
    for (i = 1; i <= count; ++i) { header = header ",right." name[i]; unit = unit ",count" }
    print header; print unit
    for (step = 0; step < poses; ++step) {
        for (k = 0; k < 200; ++k) row(t += 0.01, step, step, 0)
        for (k = 1; step + 1 < poses && k <= 60; ++k) row(t += 0.01, step, step + 1, k / 60)
    }
    if (tail) {
        for (k = 1; k <= 100; ++k) row(t += 0.01, poses - 1, 0, k / 100)
        for (k = 1; k <= 100; ++k) row(t += 0.01, 0, 6, k / 100)
    }
}
