# Draws the way of a sample as an SVG, from the first block of code in "The way of a sample" of ARCHITECTURE.md:
#   awk -f tests/house/draw_frame.awk ARCHITECTURE.md >.github/frame.svg
# A line "X thread ..." begins a lane, a line with ═ is what carries data to the next one, "[N]" is a phase of frame.h.
function escaped(text) { gsub(/&/, "\\&amp;", text); gsub(/</, "\\&lt;", text); gsub(/>/, "\\&gt;", text); return text }
function trimmed(text) { gsub(/^[ │]+|[ ]+$/, "", text); return text }
function text(x, y, class, words) { body = body sprintf("<text x=\"%d\" y=\"%d\" class=\"%s\">%s</text>\n", x, y, class, escaped(words)) }
function box(x, y, w, h, class) { body = body sprintf("<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" rx=\"6\" class=\"%s\"/>\n", x, y, w, h, class) }
function end_lane() {
    if (lane == "") return
    lanes = lanes sprintf("<rect x=\"10\" y=\"%d\" width=\"%d\" height=\"%d\" rx=\"10\" class=\"lane\"/>\n", lane_y, width - 20, y - lane_y + 4)
    lane = ""
}
BEGIN { width = 1120; y = 20; row = 26 }
/^## / { in_section = ($0 == "## The way of a sample"); next }
in_section && /^```/ { fences++; if (fences == 2) exit; next }
!in_section || fences != 1 || /^ *$/ { next }
/═/ {
    words = $0; side = ""
    if (match(words, /══+ [^═]*$/) && words ~ /thread/) { side = substr(words, RSTART); gsub(/═/, "", side) }
    gsub(/═+[^═]*$/, "", words); gsub(/[═│]/, "", words); words = trimmed(words)
    if (lane != "" && side != "") { # leaves the lane sideways, the lane continues
        body = body sprintf("<path d=\"M300 %d H 640\" class=\"arrow\"/>\n", y + 9)
        text(650, y + 13, "carry", words " →" side)
        y += row
        next
    }
    end_lane()
    body = body sprintf("<path d=\"M60 %d V %d\" class=\"arrow\"/>\n", y + 6, y + 38)
    text(76, y + 27, "carry", words)
    y += 46
    next
}
/^ [a-z]+ thread/ {
    end_lane()
    lane = $0; lane_y = y
    where = lane; sub(/^ [a-z]+ thread[^ ]*( [a-z,]+)*  +/, "", where)
    if (where == lane) where = ""
    name = lane; sub(/   .*/, "", name)
    y += 22
    text(24, y - 3, "thread", trimmed(name))
    if (where != "") body = body sprintf("<text x=\"%d\" y=\"%d\" class=\"room\" text-anchor=\"end\">%s</text>\n", width - 24, y - 3, escaped(trimmed(where)))
    y += 8
    next
}
{
    line = $0; phase = ""
    if (match(line, /\[[0-9]+\]/)) { phase = substr(line, RSTART + 1, RLENGTH - 2); sub(/\[[0-9]+\] */, "      ", line) }
    match(line, /[^ ]/); depth = RSTART
    line = trimmed(line)
    where = line; what = ""
    if (match(line, /   +|  /)) { where = substr(line, 1, RSTART - 1); what = trimmed(substr(line, RSTART)) }
    x = 58 + (depth > 8 ? 24 : 0)
    if (phase != "") {
        box(20, y - 1, 26, 20, "phase")
        body = body sprintf("<text x=\"33\" y=\"%d\" class=\"number\" text-anchor=\"middle\">%s</text>\n", y + 13, phase)
    }
    text(x, y + 13, "call", where)
    if (phase != "" && match(what, /^[a-z]+: /)) { # the phase's name
        text(420, y + 13, "name", substr(what, 1, RLENGTH - 2))
        text(498, y + 13, "what", substr(what, RLENGTH + 1))
    } else if (what != "")
        text(420, y + 13, "what", what)
    y += row
}
END {
    end_lane()
    printf "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" width=\"%d\" height=\"%d\" role=\"img\">\n", width, y + 14, width, y + 14
    print "<title>The way of a sample: threads, calls and the ten phases of a frame</title>"
    print "<style>"
    print "text{font:13px sans-serif;fill:#24292f} .call{font:12px monospace} .what{fill:#57606a} .name{font-weight:600} .thread{font:600 14px sans-serif}"
    print ".room{fill:#57606a} .carry{font:600 12px sans-serif;fill:#9a6700} .number{font:600 12px sans-serif;fill:#fff}"
    print ".lane{fill:#f6f8fa;stroke:#d0d7de} .phase{fill:#0969da} .arrow{stroke:#9a6700;stroke-width:2;fill:none;marker-end:url(#head)}"
    print "</style>"
    print "<defs><marker id=\"head\" viewBox=\"0 0 8 8\" refX=\"6\" refY=\"4\" markerWidth=\"6\" markerHeight=\"6\" orient=\"auto\"><path d=\"M0 0L8 4L0 8z\" fill=\"#9a6700\"/></marker></defs>"
    printf "<rect width=\"%d\" height=\"%d\" fill=\"#fff\"/>\n%s%s</svg>\n", width, y + 14, lanes, body
}
