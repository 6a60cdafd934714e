# SPDX-License-Identifier: MIT
"""Usage: lods.py FULL CHAINS LEVELS

Is CHAINS the scene of FULL with LEVELS levels, by MSFT_lod? Each node that
shows a refined mesh in FULL names a node for each coarser level, of the same
place and skin, with fewer faces; the shares of the screen fall.
"""
import sys

from gltf import Gltf


def faces(g, mesh):
    return sum(len(g.faces(p)) for p in g.json['meshes'][mesh]['primitives']
               if p.get('mode', 4) == 4)


def main(full, chains, levels):
    a, b = Gltf(full), Gltf(chains)
    nodes = b.json['nodes']
    marked = [n for n in nodes if 'MSFT_lod' in n.get('extensions', {})]
    assert len(marked) > 0 and 'MSFT_lod' in b.json['extensionsUsed']
    for node in marked:
        ids = node['extensions']['MSFT_lod']['ids']
        shares = node['extras']['MSFT_screencoverage']
        assert len(ids) == levels - 1 and len(shares) == levels, ids
        assert all(x >= y for x, y in zip(shares, shares[1:])), shares
        assert shares[0] <= 1 and shares[-1] == 0, shares
        assert 'children' not in node
        counts = [faces(b, node['mesh'])]
        assert counts[0] == faces(a, node['mesh']), counts
        for number in ids:
            coarse = nodes[number]
            for key in ('translation', 'rotation', 'scale', 'matrix', 'skin',
                        'weights', 'name'):
                assert coarse.get(key) == node.get(key), key
            counts.append(faces(b, coarse['mesh']))
        assert all(x >= y for x, y in zip(counts, counts[1:])), counts


main(sys.argv[1], sys.argv[2], int(sys.argv[3]))
