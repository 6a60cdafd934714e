# SPDX-License-Identifier: MIT
"""Usage: draco.py PLAIN PACKED

Is PACKED the scene PLAIN with its refined primitives, and no others, in
KHR_draco_mesh_compression, the same attributes in each, nothing stored twice?
"""
import sys

from gltf import Gltf

NAME = 'KHR_draco_mesh_compression'


def check_primitive(plain, packed, p, q):
    extension = q['extensions'][NAME]
    assert set(extension['attributes']) == set(q['attributes'])
    ids = list(extension['attributes'].values())
    assert len(set(ids)) == len(ids)
    assert packed.view(extension['bufferView'])[:5] == b'DRACO'
    for name in list(p['attributes']) + ['']:
        a, b = [g.json['accessors'][r['attributes'][name] if name
                                    else r['indices']]
                for g, r in ((plain, p), (packed, q))]
        assert 'bufferView' not in b and 'byteOffset' not in b
        assert a['type'] == b['type'], name
        if not name:
            assert a['count'] == b['count'], 'faces'
        if name == 'POSITION':
            size = max(y - x for x, y in zip(a['min'], a['max']))
            for key in 'min', 'max':
                assert all(abs(x - y) <= 1e-5 * (size + abs(x))
                           for x, y in zip(a[key], b[key])), key


def main():
    plain, packed = Gltf(sys.argv[1]), Gltf(sys.argv[2])
    count = 0
    assert NAME in packed.json['extensionsUsed']
    assert NAME in packed.json['extensionsRequired']
    for x, y in zip(plain.json['meshes'], packed.json['meshes']):
        for p, q in zip(x['primitives'], y['primitives']):
            if NAME in q.get('extensions', {}):
                check_primitive(plain, packed, p, q)
                count += 1
            else: # kept as it is
                assert 'bufferView' in packed.json['accessors'][
                    q['attributes']['POSITION']]
    assert count > 0


main()
