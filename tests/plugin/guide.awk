# Takes the code blocks of a guide apart: each into the file OUT/NUMBER.KIND, where the kind is what
# the comment before it says: "<!-- template -->", "<!-- in: process -->", "<!-- not run: why -->"
# ("none" without one), with the block's language behind it: 07.process.c, 08.none.sh. Blocks may be
# indented, in a list.
/^ *<!-- .* -->$/ {
    mark = $0
    gsub(/^ *<!-- | -->$/, "", mark)
    sub(/^in: /, "", mark)
    sub(/^not run: .*/, "skipped", mark)
    next
}
!inside && /^ *```/ {
    inside = 1
    indent = index($0, "`") - 1
    language = substr($0, indent + 4)
    file = sprintf("%s/%02d.%s.%s", OUT, ++count, mark ? mark : "none", language ? language : "text")
    printf "" > file
    mark = ""
    next
}
inside && /^ *```$/ { inside = 0; close(file); next }
inside { print substr($0, indent + 1) > file; next }
/[^ ]/ { mark = "" }
