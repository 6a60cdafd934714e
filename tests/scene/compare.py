# SPDX-License-Identifier: MIT
"""Usage: compare.py INPUT OUTPUT [full]

Is OUTPUT, extracted from the scene that INPUT was baked to, the same scene?
Everything but geometry has to be equal: JSON by value, images and other
accessors by their bytes or numbers. With `full`, geometry is compared, too: the
same faces, each corner with the same attributes, within the quantisation of
the default options. Of compressed inputs only JSON and images are compared.
"""
import collections
import math
import sys

from gltf import Gltf

# Half a step of each attribute's default bits, as a share of its range.
STEPS = {'TEXCOORD': 0.5 / 4095, 'COLOR': 0.5 / 255, 'WEIGHTS': 0.5 / 4095}


def check(good, *what):
    if not good:
        print('different:', *what)
        sys.exit(1)


def unmark(g):
    """Takes the mark of a GLB with a scene in it out of the document."""
    g.json.get('extensions', {}).pop('PMESH_progressive', None)
    if g.json.get('extensions') == {}:
        del g.json['extensions']
    if 'PMESH_progressive' in g.json.get('extensionsUsed', []):
        g.json['extensionsUsed'].remove('PMESH_progressive')


def compare_json(a, b):
    unmark(b)
    for key in sorted(set(a.json) | set(b.json)):
        if key in ('accessors', 'bufferViews', 'buffers', 'images', 'meshes',
                   'extensionsUsed', 'extensionsRequired'):
            continue
        check(a.json.get(key) == b.json.get(key), key)
    for key in ('extensionsUsed', 'extensionsRequired'):
        gone = set(a.json.get(key, [])) - set(b.json.get(key, []))
        check(gone <= {'EXT_meshopt_compression', 'KHR_mesh_quantization',
                       'KHR_draco_mesh_compression'}, key, gone)
        check(set(b.json.get(key, [])) <= set(a.json.get(key, [])), key)


def compare_images(a, b):
    before, after = a.json.get('images', []), b.json.get('images', [])
    check(len(before) == len(after), 'number of images')
    for i, (x, y) in enumerate(zip(before, after)):
        check(a.image(x) == b.image(y), 'image', i)
        for key in set(x) - {'uri', 'bufferView'}:
            check(x[key] == y.get(key), 'image', i, key)


def compare_accessor(a, b, number, what):
    check(a.accessor(number) == b.accessor(number), what, number)


def compare_others(a, b):
    for skin in a.json.get('skins', []):
        if 'inverseBindMatrices' in skin:
            compare_accessor(a, b, skin['inverseBindMatrices'], 'skin')
    for animation in a.json.get('animations', []):
        for sampler in animation['samplers']:
            compare_accessor(a, b, sampler['input'], 'animation')
            compare_accessor(a, b, sampler['output'], 'animation')
    for i, (x, y) in enumerate(zip(a.json['meshes'], b.json['meshes'])):
        check({k: v for k, v in x.items() if k != 'primitives'} ==
              {k: v for k, v in y.items() if k != 'primitives'}, 'mesh', i)
        check(len(x['primitives']) == len(y['primitives']), 'primitives', i)
        for p, q in zip(x['primitives'], y['primitives']):
            for key in set(p) | set(q):
                if key not in ('attributes', 'indices', 'mode', 'targets',
                               'extensions'):
                    check(p.get(key) == q.get(key), 'mesh', i, key)
            if p.get('mode', 4) < 4:
                check(p == q, 'kept primitive of mesh', i)
                for number in list(p['attributes'].values()):
                    compare_accessor(a, b, number, 'kept')


def check_weights(g):
    """Every vertex of a skin has weights, and their sum is 1."""
    for i, mesh in enumerate(g.json['meshes']):
        for p in mesh['primitives']:
            sets = [g.accessor(a) for n, a in p['attributes'].items()
                    if n.startswith('WEIGHTS_')]
            for rows in zip(*sets):
                total = sum(sum(row) for row in rows)
                check(abs(total - 1) < 1e-6, 'weights of mesh', i, total)


class Nearest:
    """The output's positions, found by the input's."""

    def __init__(self, points, cell):
        self.cell = cell
        self.cells = collections.defaultdict(set)
        for p in points:
            self.cells[self.key(p)].add(p)

    def key(self, p):
        return tuple(int(math.floor(c / self.cell)) for c in p)

    def __call__(self, p):
        x, y, z = self.key(p)
        best, found = self.cell, None
        for i in (x - 1, x, x + 1):
            for j in (y - 1, y, y + 1):
                for k in (z - 1, z, z + 1):
                    for q in self.cells.get((i, j, k), ()):
                        d = math.dist(p, q)
                        if d < best:
                            best, found = d, q
        return found


def turn(face):
    """The corners from the least one on: a face has no first corner."""
    at = face.index(min(face))
    return face[at:] + face[:at]


