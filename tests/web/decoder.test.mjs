// SPDX-License-Identifier: MIT
// The WebAssembly decoder says what the native one says.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, readdirSync } from "node:fs";
import { test } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { Decoder, PmeshError, supported } from "pmesh";

const golden = pathToFileURL(process.env.PMESH_GOLDEN);
const read = (name) => new Uint8Array(readFileSync(new URL(name, golden)));
// But for scenes, which scene.test.mjs is for: the ninth byte tells.
const names = readdirSync(golden).filter((name) =>
    name.endsWith(".pmesh") && read(name)[8] !== 8);

// FNV-1a over 32-bit numbers, as tests/golden/golden_decode.c.
function hash(h, words) {
    for (const word of words)
        for (let shift = 0; shift < 32; shift += 8)
            h = BigInt.asUintN(64,
                (h ^ BigInt(word >>> shift & 255)) * 0x100000001b3n);
    return h;
}

const START = 0xcbf29ce484222325n;
const bits = (floats) => new Uint32Array(floats.slice().buffer);
const hex = (h) => h.toString(16).padStart(16, "0");

function line(decoder, changes) {
    let h = hash(START, bits(Float32Array.of(decoder.error)));
    h = hash(h, bits(decoder.positions.subarray(0, 3 * decoder.vertexCount)));
    for (const { values, components } of decoder.attributes)
        h = hash(h, bits(values.subarray(0, components * decoder.vertexCount)));
    let c = START;
    for (const ranges of [changes.vertices, changes.faces])
        c = hash(c, [ranges.length,
            ...ranges.flatMap(({ first, count }) => [first, count])]);
    return [decoder.faceCount, decoder.vertexCount, hex(h), hex(c)].join(" ");
}

// What golden_decode walked through.
function walk(decoder, data) {
    let at = 0;
    while (at < data.length / 2 - 1 || !decoder.header)
        decoder.feed(data.subarray(at, ++at));
    if (at < Math.floor(data.length / 2))
        decoder.feed(data.subarray(at, ++at));
    const lines = [], h = decoder.header;
    const move = (target) => {
        const changes = decoder.refine(target);
        lines.push(changes ? line(decoder, changes) : "nothing yet");
    };
    move();
    assert.equal(decoder.feed(data.subarray(at)), true);
    const all = h.faces, tenth = Math.floor(all / 10);
    move({ faces: all });
    move({ faces: Math.floor(all / 2) });
    move({ faces: tenth * 9 });
    move({ faces: 1 });
    move({ faces: Math.floor(all / 5) });
    move({ error: h.levels[h.levels.length >> 1].error });
    move({ bytes: Math.floor(h.bytes / 2) });
    move();
    return lines;
}

function expected() {
    const files = {};
    let name;
    for (const text of readFileSync(new URL("hashes.txt", golden), "utf8")
        .split("\n")) {
        const words = text.trim().split(/\s+/);
        if (text.startsWith("#") || words[0] === "file")
            continue;
        if (!text.startsWith(" "))
            files[name = text] = [];
        else
            files[name].push(words.slice(1).join(" ") === "nothing yet" ?
                "nothing yet" :
                [words[1], words[2], words[7], words[8]].join(" "));
    }
    return files;
}

test("is supported here", () => assert.equal(supported, true));

test("golden files decode to the same bits", async () => {
    const wanted = expected();
    assert.ok(names.length > 10);
    for (const name of names) {
        const lines = walk(await Decoder.create(), read(name));
        assert.deepEqual(lines, wanted[name], name);
    }
});

test("pieces of any size leave the same state", async () => {
    const data = read("seam.pmesh");
    const states = [];
    for (const size of [1, 7, 1000, data.length]) {
        const decoder = await Decoder.create();
        for (let at = 0; at < data.length; at += size)
            decoder.feed(data.subarray(at, at + size));
        states.push(line(decoder, decoder.refine()));
    }
    assert.equal(new Set(states).size, 1);
});

test("ranges reproduce the buffers", async () => {
    const decoder = await Decoder.create();
    const data = read("blocks.pmesh");
    let positions, indices;
    for (let at = 0, i = 1; i < 400; i++) {
        decoder.feed(data.subarray(at, at += 100));
        const changes = decoder.refine({
            faces: 1 + (i * 7919) % 2592, maxOps: i % 3 ? i % 50 : 0,
        });
        if (!changes)
            continue;
        positions ??= new Float32Array(decoder.positions.length);
        indices ??= new Uint32Array(decoder.indices.length);
        for (const { first, count } of changes.vertices)
            positions.set(decoder.positions.subarray(3 * first,
                3 * (first + count)), 3 * first);
        for (const { first, count } of changes.faces)
            indices.set(decoder.indices.subarray(3 * first,
                3 * (first + count)), 3 * first);
        const v = 3 * decoder.vertexCount, f = 3 * decoder.faceCount;
        assert.deepEqual(positions.subarray(0, v),
            decoder.positions.subarray(0, v));
        assert.deepEqual(Array.from(indices.subarray(0, f)),
            Array.from(decoder.indices.subarray(0, f)));
    }
});

