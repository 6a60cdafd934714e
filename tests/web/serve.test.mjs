// SPDX-License-Identifier: MIT
// pmesh view --serve: page and mesh on loopback, ranges, refusals, rate.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { request } from "node:http";
import { connect } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { open } from "pmesh";

const { PMESH, PMESH_SAMPLE } = process.env;
const data = readFileSync(PMESH_SAMPLE);
const folder = mkdtempSync(join(tmpdir(), "pmesh-"));
const page = join(folder, "page.html");
writeFileSync(page, "<title><!--pmesh:title--></title><!--pmesh:data-->");

async function start(...options) {
    const server = spawn(PMESH, ["view", PMESH_SAMPLE, "--serve", "--page",
        page, ...options], { stdio: ["ignore", "pipe", "inherit"] });
    const text = await new Promise((done) => server.stdout.once("data", done));
    return { url: String(text).trim(), kill: () => server.kill() };
}

let server;
before(async () => { server = await start(); });
after(() => {
    server.kill();
    rmSync(folder, { recursive: true });
});

const mesh = (headers = {}, method = "GET") =>
    fetch(`${server.url}mesh.pmesh`, { headers, method });

async function bodyOf(response) {
    return Buffer.from(await response.arrayBuffer());
}

test("page and mesh", async () => {
    const response = await fetch(server.url);
    assert.match(response.headers.get("Content-Type"), /^text\/html/);
    assert.match(await response.text(), /data-url="\/mesh.pmesh"/);
    assert.deepEqual(await bodyOf(await mesh()), data);
    const head = await mesh({}, "HEAD");
    assert.equal(Number(head.headers.get("Content-Length")), data.length);
    assert.equal((await bodyOf(head)).length, 0);
});

test("ranges", async () => {
    const etag = (await mesh({}, "HEAD")).headers.get("ETag");
    assert.match(etag, /^"[^"]+"$/);
    for (const [range, first, end] of [["bytes=1000-", 1000, data.length],
        ["bytes=5-9", 5, 10], ["bytes=7-999999999", 7, data.length]]) {
        const part = await mesh({ Range: range, "If-Range": etag });
        assert.equal(part.status, 206);
        assert.equal(part.headers.get("Content-Range"),
            `bytes ${first}-${end - 1}/${data.length}`);
        assert.deepEqual(await bodyOf(part), data.subarray(first, end));
    }
    for (const headers of [{ Range: "bytes=5-", "If-Range": '"x"' },
        { Range: "bytes=-5" }, { Range: "lines=1-2" }, { Range: "bytes=9-5" }])
        assert.equal((await mesh(headers)).status, 200);
    assert.equal((await mesh({ Range: `bytes=${data.length}-` })).status, 416);
});

function raw(text) {
    return new Promise((done) => {
        let all = "";
        const socket = connect(Number(new URL(server.url).port), "127.0.0.1");
        socket.on("data", (part) => { all += part; });
        socket.on("error", () => done(all));
        socket.on("close", () => done(all));
        socket.end(text);
    });
}

test("what is refused", async () => {
    const status = (options) => new Promise((done) => request(server.url,
        options, (response) => done(response.statusCode)).end());
    assert.equal(await status({ path: "/other" }), 404);
    assert.equal(await status({ path: "/../etc/passwd" }), 404);
    assert.equal(await status({ method: "POST" }), 405);
    assert.equal(await status({ headers: { Host: "example.org" } }), 403);
    assert.equal(await raw("nonsense\r\n\r\n").then((t) => t.slice(0, 12)),
        "HTTP/1.1 405");
    assert.equal(await raw("GET"), "");
    assert.equal(await raw(`GET /${"x".repeat(9000)} HTTP/1.1\r\n\r\n`), "");
    assert.equal(await raw("GET / HTTP/1.1\0\r\n\r\n"), "");
    assert.deepEqual(await bodyOf(await mesh()), data, "still there");
});

test("a rate is kept, and a stop and a resume work", async () => {
    const slow = await start("--rate", "4M");
    try {
        const began = performance.now();
        const stream = await open(`${slow.url}mesh.pmesh`);
        await stream.load({ faces: 5000 });
        assert.ok(stream.source.at < data.length);
        await stream.load();
        assert.equal(stream.faceCount, stream.header.faces);
        assert.equal(stream.source.requests, 2);
        const least = 1000 * 8 * data.length / 4e6;
        assert.ok(performance.now() - began > 0.8 * least);
    } finally {
        slow.kill();
    }
});
