# SPDX-License-Identifier: MIT
"""Usage: pose.py FILE SECONDS OUT.obj

Deforms the skinned meshes of a glTF file by its first animation and writes
them as OBJ. Linear interpolation is enough here.
"""
import bisect
import sys

from gltf import Gltf


def multiply(a, b):
    """Of 4 x 4 matrices, column by column, as glTF has them."""
    return [sum(a[4 * k + r] * b[4 * c + k] for k in range(4))
            for c in range(4) for r in range(4)]


def local(node):
    if 'matrix' in node:
        return node['matrix']
    x, y, z, w = node.get('rotation', (0, 0, 0, 1))
    n = (x * x + y * y + z * z + w * w) ** 0.5
    x, y, z, w = x / n, y / n, z / n, w / n
    s, t = node.get('scale', (1, 1, 1)), node.get('translation', (0, 0, 0))
    rows = ((1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
            (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
            (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)))
    return [rows[r][c] * s[c] if r < 3 else 0.0
            for c in range(3) for r in range(4)] + list(t) + [1.0]


def animate(g, seconds):
    animation = g.json['animations'][0]
    for channel in animation['channels']:
        sampler = animation['samplers'][channel['sampler']]
        times = [t for (t,) in g.accessor(sampler['input'])]
        values = g.accessor(sampler['output'])
        k = min(max(bisect.bisect_right(times, seconds) - 1, 0),
                len(times) - 2)
        share = (seconds - times[k]) / (times[k + 1] - times[k])
        share = min(max(share, 0.0), 1.0)
        a, b = values[k], values[k + 1]
        if channel['target']['path'] == 'rotation' and sum(
                x * y for x, y in zip(a, b)) < 0:
            b = tuple(-y for y in b)
        node = g.json['nodes'][channel['target']['node']]
        node[channel['target']['path']] = [
            x + (y - x) * share for x, y in zip(a, b)]


def worlds(g):
    nodes = g.json['nodes']
    parent = {c: i for i, n in enumerate(nodes) for c in n.get('children', [])}
    found = {}

    def world(i):
        if i not in found:
            m = local(nodes[i])
            found[i] = multiply(world(parent[i]), m) if i in parent else m
        return found[i]
    return [world(i) for i in range(len(nodes))]


def deform(matrices, p, joints, weights):
    out = [0.0, 0.0, 0.0]
    for j, w in zip(joints, weights):
        if w > 0:
            m = matrices[int(j)]
            for r in range(3):
                out[r] += w * (m[r] * p[0] + m[4 + r] * p[1] +
                               m[8 + r] * p[2] + m[12 + r])
    return out


def main(path, seconds, out):
    g = Gltf(path)
    animate(g, seconds)
    world = worlds(g)
    lines, base = [], 1
    for node in g.json['nodes']:
        if 'mesh' not in node or 'skin' not in node:
            continue
        skin = g.json['skins'][node['skin']]
        bind = g.accessor(skin['inverseBindMatrices'])
        matrices = [multiply(world[j], b)
                    for j, b in zip(skin['joints'], bind)]
        for p in g.json['meshes'][node['mesh']]['primitives']:
            a = {n: g.accessor(i) for n, i in p['attributes'].items()}
            for row in zip(a['POSITION'], a['JOINTS_0'], a['WEIGHTS_0']):
                lines.append('v %.9g %.9g %.9g' % tuple(deform(matrices,
                                                               *row)))
            lines += ['f %d %d %d' % tuple(base + i for i in f)
                      for f in g.faces(p)]
            base += len(a['POSITION'])
    with open(out, 'w') as file:
        file.write('\n'.join(lines) + '\n')


main(sys.argv[1], float(sys.argv[2]), sys.argv[3])
