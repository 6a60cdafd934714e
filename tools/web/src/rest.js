// SPDX-License-Identifier: MIT
// The beginning of a file that is a scene in one of several ways, and a source
// for what comes behind it.
import { PmeshError } from "./module.js";

const GLTF = 0x46546c67, JSON_CHUNK = 0x4e4f534a;
const PMESH = [0x89, 0x50, 0x4d, 0x53, 0x48];

// A source whose first bytes have been read: `have` of them, from `start` on,
// are still to be handed out; it ends after `length`, and keeps what passes if
// that is known.
export class Rest {
    expected = Infinity;
    #kept = null;
    #size = 0;
    #source;
    #have;
    #start;
    #length;

    constructor(source, have, start = 0, length = Infinity) {
        this.#source = source;
        this.#have = have;
        this.#start = start;
        this.#length = length;
        if (length < Infinity)
            this.#kept = new Uint8Array(length);
    }

    // A copy of bytes that have passed, or null.
    take(first, size) {
        return first + size <= this.#size ?
            this.#kept.slice(first, first + size) : null;
    }

    async next() {
        const left = this.#length - this.at;
        if (left <= 0)
            return null;
        const bytes = this.#have ?? await this.#source.next();
        this.#have = null;
        if (this.#start > 0 && this.generation > 0)
            throw new PmeshError("the file was replaced while it was read",
                "http");
        return bytes && this.#keep(bytes.subarray(0, left));
    }

    #keep(bytes) {
        this.#kept?.set(bytes, this.#size);
        this.#size += bytes.length;
        return bytes;
    }

    // Of the part that this is a source of, handed out.
    get at() {
        return this.#source.at - this.#start - (this.#have?.length ?? 0);
    }

    get generation() {
        return this.#source.generation;
    }

    get requests() {
        return this.#start > 0 ? 0 : this.#source.requests;
    }

    stop() {
        this.#source.stop();
    }

    reset() {
        this.#have = null;
        this.#source.reset();
    }
}

// Collects what a source hands out.
class Head {
    #source;
    #data = new Uint8Array(65536);
    #size = 0;

    constructor(source) {
        this.#source = source;
    }

    // All that was read, which is `size` bytes or more unless the source ends.
    async read(size) {
        while (this.#size < size) {
            const bytes = await this.#source.next();
            if (!bytes)
                break;
            this.#add(bytes);
        }
        return this.#data.subarray(0, this.#size);
    }

    #add(bytes) {
        const size = this.#size + bytes.length;
        if (size > this.#data.length) {
            const more = new Uint8Array(2 * size);
            more.set(this.#data.subarray(0, this.#size));
            this.#data = more;
        }
        this.#data.set(bytes, this.#size);
        this.#size = size;
    }
}

// { kind: "pmesh", data } with what has been read; or { kind: "gltf", data,
// tail }: what GLTFLoader can parse, and a source for a stream behind it.
export async function readHead(source, extension) {
    const head = new Head(source), start = await head.read(20);
    if (PMESH.every((byte, i) => start[i] === byte))
        return { kind: "pmesh", data: start };
    const first = await tailOf(head, start, extension);
    const all = await head.read(first ? first.at : Infinity);
    const size = first ? first.at : all.length;
    return {
        kind: "gltf",
        data: all.slice(0, size).buffer,
        tail: first && new Rest(source, all.slice(size), size, first.length),
    };
}

// Where the stream of a .glb begins; null: there is none.
async function tailOf(head, start, extension) {
    const view = new DataView(start.buffer);
    if (start.length < 20 || view.getUint32(0, true) !== GLTF ||
        view.getUint32(16, true) !== JSON_CHUNK)
        return null;
    const end = 20 + view.getUint32(12, true);
    const bytes = (await head.read(end)).subarray(20, end);
    const json = JSON.parse(new TextDecoder().decode(bytes));
    const number = json.extensions?.[extension]?.bufferView;
    const at = json.bufferViews?.[number];
    return at?.buffer === 0 ?
        { at: end + 8 + (at.byteOffset ?? 0), length: at.byteLength } : null;
}
