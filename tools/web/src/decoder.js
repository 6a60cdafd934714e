// SPDX-License-Identifier: MIT
// The decoder: bytes in, any level of detail out. The lists of numbers that the
// module answers with are told in pmesh_wasm.c.
import { Instance, PmeshError, compile } from "./module.js";
import { compressed } from "./wasm.js";

const NEED_DATA = 1, MORE = 2, E_MEMORY = -2;
const KINDS = ["normal", "texcoord", "color", "generic"];

let module;

// The compiled module, made at the first call.
export function ready() {
    module ??= compile(compressed);
    return module;
}

// A mesh at any level of what has been decoded of it.
export class Detail {
    #instance;
    #mesh; // its address there
    #options;
    #header = null;
    #at = null; // of the buffers

    constructor(instance, mesh, { morph = false, inflate = false } = {}) {
        this.#instance = instance;
        this.#mesh = mesh;
        this.#options = { morph, inflate };
    }

    get #wasm() {
        return this.#instance.exports;
    }

    #list(at, count) {
        return this.#instance.list(at, count);
    }

    // Makes the buffers when the header has arrived.
    takeHeader() {
        const at = this.#header ? 0 : this.#wasm.info(this.#mesh);
        if (at === 0)
            return;
        this.#header = readHeader(this.#list(at, 26 + 5 * 64 + 4 * 8));
        const { morph, inflate } = this.#options;
        if (this.#wasm.bind(this.#mesh, morph, inflate) < 0)
            this.#instance.fail(E_MEMORY);
        const count = this.#header.attributes.length;
        this.#at = Array.from(this.#list(this.#wasm.buffers(this.#mesh),
            8 + count));
    }

    // Counts of full detail, grid, attributes and level table; null until the
    // header has arrived.
    get header() {
        return this.#header;
    }

    get progress() {
        const [bytes, faces, levels, exactVertices, complete] =
            this.#list(this.#wasm.state(this.#mesh), 5);
        return { bytes, faces, levels, exactVertices, complete: complete > 0 };
    }

    // Moves the visible mesh to { faces, error, bytes, maxOps }; null while
    // there is none, else the ranges that changed and whether more is left.
    refine({ faces = 0, error = 0, bytes = 0, maxOps = 0 } = {}) {
        const status = this.#wasm.refine(this.#mesh, faces, error, bytes, maxOps);
        if (status === NEED_DATA)
            return null;
        const at = this.#at[7], words = this.#instance.buffer;
        const counts = new Uint32Array(words, at, 2);
        return {
            vertices: readRanges(words, at + 8, counts[0]),
            faces: readRanges(words, at + 8 + 8 * 64, counts[1]),
            more: status === MORE,
        };
    }

    #visible() {
        return this.#list(this.#wasm.state(this.#mesh), 9).subarray(5);
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
        return new Float32Array(this.#instance.buffer, at, count);
    }

    #indices(at) {
        const Type = this.#at[1] === 2 ? Uint16Array : Uint32Array;
        return new Type(this.#instance.buffer, at, 3 * this.#header.faces);
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
            values: this.#floats(this.#at[8 + i],
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
        const status = this.#wasm.sort(this.#mesh);
        const count = status === 0 ? this.#header.materialCount : 0;
        const groups = readRanges(this.#instance.buffer, this.#at[4], count)
            .map((group, material) => ({ material, ...group }));
        return { indices: this.#indices(this.#at[3]), groups };
    }

    // Where the visible vertices lie on the coarser mesh `target`: the start
    // of a geomorph. Needs { morph: true } at creation.
    morph({ faces = 0, error = 0, bytes = 0 } = {}) {
        if (!this.#options.morph)
            throw new PmeshError("created without morph", "argument");
        if (this.#wasm.morph(this.#mesh, faces, error, bytes) !== 0)
            return null;
        return this.#floats(this.#at[5], 3 * this.vertexCount);
    }

    // Positions of the visible vertices, swollen to the volume of the full mesh:
    // for the eye. All change with every refine(). Needs { inflate: true } at
    // creation. Views of the same memory each time.
    inflated() {
        if (!this.#options.inflate)
            throw new PmeshError("created without inflate", "argument");
        if (this.#wasm.inflate(this.#mesh) !== 0)
            return null;
        return this.#floats(this.#at[6], 3 * this.#header.vertices);
    }

    // { minimum, maximum } of the visible mesh, or null.
    bounds() {
        const at = this.#wasm.bounds(this.#mesh);
        if (at === 0)
            return null;
        const [a, b, c, d, e, f] = this.#list(at, 6);
        return { minimum: [a, b, c], maximum: [d, e, f] };
    }

    // The first visible face that the ray meets: { face, distance, weights },
    // or null.
    raycast([x, y, z], [dx, dy, dz]) {
        const at = this.#wasm.raycast(this.#mesh, x, y, z, dx, dy, dz);
        if (at === 0)
            return null;
        const [face, distance, ...weights] = this.#list(at, 5);
        return { face, distance, weights };
    }

    materialName(material) {
        return this.#instance.text(this.#wasm.material_name(this.#mesh, material));
    }

    // Bytes of memory the instance holds.
    get memory() {
        return this.#instance.buffer.byteLength;
    }
}

// The same of a file by itself.
export class Decoder extends Detail {
    #instance;

    // maxMemory: bytes that a file may need for decoding. morph, inflate: the
    // functions of that name will be called. base: decodes Draco base meshes.
    static async create(options) {
        return new Decoder(await ready(), options);
    }

    constructor(compiled, options) {
        const instance = new Instance(compiled, options);
        super(instance, instance.created, options);
        this.#instance = instance;
    }

    // Takes the next bytes; true once the file is complete. Throws where they
    // are damaged; what came before stays usable.
    feed(bytes) {
        return this.#instance.feed(bytes, () => this.takeHeader());
    }

    // Whether there is something to show.
    get ready() {
        return this.progress.levels > 0;
    }

    // Whether what is decoded meets the target; without limits: everything.
    meets({ faces = 0, error = 0, bytes = 0 }, received) {
        const done = this.progress;
        if (done.complete || done.levels === 0)
            return done.complete;
        const fine = this.header.levels.findIndex((l) => l.error <= error);
        return (faces > 0 && done.faces >= faces) ||
            (bytes > 0 && (done.bytes >= bytes || received >= bytes)) ||
            (error > 0 && fine >= 0 && done.levels > fine);
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
        measured: next() !== 0,
    };
    const attributeCount = next(), levelCount = next();
    header.levels = Array.from({ length: levelCount }, () => ({
        bytes: next(),
        faces: next(),
        meshVertices: next(),
        vertices: next(),
        error: next(),
        rms: next(),
        furthest: next(),
    }));
    header.attributes = Array.from({ length: attributeCount }, () => ({
        kind: KINDS[next()],
        set: next(),
        components: next(),
        bits: next(),
    }));
    return header;
}
