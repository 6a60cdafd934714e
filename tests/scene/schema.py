# SPDX-License-Identifier: MIT
"""Usage: schema.py FILE...

Are PMESH_progressive's objects in these glTF files as format/ says? Knows as
much of JSON Schema as that file uses; stops at a word that it does not know.
"""
import json
import sys

from gltf import Gltf

KINDS = {'object': dict, 'array': list, 'integer': int, 'boolean': bool,
         'string': str}
WORDS = {'description', 'type', 'properties', 'required', 'items', 'enum',
         'additionalProperties', 'minimum', 'oneOf', '$ref'}

with open('format/PMESH_progressive.schema.json', encoding='utf-8') as f:
    SCHEMA = json.load(f)


def check(value, rule, where):
    assert set(rule) <= WORDS, (where, 'words of the schema', set(rule) - WORDS)
    if '$ref' in rule:
        rule = SCHEMA['$defs'][rule['$ref'].rpartition('/')[2]]
    if 'type' in rule:
        good = isinstance(value, KINDS[rule['type']])
        assert good and (rule['type'] == 'boolean' or value is not True), where
    assert value in rule.get('enum', [value]), where
    if 'oneOf' in rule:
        assert sum(set(one['required']) <= set(value)
                   for one in rule['oneOf']) == 1, where
    assert 'minimum' not in rule or value >= rule['minimum'], where
    for item in value if 'items' in rule else []:
        check(item, rule['items'], where)
    missing = set(rule.get('required', [])) - set(value if rule.get('required')
                                                  else [])
    assert not missing, (where, missing)
    if not isinstance(value, dict):
        return
    for name, member in value.items():
        other = rule.get('additionalProperties', {})
        inner = rule.get('properties', {}).get(name, other)
        assert inner is not False, (where, name)
        check(member, inner, where + '.' + name)


def main(files):
    for name in files:
        g = Gltf(name)
        root = g.json['extensions']['PMESH_progressive']
        check(root, SCHEMA['$defs']['root'], 'root')
        assert 'PMESH_progressive' in g.json['extensionsUsed']
        count = 0
        for mesh in g.json['meshes']:
            for p in mesh['primitives']:
                extension = p.get('extensions', {}).get('PMESH_progressive')
                if extension is not None:
                    check(extension, SCHEMA['$defs']['primitive'], 'primitive')
                    count += 1
        assert count > 0
        view = g.json['bufferViews'][root['bufferView']]
        rest = g.json['buffers'][0]['byteLength'] - view['byteOffset']
        assert rest - view['byteLength'] < 4, 'the stream is not the last'


main(sys.argv[1:])
