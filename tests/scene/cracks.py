# SPDX-License-Identifier: MIT
"""Usage: cracks.py INPUT OUTPUT...

No mesh of an output has more boundary edges than it has in the input. Edges are
told by their positions, so a seam is no boundary as long as it does not open.
"""
import collections
import sys

from gltf import Gltf


def boundary(g, mesh):
    edges = collections.Counter()
    for p in mesh['primitives']:
        if p.get('mode', 4) < 4 or 'POSITION' not in p['attributes']:
            continue
        at = g.accessor(p['attributes']['POSITION'])
        for face in g.faces(p):
            a, b, c = (at[i] for i in face)
            if a != b != c != a:
                for edge in ((a, b), (b, c), (c, a)):
                    edges[tuple(sorted(edge))] += 1
    return sum(n == 1 for n in edges.values())


first = Gltf(sys.argv[1])
limits = [boundary(first, m) for m in first.json['meshes']]
bad = 0
for path in sys.argv[2:]:
    g = Gltf(path)
    for i, mesh in enumerate(g.json['meshes']):
        n = boundary(g, mesh)
        if n > limits[i]:
            print(path, 'mesh', i, n, 'boundary edges instead of', limits[i])
            bad += 1
sys.exit(bad > 0)
