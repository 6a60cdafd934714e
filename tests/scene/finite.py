# SPDX-License-Identifier: MIT
"""Usage: finite.py FILE NAME...

Are all values in the accessors of FILE numbers, and do its primitives have the
attributes NAME? Normals and tangents are of length 1.
"""
import math
import sys

from gltf import Gltf


def main(path, names):
    g = Gltf(path)
    primitives = [p for m in g.json['meshes'] for p in m['primitives']]
    assert primitives
    for primitive in primitives:
        for name in names:
            rows = g.accessor(primitive['attributes'][name])
            assert all(math.isfinite(c) for r in rows for c in r), name
            if name in ('NORMAL', 'TANGENT'):
                for row in rows:
                    length = math.hypot(*row[:3])
                    assert abs(length - 1) < 0.02, (name, row)


main(sys.argv[1], sys.argv[2:])
