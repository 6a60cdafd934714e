// SPDX-License-Identifier: MIT
// Scenes through three's GLTFLoader: .pmesh, .glb with the stream behind the
// coarse meshes, and .glb beside which it lies; in node, and with textures in
// headless Chromium. From the environment: PMESH_ZOO, PACKAGE, CHROMIUM, SHOTS.
import assert from "node:assert/strict";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { ProgressivePlugin, load } from "pmesh/three";
import { openScene } from "pmesh/scene";
import { wrap } from "./glb.mjs";
import { serve } from "./server.mjs";

globalThis.self ??= globalThis;
const { PACKAGE, PMESH_ZOO, CHROMIUM, SHOTS } = process.env;
const { dress } = await import(pathToFileURL(join(PACKAGE, "dress.js")));
const read = (name) => readFileSync(join(PMESH_ZOO, `${name}.pmesh`));
const PLAIN = ["skinned", "scenes", "shared", "morphs", "attributes", "decals",
    "quantised", "sparse", "interleaved"];

// The scene as a .glb: coarse meshes, then the stream, in it or at `uri`.
async function packed(name, uri) {
    const data = read(name), scene = await openScene(data);
    await scene.load();
    const { json, coarse } = dress(JSON.parse(await scene.document()), scene,
        "PMESH_progressive");
    const buffers = json.buffers.map((unused, i) => i === coarse.number ?
        new Uint8Array(coarse.data) : scene.resource(i));
    return wrap(json, buffers, data, uri);
}

function meshesOf(gltf) {
    const found = [];
    for (const scene of gltf.scenes)
        scene.traverse((object) => object.isMesh && found.push(object));
    return found;
}

// Every object draws faces of the stream's mesh, at the level it stands at.
async function check(gltf, name) {
    await gltf.progressive.ready;
    await new Promise((done) => setTimeout(done)); // as a frame would
    const { scene } = gltf.progressive;
    let faces = 0;
    const geometries = new Set(meshesOf(gltf).map((m) => m.geometry));
    for (const { index, attributes, drawRange } of geometries) {
        if (drawRange.count === Infinity)
            continue; // kept as it was
        faces += drawRange.count / 3;
        assert.ok(drawRange.start + drawRange.count <= index.count);
        const source = scene.meshes.find((mesh) =>
            mesh.positions.byteOffset === attributes.position.array.byteOffset);
        assert.ok(source, `${name}: positions are those of a mesh`);
        for (const { array, itemSize } of Object.values(attributes))
            assert.equal(array.length, itemSize * source.header.vertices);
        for (let i = 0; i < drawRange.count; i++)
            assert.ok(index.array[drawRange.start + i] < source.vertexCount);
    }
    assert.equal(faces, scene.faceCount, name);
}

test("a .pmesh scene becomes objects, skins, animations", async () => {
    for (const name of PLAIN) {
        const gltf = await load(read(name), new GLTFLoader());
        await check(gltf, name);
        await gltf.progressive.done;
        const { scene } = gltf.progressive;
        assert.equal(scene.faceCount, scene.header.faces);
        await check(gltf, name);
        for (const faces of [1, 300, 1e6]) {
            gltf.progressive.refine({ faces });
            await check(gltf, name);
        }
        const json = JSON.parse(await scene.document());
        assert.equal(gltf.animations.length, json.animations?.length ?? 0);
        for (const mesh of meshesOf(gltf).filter((m) => m.isSkinnedMesh)) {
            const { skinWeight } = mesh.geometry.attributes;
            for (let v = 0; v < 5; v++)
                assert.ok(Math.abs(skinWeight.getX(v) + skinWeight.getY(v) +
                    skinWeight.getZ(v) + skinWeight.getW(v) - 1) < 1e-6);
        }
    }
});

test("morph targets follow", async () => {
    const gltf = await load(read("morphs"), new GLTFLoader());
    await gltf.progressive.done;
    const mesh = meshesOf(gltf).find((m) =>
        m.geometry.morphAttributes.position && m.geometry.drawRange.count !==
            Infinity);
    const [target] = mesh.geometry.morphAttributes.position;
    assert.equal(target.count, mesh.geometry.attributes.position.count);
    assert.ok(target.array.some((x) => x !== 0));
    assert.equal(mesh.morphTargetInfluences.length,
        mesh.geometry.morphAttributes.position.length);
});

