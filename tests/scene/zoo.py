# SPDX-License-Identifier: MIT
"""Usage: zoo.py FOLDER

Writes small glTF files, each with another of the things that glTF can hold.
"""
import base64
import json
import math
import os
import struct
import sys
import zlib

FORMATS = {5120: 'b', 5121: 'B', 5122: 'h', 5123: 'H', 5125: 'I', 5126: 'f'}
TYPES = {1: 'SCALAR', 2: 'VEC2', 3: 'VEC3', 4: 'VEC4', 16: 'MAT4'}
U8, I16, U16, U32, F32 = 5121, 5122, 5123, 5125, 5126
VERTICES, INDICES = 34962, 34963


class File:
    def __init__(self):
        self.json = {'asset': {'version': '2.0', 'generator': 'zoo'},
                     'scene': 0, 'scenes': [], 'nodes': [], 'meshes': [],
                     'accessors': [], 'bufferViews': []}
        self.bin = b''

    def view(self, data, **more):
        self.bin += b'\0' * (-len(self.bin) % 4)
        self.json['bufferViews'].append(dict(
            buffer=0, byteOffset=len(self.bin), byteLength=len(data), **more))
        self.bin += data
        return len(self.json['bufferViews']) - 1

    def accessor(self, rows, component=F32, target=VERTICES, **more):
        rows = [r if isinstance(r, (tuple, list)) else (r,) for r in rows]
        width = len(rows[0])
        form = '<%d%s' % (width, FORMATS[component])
        size = struct.calcsize(form)
        step = size if target != VERTICES else (size + 3) // 4 * 4
        data = b''.join(struct.pack(form, *r).ljust(step, b'\0')
                        for r in rows)
        extra = {'target': target} if target else {}
        if target == VERTICES:
            extra['byteStride'] = step
        return self.describe(rows, component, self.view(data, **extra),
                             **more)

    def describe(self, rows, component, view, **more):
        width = len(rows[0])
        a = dict(componentType=component, count=len(rows), type=TYPES[width],
                 **more)
        if view is not None:
            a['bufferView'] = view
        if width == 3 or more.get('bounds') or width == 1:
            as_floats = component == F32
            fix = (lambda v: struct.unpack('<f', struct.pack('<f', v))[0]) \
                if as_floats else int
            a['min'] = [fix(min(r[k] for r in rows)) for k in range(width)]
            a['max'] = [fix(max(r[k] for r in rows)) for k in range(width)]
        a.pop('bounds', None)
        self.json['accessors'].append(a)
        return len(self.json['accessors']) - 1

    def indices(self, order, component=U16):
        return self.accessor(order, component, INDICES)

    def mesh(self, primitives, **more):
        self.json['meshes'].append(dict(primitives=primitives, **more))
        return len(self.json['meshes']) - 1

    def node(self, **more):
        self.json['nodes'].append(more)
        return len(self.json['nodes']) - 1

    def save(self, path):
        j = self.json
        if not j['scenes']:
            j['scenes'] = [{'nodes': list(range(len(j['nodes'])))}]
        j['buffers'] = [{'byteLength': len(self.bin)}]
        text = json.dumps(j).encode()
        text += b' ' * (-len(text) % 4)
        data = self.bin + b'\0' * (-len(self.bin) % 4)
        with open(path, 'wb') as out:
            out.write(struct.pack('<4sIII4s', b'glTF', 2,
                                  28 + len(text) + len(data), len(text),
                                  b'JSON') + text)
            out.write(struct.pack('<I4s', len(data), b'BIN\0') + data)


class Sheet:
    """A bumpy square of n x n cells: rows of attributes, faces, a strip."""

    def __init__(self, n, bump=0.1):
        side = range(n + 1)
        self.n = n
        self.uv = [(x / n, y / n) for y in side for x in side]
        self.points = [(u, v, bump * math.sin(7 * u) * math.cos(5 * v))
                       for u, v in self.uv]
        self.normals = [self.normal(u, v, bump) for u, v in self.uv]
        at = [y * (n + 1) + x for y in range(n) for x in range(n)]
        self.faces = [i for a in at
                      for i in (a, a + 1, a + n + 2, a, a + n + 2, a + n + 1)]

    @staticmethod
    def normal(u, v, bump):
        dx = 7 * bump * math.cos(7 * u) * math.cos(5 * v)
        dy = -5 * bump * math.sin(7 * u) * math.sin(5 * v)
        length = math.sqrt(dx * dx + dy * dy + 1)
        return (-dx / length, -dy / length, 1 / length)

    def strip(self):
        order, n = [], self.n
        for y in range(n):
            row = [y * (n + 1) + x + d * (n + 1) for x in range(n + 1)
                   for d in (1, 0)]
            order += ([order[-1], row[0]] if order else []) + row
        return order


