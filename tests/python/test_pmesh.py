# SPDX-License-Identifier: MIT
"""The Python module says what the program says."""
import gc
import json
import os
import subprocess
import sys
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, "tools/python")
import pmesh  # noqa: E402

GOLDEN = "tests/golden/"


def read(name):
    with open(GOLDEN + name, "rb") as file:
        return file.read()


def info(name):
    return json.loads(subprocess.run(
        [os.environ["PMESH"], "info", GOLDEN + name, "--json"],
        check=True, capture_output=True).stdout)


class Module(unittest.TestCase):
    def test_header_is_that_of_info(self):
        for name in sorted(os.listdir(GOLDEN)):
            if not name.endswith(".pmesh") or name == "scene.pmesh":
                continue
            told, h = info(name), pmesh.Decoder(read(name)).header
            self.assertEqual(told["content_hash"], f"{h.content_hash:016x}")
            for key in ("bytes", "faces", "base_faces", "format_version"):
                self.assertEqual(told[key], getattr(h, key), (name, key))
            self.assertEqual(told["vertices"], h.mesh_vertices)
            self.assertEqual(told["output_vertices"], h.vertices)
            self.assertEqual(told["lossless_bytes"], h.exact_bytes)
            self.assertEqual(told["decoder_memory"], h.memory)
            self.assertEqual(told["step"], h.grid.step)
            self.assertEqual([a["components"] for a in told["attributes"]],
                             [a.components for a in
                              h.attributes[:h.attribute_count]])
            self.assertEqual([l["faces"] for l in told["levels"]],
                             [l.faces for l in h.levels[:h.level_count]])

    def test_mesh_is_that_of_extract(self):
        mesh = pmesh.Decoder(read("seam.pmesh"))
        for faces in (40, 100, 10000):
            mesh.refine(faces=faces)
            text = subprocess.run(
                [os.environ["PMESH"], "extract", GOLDEN + "seam.pmesh",
                 "--faces", str(faces), "-q", "-o", "-", "--format", "off",
                 "--no-attributes"],
                check=True, capture_output=True).stdout.split()
            self.assertEqual(int(text[2]), mesh.face_count)

    def test_pieces_and_ranges(self):
        data, mesh = read("blocks.pmesh"), pmesh.Decoder()
        self.assertIsNone(mesh.refine())
        positions, indices = {}, {}
        for at in range(0, len(data), 97):
            done = mesh.feed(data[at:at + 97])
            changes = mesh.refine(max_ops=30)
            if not changes:
                continue
            for first, count in changes.vertices:
                positions.update(enumerate(
                    mesh.positions[3 * first:3 * (first + count)], 3 * first))
            for first, count in changes.faces:
                indices.update(enumerate(
                    mesh.indices[3 * first:3 * (first + count)], 3 * first))
            for array, copy in ((mesh.positions, positions),
                                (mesh.indices, indices)):
                self.assertEqual(list(array),
                                 [copy[i] for i in range(len(array))])
        self.assertTrue(done)
        self.assertTrue(mesh.progress.complete)

    def test_damage(self):
        data = bytearray(read("closed.pmesh"))
        data[-20] ^= 1
        mesh = pmesh.Decoder()
        with self.assertRaises(pmesh.PmeshError) as caught:
            mesh.feed(data)
        self.assertGreater(caught.exception.offset, 0)
        self.assertIn("SPEC", caught.exception.rule)
        mesh.refine()
        self.assertGreater(mesh.face_count, 0)
        with self.assertRaises(pmesh.PmeshError):
            pmesh.Decoder(b"solid mesh")

    def test_views_outlive_the_decoder(self):
        mesh = pmesh.Decoder(read("closed.pmesh"))
        positions, copy = mesh.positions, list(mesh.positions)
        del mesh
        gc.collect()
        self.assertEqual(list(positions), copy)

    def test_questions(self):
        mesh = pmesh.Decoder(read("closed.pmesh"))
        low, high = mesh.bounds()
        corners = mesh.indices[:3].tolist()
        middle = [sum(mesh.positions[3 * v + k] for v in corners) / 3
                  for k in range(3)]
        away = [b - a + 1 for a, b in zip(low, high)]
        face, distance, weights = mesh.raycast(
            [x - d for x, d in zip(middle, away)], away)
        self.assertLess(face, mesh.face_count)
        self.assertLessEqual(distance, 1.0001)
        self.assertAlmostEqual(sum(weights), 1)
        self.assertEqual(mesh.error, 0)


if __name__ == "__main__":
    result = unittest.main(exit=False, verbosity=0).result
    bad = len(result.failures) + len(result.errors)
    print(f"{result.testsRun - bad} passed, {bad} failed")
    sys.exit(bad > 0)