def corner_rows(g, p):
    """Names and values of all attributes, those of morph targets included."""
    found = {n: a for n, a in p['attributes'].items() if n != 'POSITION'}
    for i, target in enumerate(p.get('targets', [])):
        found.update({'target %d %s' % (i, n): a for n, a in target.items()})
    names = sorted(found)
    return names, [g.accessor(found[n]) for n in names]


def ranges_of(rows):
    return [max(r[k] for r in rows) - min(r[k] for r in rows)
            for k in range(len(rows[0]))]


def same_corner(names, x, y, spans, skin):
    for name, u, v, span in zip(names, x, y, spans):
        if name == 'NORMAL' or name == 'TANGENT':
            length = math.sqrt(sum(c * c for c in u[:3])) or 1
            if math.dist([c / length for c in u[:3]], v[:3]) > 0.01 or \
                    (len(u) == 4 and u[3] != v[3]):
                return False
        elif name.startswith('JOINTS'):
            weights = skin[name.replace('JOINTS', 'WEIGHTS')]
            if any(i != j for i, j, w in zip(u, v, weights) if w > 0):
                return False
        else:
            share = STEPS.get(name.split('_')[0], 0.5 / 4095)
            for i, j, s in zip(u, v, span):
                s = 1 if name.startswith('COLOR') else s
                if abs(i - j) > s * share * 1.5 + 2e-3 * (
                        name.startswith('WEIGHTS')) + 1e-5 * abs(i) + 1e-7:
                    return False
    return True


def compare_primitive(a, b, p, q, cell, where):
    pa, pb = (a.accessor(p['attributes']['POSITION']),
              b.accessor(q['attributes']['POSITION']))
    find = Nearest(pb, cell)
    near = [find(x) for x in pa]
    names, before = corner_rows(a, p)
    other, after = corner_rows(b, q)
    check(names == other, where, 'attributes', names, other)
    spans = [ranges_of(rows) for rows in before]
    faces = collections.defaultdict(list)
    for f in b.faces(q):
        key = turn(tuple((pb[i], i) for i in f))
        faces[tuple(k for k, _ in key)].append([i for _, i in key])
    missing, wrong = 0, 0
    for f in a.faces(p):
        if len({pa[i] for i in f}) < 3:
            continue
        key = turn(tuple((near[i], i) for i in f)) if None not in [
            near[i] for i in f] else None
        candidates = faces.get(tuple(k for k, _ in key), []) if key else []
        hit = None
        for c in candidates:
            corners = [i for _, i in key]
            # Corners at one grid point may have any order among themselves.
            for t in range(3):
                d = c[t:] + c[:t]
                if [pb[i] for i in d] == [k for k, _ in key] and all(
                        same_corner(names, [r[i] for r in before],
                                    [r[j] for r in after], spans,
                                    {n: r[j] for n, r in zip(names, after)})
                        for i, j in zip(corners, d)):
                    hit = c
        if hit:
            candidates.remove(hit)
        elif candidates:
            wrong += 1
        else:
            missing += 1
    left = sum(len(v) for v in faces.values())
    check(missing == 0 and wrong == 0 and left <= 1, where, missing,
          'faces missing,', wrong, 'with other attributes,', left, 'too many')
    return len(pa), len(pb)


def extent(g, mesh):
    low, high = [1e300] * 3, [-1e300] * 3
    for p in mesh['primitives']:
        if p.get('mode', 4) < 4 or 'POSITION' not in p['attributes']:
            continue
        for row in g.accessor(p['attributes']['POSITION']):
            low = [min(x, y) for x, y in zip(low, row)]
            high = [max(x, y) for x, y in zip(high, row)]
    return max(y - x for x, y in zip(low, high))


def compare_geometry(a, b):
    total = [0, 0]
    for i, (x, y) in enumerate(zip(a.json['meshes'], b.json['meshes'])):
        for k, (p, q) in enumerate(zip(x['primitives'], y['primitives'])):
            if p.get('mode', 4) < 4 or 'POSITION' not in p['attributes']:
                continue
            cell = 0.9 * extent(a, x) / 16383 + 1e-6 * extent(a, x) + 1e-30
            n = compare_primitive(a, b, p, q, cell,
                                  'mesh %d, primitive %d:' % (i, k))
            total = [total[0] + n[0], total[1] + n[1]]
    print('%d vertices became %d' % tuple(total))


before, after = Gltf(sys.argv[1]), Gltf(sys.argv[2])
compare_json(before, after)
check_weights(after)
compare_images(before, after)
packed = {'EXT_meshopt_compression', 'KHR_draco_mesh_compression'}
if not packed & set(before.json.get('extensionsUsed', [])):
    compare_others(before, after)
    if 'full' in sys.argv:
        compare_geometry(before, after)
