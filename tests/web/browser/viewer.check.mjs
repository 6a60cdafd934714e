// SPDX-License-Identifier: MIT
// The page of `pmesh view` in headless Chromium. From the environment: PMESH,
// PMESH_SAMPLE (a .pmesh of some 70,000 faces), CHROMIUM, SHOTS (a folder that
// gets pictures for people to look at).
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const { PMESH, PMESH_GOLDEN, PMESH_SAMPLE, PMESH_ZOO, CHROMIUM, SHOTS } =
    process.env;
const FLAGS = ["--no-sandbox", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update",
    "--disable-sync", "--enable-precise-memory-info", "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader"];

let browser, page;

mkdirSync(SHOTS, { recursive: true });
const file = join(SHOTS, "page.html");
execFileSync(PMESH, ["view", PMESH_SAMPLE, "-o", file, "-q"]);

before(async () => {
    browser = await chromium.launch({ executablePath: CHROMIUM, args: FLAGS });
    page = await openPage(pathToFileURL(file).href);
    await page.waitForFunction(() => globalThis.viewer?.finished, null,
        { timeout: 60_000 });
});

after(() => browser?.close());

// Counts what goes to the graphics card; errors of the page fail the test.
async function openPage(address, options = {}) {
    const made = await browser.newPage({
        viewport: { width: 1200, height: 760 }, ...options,
    });
    made.on("pageerror", (error) => { throw error; });
    await made.addInitScript(() => {
        globalThis.sent = 0;
        const gl = WebGL2RenderingContext.prototype;
        const { bufferSubData, bufferData } = gl;
        gl.bufferSubData = function (target, at, array, first, count) {
            globalThis.sent += (count ?? array.length) *
                array.BYTES_PER_ELEMENT;
            return bufferSubData.apply(this, arguments);
        };
        gl.bufferData = function (target, data) {
            globalThis.sent += data.byteLength ?? data;
            return bufferData.apply(this, arguments);
        };
    });
    await made.goto(address);
    return made;
}

const settle = (on = page) => on.evaluate(async () => {
    for (let i = 0; i < 3; i++)
        await new Promise(requestAnimationFrame);
});

// Part of the canvas, from `left` to `right`, that is not the background.
async function drawn(name, left = 0, right = 1) {
    await settle();
    const shot = await page.locator("#view").screenshot();
    writeFileSync(join(SHOTS, `${name}.png`), await page.screenshot());
    return page.evaluate(async ([text, from, to]) => {
        const image = new Image();
        image.src = `data:image/png;base64,${text}`;
        await image.decode();
        const canvas = document.createElement("canvas");
        canvas.width = image.width;
        canvas.height = image.height;
        const context = canvas.getContext("2d");
        context.drawImage(image, 0, 0);
        const x = Math.floor(from * image.width);
        const w = Math.floor(to * image.width) - x;
        const { data } = context.getImageData(x, 0, w, image.height);
        const colors = new Set();
        let other = 0;
        for (let i = 0; i < data.length; i += 4) {
            other += Math.abs(data[i] - 246) > 12;
            colors.add(data[i] << 16 | data[i + 1] << 8 | data[i + 2]);
        }
        return { part: 4 * other / data.length, colors: colors.size };
    }, [shot.toString("base64"), left, right]);
}

const faceCount = () => page.evaluate(() => viewer.mesh.faceCount);

async function setFaces(faces) {
    await page.fill("#face-count", String(faces));
    return faceCount();
}

const native = (faces) => Number(/(\d+) of \d+ faces/.exec(execFileSync(PMESH,
    ["extract", PMESH_SAMPLE, "--faces", String(faces), "-o",
        join(SHOTS, "x.stl")], { encoding: "utf8" }))[1]);

test("a page from a file shows the whole mesh", async () => {
    const all = await page.evaluate(() => viewer.mesh.header.faces);
    assert.equal(await faceCount(), all);
    const { part, colors } = await drawn("full");
    assert.ok(part > 0.1 && part < 0.9, `${part} of the picture`);
    assert.ok(colors > 100, `${colors} colours`);
    assert.match(await page.textContent("#error"), /none/);
});

test("faces are those of the native program, and are drawn", async () => {
    for (const faces of [1, 500, 1234, 5000, 31_415, 1e6]) {
        assert.equal(await setFaces(faces), native(faces), `${faces} asked`);
        await settle();
        assert.equal(await page.evaluate(() =>
            viewer.stage.info.render.triangles), await faceCount());
    }
});

