# SPDX-License-Identifier: MIT
# awk -v names=FILE -f musts.awk SPEC.md musts.txt: the rules and the files that
# break them. Fails if a rule is not in SPEC.md, has no file or one that is not
# among the names, if a file breaks no rule, or if a MUST of SPEC.md is left.
function complain(what) {
    print "!! " what
    bad++
}

function finish_rule() {
    if (rule == "")
        return
    if (!files && !reason)
        complain("no file: " rule)
    print rule
    print "    " list
    rules++
    rule = ""
}

function take_file(pattern, i, found) {
    sub(/[*]/, ".*", pattern)
    for (i = 1; i <= count; i++)
        if (name[i] ~ ("^" pattern "$")) {
            found = used[i] = 1
            list = list (list == "" ? "" : " ") name[i]
        }
    if (!found)
        complain("no such file: " pattern)
    files++
}

BEGIN {
    while ((getline line < names) > 0)
        name[++count] = line
}

FNR == NR {
    spec = spec " " $0
    next
}

FNR == 1 { gsub(/[ \t]+/, " ", spec) }

/^#/ || /^$/ { next }

/^[^ ]/ {
    finish_rule()
    rule = $0
    list = ""
    files = reason = 0
    at = index(spec, rule)
    if (!at)
        complain("not in SPEC.md: " rule)
    else
        spec = substr(spec, 1, at - 1) "~" substr(spec, at + length(rule))
    next
}

$1 == "=" {
    reason = 1
    sub(/^ *= /, "")
    list = list (list == "" ? "= " : " ") $0
    next
}

{
    for (i = 1; i <= NF; i++)
        take_file($i)
}

END {
    finish_rule()
    while ((at = index(spec, "MUST")) > 0) {
        complain("a MUST without a line: ..." substr(spec, at - 50, 130))
        spec = substr(spec, at + 4)
    }
    for (i = 1; i <= count; i++)
        if (!used[i])
            complain("breaks no rule: " name[i])
    print rules " rules, " count " files, " bad + 0 " missing"
    exit bad > 0
}
