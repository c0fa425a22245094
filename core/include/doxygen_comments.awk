# Marks the comments of plugin.h for Doxygen: a comment behind code belongs to what is before it, any other to what follows.
/^\/\* ---- .* ---- \*\/$/ {
    gsub(/^\/\* ---- | ---- \*\/$/, "")
    printf "/** @name %s */\n", $0
    next
}
NR == 1 { sub(/\/\*/, "/** @file\n *") }
{
    if (!is_open && match($0, /\/\*[^*]/)) sub(/\/\*/, (substr($0, 1, RSTART - 1) ~ /[^ ]/) ? "/**<" : "/**")
    is_open = ($0 ~ /\/\*/ || is_open) && $0 !~ /\*\/[^\/]*$/
    print
}
