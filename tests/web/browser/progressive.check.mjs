// SPDX-License-Identifier: MIT
// A GLB by `pmesh bake -o scene.glb` in three.js as it is, without a line of
// ours: its base meshes are drawn, textured and skinned. From the environment:
// PMESH, PMESH_MODELS (where glTF files to bake are; without it all is skipped),
// CHROMIUM, SHOTS (a folder that gets pictures for people to look at).
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { extname, join } from "node:path";
import { after, before, test } from "node:test";
import { chromium } from "playwright-core";

const { PMESH, PMESH_MODELS, CHROMIUM, SHOTS, THREE } = process.env;
const FLAGS = ["--no-sandbox", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update",
    "--disable-sync", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];

// Loads a model, frames it, draws it, and tells what three.js sees.
const PAGE = `<!doctype html><title>base</title>
<style>body { margin: 0 }</style><canvas id="view"></canvas>
<script type="importmap">{ "imports": {
    "three": "/three/build/three.module.js",
    "three/addons/": "/three/examples/jsm/" } }</script>
<script type="module">
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
try {
    const renderer = new THREE.WebGLRenderer({
        canvas: document.getElementById("view"), antialias: true });
    renderer.setSize(800, 600);
    const scene = new THREE.Scene();
    scene.background = new THREE.Color(0xffffff);
    scene.add(new THREE.HemisphereLight(0xffffff, 0x888888, 3));
    const gltf = await new GLTFLoader().loadAsync("/model.glb");
    scene.add(gltf.scene);
    const box = new THREE.Box3().setFromObject(gltf.scene, true);
    const size = box.getSize(new THREE.Vector3()).length();
    const center = box.getCenter(new THREE.Vector3());
    const camera = new THREE.PerspectiveCamera(40, 4 / 3, size / 100, 9 * size);
    camera.position.set(0.7, 0.4, 1).multiplyScalar(0.95 * size).add(center);
    camera.lookAt(center);
    await renderer.compileAsync(scene, camera);
    renderer.render(scene, camera);
    const told = { faces: renderer.info.render.triangles, meshes: 0,
        textures: renderer.info.memory.textures, skinned: 0,
        animations: gltf.animations.length };
    gltf.scene.traverse((o) => {
        told.meshes += !!o.isMesh;
        told.skinned += !!o.isSkinnedMesh;
    });
    const gl = renderer.getContext(), pixels = new Uint8Array(800 * 600 * 4);
    renderer.render(scene, camera);
    gl.readPixels(0, 0, 800, 600, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    let drawn = 0;
    const colors = new Set();
    for (let i = 0; i < pixels.length; i += 4) {
        drawn += pixels[i] < 250 || pixels[i + 1] < 250;
        colors.add(pixels[i] << 16 | pixels[i + 1] << 8 | pixels[i + 2]);
    }
    told.part = drawn / (800 * 600);
    told.colors = colors.size;
    globalThis.told = told;
} catch (error) {
    globalThis.told = { error: String(error) };
}
</script>`;

let browser, server, model;

before(async () => {
    mkdirSync(SHOTS, { recursive: true });
    server = createServer((request, response) => {
        const path = request.url;
        response.setHeader("Content-Type", extname(path) === ".js"
            ? "text/javascript" : path === "/" ? "text/html"
            : "application/octet-stream");
        response.end(path === "/" ? PAGE : path === "/model.glb" ? model
            : path.startsWith("/three/") && existsSync(THREE + path.slice(6))
            ? readFileSync(THREE + path.slice(6)) : "");
    }).listen(0, "127.0.0.1");
    browser = await chromium.launch({ executablePath: CHROMIUM, args: FLAGS });
});

after(async () => {
    await browser?.close();
    server?.close();
});

async function show(name, input) {
    const glb = join(SHOTS, `${name}-progressive.glb`);
    execFileSync(PMESH, ["bake", "-q", input, "-o", glb]);
    model = readFileSync(glb);
    const info = JSON.parse(execFileSync(PMESH, ["info", "--json", glb]));
    const page = await browser.newPage({ viewport: { width: 800, height: 600 } });
    await page.goto(`http://127.0.0.1:${server.address().port}/`);
    await page.waitForFunction(() => globalThis.told, null, { timeout: 90_000 });
    const told = await page.evaluate(() => globalThis.told);
    writeFileSync(join(SHOTS, `${name}-base.png`), await page.screenshot());
    await page.close();
    return { told, info };
}

for (const [name, file] of [["CesiumMan", "CesiumMan.glb"],
    ["FlightHelmet", "FlightHelmet/FlightHelmet.gltf"]])
    test(`three.js draws the base of ${name} without our code`, {
        skip: !existsSync(join(PMESH_MODELS ?? "", file)) && "no models",
    }, async () => {
        const { told, info } = await show(name, join(PMESH_MODELS, file));
        assert.equal(told.error, undefined);
        assert.equal(told.faces, info.base_faces);
        assert.ok(told.faces < info.faces / 10);
        assert.ok(told.textures > 0, "textured");
        assert.ok(told.part > 0.05 && told.part < 0.8, `part ${told.part}`);
        assert.ok(told.colors > 100, `colors ${told.colors}`);
        if (name === "CesiumMan")
            assert.ok(told.skinned === 1 && told.animations === 1);
    });
