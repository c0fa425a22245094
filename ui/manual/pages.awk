# Writes a manual page (man) from the help of a command, or from a guide in Markdown.
#   awk -v page=marotte-perform -v section=1 -v about=SUMMARY -v date=2026-11-28 -v version=0.1.0 -f pages.awk HELP.txt
#   awk -v markdown=1 -v page=marotte_log -v section=5 ... -v from="## The log table" -v to="## The" -f pages.awk GUIDE.md
# The help has lines "  --fps N   text" with indented lines below, usage lines that begin with "marotte", and lists. Of Markdown:
# headings, paragraphs, lists, tables, code, quotes, `names`, *emphasis*, [links](to).

# A line of text as man reads it: no request, no escape by accident.
function plain(text) {
    gsub(/\\/, "\\e", text)
    gsub(/-/, "\\-", text)
    gsub(/'/, "\\(aq", text)
    gsub(/`/, "\\(ga", text)
    gsub(/\^/, "\\(ha", text)
    gsub(/~/, "\\(ti", text)
    if (text ~ /^\./) text = "\\&" text
    return text
}
function quoted(text) {
    text = plain(text)
    gsub(/"/, "\\(dq", text)
    return "\"" text "\""
}
# A heading in capitals is one of the page, another is within it.
function heading(text, is_first) { close_all(); print (is_first ? ".SH " : ".SS ") quoted(text); needs_break = 0; is_fresh = 1 }
function paragraph() { if (needs_break && !is_fresh) print in_item ? ".IP" : ".PP"; needs_break = is_fresh = 0 }
function open_literal() {
    if (!literal && !is_fresh) print ".PP"
    if (!literal) { print ".RS 4"; print ".nf" }
    literal = 1
    is_fresh = 0
}
function close_literal() { if (literal) { print ".fi"; print ".RE"; needs_break = 0 } literal = 0 }
function close_item() { in_item = 0 }
function close_all() { close_literal(); close_item() }
function indent_of(line) { match(line, /^ */); return RLENGTH }
function words_of(line) { sub(/^ +/, "", line); return line }

BEGIN {
    upper = toupper(page)
    printf ".TH %s %s %s %s %s\n", quoted(upper), section, date, quoted("marotte " version), \
        quoted(section == 5 ? "File formats" : "Commands of marotte")
    print ".SH NAME"
    print plain(page) " \\- " plain(about)
    if (!markdown) state = "synopsis"
}

# ---- the help of a command; "=== NAME" begins that of a subcommand ----

!markdown && /^=== / { heading("marotte " substr($0, 5), 1); in_part = 1; state = "usage"; next }
!markdown && state == "synopsis" {
    if (!begun) { print ".SH SYNOPSIS"; print ".nf"; begun = 1 }
    if ($0 == "" || /^  [A-Z]/) { print ".fi"; heading("DESCRIPTION", 1); state = "text" }
    if ($0 == "") next
    if (state == "text") { is_fresh = 0; print plain(words_of($0)); next }
    sub(/^usage: /, "")
    sub(/^  marotte/, "marotte")
    print plain($0)
    next
}
!markdown && state == "usage" {
    if ($0 == "") { close_literal(); state = "text"; next }
    open_literal(); print plain($0)
    next
}
!markdown && /^$/ { close_all(); needs_break = 1; next }
!markdown && /^Examples:$/ { heading(in_part ? "Examples" : "EXAMPLES", !in_part); in_examples = 1; next }
!markdown && in_examples && /^  / { open_literal(); print plain(words_of($0)); next }
!markdown && /^marotte / && /\[|--|[A-Z][A-Z]/ && !/[.:]$/ { # usage of a subcommand within the help
    in_examples = 0
    close_item()
    open_literal(); print plain($0)
    in_usage = 1
    next
}
!markdown && in_usage && /^        / { print plain($0); next }
!markdown {
    if (in_usage) { close_literal(); in_usage = 0; needs_break = 0; print ".PP" }
    indent = indent_of($0)
    if (indent == 0) {
        in_examples = 0
        close_all()
        if ($0 ~ /^[A-Z][^.]*:$/ || (needs_break && $0 ~ /^[A-Z][a-z, ]*$/)) { sub(/:$/, ""); heading($0, 0); next }
        paragraph()
        print plain($0)
        next
    }
    text = words_of($0)
    at = match(text, /  +[^ ]/)
    if (!at && match(text, /^[-a-z ]+( [A-Z][A-Z]+)+ [a-z]/)) at = RSTART + RLENGTH - 2 # no room for a second blank
    is_term = indent == 2 && (text ~ /^-/ || at > 0)
    if (is_term || (indent == 6 && text ~ /^[.\/]/)) {
        close_literal()
        term = at > 0 ? substr(text, 1, at - 1) : text
        rest = at > 0 ? words_of(substr(text, at)) : ""
        sub(/ +$/, "", term)
        print ".TP"
        print "\\fB" plain(term) "\\fR"
        if (rest != "") print plain(rest)
        in_item = 1
        needs_break = is_fresh = 0
        next
    }
    if (in_item) { print plain(text); next }
    paragraph()
    print plain(text)
    next
}

# ---- a guide in Markdown ----

# `names`, **strong**, *emphasis*, [text](link) of one line.
function styled(text,   out, at, word) {
    while (match(text, /`[^`]+`|\*\*[^*]+\*\*|\*[^* ][^*]*\*|!?\[[^]]+\]\([^)]*\)/)) {
        out = out plain(substr(text, 1, RSTART - 1))
        word = substr(text, RSTART, RLENGTH)
        text = substr(text, RSTART + RLENGTH)
        if (word ~ /^`/) out = out "\\fB" plain(substr(word, 2, length(word) - 2)) "\\fR"
        else if (word ~ /^\*\*/) out = out "\\fB" plain(substr(word, 3, length(word) - 4)) "\\fR"
        else if (word ~ /^\*/) out = out "\\fI" plain(substr(word, 2, length(word) - 2)) "\\fR"
        else { sub(/^!?\[/, "", word); sub(/\]\(.*/, "", word); gsub(/[`*]/, "", word); out = out plain(word) }
    }
    out = out plain(text)
    sub(/^\\&\\&/, "\\\\\\&", out)
    if (out ~ /^[.']/) out = "\\&" out
    return out
}
markdown && !is_on {
    if (index($0, from) == 1) is_on = 1
    else next
    heading("DESCRIPTION", 1)
    if (from ~ /^## /) next
}
markdown && to != "" && index($0, to) == 1 { exit }
markdown && /^ *```/ {
    if (literal) close_literal()
    else open_literal()
    next
}
markdown && literal { print plain($0); next }
markdown && /^<!--/ { next }
markdown && /^#+ / {
    match($0, /^#+/)
    level = RLENGTH
    sub(/^#+ /, "")
    gsub(/[`*]/, "")
    if (level == 1) next
    heading($0, level == 2)
    next
}
markdown && /^ *$/ { needs_break = 1; in_table = 0; next }
markdown && /^ *\|/ { # a row: its first cell is a term
    line = $0
    if (line ~ /^ *\|[-| :]+\|? *$/) next
    sub(/^ *\| */, "", line)
    sub(/ *\| *$/, "", line)
    gsub(/\\\|/, "\001", line)
    count = split(line, cell, / *\| */)
    is_head = !in_table
    in_table = 1
    if (is_head) { for (i = 1; i <= count; ++i) head[i] = cell[i]; next }
    gsub(/\001/, "|", cell[1])
    if (cell[1] != "") { print ".TP"; print styled(cell[1]) }
    else print ".IP"
    for (i = 2; i <= count; ++i) {
        gsub(/\001/, "|", cell[i])
        if (cell[i] != "") print (head[i] != "" ? styled(head[i]) ": " : "") styled(cell[i]) (i < count ? ";" : "")
    }
    in_item = 1
    needs_break = is_fresh = 0
    next
}
markdown && /^ *([-*]|[0-9]+\.) / {
    match($0, /^ *([-*]|[0-9]+\.) /)
    mark = words_of(substr($0, 1, RLENGTH - 1))
    rest = substr($0, RLENGTH + 1)
    print ".IP " (mark ~ /^[0-9]/ ? mark " 4" : "\\(bu 2")
    print styled(rest)
    in_item = 1
    needs_break = is_fresh = 0
    next
}
markdown {
    line = words_of($0)
    if (needs_break && indent_of($0) == 0) in_item = 0
    paragraph()
    print styled(line)
}
END {
    if (state == "synopsis") print ".fi"
    close_all()
    if (also != "") {
        print ".SH SEE ALSO"
        count = split(also, other, " ")
        for (i = 1; i <= count; ++i) {
            match(other[i], /\(/)
            print ".BR " plain(substr(other[i], 1, RSTART - 1)) " " substr(other[i], RSTART) (i < count ? "," : "")
        }
    }
}
