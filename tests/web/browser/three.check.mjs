// SPDX-License-Identifier: MIT
// pmesh/three without a picture: what three.js is told to draw and to send.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { test } from "node:test";
import { MeshBasicMaterial, Raycaster, Vector3 } from "three";
import { open } from "pmesh";
import { dracoBase } from "pmesh/draco";
import { ProgressiveMesh } from "pmesh/three";
import { serve } from "./server.mjs";

const { PMESH_GOLDEN, PMESH_SAMPLE, PMESH_OTHER } = process.env;
const sample = readFileSync(PMESH_SAMPLE);

// What the graphics card would hold.
function card(object) {
    const copies = new Map();
    let sent = 0;
    return {
        get sent() { return sent; },
        render() {
            const g = object.geometry;
            for (const a of [g.index, ...Object.values(g.attributes)]) {
                if (!copies.has(a))
                    copies.set(a, { data: a.array.slice(), version: a.version });
                const copy = copies.get(a);
                if (a.version > copy.version)
                    for (const { start, count } of a.updateRanges) {
                        copy.data.set(a.array.subarray(start, start + count),
                            start);
                        sent += count * a.array.BYTES_PER_ELEMENT;
                    }
                copy.version = a.version;
                a.clearUpdateRanges();
            }
        },
        check() {
            const g = object.geometry;
            const vertices = object.source.vertexCount;
            for (const a of Object.values(g.attributes)) {
                const n = a.itemSize * vertices;
                assert.deepEqual(copies.get(a).data.subarray(0, n),
                    a.array.subarray(0, n));
            }
            assert.deepEqual(
                copies.get(g.index).data.subarray(0, g.drawRange.count),
                g.index.array.subarray(0, g.drawRange.count));
            assert.equal(g.drawRange.count, 3 * object.source.faceCount);
        },
    };
}

test("sends ranges that keep the card's buffers equal", async () => {
    for (const data of [sample, readFileSync(PMESH_OTHER)]) {
        const mesh = await open(data);
        const object = new ProgressiveMesh(mesh, new MeshBasicMaterial());
        const graphics = card(object);
        graphics.render();
        await object.stream({ faces: 9000 }, () => {
            graphics.render();
            graphics.check();
        });
        for (const faces of [300, 8000, 8020, 500]) {
            object.refine({ faces });
            graphics.render();
            graphics.check();
        }
        assert.ok("uv" in object.geometry.attributes === (data === sample));
        const { normal } = object.geometry.attributes;
        const n = new Vector3().fromBufferAttribute(normal, 7);
        assert.ok(n.length() > 0);
    }
});

test("many refines before a frame lose nothing", async () => {
    const mesh = await open(sample);
    await mesh.load();
    const object = new ProgressiveMesh(mesh, new MeshBasicMaterial());
    const graphics = card(object);
    for (let i = 1; i < 40; i++) {
        for (let k = 1; k <= 1 + i % 12; k++)
            object.refine({ faces: 1 + (i * k * 7919) % 60_000 });
        graphics.render();
        graphics.check();
    }
});

test("materials become groups", async () => {
    const mesh = await open(readFileSync(`${PMESH_GOLDEN}materials.pmesh`));
    const materials = Array.from({ length: mesh.header.materialCount },
        () => new MeshBasicMaterial());
    assert.ok(materials.length > 1);
    const object = new ProgressiveMesh(mesh, materials);
    const graphics = card(object);
    await object.stream();
    for (const faces of [1, 1e6]) {
        object.refine({ faces });
        graphics.render();
        graphics.check();
        const { groups } = object.geometry;
        assert.equal(groups.reduce((n, { count }) => n + count, 0),
            3 * mesh.faceCount);
    }
});

test("the sphere holds every level, and rays meet what is visible", async () => {
    const mesh = await open(sample);
    await mesh.load();
    const object = new ProgressiveMesh(mesh, new MeshBasicMaterial());
    const { boundingSphere: sphere } = object.geometry;
    const { position } = object.geometry.attributes;
    const at = new Vector3();
    for (const faces of [1, 5000, 1e6]) {
        object.refine({ faces });
        for (let v = 0; v < mesh.vertexCount; v++)
            assert.ok(sphere.containsPoint(at.fromBufferAttribute(position, v)));
        const [a, b, c] = mesh.indices;
        const middle = [a, b, c].map((v) =>
            new Vector3().fromBufferAttribute(position, v))
            .reduce((sum, p) => sum.add(p)).divideScalar(3);
        const away = middle.clone().sub(sphere.center).normalize();
        const from = middle.clone().addScaledVector(away, 3 * sphere.radius);
        object.updateMatrixWorld();
        const hits = new Raycaster(from, away.negate()).intersectObject(object);
        assert.ok(hits.length > 0);
        assert.ok(hits.every(({ faceIndex }) => faceIndex < mesh.faceCount));
    }
});

