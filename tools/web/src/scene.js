// SPDX-License-Identifier: MIT
// pmesh/scene: many meshes out of one file, at one budget.
//
//   const scene = await openScene("scene.pmesh");
//   for await (const { meshes } of scene.stream({ faces: 200_000 }))
//       for (const { mesh, vertices, faces } of meshes)
//           upload(scene.meshes[mesh], vertices, faces);
//
// The meshes share one memory, which grows as long as meshes begin to arrive:
// views of their buffers are to be taken anew after each step.
import { Detail } from "./decoder.js";
import { Loading } from "./load.js";
import { Instance, compile } from "./module.js";
import { compressed } from "./scene-wasm.js";
import { Source } from "./source.js";
import { unpack } from "./unpack.js";

const ZLIB = 1;

let module;

// Resolves when all base meshes and the document are there. `input` as open().
export async function openScene(input, options = {}) {
    const scene = new Scene(new Source(input, options), options);
    await scene.start();
    return scene;
}

export class SceneDecoder {
    #instance;
    #options;
    #header = null;
    #meshes = [];
    #absent = 0; // meshes that have not begun

    static async create(options) {
        module ??= compile(compressed);
        return new SceneDecoder(await module, options);
    }

    // options as those of Decoder; maxMemory is for all meshes and resources.
    constructor(compiled, options) {
        this.#options = options;
        this.#instance = new Instance(compiled, options);
    }

    get #wasm() {
        return this.#instance.exports;
    }

    feed(bytes) {
        return this.#instance.feed(bytes, () => this.#take());
    }

    #take() {
        const at = this.#header ? 0 : this.#wasm.scene_info();
        if (at !== 0) {
            this.#header = readHeader(this.#instance.list(at, 6 + 4 * 64));
            this.#absent = this.#header.meshCount;
            this.#meshes = Array(this.#absent).fill(null);
        }
        for (let i = 0; i < this.#meshes.length && this.#absent > 0; i++)
            this.#begin(i);
    }

    // Makes the buffers of a mesh whose header has come.
    #begin(number) {
        const address = this.#meshes[number] ? 0 :
            this.#wasm.scene_mesh(number);
        if (address === 0)
            return;
        const mesh = new Detail(this.#instance, address, this.#options);
        mesh.takeHeader();
        this.#meshes[number] = mesh;
        this.#absent--;
    }

    // Counts, and the level table of the whole scene; null before it arrived.
    get header() {
        return this.#header;
    }

    get progress() {
        const [bytes, faces, bases, document, complete] =
            this.#instance.list(this.#wasm.scene_state(), 5);
        return {
            bytes, faces, bases, document: document > 0,
            complete: complete > 0,
        };
    }

    get ready() {
        const { bases, document } = this.progress;
        return document && bases === this.#meshes.length && bases > 0;
    }

    meets({ faces = 0, error = 0, bytes = 0 }, received) {
        const done = this.progress;
        if (done.complete || !this.ready)
            return done.complete;
        const fine = this.#header.levels.find((l) => l.error <= error);
        return (faces > 0 && done.faces >= faces) ||
            (bytes > 0 && (done.bytes >= bytes || received >= bytes)) ||
            (error > 0 && fine !== undefined && done.bytes >= fine.bytes);
    }

    // Refines each mesh to its share of { faces, error, bytes }, error being in
    // units of the world; null while there is none. `meshes` tells what
    // changed, as refine() of a mesh with its number.
    refine({ faces = 0, error = 0, bytes = 0 } = {}) {
        const at = this.#wasm.scene_share(faces, error, bytes);
        if (at === 0)
            return null;
        const count = this.#meshes.length;
        const share = new Uint32Array(this.#instance.buffer, at, count).slice();
        const meshes = [];
        share.forEach((budget, mesh) => {
            const changes = budget > 0 &&
                this.#meshes[mesh].refine({ faces: budget });
            if (changes && changes.faces.length + changes.vertices.length > 0)
                meshes.push({ mesh, ...changes });
        });
        return { meshes };
    }

    // As Decoder, but for feed(); null until the mesh begins.
    get meshes() {
        return this.#meshes;
    }

    // Largest scale of a mesh's instances.
    scale(mesh) {
        return this.#wasm.scene_scale(mesh);
    }

    get faceCount() {
        return this.#meshes.reduce((n, m) => n + (m?.faceCount ?? 0), 0);
    }

    // Of the worst mesh, in units of the world.
    get error() {
        return this.#meshes.reduce((worst, m, i) =>
            Math.max(worst, (m?.error ?? 0) * this.scale(i)), 0);
    }

    // The document's text (of glTF: its JSON), or null until all of it is there.
    async document() {
        const bytes = this.#bytes(-1);
        if (bytes && this.#header.documentPacked)
            return unpack(bytes);
        return bytes && new TextDecoder().decode(bytes);
    }

    // A copy of a resource's bytes, or null until all of them are there.
    resource(number) {
        return this.#bytes(number);
    }

    #bytes(number) {
        const [at, size, arrived] =
            this.#instance.list(this.#wasm.scene_bytes(number), 3);
        return this.#header && arrived === size ?
            new Uint8Array(this.#instance.buffer, at, size).slice() : null;
    }

    get memory() {
        return this.#instance.buffer.byteLength;
    }
}

// A scene that reads for itself.
export class Scene extends Loading {
    constructor(source, options) {
        super(source, () => SceneDecoder.create(options));
    }

    get meshes() {
        return this.decoder.meshes;
    }

    document() {
        return this.decoder.document();
    }

    resource(number) {
        return this.decoder.resource(number);
    }
}

function readHeader(list) {
    let at = 0;
    const next = () => list[at++];
    const hex = () => next().toString(16).padStart(8, "0");
    const header = {
        contentHash: hex() + hex(),
        meshCount: next(),
        resourceCount: next(),
        documentPacked: next() === ZLIB,
    };
    const levelCount = next();
    header.levels = Array.from({ length: levelCount }, () => ({
        bytes: next(),
        faces: next(),
        vertices: next(),
        error: next(),
    }));
    header.faces = header.levels.at(-1).faces;
    return header;
}
