// SPDX-License-Identifier: MIT
// Feeds a decoder from a source, as far as a target needs.
import { PmeshError } from "./module.js";

// Fed at a time, so that one step stays short; fewer until there is a picture.
const PIECE = 8192, FIRST_PIECE = 512;

export class Loading {
    #source;
    #create;
    #decoder = null;
    #pending = new Uint8Array(0); // read, but not yet fed
    #generation = 0;
    #startedOver = false;

    // create: makes a decoder, which feeds, refines and tells when it is ready
    // to show something and whether it meets a target.
    constructor(source, create) {
        this.#source = source;
        this.#create = create;
    }

    async start() {
        this.#decoder = await this.#create();
        while (!this.#decoder.ready)
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
                this.#decoder = await this.#create();
            }
            this.#pending = bytes;
        }
        const piece = this.#pending.subarray(0,
            this.#decoder.ready ? PIECE : FIRST_PIECE);
        this.#pending = this.#pending.subarray(piece.length);
        try {
            this.#decoder.feed(piece);
        } catch (error) {
            return this.#startOver(error);
        }
        if (this.#decoder.header?.bytes)
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

    #meets(target) {
        return this.#decoder.meets(target, this.received);
    }

    // Bytes that have been fed.
    get received() {
        return this.#source.at - this.#pending.length;
    }

    // Reads until the target can be shown, shows it piece by piece, and yields
    // what changed; `restarted` says that the file was replaced by another
    // one, whose buffers are new ones. Ends the request when the target is met.
    async *stream(target = {}) {
        let last = this.#decoder;
        try {
            yield { ...this.refine(target), restarted: false };
            while (!this.#meets(target) && await this.#step()) {
                const changes = this.refine(target);
                if (!changes || isEmpty(changes))
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
        return { ...this.#decoder.progress, received: this.received };
    }

    refine(target) {
        return this.#decoder.refine(target);
    }

    get faceCount() {
        return this.#decoder.faceCount;
    }

    get error() {
        return this.#decoder.error;
    }
}

function isEmpty({ vertices, faces, meshes }) {
    return meshes ? meshes.length === 0 :
        faces.length + vertices.length === 0;
}