def plain(f, s, **more):
    return dict({'attributes': {'POSITION': f.accessor(s.points),
                                'NORMAL': f.accessor(s.normals)},
                 'indices': f.indices(s.faces)}, **more)


def png(shade):
    def chunk(kind, data):
        return (struct.pack('>I', len(data)) + kind + data +
                struct.pack('>I', zlib.crc32(kind + data)))
    rows = (b'\0' + bytes([shade] * 12)) * 4
    return (b'\x89PNG\r\n\x1a\n' +
            chunk(b'IHDR', struct.pack('>IIBBBBB', 4, 4, 8, 2, 0, 0, 0)) +
            chunk(b'IDAT', zlib.compress(rows)) + chunk(b'IEND', b''))


def modes(f):
    s = Sheet(12)
    position = f.accessor(s.points)
    a = f.mesh([{'attributes': {'POSITION': position}, 'mode': 5,
                 'indices': f.indices(s.strip())}], name='strip')
    rim = [(math.cos(i / 8), math.sin(i / 8), 0.0) for i in range(40)]
    b = f.mesh([{'attributes': {'POSITION': f.accessor([(0., 0., .5)] + rim)},
                 'mode': 6}], name='fan without indices')
    loose = [s.points[i] for i in s.faces]
    c = f.mesh([{'attributes': {'POSITION': f.accessor(loose)}}],
               name='no indices')
    for mesh in (a, b, c):
        f.node(mesh=mesh, translation=[mesh * 2, 0, 0])


def sparse(f):
    s = Sheet(10, 0)
    moved = list(s.points)
    at = [5, 17, 60]
    for i in at:
        moved[i] = moved[i][:2] + (0.5,)
    base = f.accessor(s.points)
    new = [moved[i] for i in at]
    for view in (f.json['accessors'][base]['bufferView'], None):
        rows = moved if view is not None else [
            moved[i] if i in at else (0., 0., 0.) for i in range(len(moved))]
        number = f.describe(rows, F32, view)
        f.json['accessors'][number]['sparse'] = {
            'count': len(at),
            'indices': {'componentType': U16, 'bufferView': f.view(
                struct.pack('<%dH' % len(at), *at))},
            'values': {'bufferView': f.view(
                b''.join(struct.pack('<3f', *p) for p in new))}}
        f.node(mesh=f.mesh([{'attributes': {'POSITION': number},
                             'indices': f.indices(s.faces)}]))


def interleaved(f):
    s = Sheet(14)
    data = b''.join(struct.pack('<8f', *p, *n, *t)
                    for p, n, t in zip(s.points, s.normals, s.uv))
    view = f.view(data, byteStride=32, target=VERTICES)
    names = {'POSITION': (s.points, 0), 'NORMAL': (s.normals, 12),
             'TEXCOORD_0': (s.uv, 24)}
    attributes = {n: f.describe(rows, F32, view, byteOffset=at)
                  for n, (rows, at) in names.items()}
    f.node(mesh=f.mesh([{'attributes': attributes,
                         'indices': f.indices(s.faces, U32)}]))
    f.node(mesh=0, scale=[3, 1, 2])


def quantised(f):
    s = Sheet(16)
    points = [tuple(int(c * 1000) for c in p) for p in s.points]
    normals = [tuple(round(c * 127) for c in n) for n in s.normals]
    uv = [tuple(int(c * 65535) for c in t) for t in s.uv]
    name = 'KHR_mesh_quantization'
    f.json['extensionsUsed'] = f.json['extensionsRequired'] = [name]
    f.node(scale=[0.001] * 3, mesh=f.mesh([{
        'attributes': {
            'POSITION': f.accessor(points, I16),
            'NORMAL': f.accessor(normals, 5120, normalized=True),
            'TEXCOORD_0': f.accessor(uv, U16, normalized=True)},
        'indices': f.indices(s.faces)}]))
    f.node(mesh=0, scale=[0.002] * 3, translation=[2, 0, 0])


