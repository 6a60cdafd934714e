#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tests/bench/rate.sh
#
# Bytes against distance to the original: prefixes of pmesh files, and discrete
# levels of detail: the model simplified to 1/1, 1/2, 1/4 ... of its faces by
# CGAL's Lindstrom-Turk and coded by Draco at 8 to 14 bits.
#
# A prefix shows what its complete blocks hold, so our distance falls in steps,
# and so does that of the best Draco file with at most so many bytes. Their
# ratio is largest at the end of one of our own steps or just where a Draco
# file fits in: prefixes are cut at the size of every Draco file that is better
# than all smaller ones (of full meshes and simplified ones apart), besides the
# ends of levels and ten sizes a decade.
#
# Writes rate.csv and rate.svg and prints the worst ratios. BITS: of our
# positions (14); MESHDIST: see common.sh.
. tests/bench/common.sh
grid=${BITS:-14}
kinds="balanced quality optimal"
qps="8 9 10 11 12 13 14"
need draco_encoder "make bench-deps"
need "$tools/bench_simplify" "make bench-rate"
dir=$OUT/rate
mkdir -p "$dir"

# The shares in percent: halves, down to about fifty faces.
shares() {
    awk -v n="$1" 'BEGIN {
        for (percent = 100; n * percent / 100 >= 50; percent /= 2)
            printf "%.10g ", percent
    }'
}

# draco_levels NAME: rows of every Draco file
draco_levels() {
    share=$(shares "$(faces "$dir/$1.obj")")
    # shellcheck disable=SC2086 # words on purpose
    "$tools/bench_simplify" -t cgal-lt "$dir/$1.obj" "$dir" ${share#100 } \
        >"$dir/peer.log"
    cp "$dir/$1.obj" "$dir/cgal-lt_100.obj"
    for percent in $share; do
        lod=$dir/cgal-lt_$percent.obj
        for qp in $qps; do
            draco "$lod" "$dir/lod.drc" "$qp"
            draco_decoder -i "$dir/lod.drc" -o "$dir/lod.obj" \
                >"$dir/lod.log"
            distance=$(rms "$dir/$1.obj" "$dir/lod.obj")
            echo "$1,draco,$(bytes "$dir/lod.drc"),$(
                faces "$lod"),$qp,$distance"
        done
    done
}

# cuts FILE DRACO_ROWS: byte counts to look at, from 1 % of the file on
cuts() {
    sort -t , -k 3n -k 6g "$2" |
        awk -F , -v all="$(bytes "$1")" -v full="$(json "$1.json" faces)" '
        function put(n) { if (n >= all / 100 && n <= all) print int(n) }
        FILENAME != "-" {
            if (match($0, /{"bytes": *[0-9]+/))
                put(substr($0, RSTART + 9, RLENGTH - 9) + 0)
            next
        }
        { whole = $4 >= full }
        !(whole in best) || $6 < best[whole] { best[whole] = $6; put($3) }
        END {
            for (i = 0; i <= 20; i++)
                put(int(all / 10 ^ (i / 10) + 0.999))
        }' "$1.json" - | sort -nu
}

# ours NAME KIND DRACO_ROWS: a row for each cut that shows a mesh
ours() {
    file=$dir/$1.$2.pmesh
    bake "$dir/$1.obj" "$file" "$2" "$grid"
    shown=0
    for count in $(cuts "$file" "$3"); do
        rm -f "$dir/cut.obj"
        "$PMESH" extract -q "$file" --bytes "$count" -o "$dir/cut.obj" \
            2>"$dir/cut.log" || [ $? = 4 ] # the base mesh is not there yet
        [ -e "$dir/cut.obj" ] || continue
        now=$(faces "$dir/cut.obj")
        [ "$now" = "$shown" ] || distance=$(rms "$dir/$1.obj" "$dir/cut.obj")
        shown=$now
        echo "$1,$2,$count,$now,$grid,$distance"
    done
}

{
    echo model,coder,bytes,faces,bits,rms
    models | while read -r model; do
        name=$(basename "$model" .obj)
        positions_only "$model" >"$dir/$name.obj"
        progress "$name: draco"
        draco_levels "$name" >"$dir/draco.csv"
        cat "$dir/draco.csv"
        for kind in $kinds; do
            progress "$name: $kind"
            ours "$name" "$kind" "$dir/draco.csv"
        done
    done
} >"$OUT/rate.csv"
awk -F , -v kinds="$kinds" -f tests/bench/rate.awk "$OUT/rate.csv"
python3 tests/bench/plot.py rate "$OUT/rate.csv" "$OUT/rate.svg"
echo "$OUT/rate.csv $OUT/rate.svg"