test("a .glb sharpens while its tail loads, in one request", async () => {
    const body = await packed("skinned");
    const server = await serve(body, { rate: 32 });
    try {
        const counts = [];
        const gltf = await load(server.url, new GLTFLoader(), {
            changed: ({ scene }) => counts.push(scene.faceCount),
        });
        const { sent } = server;
        await check(gltf, "skinned");
        await gltf.progressive.done;
        await check(gltf, "skinned");
        assert.ok(sent < body.length, "shown before all was sent");
        assert.equal(gltf.progressive.scene.progress.complete, true);
        assert.ok(new Set(counts).size > 1);
        assert.equal(server.log.length, 1);
    } finally {
        await server.close();
    }
});

test("the plugin alone takes both packings, and any loader the coarse one",
    async () => {
        const glb = await packed("shared");
        const beside = await packed("shared", "shared.pmesh");
        const server = await serve(read("shared"));
        const base = new URL(".", server.url).href;
        try {
            for (const data of [glb, beside]) {
                const loader = new GLTFLoader();
                loader.register((parser) => new ProgressivePlugin(parser));
                const gltf = await loader.parseAsync(data.buffer, base);
                const coarse = meshesOf(gltf).map((m) => m.geometry.index.count);
                await gltf.progressive.done;
                await check(gltf, "shared");
                const fine = gltf.progressive.scene.faceCount;
                assert.equal(fine, gltf.progressive.scene.header.faces);
                assert.ok(coarse.length > 0);
                const plain = await new GLTFLoader().parseAsync(data.buffer,
                    base);
                const faces = meshesOf(plain).reduce((n, m) =>
                    n + m.geometry.index.count / 3, 0);
                assert.ok(faces > 0 && faces < fine);
                assert.equal(plain.progressive, undefined);
            }
        } finally {
            await server.close();
        }
    });

test("a .glb of pmesh bake sharpens in one request, and by the plugin alone",
    async () => {
        for (const name of PLAIN) {
            const body = readFileSync(join(PMESH_ZOO, "tail", `${name}.glb`));
            const server = await serve(body, { rate: 128 });
            const loader = new GLTFLoader();
            loader.register((parser) => new ProgressivePlugin(parser));
            try {
                for (const gltf of [await load(server.url, new GLTFLoader()),
                    await loader.parseAsync(new Uint8Array(body).buffer, "")]) {
                    await gltf.progressive.done;
                    await check(gltf, name);
                    const { scene } = gltf.progressive;
                    assert.equal(scene.progress.complete, true);
                    assert.equal(scene.faceCount, scene.header.faces);
                    const json = JSON.parse(await scene.document());
                    assert.equal(gltf.animations.length,
                        json.animations?.length ?? 0);
                }
                assert.equal(server.log.length, 1);
            } finally {
                await server.close();
            }
        }
    });

test("ends at a target, and goes on by Range", async () => {
    const packings = [await packed("morphs"), read("morphs")];
    for (const body of packings) {
        const server = await serve(body, { rate: 32 });
        try {
            const gltf = await load(server.url, new GLTFLoader(),
                { target: { faces: 200 } });
            await gltf.progressive.done;
            const { scene } = gltf.progressive;
            assert.ok(scene.faceCount <= 200);
            assert.equal(scene.progress.complete, false);
            await check(gltf, "morphs");
            await gltf.progressive.stream();
            assert.equal(scene.faceCount, scene.header.faces);
            await check(gltf, "morphs");
            assert.equal(server.log.length, 2);
            assert.match(server.log[1].range, /^bytes=\d+-$/);
        } finally {
            await server.close();
        }
    }
});

test("ranges keep the card's buffers equal", async () => {
    const gltf = await load(read("attributes"), new GLTFLoader());
    await gltf.progressive.done;
    const card = new Map();
    const render = () => {
        for (const { geometry: g } of meshesOf(gltf))
            for (const a of [g.index, ...Object.values(g.attributes)]) {
                const copy = card.get(a) ?? a.array.slice();
                for (const { start, count } of a.updateRanges)
                    copy.set(a.array.subarray(start, start + count), start);
                a.clearUpdateRanges();
                card.set(a, copy);
            }
    };
    render();
    for (let i = 1; i < 50; i++) {
        const faces = 1 + i * 7919 % gltf.progressive.scene.header.faces;
        const { meshes } = gltf.progressive.refine({ faces });
        render();
        for (const { geometry: g } of meshesOf(gltf)) {
            const end = g.drawRange.start + g.drawRange.count;
            assert.deepEqual(card.get(g.index).subarray(0, end),
                g.index.array.subarray(0, end));
            const source = gltf.progressive.scene.meshes[0];
            for (const a of Object.values(g.attributes))
                assert.deepEqual(
                    card.get(a).subarray(0, a.itemSize * source.vertexCount),
                    a.array.subarray(0, a.itemSize * source.vertexCount));
        }
        assert.ok(meshes.length <= 1);
    }
});

