// SPDX-License-Identifier: MIT
// pmesh: a mesh that sharpens while it loads.
//
//   const mesh = await open("bunny.pmesh", { faces: 50_000 });
//   for await (const changes of mesh.stream())
//       upload(mesh, changes);
import { Decoder, PmeshError, ready, supported } from "./decoder.js";
import { Source } from "./source.js";

export { Decoder, PmeshError, Source, ready, supported };

// Fed at a time, so that one step stays short; fewer until there is a picture.
const PIECE = 8192, FIRST_PIECE = 512;

// Resolves when the base mesh can be shown. `input`: URL, Response,
// ReadableStream, Blob, ArrayBuffer or a view.
export async function open(input, options = {}) {
    const mesh = new Mesh(new Source(input, options), options);
    await mesh.start();
    return mesh;
}

export class Mesh {
    #source;
    #options;
    #decoder = null;
    #pending = new Uint8Array(0); // read, but not yet fed
    #generation = 0;
    #startedOver = false;

    constructor(source, options = {}) {
        this.#source = source;
        this.#options = options;
    }

    async start() {
        this.#decoder = await Decoder.create(this.#options);
        while (this.#decoder.progress.levels === 0)
            if (!await this.#step())
                throw new PmeshError("ends before the base mesh", "cut");
    }

    // Reads and feeds one piece; false at the end of the source.
    async #step() {
        if (this.#pending.length === 0) {
            const bytes = await this.#source.next();
            if (!bytes)
                return false;
            if (this.#source.generation !== this.#generation) {
                this.#generation = this.#source.generation;
                this.#decoder = await Decoder.create(this.#options);
            }
            this.#pending = bytes;
        }
        const piece = this.#pending.subarray(0,
            this.#decoder.progress.levels > 0 ? PIECE : FIRST_PIECE);
        this.#pending = this.#pending.subarray(piece.length);
        try {
            this.#decoder.feed(piece);
        } catch (error) {
            return this.#startOver(error);
        }
        if (this.#decoder.header)
            this.#source.expected = this.#decoder.header.bytes;
        return true;
    }

    // A resumed file may have changed unnoticed: one more try, from the start.
    #startOver(error) {
        if (this.#source.requests < 2 || this.#startedOver)
            throw error;
        this.#startedOver = true;
        this.#pending = this.#pending.subarray(0, 0);
        this.#source.reset();
        return true;
    }

    // Whether what is decoded meets the target; without limits: everything.
    #meets({ faces = 0, error = 0, bytes = 0 }) {
        const done = this.#decoder.progress;
        if (done.complete || done.levels === 0)
            return done.complete;
        const { levels } = this.#decoder.header;
        const fine = levels.findIndex((level) => level.error <= error);
        return (faces > 0 && done.faces >= faces) ||
            (bytes > 0 && done.bytes >= bytes) ||
            (bytes > 0 && this.#received >= bytes) ||
            (error > 0 && fine >= 0 && done.levels > fine);
    }

    get #received() {
        return this.#source.at - this.#pending.length;
    }

    // Reads until the target can be shown, shows it piece by piece, and yields
    // the ranges that changed; `restarted` says that the file was replaced by
    // another one, whose buffers are new ones. Ends the request when the
    // target is met.
    async *stream(target = {}) {
        let last = this.#decoder;
        try {
            yield { ...this.refine(target), restarted: false };
            while (!this.#meets(target) && await this.#step()) {
                const changes = this.refine(target);
                if (!changes?.faces.length && !changes?.vertices.length)
                    continue;
                yield { ...changes, restarted: last !== this.#decoder };
                last = this.#decoder;
            }
        } finally {
            this.stop();
        }
    }

    // The same without a look at what is on the way.
    async load(target = {}) {
        while (!this.#meets(target) && await this.#step());
        this.stop();
        return this.refine(target);
    }

    // Ends the request; stream() and load() go on from here with a new one.
    stop() {
        this.#source.stop();
    }

    // Lets go of everything.
    dispose() {
        this.stop();
        this.#decoder = null;
    }

    get source() {
        return this.#source;
    }

    get decoder() {
        return this.#decoder;
    }

    get header() {
        return this.#decoder.header;
    }

    get progress() {
        return { ...this.#decoder.progress, received: this.#received };
    }

    refine(target) {
        return this.#decoder.refine(target);
    }

    get positions() {
        return this.#decoder.positions;
    }

    get indices() {
        return this.#decoder.indices;
    }

    get attributes() {
        return this.#decoder.attributes;
    }

    get faceCount() {
        return this.#decoder.faceCount;
    }

    get vertexCount() {
        return this.#decoder.vertexCount;
    }

    get error() {
        return this.#decoder.error;
    }
}
