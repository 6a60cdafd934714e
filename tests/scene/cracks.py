# SPDX-License-Identifier: MIT
"""Usage: cracks.py INPUT OUTPUT...

No mesh of an output has more boundary edges than it has in the input. Edges are
told by their positions, so a seam is no boundary as long as it does not open.
No face of an output names a vertex twice.
"""
import collections
import sys

from gltf import Gltf


def faces_of(g, p):
    """Corner positions of a primitive's faces with an area."""
    if p.get('mode', 4) < 4 or 'POSITION' not in p['attributes']:
        return []
    at = g.accessor(p['attributes']['POSITION'])
    faces = [tuple(at[i] for i in face) for face in g.faces(p)]
    return [f for f in faces if len(set(f)) == 3]


def open_edges(faces):
    edges = collections.Counter()
    for a, b, c in faces:
        for edge in ((a, b), (b, c), (c, a)):
            edges[tuple(sorted(edge))] += 1
    return sum(n == 1 for n in edges.values())


def is_apart(g, mesh):
    """Primitives on the same faces are refined each for itself."""
    seen = collections.Counter()
    for p in mesh['primitives']:
        seen.update(set(frozenset(f) for f in faces_of(g, p)))
    return any(n > 1 for n in seen.values())


def boundary(g, mesh, apart):
    lists = [faces_of(g, p) for p in mesh['primitives']]
    if apart:
        return sum(open_edges(faces) for faces in lists)
    return open_edges([f for faces in lists for f in faces])


def faces_of_fewer_corners(g, mesh):
    return [f for p in mesh['primitives'] if p.get('mode', 4) >= 4
            for f in g.faces(p) if len(set(f)) < 3]


first = Gltf(sys.argv[1])
apart = [is_apart(first, m) for m in first.json['meshes']]
limits = [boundary(first, m, a) for m, a in zip(first.json['meshes'], apart)]
bad = 0
for path in sys.argv[2:]:
    g = Gltf(path)
    for i, mesh in enumerate(g.json['meshes']):
        n = boundary(g, mesh, apart[i])
        if n > limits[i]:
            print(path, 'mesh', i, n, 'boundary edges instead of', limits[i])
            bad += 1
        for face in faces_of_fewer_corners(g, mesh):
            print(path, 'mesh', i, 'has the face', face)
            bad += 1
sys.exit(bad > 0)
