// SPDX-License-Identifier: MIT
// What there is around a WebAssembly module of the decoder (pmesh_wasm.c).
const INPUT_SIZE = 65536;
const NEED_DATA = 1, E_CORRUPT = -12, E_UNSUPPORTED = -14;

// A function that returns a vector, to see whether there are any.
const VECTOR = Uint8Array.of(0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1,
    123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11);

export const supported = typeof WebAssembly === "object" &&
    typeof DecompressionStream === "function" && WebAssembly.validate(VECTOR);

export async function compile(compressed) {
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
    "-11": "version", [E_CORRUPT]: "corrupt", "-13": "checksum",
    [E_UNSUPPORTED]: "unsupported",
};

export class Instance {
    // base: decodes Draco base meshes (draco.js); without it they are refused.
    constructor(module, { maxMemory = 2 ** 30, base = null } = {}) {
        const page = { base: (...all) => this.#callBase(base, ...all) };
        this.exports = new WebAssembly.Instance(module, { pmesh: page })
            .exports;
        this.created = this.exports.create(maxMemory, base !== null);
        if (!this.created)
            throw new PmeshError("out of memory", "memory");
    }

    get buffer() {
        return this.exports.memory.buffer;
    }

    list(at, count) {
        return new Float64Array(this.buffer, at, count);
    }

    text(at) {
        const bytes = new Uint8Array(this.buffer, at);
        return new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0)));
    }

    // The answer comes from elsewhere: the module checks what it says.
    #callBase(base, data, size, vertices, faces, positions, indices) {
        const bytes = new Uint8Array(this.buffer, data, size).slice();
        try {
            const made = base(bytes, vertices, faces);
            if (made?.positions.length !== 3 * vertices ||
                made.indices.length !== 3 * faces)
                return E_CORRUPT;
            new Int32Array(this.buffer, positions).set(made.positions);
            new Uint32Array(this.buffer, indices).set(made.indices);
            return 0;
        } catch {
            return E_CORRUPT;
        }
    }

    // `after` is called when the module has had a part of the bytes.
    feed(bytes, after) {
        let status = NEED_DATA;
        for (let at = 0; at < bytes.length && status === NEED_DATA;
            at += INPUT_SIZE) {
            const part = bytes.subarray(at, at + INPUT_SIZE);
            new Uint8Array(this.buffer, this.exports.input(), part.length)
                .set(part);
            status = this.exports.feed(part.length);
            after();
        }
        if (status < 0)
            this.fail(status);
        return status === 0;
    }

    fail(status) {
        const text = this.text(this.exports.status_text(status));
        const rule = this.text(this.exports.rule());
        const offset = this.exports.offset();
        throw new PmeshError(
            rule ? `byte ${offset}: ${text} (${rule})` : text,
            CODES[status] ?? "unknown", offset);
    }
}
