# SPDX-License-Identifier: MIT
# shellcheck shell=sh disable=SC2154
# view: the page of a template, and what it says when it cannot make one. The
# server is tested in tests/web.

cat >page.html <<'HTML'
<title><!--pmesh:title--></title><!--pmesh:data--><p>$& \1</p>
HTML
cp "$baked" 'a <b> & "c".pmesh'
check 'view' 0 view 'a <b> & "c".pmesh' --page page.html -o out.html
ok 'one line of report' test "$(wc -l <"$work/out")" -eq 1
ok 'the title is escaped' grep -q \
    '^<title>a &lt;b&gt; &amp; &quot;c&quot;.pmesh</title>' out.html
ok 'the rest is as it was' grep -q '</script><p>$& \\1</p>$' out.html
sed 's/.*id="mesh">//; s/<.*//' out.html >text
ok 'the mesh is in the page' sh -c \
    "base64 -d <text | cmp - '$baked'"
check 'view --title' 0 view "$baked" --page page.html --title T -o t.html
ok 'the title is the one given' grep -q '^<title>T</title>' t.html
"$PMESH" view - --page page.html -o - <"$baked" >"$work/out" 2>"$work/err"
judge 'from standard input to standard output' 0 $? 'view - -o -'
ok 'the page is on standard output' out '^<title>mesh</title>'
check 'view -q' 0 view -q "$baked" --page page.html -o q.html
ok 'view -q is quiet' test ! -s "$work/out"

cp "$PMESH" alone
printf 'no marks' >plain.html
./alone view "$baked" -o no.html >"$work/out" 2>"$work/err"
judge 'without a page' 1 $? 'view without a page'
ok 'it says how to get one' err 'make viewer'
ok 'nothing is written' absent no.html
check 'a page that is none' 1 view "$baked" --page plain.html -o no.html
ok 'that is said' err 'no page of the viewer'
check 'a missing page' 1 view "$baked" --page nope.html -o no.html
check 'neither -o nor --serve' 2 view "$baked"
check 'both' 2 view "$baked" -o no.html --serve
check 'a port out of range' 2 view "$baked" --serve --port 70000
check 'view of another file' 4 view "$torus" --page page.html -o no.html
check 'view of a missing file' 1 view nope.pmesh --page page.html -o no.html
cp "$baked" same.pmesh
check 'onto the input' 1 view same.pmesh --page page.html -o same.pmesh
"$PMESH" bake "$torus" -o draco.pmesh -q --base draco
check 'a Draco base mesh' 5 view draco.pmesh --page page.html -o no.html
ok 'nothing but what was asked is written' absent no.html
