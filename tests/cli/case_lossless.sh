# SPDX-License-Identifier: MIT
# shellcheck shell=sh disable=SC2154
# bake --lossless: the input's floats come back, bit for bit.

# The faces of an OBJ by the text of their corners, least corner first.
corners() {
    awk '$1 == "v" {
             for (i = 2; i < 5; i++)
                 if ($i ~ /\./) {
                     sub(/0+$/, "", $i)
                     sub(/\.$/, "", $i)
                 }
             v[++n] = $2 " " $3 " " $4
         }
         $1 == "f" {
             a = v[$2 + 0]; b = v[$3 + 0]; c = v[$4 + 0]
             if (a < b && a < c) print a, b, c
             else if (b < c) print b, c, a
             else print c, a, b
         }' "$1" | sort
}
# The facets of a binary STL as bits, without normals.
facets() {
    tail -c +85 "$1" | od -An -v -tx1 -w50 | cut -c 37-144 | awk '{
        a = substr($0, 1, 36); b = substr($0, 37, 36); c = substr($0, 73, 36)
        if (a < b && a < c || a == c && a < b) print a b c
        else if (b < c) print b c a
        else print c a b }' | sort
}

for options in '' '--placement optimal' '--position-bits 8' \
    '--base draco' '--position-bits 24'; do
    # shellcheck disable=SC2086 # words on purpose
    check "bake --lossless $options" 0 \
        bake "$torus" -o a.pmesh --lossless $options --json
    ok 'it is reported' test "$(sed -n 's/.*"lossless": \([0-9]*\).*/\1/p' \
        "$work/out" | head -n 1)" -gt 0
    check 'it verifies' 0 verify a.pmesh
    ok 'as lossless' out 'good, .* exact positions$'
    check 'it extracts' 0 extract a.pmesh -q -o a.obj
    corners "$torus" >want
    corners a.obj >have
    ok 'it has every face' test "$(wc -l <have)" -eq 4608
    ok 'the text of every corner is that of the input' cmp -s want have
done
check 'info' 0 info a.pmesh
ok 'info tells' out '^lossless '
check 'info --json' 0 info a.pmesh --json
ok 'info --json tells' test "$(json lossless)" = true
ok 'info knows the size' test "$(json bytes)" = "$(size a.pmesh)"
check 'into PLY' 0 extract a.pmesh -q -o a.ply
check 'compare' 0 compare a.ply a.pmesh --fail-above 0
check 'bake the lossless file again' 0 bake a.pmesh -o b.pmesh -q --lossless
check 'and extract' 0 extract b.pmesh -q -o b.obj
corners b.obj >have
ok 'nothing was lost on the way' cmp -s want have
check 'two threads' 0 bake "$torus" -o c.pmesh -q --lossless -j 2 \
    --position-bits 24
ok 'the same bytes' cmp -s a.pmesh c.pmesh

# Facets of all kinds of floats, signed zeros and denormals among them.
{
    head -c 80 /dev/zero
    printf '\004\000\000\000'
    awk 'BEGIN {
        split("00000000 00000080 01000000 ffff7f80 0000803f abcd1242 " \
              "99aa11c3 0000c0bf 12345678 cdcccc3d 00000042", x, " ")
        for (f = 0; f < 4; f++) {
            s = "000000000000000000000000"
            for (i = 0; i < 9; i++) s = s x[(7 * f + 3 * i + f * i) % 11 + 1]
            s = s "0000"
            for (i = 1; i < length(s); i += 2) {
                c = index("0123456789abcdef", substr(s, i, 1)) * 16 - 17 + \
                    index("0123456789abcdef", substr(s, i + 1, 1))
                printf "\\%03o", c
            }
        }
    }' >octal
    # shellcheck disable=SC2059 # escapes are the format
    printf "$(cat octal)"
} >in.stl
check 'STL of odd floats' 0 bake in.stl -o s.pmesh -q --lossless
check 'back to STL' 0 extract s.pmesh -q -o out.stl
facets in.stl >want
facets out.stl >have
ok 'four facets, bit for bit' test "$(wc -l <have)" -eq 4
ok 'they are those of the input' cmp -s want have

printf 'v %s\n' '0 0 0' '1 0 0' '0 1 0' '-0 0 0' '1 1 0' >z.obj
printf 'f %s\n' '1 2 3' '4 3 5' >>z.obj
check 'zeros of two signs' 0 bake z.obj -o z.pmesh --lossless
ok 'a counted warning' err 'warning: 1 positions differ .* sign of a zero'
check 'zeros of two signs, welded' 0 bake z.obj -o z.pmesh --lossless \
    --weld 1e-30
ok 'no warning' silent
check 'without --lossless' 0 bake z.obj -o z.pmesh
ok 'no warning either' silent

check 'on a coarse grid the layer is large' 0 \
    bake "$torus" -o d.pmesh -q --lossless --position-bits 8
whole=$(size d.pmesh)
head -c $((whole - 7)) d.pmesh >cut.pmesh
check 'the last byte of the layer is missing' 0 extract cut.pmesh -o cut.obj
ok 'it is said' err '4608 of 4608 faces, not all exact'
check 'strictly' 4 extract cut.pmesh --strict -o x.obj
flip d.pmesh $((whole - 1000))
check 'a flipped bit in the layer is found' 4 verify d.pmesh
check 'and all before it can be salvaged' 0 \
    extract d.pmesh -q --salvage -o salvaged.obj
ok 'which is all faces' test "$(faces salvaged.obj)" = 4608