def skinned(f):
    s = Sheet(20)
    joints = [(int(3 * u), min(int(3 * u) + 1, 3), 0, 0) for u, v in s.uv]
    joints = [j if j[0] != j[1] else (3, 0, 0, 0) for j in joints]
    weights = [(1 - (3 * u) % 1, (3 * u) % 1, 0., 0.) if j[1] else
               (1., 0., 0., 0.) for (u, v), j in zip(s.uv, joints)]
    joints = [tuple(i if w else 0 for i, w in zip(j, r))
              for j, r in zip(joints, weights)]
    bind = [tuple(float(i % 5 == 0) for i in range(12)) +
            (-k / 3, 0., 0., 1.) for k in range(4)]
    p = plain(f, s)
    p['attributes'].update(JOINTS_0=f.accessor(joints, U8),
                           WEIGHTS_0=f.accessor(weights))
    mesh = f.mesh([p], name='cloth')
    bones = [f.node(translation=[1 / 3 if k else 0, 0, 0],
                    **({'children': [k + 1]} if k < 3 else {}))
             for k in range(4)]
    f.json['skins'] = [{'joints': bones, 'skeleton': 0,
                        'inverseBindMatrices': f.accessor(bind, target=None)}]
    f.node(mesh=mesh, skin=0)
    times = [0., 0.5, 1.]
    turns = [(0., 0., math.sin(a), math.cos(a)) for a in (0, 0.4, 0)]
    f.json['animations'] = [{
        'samplers': [{'input': f.accessor(times, target=None),
                      'output': f.accessor(turns, target=None)}],
        'channels': [{'sampler': 0,
                      'target': {'node': 2, 'path': 'rotation'}}]}]
    f.json['scenes'] = [{'nodes': [0, 4]}]


def eight_weights(f):
    s = Sheet(8)
    p = plain(f, s)
    for k in range(2):
        p['attributes']['JOINTS_%d' % k] = f.accessor(
            [tuple(4 * k + i for i in range(4))] * len(s.points), U16)
        p['attributes']['WEIGHTS_%d' % k] = f.accessor(
            [(0.125,) * 4] * len(s.points))
    mesh = f.mesh([p])
    bones = [f.node(translation=[i, 0, 0]) for i in range(8)]
    root = f.node(children=bones)
    f.json['skins'] = [{'joints': bones}]
    f.node(mesh=mesh, skin=0)
    f.json['scenes'] = [{'nodes': [root, root + 1]}]


def scenes(f):
    meshes = [f.mesh([plain(f, Sheet(4 + 3 * k))], extras={'k': k})
              for k in range(4)]
    inner = [f.node(mesh=meshes[k % 3], name='n%d' % k,
                    translation=[k, 0, 0]) for k in range(6)]
    top = f.node(children=inner, scale=[10, 10, 10], extras={'a': [1, None]})
    eye = f.node(camera=0, translation=[0, 0, 5])
    f.json['cameras'] = [{'type': 'perspective', 'perspective': {
        'yfov': 0.8, 'znear': 0.1}}]
    f.json['scenes'] = [{'nodes': [top, eye], 'name': 'one'},
                        {'nodes': [f.node(mesh=2)]},
                        {'nodes': [f.node(mesh=3)]}]
    f.json['extensionsUsed'] = ['ZOO_unknown']
    spare = f.accessor([1., 2., 3.], target=None)
    f.json['extensions'] = {'ZOO_unknown': {'data': spare, 'text': 'x'}}
    f.json['extras'] = {'deep': {'er': [1.5, 'ü', True]}}


def morphs(f):
    s = Sheet(16)
    p = plain(f, s)
    up = [(0., 0., u * v) for u, v in s.uv]
    p['targets'] = [{'POSITION': f.accessor(up),
                     'NORMAL': f.accessor([(0., 0., 0.1)] * len(up))},
                    {'POSITION': f.accessor([(u * u, 0., 0.)
                                             for u, v in s.uv])}]
    f.node(mesh=f.mesh([p], weights=[0.5, 0]))
    many = plain(f, s)
    many['targets'] = [{'POSITION': p['targets'][k % 2]['POSITION']}
                       for k in range(9)]
    f.node(mesh=f.mesh([many], weights=[0] * 9), translation=[2, 0, 0])
    f.json['animations'] = [{
        'samplers': [{'input': f.accessor([0., 1.], target=None),
                      'output': f.accessor([0., 0., 1., 1.], target=None)}],
        'channels': [{'sampler': 0, 'target': {'node': 0,
                                               'path': 'weights'}}]}]


def kept(f):
    s = Sheet(12)
    line = {'attributes': {'POSITION': f.accessor(s.points[:20])}, 'mode': 3}
    dots = {'attributes': {'POSITION': f.accessor(s.points[20:50])},
            'mode': 0}
    f.node(mesh=f.mesh([line, plain(f, s), dots]))
    f.node(mesh=f.mesh([dict(line)]), translation=[0, 2, 0])


