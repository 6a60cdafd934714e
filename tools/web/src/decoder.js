// SPDX-License-Identifier: MIT
// The decoder: bytes in, any level of detail out. One WebAssembly instance for
// each mesh; the lists of numbers it answers with are told in pmesh_wasm.c.
import { compressed } from "./wasm.js";

const NEED_DATA = 1, MORE = 2, E_MEMORY = -2;
const INPUT_SIZE = 65536;
const KINDS = ["normal", "texcoord", "color", "generic"];

// A function that returns a vector, to see whether there are any.
const VECTOR = Uint8Array.of(0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1,
    123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11);

export const supported = typeof WebAssembly === "object" &&
    typeof DecompressionStream === "function" && WebAssembly.validate(VECTOR);

let module;

// The compiled module, made at the first call.
export function ready() {
    module ??= compile();
    return module;
}

async function compile() {
    const text = atob(compressed);
    const bytes = Uint8Array.from(text, (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream()
        .pipeThrough(new DecompressionStream("gzip"));
    return WebAssembly.compile(await new Response(stream).arrayBuffer());
}

// code: the name of a status ("corrupt", "limit", ...) or "http", "aborted".
export class PmeshError extends Error {
    constructor(message, code, offset = 0) {
        super(message);
        this.name = "PmeshError";
        this.code = code;
        this.offset = offset;
    }
}

const CODES = {
    "-1": "argument", "-2": "memory", "-3": "limit", "-10": "magic",
    "-11": "version", "-12": "corrupt", "-13": "checksum",
    "-14": "unsupported",
};

export class Decoder {
    #wasm;
    #withMorph;
    #header = null;
    #at = null; // of the buffers

    // maxMemory: bytes that a file may need for decoding. morph: morph() will
    // be called.
    static async create({ maxMemory = 2 ** 30, morph = false } = {}) {
        return new Decoder(await ready(), maxMemory, morph);
    }

    constructor(compiled, maxMemory, morph) {
        this.#wasm = new WebAssembly.Instance(compiled).exports;
        this.#withMorph = morph;
        if (this.#wasm.create(maxMemory) < 0)
            throw new PmeshError("out of memory", "memory");
    }

    #list(at, count) {
        return new Float64Array(this.#wasm.memory.buffer, at, count);
    }

    #text(at) {
        const bytes = new Uint8Array(this.#wasm.memory.buffer, at);
        return new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0)));
    }

    #fail(status) {
        const text = this.#text(this.#wasm.status_text(status));
        const rule = this.#text(this.#wasm.rule());
        const offset = this.#list(this.#wasm.state(), 6)[5];
        throw new PmeshError(
            rule ? `byte ${offset}: ${text} (${rule})` : text,
            CODES[status] ?? "unknown", offset);
    }

    // Takes the next bytes; true once the file is complete. Throws where they
    // are damaged; what came before stays usable.
    feed(bytes) {
        let status = NEED_DATA;
        for (let at = 0; at < bytes.length && status === NEED_DATA;
            at += INPUT_SIZE) {
            const part = bytes.subarray(at, at + INPUT_SIZE);
            new Uint8Array(this.#wasm.memory.buffer, this.#wasm.input(),
                part.length).set(part);
            status = this.#wasm.feed(part.length);
            this.#takeHeader();
        }
        if (status < 0)
            this.#fail(status);
        return status === 0;
    }

    #takeHeader() {
        const at = this.#header ? 0 : this.#wasm.info();
        if (at === 0)
            return;
        this.#header = readHeader(this.#list(at, 26 + 5 * 64 + 4 * 8));
        if (this.#wasm.bind(this.#withMorph) < 0)
            this.#fail(E_MEMORY);
        const count = this.#header.attributes.length;
        this.#at = Array.from(this.#list(this.#wasm.buffers(), 7 + count));
    }

    // Counts of full detail, grid, attributes and level table; null until the
    // header has arrived.
    get header() {
        return this.#header;
    }

    get progress() {
        const [bytes, faces, levels, exactVertices, complete] =
            this.#list(this.#wasm.state(), 5);
        return { bytes, faces, levels, exactVertices, complete: complete > 0 };
    }

    // Moves the visible mesh to { faces, error, bytes, maxOps }; null while
    // there is none, else the ranges that changed and whether more is left.
    refine({ faces = 0, error = 0, bytes = 0, maxOps = 0 } = {}) {
        const status = this.#wasm.refine(faces, error, bytes, maxOps);
        if (status === NEED_DATA)
            return null;
        const at = this.#at[6], words = this.#wasm.memory.buffer;
        const counts = new Uint32Array(words, at, 2);
        return {
            vertices: readRanges(words, at + 8, counts[0]),
            faces: readRanges(words, at + 8 + 8 * 64, counts[1]),
            more: status === MORE,
        };
    }

    #visible() {
        return this.#list(this.#wasm.state(), 10).subarray(6);
    }

    get faceCount() {
        return this.#visible()[0];
    }

    get vertexCount() {
        return this.#visible()[1];
    }

    // Of the level that is visible, in units of the model.
    get error() {
        return this.#visible()[3];
    }

    #floats(at, count) {
        return new Float32Array(this.#wasm.memory.buffer, at, count);
    }

    #indices(at) {
        const Type = this.#at[1] === 2 ? Uint16Array : Uint32Array;
        return new Type(this.#wasm.memory.buffer, at, 3 * this.#header.faces);
    }

    // Views into the module's memory, as large as full detail needs; refine()
    // changes them in place. null before the header.
    get positions() {
        return this.#at &&
            this.#floats(this.#at[2], 3 * this.#header.vertices);
    }

    get indices() {
        return this.#at && this.#indices(this.#at[0]);
    }

    get attributes() {
        return this.#at && this.#header.attributes.map((attribute, i) => ({
            ...attribute,
            values: this.#floats(this.#at[7 + i],
                attribute.components * this.#header.vertices),
        }));
    }

    // The visible faces sorted by material, made anew: { indices, groups },
    // a group being { material, first, count } in faces.
    sorted() {
        if (!this.#header || this.#header.materialCount === 1)
            return {
                indices: this.indices,
                groups: [{ material: 0, first: 0, count: this.faceCount }],
            };
        const status = this.#wasm.sort();
        const count = status === 0 ? this.#header.materialCount : 0;
        const groups = readRanges(this.#wasm.memory.buffer, this.#at[4], count)
            .map((group, material) => ({ material, ...group }));
        return { indices: this.#indices(this.#at[3]), groups };
    }

    // Where the visible vertices lie on the coarser mesh `target`: the start
    // of a geomorph. Needs { morph: true } at creation.
    morph({ faces = 0, error = 0, bytes = 0 } = {}) {
        if (!this.#withMorph)
            throw new PmeshError("created without morph", "argument");
        if (this.#wasm.morph(faces, error, bytes) !== 0)
            return null;
        return this.#floats(this.#at[5], 3 * this.vertexCount);
    }

    // { minimum, maximum } of the visible mesh, or null.
    bounds() {
        const at = this.#wasm.bounds();
        if (at === 0)
            return null;
        const [a, b, c, d, e, f] = this.#list(at, 6);
        return { minimum: [a, b, c], maximum: [d, e, f] };
    }

    // The first visible face that the ray meets: { face, distance, weights },
    // or null.
    raycast([x, y, z], [dx, dy, dz]) {
        const at = this.#wasm.raycast(x, y, z, dx, dy, dz);
        if (at === 0)
            return null;
        const [face, distance, ...weights] = this.#list(at, 5);
        return { face, distance, weights };
    }

    materialName(material) {
        return this.#text(this.#wasm.material_name(material));
    }

    // Bytes of memory the instance holds.
    get memory() {
        return this.#wasm.memory.buffer.byteLength;
    }
}

function readRanges(buffer, at, count) {
    const words = new Uint32Array(buffer, at, 2 * count);
    return Array.from({ length: count }, (_, i) =>
        ({ first: words[2 * i], count: words[2 * i + 1] }));
}

function readHeader(list) {
    let at = 0;
    const next = () => list[at++];
    const three = () => [next(), next(), next()];
    const hex = () => next().toString(16).padStart(8, "0");
    const header = {
        formatVersion: next(),
        contentHash: hex() + hex(),
        bytes: next(),
        exactBytes: next(),
        memory: next(),
        profile: ["compact", "balanced", "quality"][next()],
        placement: ["subset", "optimal"][next()],
        baseCoder: ["native", "draco"][next()],
        positionBits: next(),
        step: next(),
        origin: three(),
        bounds: three(),
        faces: next(),
        meshVertices: next(),
        vertices: next(),
        baseFaces: next(),
        baseMeshVertices: next(),
        baseVertices: next(),
        materialCount: next(),
    };
    const attributeCount = next(), levelCount = next();
    header.levels = Array.from({ length: levelCount }, () => ({
        bytes: next(),
        faces: next(),
        meshVertices: next(),
        vertices: next(),
        error: next(),
    }));
    header.attributes = Array.from({ length: attributeCount }, () => ({
        kind: KINDS[next()],
        set: next(),
        components: next(),
        bits: next(),
    }));
    return header;
}
