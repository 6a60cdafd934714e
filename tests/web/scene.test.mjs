// SPDX-License-Identifier: MIT
// pmesh/scene: what the native program shows of a scene, at any budget.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { deflateSync } from "node:zlib";
import { PmeshError, Source } from "pmesh";
import { Scene, SceneDecoder, openScene } from "pmesh/scene";
import { unpack } from "../pmesh/unpack.js";
import { serve } from "./server.mjs";

const { PMESH, PMESH_GOLDEN, PMESH_ZOO } = process.env;
const files = readdirSync(PMESH_ZOO).filter((name) => name.endsWith(".pmesh"))
    .map((name) => join(PMESH_ZOO, name));

const native = (file, ...target) => Number(/(\d+) of \d+ faces/.exec(
    execFileSync(PMESH, ["extract", file, ...target, "-o",
        join(PMESH_ZOO, "x.glb")], { encoding: "utf8" }))[1]);

test("budgets show as many faces as native code", async () => {
    assert.ok(files.length > 5);
    let compared = 0;
    for (const file of files) {
        const scene = await openScene(readFileSync(file));
        await scene.load();
        const { header } = scene;
        assert.equal(scene.faceCount, header.faces);
        /* The program counts what is drawn, a budget here what is decoded. */
        const once = native(file) === header.faces;
        compared += once;
        for (const part of [0, 0.3, 0.5, 0.9]) {
            const faces = Math.max(1, Math.floor(part * header.faces));
            scene.refine({ faces });
            if (once)
                assert.equal(scene.faceCount,
                    native(file, "--faces", String(faces)), `${file} ${faces}`);
            else
                assert.ok(scene.faceCount <=
                    Math.max(faces, header.levels[0].faces));
        }
        const { error } = header.levels[header.levels.length >> 1];
        scene.refine({ error });
        assert.ok(scene.error <= error);
    }
    assert.ok(compared > 5);
});

test("the golden scene is decoded whole, with any document", async () => {
    const scene = await openScene(readFileSync(join(PMESH_GOLDEN,
        "scene.pmesh")));
    await scene.load();
    assert.equal(scene.progress.complete, true);
    assert.equal(scene.faceCount, scene.header.faces);
});

test("ranges of all meshes reproduce their buffers", async () => {
    const scene = await openScene(readFileSync(files.find((f) =>
        f.endsWith("scenes.pmesh"))));
    await scene.load();
    const copies = scene.meshes.map(({ indices }) => indices.slice());
    for (let i = 1; i < 60; i++) {
        const { meshes } = scene.refine(
            { faces: 1 + i * 7919 % scene.header.faces });
        for (const { mesh, faces } of meshes) {
            const { indices } = scene.meshes[mesh];
            for (const { first, count } of faces)
                copies[mesh].set(indices.subarray(3 * first,
                    3 * (first + count)), 3 * first);
        }
        scene.meshes.forEach(({ indices, faceCount }, mesh) =>
            assert.deepEqual([...copies[mesh].subarray(0, 3 * faceCount)],
                [...indices.subarray(0, 3 * faceCount)]));
    }
});

test("pieces of any size leave the same state, and a prefix its part",
    async () => {
        const data = readFileSync(files[0]), states = new Set();
        for (const size of [1, 100, data.length]) {
            const decoder = await SceneDecoder.create();
            for (let at = 0; at < data.length; at += size)
                decoder.feed(data.subarray(at, at + size));
            decoder.refine();
            states.add([decoder.faceCount, decoder.progress.complete,
                await decoder.document()].join());
        }
        assert.equal(states.size, 1);
        const scene = new Scene(new Source(data.subarray(0,
            Math.floor(0.7 * data.length))));
        await scene.start();
        await scene.load();
        assert.equal(scene.progress.complete, false);
        assert.ok(scene.faceCount > 0);
    });

test("the document is glTF, and resources come whole", async () => {
    for (const file of files) {
        const scene = await openScene(readFileSync(file));
        await scene.load();
        const json = JSON.parse(await scene.document());
        assert.equal(json.asset.version, "2.0");
        for (let i = 0; i < scene.header.resourceCount; i++)
            assert.ok(scene.resource(i) instanceof Uint8Array);
    }
});

test("a document unpacks to what its size allows", async () => {
    const text = "a few words";
    assert.equal(await unpack(deflateSync(text)), text);
    for (const [word, times] of [[" ", 100 << 20], ["[],", 1 << 20]])
        await assert.rejects(unpack(deflateSync(word.repeat(times))),
            { name: "PmeshError", code: "limit" });
    const quoted = `["${"[],".repeat(1 << 20)}"]`;
    assert.equal(await unpack(deflateSync(quoted)), quoted);
    await assert.rejects(unpack(deflateSync(text).subarray(0, 9)));
});

test("is shown before the file has arrived", async () => {
    const file = files.find((f) => f.endsWith("morphs.pmesh"));
    const server = await serve(readFileSync(file), { rate: 64 });
    try {
        const scene = await openScene(server.url), counts = [scene.faceCount];
        for await (const unused of scene.stream())
            counts.push(scene.faceCount);
        assert.ok(counts.length > 2);
        assert.deepEqual(counts, [...counts].sort((a, b) => a - b));
        assert.equal(scene.progress.complete, true);
        assert.equal(server.log.length, 1);
    } finally {
        await server.close();
    }
});

test("damage, single meshes and too much memory are told", async () => {
    const data = readFileSync(files[0]);
    const broken = data.slice();
    broken[broken.length >> 1] ^= 4;
    const decoder = await SceneDecoder.create();
    assert.throws(() => decoder.feed(broken), (error) =>
        error instanceof PmeshError && error.offset > 0);
    const other = await SceneDecoder.create();
    assert.throws(() => other.feed(readFileSync(process.env.PMESH_SAMPLE)),
        { code: "unsupported" });
    const small = await SceneDecoder.create({ maxMemory: 1000 });
    assert.throws(() => small.feed(data), { code: "limit" });
});
