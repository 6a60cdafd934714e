# SPDX-License-Identifier: MIT
"""Reads glTF files for the tests: JSON, bytes, accessors as numbers."""
import base64
import json
import os
import struct
import urllib.parse

FORMATS = {5120: 'b', 5121: 'B', 5122: 'h', 5123: 'H', 5125: 'I', 5126: 'f'}
WIDTHS = {'SCALAR': 1, 'VEC2': 2, 'VEC3': 3, 'VEC4': 4, 'MAT4': 16}
UNITS = {5120: 127, 5121: 255, 5122: 32767, 5123: 65535}


class Gltf:
    def __init__(self, path):
        self.folder = os.path.dirname(path)
        data = open(path, 'rb').read()
        self.bin = b''
        if data[:4] == b'glTF':
            size = struct.unpack('<I', data[12:16])[0]
            text = data[20:20 + size]
            self.bin = data[28 + size:]
        else:
            text = data
        self.json = json.loads(text)
        self.cache = {}

    def uri(self, uri):
        if uri.startswith('data:'):
            return base64.b64decode(uri.split(',', 1)[1])
        name = os.path.join(self.folder, urllib.parse.unquote(uri))
        return open(name, 'rb').read()

    def buffer(self, number):
        if number not in self.cache:
            buffer = self.json['buffers'][number]
            self.cache[number] = (self.uri(buffer['uri']) if 'uri' in buffer
                                  else self.bin[:buffer['byteLength']])
        return self.cache[number]

    def view(self, number):
        view = self.json['bufferViews'][number]
        start = view.get('byteOffset', 0)
        return self.buffer(view['buffer'])[start:start + view['byteLength']]

    def image(self, image):
        if 'bufferView' in image:
            return self.view(image['bufferView'])
        return self.uri(image['uri'])

    def elements(self, view, offset, stride, component, width, count):
        form = '<%d%s' % (width, FORMATS[component])
        stride = stride or struct.calcsize(form)
        data = self.view(view)
        return [struct.unpack_from(form, data, offset + i * stride)
                for i in range(count)]

    def accessor(self, number):
        """Tuples; normalised integers as numbers of -1 .. 1."""
        a = self.json['accessors'][number]
        component, width = a['componentType'], WIDTHS[a['type']]
        if 'bufferView' in a:
            view = self.json['bufferViews'][a['bufferView']]
            rows = self.elements(a['bufferView'], a.get('byteOffset', 0),
                                 view.get('byteStride'), component, width,
                                 a['count'])
        else:
            rows = [(0,) * width] * a['count']
        if 'sparse' in a:
            s = a['sparse']
            at = self.elements(s['indices']['bufferView'],
                               s['indices'].get('byteOffset', 0), None,
                               s['indices']['componentType'], 1, s['count'])
            new = self.elements(s['values']['bufferView'],
                                s['values'].get('byteOffset', 0), None,
                                component, width, s['count'])
            for (i,), row in zip(at, new):
                rows[i] = row
        if a.get('normalized'):
            unit = UNITS[component]
            rows = [tuple(max(c / unit, -1.0) for c in r) for r in rows]
        return rows

    def faces(self, primitive):
        """Vertex triples of a primitive of triangles, strips or fans."""
        if 'indices' in primitive:
            order = [i for (i,) in self.accessor(primitive['indices'])]
        else:
            position = primitive['attributes']['POSITION']
            order = list(range(self.json['accessors'][position]['count']))
        mode = primitive.get('mode', 4)
        if mode == 4:
            return [tuple(order[i:i + 3]) for i in range(0, len(order), 3)]
        count = len(order) - 2
        if mode == 5:
            return [(order[i], order[i + 1 + i % 2], order[i + 2 - i % 2])
                    for i in range(count)]
        return [(order[i + 1], order[i + 2], order[0]) for i in range(count)]
