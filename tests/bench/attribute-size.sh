#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tests/bench/attribute-size.sh
#
# Bytes of meshes with attributes against Draco's best compression at the same
# bits: positions 12, texture coordinates 10, normals 10, all others 8. Geometry
# alone on both sides: a scene's document, images and animations do not count,
# nor does the document of Draco's glTF file. OBJ goes through draco_encoder,
# glTF through gltf-transform (npm, TRANSFORM names it), else draco_transcoder
# (whose level of compression cannot be chosen).
#
# Writes attribute-size.csv and prints it. SUBJECTS: files below PMESH_MODELS.
. tests/bench/common.sh
subjects=${SUBJECTS:-CesiumMan.glb FlightHelmet/FlightHelmet.gltf pizza.obj
human.obj}
profiles=${PROFILES:-compact balanced}
need draco_encoder "make bench-deps"
dir=$OUT/attribute-size
mkdir -p "$dir"

# The sum of a GLB's Draco buffers.
draco_bytes() {
    python3 - "$1" <<'END'
import json, struct, sys
data = open(sys.argv[1], 'rb').read()
size, = struct.unpack('<I', data[12:16])
gltf = json.loads(data[20:20 + size])
views = {p['extensions']['KHR_draco_mesh_compression']['bufferView']
         for m in gltf['meshes'] for p in m['primitives']}
print(sum(gltf['bufferViews'][v]['byteLength'] for v in views))
END
}

draco_size() (
    case $1 in
    *.obj)
        draco_encoder -i "$1" -o "$dir/a.drc" -cl 10 -qp 12 -qt 10 -qn 10 \
            -qg 8 >"$dir/log"
        bytes "$dir/a.drc"
        return
        ;;
    esac
    if [ -n "${TRANSFORM-}" ]; then
        "$TRANSFORM" draco "$1" "$dir/a.glb" --method edgebreaker \
            --encode-speed 0 --decode-speed 0 --quantize-position 12 \
            --quantize-texcoord 10 --quantize-normal 10 --quantize-color 8 \
            --quantize-generic 8 >"$dir/log" 2>&1
    else
        draco_transcoder -i "$1" -o "$dir/a.glb" -qp 12 -qt 10 -qn 10 -qc 8 \
            -qtg 8 -qw 8 -qg 8 >"$dir/log"
    fi
    draco_bytes "$dir/a.glb"
)

our_size() (
    "$PMESH" bake -q --json "$1" --profile "$2" --position-bits 12 \
        --uv-bits 10 --normal-bits 10 --color-bits 8 --generic-bits 8 \
        -o "$dir/a.pmesh" >"$dir/a.json"
    json "$dir/a.json" bytes document_bytes resource_bytes |
        awk -F , '{ print $1 - $2 - $3 }'
)

{
    echo model,profile,bytes,draco
    for subject in $subjects; do
        progress "$subject"
        theirs=$(draco_size "$PMESH_MODELS/$subject")
        for profile in $profiles; do
            ours=$(our_size "$PMESH_MODELS/$subject" "$profile")
            echo "$(basename "$subject"),$profile,$ours,$theirs"
        done
    done
} >"$OUT/attribute-size.csv"

awk -F , '
    NR == 1 { printf "%-18s %-9s %8s %8s  ratio\n", $1, $2, $3, $4; next }
    {
        printf "%-18s %-9s %8d %8d  %.3f\n", $1, $2, $3, $4, $3 / $4
        ours[$2] += $3
        draco[$2] += $4
    }
    END {
        for (p in ours)
            printf "%-18s %-9s %8d %8d  %.3f\n", "sum", p, ours[p], draco[p],
                ours[p] / draco[p]
    }' "$OUT/attribute-size.csv"