def attributes(f):
    s, t = Sheet(15), Sheet(9)
    t.points = [(x + 1, y, z) for x, y, z in t.points]
    n = len(s.points)
    a, b = plain(f, s, material=0), plain(f, t, material=1)
    colours = [(i % 256, 255 - i % 256, 7, 255) for i in range(n)]
    a['attributes'].update(
        COLOR_0=f.accessor(colours, U8, normalized=True),
        _ID=f.accessor([i * 7 % 5000 for i in range(n)], U16),
        _HEAT=f.accessor([math.sin(i / 50) for i in range(n)]))
    b['attributes'].pop('NORMAL')
    b['attributes']['COLOR_0'] = f.accessor([(0.5, u, v) for u, v in t.uv])
    b['attributes']['TEXCOORD_0'] = f.accessor(t.uv)
    f.json['materials'] = [{'name': 'a'},
                           {'pbrMetallicRoughness': {'metallicFactor': 0}}]
    f.node(mesh=f.mesh([a, b]))


def textures(f):
    s = Sheet(18)
    p = plain(f, s, material=0)
    p['attributes']['TEXCOORD_0'] = f.accessor(s.uv)
    p['attributes']['TANGENT'] = f.accessor(
        [tuple(c / math.hypot(n[2], n[0]) for c in (n[2], 0, -n[0])) + (-1.,)
         for n in s.normals])
    data = 'data:image/png;base64,' + base64.b64encode(png(200)).decode()
    f.json['images'] = [{'uri': data},
                        {'bufferView': f.view(png(90)),
                         'mimeType': 'image/png', 'name': 'inside'},
                        {'uri': 'zoo%20image.png'}]
    f.json['textures'] = [{'source': k} for k in range(3)]
    f.json['materials'] = [{
        'pbrMetallicRoughness': {'baseColorTexture': {'index': 0},
                                 'metallicRoughnessTexture': {'index': 2}},
        'normalTexture': {'index': 1}}]
    f.node(mesh=f.mesh([p]))


def shared(f):
    """One set of vertices for all primitives, one view for all indices."""
    s = Sheet(20)
    position, normal = f.accessor(s.points), f.accessor(s.normals)
    half = len(s.faces) // 2 // 3 * 3
    parts = [s.faces[:half], s.faces[half:]]
    view = f.view(struct.pack('<%dH' % len(s.faces), *s.faces),
                  target=INDICES)
    f.json['materials'] = [{'doubleSided': True}, {'name': 'b'}]
    primitives = [{'attributes': {'POSITION': position, 'NORMAL': normal},
                   'material': k,
                   'indices': f.describe([(i,) for i in part], U16, view,
                                         byteOffset=2 * half * k)}
                  for k, part in enumerate(parts)]
    f.node(mesh=f.mesh(primitives))


def decals(f):
    """Two materials on the same faces."""
    s = Sheet(10)
    f.json['materials'] = [{'name': 'wall'}, {'alphaMode': 'BLEND'}]
    under, over = plain(f, s, material=0), plain(f, s, material=1)
    over['attributes']['TEXCOORD_0'] = f.accessor(s.uv)
    f.node(mesh=f.mesh([under, over]))


def wild(f):
    """Every attribute with values that are no numbers, or too large."""
    s = Sheet(12)
    p = plain(f, s, material=0)
    odd = (float('inf'), float('-inf'), float('nan'), 3e38, -3e38, 1e-45)
    for name, width in (('NORMAL', 3), ('TANGENT', 4), ('TEXCOORD_0', 2),
                        ('COLOR_0', 4), ('_HEAT', 1)):
        rows = [tuple(odd[(i + k) % 6] if (i + k) % 5 == 0 else 0.5
                      for k in range(width)) for i in range(len(s.points))]
        p['attributes'][name] = number = f.accessor(rows)
        for bound in ('min', 'max'):
            f.json['accessors'][number].pop(bound, None)
    f.json['materials'] = [{'normalTexture': {'index': 0}}]
    f.json['textures'] = [{}]
    f.node(mesh=f.mesh([p]))


def main(folder):
    with open(os.path.join(folder, 'zoo image.png'), 'wb') as out:
        out.write(png(30))
    for make in (modes, sparse, interleaved, quantised, skinned,
                 eight_weights, scenes, morphs, kept, attributes, textures,
                 shared, decals):
        f = File()
        make(f)
        f.save(os.path.join(folder, make.__name__ + '.glb'))
    os.mkdir(os.path.join(folder, 'wild'))
    f = File()
    wild(f)
    f.save(os.path.join(folder, 'wild', 'wild.glb'))


main(sys.argv[1])
