# SPDX-License-Identifier: MIT
"""Usage: mtl.py INPUT PLAIN.glb MERGED.obj

Do MERGED.obj and the library that it names show the materials of INPUT: each
that has faces, by name, with its colour and the bytes of its images, and
texture coordinates as OBJ has them, of those in PLAIN.glb?
"""
import os
import sys

from gltf import Gltf


def read_library(path):
    materials = {}
    with open(path, encoding='utf-8') as lines:
        for word, _, rest in (line.rstrip('\n').partition(' ')
                              for line in lines):
            if word == 'newmtl':
                assert rest not in materials, rest
                current = materials[rest] = {}
            elif word:
                current[word] = rest
    return materials


def check_image(g, folder, slot, name, where):
    source = None
    if slot is not None:
        source = g.json['textures'][slot['index']].get('source')
    if source is None:
        return
    with open(os.path.join(folder, name), 'rb') as f:
        assert f.read() == g.image(g.json['images'][source]), where


def check_material(g, folder, material, shown):
    pbr = material.get('pbrMetallicRoughness', {})
    color = pbr.get('baseColorFactor', [1, 1, 1, 1])
    written = [float(x) for x in shown['Kd'].split()]
    assert all(abs(x - y) < 1e-6 for x, y in zip(color, written)), written
    assert abs(float(shown['Pr']) - pbr.get('roughnessFactor', 1)) < 1e-6
    check_image(g, folder, pbr.get('baseColorTexture'), shown.get('map_Kd'),
                'map_Kd')
    check_image(g, folder, material.get('normalTexture'), shown.get('norm'),
                'norm')


def main(source, plain, merged):
    g, p = Gltf(source), Gltf(plain)
    with open(merged, encoding='utf-8') as f:
        lines = [line.split(None, 1) for line in f]
    uses = {rest.strip() for word, rest in lines if word == 'usemtl'}
    coords = {tuple(round(float(x), 5) for x in rest.split())
              for word, rest in lines if word == 'vt'}
    rows = {(round(row[0], 5), round(1 - row[1], 5))
            for mesh in p.json['meshes'] for q in mesh['primitives']
            if q.get('mode', 4) >= 4 and 'TEXCOORD_0' in q['attributes']
            for row in p.accessor(q['attributes']['TEXCOORD_0'])}
    off = [c for c in coords - {(0, 0), (0, 1)} if not any(
        (round(c[0] + i * 1e-5, 5), round(c[1] + j * 1e-5, 5)) in rows
        for i in (-1, 0, 1) for j in (-1, 0, 1))]
    assert not off, ('texture coordinates', off[:3])
    materials = g.json.get('materials', [])
    if not materials:
        assert not any(word == 'mtllib' for word, _ in lines)
        return
    folder = os.path.dirname(merged)
    name, = [rest.strip() for word, rest in lines if word == 'mtllib']
    library = read_library(os.path.join(folder, name))
    assert uses <= set(library) | {'default'}, uses
    assert len(library) == len(materials)
    for material, (name, shown) in zip(materials, library.items()):
        assert name.startswith(material.get('name', 'material_')), name
        check_material(g, folder, material, shown)


main(*sys.argv[1:])