test("morphs evenly between levels, both ways", async () => {
    const mesh = await open(sample, { morph: true });
    await mesh.load();
    mesh.refine({ faces: 2000 });
    const object = new ProgressiveMesh(mesh, new MeshBasicMaterial(),
        { morph: true });
    const graphics = card(object);
    const { position } = object.geometry.attributes;
    for (const [faces, up] of [[9000, true], [1000, false]]) {
        object.morphTo({ faces }, 200);
        const from = position.array.slice(0, 3 * mesh.vertexCount);
        const shown = mesh.faceCount;
        assert.equal(object.tick(100), true);
        graphics.render();
        const half = position.array.slice(0, from.length);
        assert.equal(mesh.faceCount, shown, "no faces come or go on the way");
        const to = up ? mesh.positions : mesh.morph({ faces });
        for (let i = 0; i < from.length; i++)
            assert.ok(Math.abs((from[i] + to[i]) / 2 - half[i]) < 1e-5);
        assert.equal(object.tick(150), false);
        assert.ok(Math.abs(mesh.faceCount - faces) < 3);
        graphics.render();
        graphics.check();
        const n = 3 * mesh.vertexCount;
        assert.deepEqual(position.array.subarray(0, n),
            mesh.positions.subarray(0, n));
    }
    assert.equal(object.tick(10), false);
});

test("inflated positions are sent whole", async () => {
    const mesh = await open(readFileSync(`${PMESH_GOLDEN}closed.pmesh`),
        { inflate: true });
    const object = new ProgressiveMesh(mesh, new MeshBasicMaterial(),
        { inflate: true });
    const graphics = card(object);
    graphics.render();
    await object.stream({ faces: 3000 }, () => {
        graphics.render();
        graphics.check();
    });
    const { position } = object.geometry.attributes;
    assert.notDeepEqual(position.array.subarray(0, 3000),
        mesh.positions.subarray(0, 3000));
    assert.deepEqual(position.array.subarray(0, 3000),
        mesh.inflated().subarray(0, 3000));
});

test("a base mesh by Draco, if the page has it", async () => {
    const require = createRequire(import.meta.url);
    const draco = await require("draco3d").createDecoderModule();
    const data = readFileSync(process.env.PMESH_DRACO);
    await assert.rejects(open(data), { code: "unsupported" });
    const mesh = await open(data, { base: dracoBase(draco) });
    assert.equal(mesh.header.baseCoder, "draco");
    await mesh.load();
    const text = execFileSync(process.env.PMESH, ["extract", "-q",
        process.env.PMESH_DRACO, "--format", "obj", "-o", "-"],
    { encoding: "utf8", maxBuffer: 2 ** 26 });
    const native = new Set(text.split("\n").filter((l) => l.startsWith("v "))
        .map((l) => l.split(" ").slice(1, 4).map(Math.fround).join()));
    for (let v = 0; v < mesh.vertexCount; v++)
        assert.ok(native.has(mesh.positions.subarray(3 * v, 3 * v + 3).join()));
    for (const base of [() => null, () => { throw new Error("no"); },
        () => ({ positions: [1], indices: [] })])
        await assert.rejects(open(data, { base }), { code: "corrupt" });
});

test("a file that is replaced gets new buffers", async () => {
    const server = await serve(sample, { rate: 2000 });
    try {
        const object = new ProgressiveMesh(await open(server.url),
            new MeshBasicMaterial());
        await object.stream({ faces: 3000 });
        const old = object.geometry;
        Object.assign(server, { etag: '"2"', body: readFileSync(PMESH_OTHER) });
        const graphics = card(object);
        await object.stream({}, () => {
            graphics.render();
            graphics.check();
        });
        assert.notEqual(object.geometry, old);
        assert.equal(object.source.progress.complete, true);
    } finally {
        await server.close();
    }
});
