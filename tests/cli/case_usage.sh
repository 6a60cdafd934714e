# SPDX-License-Identifier: MIT
# shellcheck shell=sh disable=SC2154
# The command line: help, options, and what is said about mistakes.

"$PMESH" >"$work/out" 2>"$work/err"
ok 'no arguments: exit code 2' test $? = 2
ok 'no arguments: usage on stderr' err '^Usage: '
ok 'no arguments: nothing on stdout' test ! -s "$work/out"

for option in help -h --help; do
    check "pmesh $option" 0 $option
    ok "pmesh $option prints on stdout only" silent
done
for command in bake extract simplify info verify compare guide sheet \
    plot stats session sample; do
    ok "the overview lists $command" out "^  $command "
done
for command in bake extract simplify info verify guide plot stats session; do
    check "$command -h" 0 $command -h
    ok "$command -h lists its options" out '^Options:'
    short=$(size "$work/out")
    check "$command --help" 0 $command --help
    ok "$command --help says more" test "$(size "$work/out")" -gt "$short"
    ok "$command --help has an example" out "^  .*pmesh $command"
    cp "$work/out" long
    check "help $command" 0 help $command
    ok "help $command is $command --help" cmp -s long "$work/out"
done
check '--version' 0 --version
ok '--version names versions' out '^pmesh [0-9]*\.[0-9]*\.[0-9]* (format '

check 'unknown command' 2 frobnicate
check 'misspelt command' 2 bakee
ok 'misspelt command: the nearest is named' err "'bake'"
check 'help for an unknown command' 2 help frobnicate
check 'misspelt option' 2 bake "$torus" -o a --profil quality
ok 'misspelt option: the nearest is named' err "'--profile'"
check 'unknown short option' 2 bake "$torus" -o a -Z
check 'option without its value' 2 bake "$torus" -o
check 'flag with a value' 2 bake "$torus" -o a --json=yes
check 'choice that there is not' 2 bake "$torus" -o a --profile tiny
ok 'choice that there is not: the choices are listed' err 'balanced'
for bad in 3 25 14.5 x nan -1 1e99 ''; do
    check "--position-bits '$bad'" 2 bake "$torus" -o a --position-bits "$bad"
done
for bad in 101% 1.5 -1 x 25%%; do
    check "--ratio '$bad'" 2 extract "$baked" -o a.obj --ratio "$bad"
done
for bad in 0 -1 5Q 1.5 99999999999; do
    check "--faces '$bad'" 2 extract "$baked" -o a.obj --faces "$bad"
done
check 'control characters in an option' 2 bake "$(printf -- '--a\033[1mb')"

check 'bake without input' 2 bake -o a.pmesh
check 'bake without output' 2 bake "$torus"
check 'bake with two inputs' 2 bake "$torus" "$torus" -o a.pmesh
check 'bake with -i and an operand' 2 bake "$torus" -i "$torus" -o a.pmesh
check 'bake into glTF' 2 bake "$torus" -o a.glb
check 'bake into OBJ' 2 bake "$torus" -o a.obj
check 'bake --base of another' 2 bake "$torus" -o a.pmesh --base zip
check 'bake --json and -o -' 2 bake "$torus" -o - --json
check 'extract without file' 2 extract -o a.obj
check 'extract without output' 2 extract "$baked"
check 'extract into an unknown format' 2 extract "$baked" -o a.xyz
check 'extract to stdout without format' 2 extract "$baked" -o -
check 'info without file' 2 info
check 'info of two files' 2 info "$baked" "$baked"
check 'verify without file' 2 verify
ok 'no mistake writes a file' only long

check 'options before and after operands' 0 bake -o a.pmesh -q "$torus"
check '--name=value' 0 bake "$torus" --output=b.pmesh -q
check '-oVALUE, -i, grouped flags' 0 bake -ob2.pmesh -i "$torus" -qv
cp "$torus" ./-x.obj
check '-- ends the options' 0 bake -q -o c.pmesh -- -x.obj
for copy in b b2 c; do
    ok "spelling of options does not matter ($copy)" cmp -s a.pmesh $copy.pmesh
done
check 'counts with a suffix' 0 extract a.pmesh -q -o k.obj --faces 1k
check 'counts without' 0 extract a.pmesh -q -o n.obj --faces=1000
ok '1k is 1000' cmp -s k.obj n.obj
check 'ratio in percent' 0 extract a.pmesh -q -o p.obj --ratio 25%
check 'ratio as a fraction' 0 extract a.pmesh -q -o f.obj --ratio 0.25
ok '25% is 0.25' cmp -s p.obj f.obj
