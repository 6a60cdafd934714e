// SPDX-License-Identifier: MIT
// Loading over HTTP: stop at a budget, go on with a Range request, and every
// way a server can be awkward about it.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { PmeshError, open } from "pmesh";
import { serve } from "./server.mjs";

const data = readFileSync(process.env.PMESH_SAMPLE);
const other = readFileSync(process.env.PMESH_OTHER);

async function withServer(options, run) {
    const server = await serve(data, options);
    try {
        await run(server);
    } finally {
        await server.close();
    }
}

const whole = await open(data);
await whole.load();
const { header } = whole;

function assertWhole(mesh, like = whole) {
    assert.equal(mesh.progress.complete, true);
    assert.equal(mesh.faceCount, like.header.faces);
    assert.deepEqual(mesh.positions, like.positions);
    assert.deepEqual(mesh.indices, like.indices);
}

test("every kind of input", async () => {
    for (const input of [data, data.buffer.slice(data.byteOffset,
        data.byteOffset + data.length), new Blob([data]),
        new Blob([data]).stream(), new Response(data)]) {
        const mesh = await open(input);
        assert.ok(mesh.faceCount > 0);
        await mesh.load();
        assertWhole(mesh);
    }
});

test("sharpens while it loads, and ends at once at the budget", async () =>
    withServer({ rate: 64 }, async (server) => {
        const mesh = await open(server.url), counts = [];
        for await (const changes of mesh.stream({ faces: 3000 })) {
            assert.equal(changes.restarted, false);
            counts.push(mesh.faceCount);
        }
        assert.ok(counts.length > 3, "shown in steps");
        assert.deepEqual(counts, [...counts].sort((a, b) => a - b));
        assert.ok(mesh.faceCount <= 3000 && mesh.faceCount > 2997);
        await new Promise((done) => setTimeout(done, 50));
        assert.ok(server.sent < data.length / 2, "the rest was not sent");
        assert.equal(server.log.length, 1);
    }));

test("goes on with a Range request", async () =>
    withServer({ rate: 512 }, async (server) => {
        const mesh = await open(server.url);
        await mesh.load({ faces: 3000 });
        const { received } = mesh.progress;
        await mesh.load({ error: header.levels.at(-3).error });
        await mesh.load();
        assertWhole(mesh);
        const [first, second] = server.log;
        assert.equal(first.range, undefined);
        assert.ok(Number(/\d+/.exec(second.range)[0]) >= received);
        assert.equal(second.condition, '"1"');
    }));

test("a date serves as validator, too", async () =>
    withServer({
        rate: 512, etag: null, lastModified: "Mon, 02 Nov 2026 10:00:00 GMT",
    }, async (server) => {
        const mesh = await open(server.url);
        await mesh.load({ faces: 3000 });
        await mesh.load();
        assertWhole(mesh);
        assert.match(server.log[1].range, /^bytes=\d+-$/);
        assert.match(server.log[1].condition, /2026/);
    }));

for (const [name, options] of Object.entries({
    "no ranges": { ranges: false },
    "no ranges, no ETag": { ranges: false, etag: null },
    "no length": { length: false },
    "no length, no ranges": { length: false, ranges: false },
    "compressed": { gzip: true },
    "compressed without length": { gzip: true, length: false },
}))
    test(`${name}: the same mesh in the end`, async () =>
        withServer({ rate: 512, ...options }, async (server) => {
            const mesh = await open(server.url);
            await mesh.load({ faces: 3000 });
            for await (const changes of mesh.stream())
                assert.equal(changes.restarted, false);
            assertWhole(mesh);
            assert.equal(server.log.length, 2);
        }));

for (const [name, options] of Object.entries({
    "another ETag": { etag: '"2"' },
    "no ETag, other bytes": { etag: null },
    "another ETag, no ranges": { etag: '"2"', ranges: false },
}))
    test(`the file changed (${name}): starts over and says so`, async () =>
        withServer({ rate: 512, ...(name.startsWith("no") ?
            { etag: null } : {}) }, async (server) => {
            const mesh = await open(server.url);
            await mesh.load({ faces: 3000 });
            Object.assign(server, options, { body: other });
            const restarts = [];
            for await (const changes of mesh.stream())
                restarts.push(changes.restarted);
            assert.equal(restarts.filter(Boolean).length, 1);
            const like = await open(other);
            await like.load();
            assertWhole(mesh, like);
        }));

test("the file changed under the same ETag: noticed, starts over", async () =>
    withServer({ rate: 512 }, async (server) => {
        const mesh = await open(server.url);
        await mesh.load({ faces: 3000 });
        server.body = other;
        await mesh.load();
        const like = await open(other);
        await like.load();
        assertWhole(mesh, like);
    }));

test("a connection that breaks off is taken up again", async () =>
    withServer({ breakAfter: 30_000 }, async (server) => {
        const mesh = await open(server.url);
        await mesh.load();
        assertWhole(mesh);
        assert.equal(server.log.length, 2);
        assert.match(server.log[1].range, /^bytes=/);
    }));

test("a file that ends early is what it is", async () => {
    const mesh = await open(data.subarray(0, data.length / 2));
    await mesh.load();
    assert.equal(mesh.progress.complete, false);
    assert.ok(mesh.faceCount > header.baseFaces);
    await assert.rejects(open(data.subarray(0, 300)), { code: "cut" });
});

test("a missing file and a signal", async () =>
    withServer({ rate: 1 }, async (server) => {
        const missing = (...all) => fetch(...all).then(() =>
            new Response(null, { status: 404, statusText: "Not Found" }));
        await assert.rejects(open(server.url, { fetch: missing }),
            (error) => error instanceof PmeshError && error.code === "http");
        const control = new AbortController();
        const opened = open(server.url, { signal: control.signal });
        setTimeout(() => control.abort(), 20);
        await assert.rejects(opened, { name: "AbortError" });
    }));

test("leaving the loop ends the request", async () =>
    withServer({ rate: 64 }, async (server) => {
        const mesh = await open(server.url);
        for await (const _ of mesh.stream())
            if (mesh.faceCount > 1000)
                break;
        const { sent } = server;
        await new Promise((done) => setTimeout(done, 50));
        assert.ok(server.sent - sent <= 64 * 1024);
        assert.ok(server.sent < data.length);
        await mesh.load();
        assertWhole(mesh);
    }));
