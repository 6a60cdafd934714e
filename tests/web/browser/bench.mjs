// SPDX-License-Identifier: MIT
// Time to decode one mesh in a page of headless Chromium, in turns: pmesh, and
// Draco's own WebAssembly (npm draco3d). Prints medians in milliseconds. From
// the environment: PMESH_FILE, DRACO_FILE, DRACO (folder of draco3d), PACKAGE
// (folder of pmesh), CHROMIUM, RUNS (9).
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { chromium } from "playwright-core";
import { serve } from "./server.mjs";

const { PMESH_FILE, DRACO_FILE, DRACO, PACKAGE, CHROMIUM } = process.env;
const RUNS = Number(process.env.RUNS ?? 9);

const files = {
    "/": "<!doctype html><script src=\"/draco.js\"></script>",
    "/mesh.drc": readFileSync(DRACO_FILE),
    "/draco.js": readFileSync(join(DRACO, "draco_decoder_nodejs.js")),
    "/draco_decoder.wasm": readFileSync(join(DRACO, "draco_decoder.wasm")),
};
for (const name of readdirSync(PACKAGE).filter((n) => n.endsWith(".js")))
    files[`/pmesh/${name}`] = readFileSync(join(PACKAGE, name));

const server = await serve(readFileSync(PMESH_FILE), { files });
const browser = await chromium.launch({
    executablePath: CHROMIUM, args: ["--no-sandbox", "--disable-gpu"],
});
const page = await browser.newPage();
await page.goto(new URL("/", server.url).href);

const times = await page.evaluate(async (runs) => {
    const { Decoder } = await import("/pmesh/index.js");
    const load = async (url) =>
        new Uint8Array(await (await fetch(url)).arrayBuffer());
    const mesh = await load("/mesh.pmesh"), drc = await load("/mesh.drc");
    const draco = await DracoDecoderModule({
        wasmBinary: (await load("/draco_decoder.wasm")).buffer,
    });

    // To positions and indices in buffers, as GLTFLoader does.
    function byDraco() {
        const buffer = new draco.DecoderBuffer(), decoder = new draco.Decoder();
        buffer.Init(drc, drc.length);
        const out = new draco.Mesh();
        decoder.DecodeBufferToMesh(buffer, out);
        const faces = out.num_faces(), size = 12 * faces;
        const at = draco._malloc(size);
        decoder.GetTrianglesUInt32Array(out, size, at);
        new Uint32Array(draco.HEAPF32.buffer, at, 3 * faces).slice();
        draco._free(at);
        const id = decoder.GetAttributeId(out, draco.POSITION);
        const attribute = decoder.GetAttribute(out, id);
        const bytes = 12 * out.num_points(), to = draco._malloc(bytes);
        decoder.GetAttributeDataArrayForAllPoints(out, attribute,
            draco.DT_FLOAT32, bytes, to);
        new Float32Array(draco.HEAPF32.buffer, to, bytes / 4).slice();
        draco._free(to);
        for (const made of [out, decoder, buffer])
            draco.destroy(made);
        return faces;
    }

    async function byPmesh() {
        const decoder = await Decoder.create();
        decoder.feed(mesh);
        decoder.refine();
        return decoder.faceCount;
    }

    const taken = { pmesh: [], draco: [], faces: [] };
    for (let i = 0; i < runs; i++)
        for (const [name, run] of [["pmesh", byPmesh], ["draco", byDraco]]) {
            const began = performance.now();
            taken.faces.push(await run());
            taken[name].push(performance.now() - began);
        }
    return taken;
}, RUNS);

const median = (list) => [...list].sort((a, b) => a - b)[list.length >> 1];
console.log(`faces ${[...new Set(times.faces)]}, pmesh ` +
    `${median(times.pmesh).toFixed(1)} ms, draco ` +
    `${median(times.draco).toFixed(1)} ms; least ` +
    `${Math.min(...times.pmesh).toFixed(1)} and ` +
    `${Math.min(...times.draco).toFixed(1)}`);
await browser.close();
await server.close();
