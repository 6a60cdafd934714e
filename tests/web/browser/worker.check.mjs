// SPDX-License-Identifier: MIT
// The package in a page, without a bundler: a real worker, and HTTP as a
// browser does it. From the environment: PMESH_SAMPLE, CHROMIUM, PACKAGE.
import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { chromium } from "playwright-core";
import { serve } from "./server.mjs";

const { PMESH_SAMPLE, CHROMIUM, PACKAGE } = process.env;
const data = readFileSync(PMESH_SAMPLE);
const files = { "/": "<!doctype html><title>test</title>" };
for (const name of readdirSync(PACKAGE).filter((n) => n.endsWith(".js")))
    files[`/pmesh/${name}`] = readFileSync(join(PACKAGE, name));

let browser, page, server;

before(async () => {
    server = await serve(data, { files, rate: 400 });
    browser = await chromium.launch({
        executablePath: CHROMIUM, args: ["--no-sandbox", "--disable-gpu"],
    });
    page = await browser.newPage();
    await page.goto(new URL("/", server.url).href);
});

after(async () => {
    await browser?.close();
    await server?.close();
});

test("a worker shows what the page itself decodes", async () => {
    const result = await page.evaluate(async () => {
        const { open } = await import("/pmesh/index.js");
        const { openInWorker } = await import("/pmesh/worker.js");
        const remote = await openInWorker("/mesh.pmesh"), steps = [];
        for await (const _ of remote.stream())
            steps.push(remote.faceCount);
        const mesh = await open("/mesh.pmesh");
        await mesh.load();
        const equal = [];
        for (const faces of [0, 900, 20_000, 1]) {
            await remote.refine({ faces });
            mesh.refine({ faces });
            const v = 3 * mesh.vertexCount, f = 3 * mesh.faceCount;
            equal.push(remote.faceCount === mesh.faceCount &&
                mesh.positions.subarray(0, v)
                    .every((x, i) => x === remote.positions[i]) &&
                mesh.indices.subarray(0, f)
                    .every((x, i) => x === remote.indices[i]));
        }
        remote.dispose();
        return { steps, equal };
    });
    assert.ok(new Set(result.steps).size > 4, "sharpens in steps");
    assert.deepEqual(result.equal, [true, true, true, true]);
});

test("stops at a budget and goes on by Range", async () => {
    server.log.length = 0;
    const result = await page.evaluate(async () => {
        const { open } = await import("/pmesh/index.js");
        const mesh = await open("/mesh.pmesh");
        await mesh.load({ faces: 5000 });
        const early = mesh.progress;
        await mesh.load();
        return { early, late: mesh.progress };
    });
    assert.equal(result.early.complete, false);
    assert.equal(result.late.complete, true);
    assert.equal(server.log.length, 2);
    assert.match(server.log[1].range, /^bytes=[1-9]/);
});