test("sliders move faces and bytes", async () => {
    const counts = [];
    for (const part of ["0", "0.25", "0.5", "0.75", "1"]) {
        await page.fill("#faces", part);
        counts.push(await faceCount());
    }
    assert.deepEqual(counts, [...counts].sort((a, b) => a - b));
    const { baseFaces, faces } = await page.evaluate(() => viewer.mesh.header);
    assert.ok(counts[0] <= baseFaces && counts.at(-1) === faces);
    await page.fill("#bytes", "0");
    assert.equal(await faceCount(), baseFaces);
    await page.fill("#bytes", "0.5");
    const level = await page.evaluate(() => viewer.mesh.error);
    assert.ok(level > 0);
});

test("levels morph, and the last frame is the level itself", async () => {
    await setFaces(2000);
    await page.check("#morph");
    const seen = await page.evaluate(async () => {
        const { mesh, stage } = viewer, list = [];
        const { position } = stage.object.geometry.attributes;
        viewer.choose({ faces: 20_000 });
        for (let i = 0; i < 200 && list.at(-1) !== 0; i++) {
            list.push(position.array.subarray(0, 3 * mesh.vertexCount)
                .reduce((n, x, k) => n + (x !== mesh.positions[k]), 0));
            await new Promise(requestAnimationFrame);
        }
        return list;
    });
    assert.ok(seen[0] > 1000 && seen.at(-1) === 0, `${seen}`);
    assert.equal(await faceCount(), native(20_000));
    await page.evaluate(() => viewer.choose({ faces: 500 }));
    await page.waitForFunction((n) => viewer.mesh.faceCount === n, native(500));
    assert.equal(await page.inputValue("#face-count"), String(native(500)));
    await page.uncheck("#morph");
});

test("coarse levels swell", async () => {
    const round = join(SHOTS, "round.html");
    execFileSync(PMESH, ["view", `${PMESH_GOLDEN}closed.pmesh`, "-o", round,
        "-q"]);
    const other = await openPage(pathToFileURL(round).href);
    await other.waitForFunction(() => globalThis.viewer?.finished);
    await other.fill("#face-count", "200");
    await settle(other);
    const size = () => other.evaluate(() => {
        const { array } = viewer.stage.object.geometry.attributes.position;
        return array.subarray(0, 3 * viewer.mesh.vertexCount)
            .reduce((sum, x) => sum + x * x, 0);
    });
    const before = await size();
    writeFileSync(join(SHOTS, "plain.png"), await other.screenshot());
    await other.check("#swell");
    await settle(other);
    writeFileSync(join(SHOTS, "swollen.png"), await other.screenshot());
    assert.ok(await size() > before);
    assert.equal(await other.evaluate(() => viewer.mesh.faceCount), 200);
    await other.check("#morph");
    assert.equal(await other.isChecked("#swell"), false);
    await other.close();
});

test("a scene is shown with its materials", async () => {
    const html = join(SHOTS, "scene.html");
    execFileSync(PMESH, ["view", join(PMESH_ZOO, "textures.pmesh"), "-o", html,
        "-q"]);
    const other = await openPage(pathToFileURL(html).href);
    await other.waitForFunction(() => globalThis.viewer?.finished, null,
        { timeout: 30_000 });
    await settle(other);
    writeFileSync(join(SHOTS, "scene.png"), await other.screenshot());
    const state = () => other.evaluate(() => ({
        faces: viewer.mesh.faceCount, all: viewer.mesh.header.faces,
        base: viewer.mesh.header.baseFaces,
        drawn: viewer.stage.info.render.triangles,
    }));
    const full = await state();
    assert.equal(full.faces, full.all);
    assert.equal(full.drawn, full.all);
    await other.fill("#faces", "0");
    await settle(other);
    const least = await state();
    assert.equal(least.faces, least.base);
    assert.ok(least.drawn < full.drawn);
    assert.equal(await other.isVisible("#tint"), false);
    await other.check("#wire");
    await settle(other);
    assert.ok(await other.evaluate(() => viewer.stage.info.render.lines) > 0);
    await other.close();
});

test("keys: sliders, toggles, turning", async () => {
    await setFaces(2000);
    await page.focus("#faces");
    await page.keyboard.press("ArrowRight");
    assert.ok(await faceCount() > 2000);
    for (const [key, id] of [["w", "wire"], ["l", "tint"], ["f", "flat"]]) {
        const before = await page.isChecked(`#${id}`);
        await page.keyboard.press(key);
        assert.equal(await page.isChecked(`#${id}`), !before);
        await drawn(id);
        await page.keyboard.press(key);
    }
    await page.focus("#view");
    const frames = await page.evaluate(() => viewer.stage.frames);
    await page.keyboard.press("ArrowLeft");
    await page.keyboard.press("+");
    await settle();
    assert.ok(await page.evaluate(() => viewer.stage.frames) > frames);
    const order = [];
    for (let i = 0; i < 12; i++) {
        order.push(await page.evaluate(() => document.activeElement.id));
        await page.keyboard.press("Tab");
    }
    for (const id of ["view", "face-count", "faces", "bytes", "wire", "speed",
        "replay"])
        assert.ok(order.includes(id), `${id} is reached by Tab`);
});