test("a tail that breaks off leaves what came", async () => {
    const body = await packed("scenes");
    const gltf = await load(body.subarray(0, body.length - 300),
        new GLTFLoader());
    await gltf.progressive.done.catch(() => {});
    await check(gltf, "scenes");
    assert.equal(gltf.progressive.scene.progress.complete, false);
});

// ---- with textures, in a page -----------------------------------------------

const PAGE = `<!doctype html><body style="margin:0"><script type="module">
import { AmbientLight, Box3, Color, DirectionalLight, PerspectiveCamera, Scene,
    Sphere, WebGLRenderer } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { load } from "pmesh/three";
const renderer = new WebGLRenderer({ preserveDrawingBuffer: true });
renderer.setSize(640, 480);
document.body.append(renderer.domElement);
const scene = new Scene(), camera = new PerspectiveCamera(35, 4 / 3, 0.01, 1e4);
scene.background = new Color(0xf6f4f0);
const key = new DirectionalLight(0xffffff, 2);
key.position.set(-1, 2, 3);
scene.add(new AmbientLight(0xffffff, 1.2), key);
globalThis.scene = scene;
globalThis.draw = () => renderer.render(scene, camera);
globalThis.show = async (url, options) => {
    const gltf = await load(url, new GLTFLoader(), options);
    await gltf.progressive.ready;
    scene.add(gltf.scene);
    const { center, radius } = new Box3().setFromObject(gltf.scene)
        .getBoundingSphere(new Sphere());
    camera.position.copy(center).add({ x: 0.5 * radius, y: 0.6 * radius,
        z: 3.2 * radius });
    camera.lookAt(center);
    draw();
    globalThis.gltf = gltf;
    return gltf.progressive.scene.faceCount;
};
globalThis.textures = () => {
    const found = [];
    gltf.scene.traverse((o) => o.isMesh && found.push(o.material.map !== null));
    return found;
};
</script>`;

async function bundle(kept) {
    const { build } = createRequire(join(kept, "x"))("esbuild");
    const script = /<script type="module">([^]*)<\/script>/.exec(PAGE)[1];
    const { outputFiles } = await build({
        stdin: { contents: script, resolveDir: kept }, bundle: true,
        write: false, format: "esm", target: "es2022",
        alias: { "pmesh/three": join(PACKAGE, "three.js") },
        nodePaths: [join(kept, "node_modules")],
    });
    return PAGE.replace(script, () => outputFiles[0].text);
}

test("textures come behind the shapes, in a page", async () => {
    const { chromium } = await import("playwright-core");
    mkdirSync(SHOTS, { recursive: true });
    const files = { "/": await bundle(join(PACKAGE, "../viewer")) };
    const glb = readFileSync(join(PMESH_ZOO, "tail", "textures.glb"));
    const server = await serve(read("textures"), { files, rate: 2 });
    const browser = await chromium.launch({
        executablePath: CHROMIUM,
        args: ["--no-sandbox", "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader"],
    });
    try {
        const page = await browser.newPage();
        const failures = [];
        page.on("pageerror", (error) => failures.push(error));
        await page.goto(new URL("/", server.url).href);
        await page.waitForFunction(() => globalThis.show);
        const coarse = await page.evaluate(() => show("/mesh.pmesh"));
        writeFileSync(join(SHOTS, "gltf-base.png"), await page.screenshot());
        const fine = await page.evaluate(async () => {
            await gltf.progressive.done;
            draw();
            return gltf.progressive.scene.faceCount;
        });
        writeFileSync(join(SHOTS, "gltf-full.png"), await page.screenshot());
        assert.ok(coarse < fine);
        assert.ok((await page.evaluate(() => textures())).some((has) => has));
        Object.assign(server, { body: glb, rate: 64 });
        assert.ok(await page.evaluate(async () => {
            scene.remove(gltf.scene);
            await show("/mesh.glb");
            await gltf.progressive.done;
            draw();
            return textures().some((has) => has);
        }));
        writeFileSync(join(SHOTS, "gltf-tail.png"), await page.screenshot());
        assert.deepEqual(failures, []);
    } finally {
        await browser.close();
        await server.close();
    }
});