test("damage is told, and what came before stays", async () => {
    const decoder = await Decoder.create();
    const data = read("closed.pmesh");
    data[data.length - 20] ^= 1;
    assert.throws(() => decoder.feed(data), (error) =>
        error instanceof PmeshError && error.offset > 0 &&
        ["checksum", "corrupt"].includes(error.code));
    decoder.refine();
    assert.ok(decoder.faceCount > 0);
    const other = await Decoder.create();
    assert.throws(() => other.feed(new TextEncoder().encode("solid mesh")),
        { code: "magic" });
});

test("a file that needs more than maxMemory is refused", async () => {
    const decoder = await Decoder.create({ maxMemory: 100_000 });
    assert.throws(() => decoder.feed(read("blocks.pmesh")), { code: "limit" });
});

test("memory does not grow behind the header, nor over walks", async () => {
    const decoder = await Decoder.create({ morph: true });
    const data = read("blocks.pmesh");
    let at = 0;
    while (!decoder.header)
        decoder.feed(data.subarray(at, ++at));
    const before = decoder.memory, { positions } = decoder;
    decoder.feed(data.subarray(at));
    for (let i = 0; i < 200; i++) {
        decoder.refine({ faces: 1 });
        decoder.refine();
        decoder.morph({ faces: 300 });
    }
    assert.equal(decoder.memory, before);
    assert.ok(positions.length > 0, "views are not detached");
});

test("swells coarse levels and leaves the full mesh", async () => {
    const decoder = await Decoder.create({ inflate: true });
    decoder.feed(read("closed.pmesh"));
    const { memory } = decoder;
    for (const faces of [100, 1000, 0]) {
        decoder.refine({ faces });
        const n = 3 * decoder.vertexCount, swollen = decoder.inflated();
        const moved = decoder.positions.subarray(0, n)
            .filter((x, i) => x !== swollen[i]).length;
        assert.ok(faces > 0 ? moved > n / 10 : moved === 0);
    }
    assert.equal(decoder.memory, memory);
    const other = await Decoder.create();
    other.feed(read("closed.pmesh"));
    assert.throws(() => other.inflated(), { code: "argument" });
});

test("inflates to the bits of pmesh extract --inflate", async () => {
    const decoder = await Decoder.create({ inflate: true });
    decoder.feed(read("closed.pmesh"));
    decoder.refine({ faces: 3000 });
    const swollen = decoder.inflated();
    const text = execFileSync(process.env.PMESH, ["extract", "-q", "--inflate",
        fileURLToPath(new URL("closed.pmesh", golden)), "--faces", "3000", "--format", "obj", "-o",
        "-"], { encoding: "utf8", maxBuffer: 2 ** 26 });
    const native = text.split("\n").filter((line) => line.startsWith("v "))
        .flatMap((line) => line.split(" ").slice(1, 4).map(Math.fround));
    const key = (at, from) => from.slice(3 * at, 3 * at + 3).join();
    const all = new Set();
    for (let v = 0; 3 * v < native.length; v++)
        all.add(key(v, native));
    for (let v = 0; v < decoder.vertexCount; v++)
        assert.ok(all.has(key(v, swollen)), `vertex ${v}`);
});

test("materials, morph, bounds and rays", async () => {
    const decoder = await Decoder.create({ morph: true });
    decoder.feed(read("materials.pmesh"));
    decoder.refine();
    const { indices, groups } = decoder.sorted();
    assert.ok(groups.length > 1);
    assert.equal(groups.reduce((n, g) => n + g.count, 0), decoder.faceCount);
    assert.equal(indices.length, decoder.indices.length);
    const { minimum, maximum } = decoder.bounds();
    const middle = minimum.map((low, k) => (low + maximum[k]) / 2);
    const hit = decoder.raycast(
        middle.map((x, k) => x + (k === 2 ? 100 : 0.01)), [0, 0, -1]);
    assert.ok(hit === null || hit.distance > 0);
    const from = decoder.morph({ faces: 1 });
    assert.equal(from.length, 3 * decoder.vertexCount);
});

test("a measured file tells how far its levels are", async () => {
    for (const name of names) {
        const decoder = await Decoder.create();
        decoder.feed(read(name));
        const { measured, levels } = decoder.header;
        assert.equal(measured, name === "measured.pmesh");
        for (const { error, rms, furthest } of levels.slice(0, -1))
            assert.ok(measured ? error > 0 && rms > 0 && rms <= furthest
                : rms === 0 && furthest === 0);
    }
});