test("split view draws both sides", async () => {
    await setFaces(300);
    await page.check("#compare");
    await page.waitForTimeout(1500);
    const left = await drawn("split", 0, 0.5);
    const right = await drawn("split", 0.5, 1);
    assert.ok(left.part > 0.02 && right.part > 0.02);
    await page.uncheck("#compare");
});

test("a step sends what changed", async () => {
    await setFaces(20_000);
    await settle();
    const sent = await page.evaluate(async () => {
        globalThis.sent = 0;
        viewer.choose({ faces: 20_040 });
        await new Promise(requestAnimationFrame);
        await new Promise(requestAnimationFrame);
        return globalThis.sent;
    });
    const all = await page.evaluate(() =>
        viewer.mesh.positions.byteLength + viewer.mesh.indices.byteLength);
    assert.ok(sent > 0 && sent < all / 2, `${sent} of ${all} bytes`);
});

test("memory does not grow over 200 walks", async () => {
    const session = await page.context().newCDPSession(page);
    const measure = async () => {
        await session.send("HeapProfiler.collectGarbage");
        return page.evaluate(() => ({
            heap: performance.memory.usedJSHeapSize,
            wasm: viewer.mesh.decoder.memory,
            geometries: viewer.stage.info.memory.geometries,
        }));
    };
    const walks = (count) => page.evaluate(async (n) => {
        for (let i = 0; i < n; i++) {
            viewer.choose({ faces: 1 });
            viewer.choose({ faces: 20_000 });
            await new Promise(requestAnimationFrame);
            viewer.choose({});
        }
    }, count);
    await page.setViewportSize({ width: 480, height: 240 }); // no GPU here
    await walks(10);
    const early = await measure();
    await walks(200);
    const late = await measure();
    assert.equal(late.wasm, early.wasm);
    assert.equal(late.geometries, early.geometries);
    assert.ok(late.heap < early.heap + 1e6,
        `${early.heap} -> ${late.heap} bytes of heap`);
});

test("loading again starts over", async () => {
    await page.click("#replay");
    await page.waitForFunction(() => viewer.finished);
    assert.equal(await faceCount(), native(1e6));
});

test("a served mesh sharpens while it arrives", async () => {
    const server = spawn(PMESH, ["view", PMESH_SAMPLE, "--serve", "--rate",
        "500k"], { stdio: ["ignore", "pipe", "inherit"] });
    try {
        const address = await new Promise((done) =>
            server.stdout.once("data", (text) => done(String(text).trim())));
        const other = await openPage(address,
            { viewport: { width: 640, height: 400 } });
        const states = [];
        await other.waitForFunction(() => globalThis.viewer?.mesh, null,
            { timeout: 30_000 });
        const first = await other.evaluate(() => ({
            ...viewer.first, all: viewer.mesh.header.bytes,
        }));
        while (!await other.evaluate(() => viewer.finished)) {
            states.push(await other.evaluate(() => viewer.mesh.faceCount));
            await other.waitForTimeout(50);
        }
        writeFileSync(join(SHOTS, "served.png"), await other.screenshot());
        assert.deepEqual(states, [...states].sort((a, b) => a - b));
        assert.ok(new Set(states).size > 4, `steps: ${[...new Set(states)]}`);
        const part = first.bytes / first.all;
        console.log(`# first picture: ${first.bytes} of ${first.all} bytes, ` +
            `${(100 * part).toFixed(1)} %`);
        assert.ok(first.levels >= 1 && part <= 0.02);
        await other.close();
    } finally {
        server.kill();
    }
});

test("dark and narrow", async () => {
    const small = await openPage(pathToFileURL(file).href, {
        viewport: { width: 400, height: 800 }, colorScheme: "dark",
    });
    await small.waitForFunction(() => globalThis.viewer?.finished, null,
        { timeout: 60_000 });
    await settle(small);
    writeFileSync(join(SHOTS, "dark.png"), await small.screenshot());
    assert.equal(await small.evaluate(() =>
        document.documentElement.scrollWidth <= innerWidth), true);
    await small.close();
});
