// SPDX-License-Identifier: MIT
// Where bytes come from: read forwards, stop at any time, go on later. Over
// HTTP that is one plain GET, and a Range request for what is missing.
//
//   206            goes on where it stopped
//   200            the server ignored the range, or the file changed: told
//                  apart by ETag, else by the first bytes; the same file is
//                  skipped up to where it stopped, another one starts anew
//   416            starts anew
//   no length      the mesh's header tells it (expected)
//   compressed     Range would count other bytes: whole response, and skipped
//   broken off     goes on, `retries` times without a byte in between
import { PmeshError } from "./module.js";

const PREFIX = 4096; // bytes kept to recognise a file by
const PIECE = 65536;

export class Source {
    at = 0;         // bytes handed out
    generation = 0; // how often the file turned out to be another one
    requests = 0;
    expected = Infinity; // bytes of the whole file, once known
    #input;
    #fetch;
    #headers;
    #signal;
    #retries;
    #reader = null;
    #abort = null;
    #skip = 0;
    #validator = null; // for If-Range: strong, or there is none
    #etag = null;
    #prefix = new Uint8Array(0);
    #recheck = false; // the first bytes decide whether it is the same file

    constructor(input, { signal, fetch, headers, retries = 2 } = {}) {
        this.#input = typeof input === "string" ? new URL(input, base()) :
            input;
        this.#fetch = fetch ?? ((...all) => globalThis.fetch(...all));
        this.#headers = headers;
        this.#signal = signal;
        this.#retries = retries;
    }

    // The next bytes, or null at the end.
    async next() {
        let failures = 0;
        for (;;) {
            this.#signal?.throwIfAborted();
            let piece;
            try {
                this.#reader ??= await this.#connect();
                piece = this.#reader && await this.#reader.read();
            } catch (error) {
                if (error instanceof PmeshError || this.#signal?.aborted ||
                    !this.#isRemote() || ++failures > this.#retries)
                    throw error;
                this.stop();
                continue;
            }
            if (!piece || piece.done) {
                this.#reader = null;
                if (this.at >= this.expected || !this.#isRemote() ||
                    this.expected === Infinity || ++failures > this.#retries)
                    return null;
                continue;
            }
            const bytes = this.#accept(piece.value);
            if (bytes.length > 0)
                return bytes;
        }
    }

    // Ends the request. next() goes on from here with another one.
    stop() {
        if (this.#input instanceof ReadableStream)
            return; // cannot be opened again: it waits
        this.#abort?.abort();
        this.#reader?.cancel?.().catch(() => {});
        this.#reader = null;
    }

    // Starts anew: what came before was damaged, or mixed from two files.
    reset() {
        this.stop();
        this.#validator = null;
        this.#restart();
    }

    #isRemote() {
        return this.#input instanceof URL;
    }

    #accept(bytes) {
        if (this.#recheck)
            bytes = this.#compare(bytes);
        const skipped = Math.min(this.#skip, bytes.length);
        this.#skip -= skipped;
        bytes = bytes.subarray(skipped);
        if (this.at < PREFIX && bytes.length > 0)
            this.#prefix = join(this.#prefix.subarray(0, this.at),
                bytes.subarray(0, PREFIX - this.at));
        this.at += bytes.length;
        return bytes;
    }

    // Collects a first piece as long as the prefix; nothing before it is full.
    #compare(bytes) {
        const head = this.#recheck === true ? bytes :
            join(this.#recheck, bytes);
        if (head.length < this.#prefix.length) {
            this.#recheck = head;
            return head.subarray(0, 0);
        }
        this.#recheck = false;
        if (this.#prefix.some((byte, i) => byte !== head[i]))
            this.#restart();
        return head;
    }

    #restart() {
        this.at = 0;
        this.generation++;
        this.expected = Infinity;
        this.#skip = 0;
        this.#recheck = false;
    }

    async #connect() {
        this.#skip = 0;
        this.#recheck = false;
        const input = this.#input;
        if (input instanceof ReadableStream)
            return input.getReader();
        if (input instanceof Blob)
            return input.slice(this.at).stream().getReader();
        if (typeof Response === "function" && input instanceof Response) {
            this.#input = new URL(input.url || "about:blank", base());
            return this.#take(input);
        }
        if (!(input instanceof URL))
            return pieces(view(input).subarray(this.at));
        return this.#request();
    }

    async #request() {
        const headers = new Headers(this.#headers);
        if (this.at > 0 && this.#validator) {
            headers.set("Range", `bytes=${this.at}-`);
            headers.set("If-Range", this.#validator);
        }
        this.#abort = new AbortController();
        const signal = this.#signal ?
            AbortSignal.any([this.#signal, this.#abort.signal]) :
            this.#abort.signal;
        this.requests++;
        return this.#take(await this.#fetch(this.#input, { headers, signal }));
    }

    #take(response) {
        if (response.status === 206)
            return this.#resume(response);
        if (response.status === 416 && this.at > 0)
            return this.#again(response);
        if (!response.ok)
            throw new PmeshError(`${response.status} ${response.statusText}`,
                "http");
        const etag = response.headers.get("ETag");
        if (this.at > 0) {
            this.#skip = this.at;
            if (!etag || !this.#etag)
                this.#recheck = true;
            else if (weak(etag) !== weak(this.#etag))
                this.#restart();
        }
        this.#remember(response, etag);
        return response.body.getReader();
    }

    #resume(response) {
        const [, first, total] = /^bytes (\d+)-\d+\/(\d+|\*)$/
            .exec(response.headers.get("Content-Range") ?? "") ?? [];
        const etag = response.headers.get("ETag");
        const other = etag && this.#etag && weak(etag) !== weak(this.#etag);
        const shorter = total && total !== "*" &&
            this.expected !== Infinity && Number(total) < this.expected;
        if (first === undefined || Number(first) > this.at || other || shorter)
            return this.#again(response);
        this.#skip = this.at - Number(first);
        return response.body.getReader();
    }

    // The whole file, without conditions.
    #again(response) {
        response.body?.cancel().catch(() => {});
        if (!this.#validator)
            throw new PmeshError(`${response.status} to a plain request`,
                "http");
        this.#validator = null;
        return this.#request();
    }

    #remember(response, etag) {
        const encoded = response.headers.get("Content-Encoding") ?? "identity";
        const strong = etag && !etag.startsWith("W/") ? etag : null;
        this.#etag = etag;
        this.#validator = encoded !== "identity" ? null :
            strong ?? (etag ? null : response.headers.get("Last-Modified"));
    }
}

function base() {
    return globalThis.location?.href ?? "file:///";
}

function weak(etag) {
    return etag.replace(/^W\//, "");
}

function view(data) {
    return ArrayBuffer.isView(data) ?
        new Uint8Array(data.buffer, data.byteOffset, data.byteLength) :
        new Uint8Array(data);
}

function join(a, b) {
    const all = new Uint8Array(a.length + b.length);
    all.set(a);
    all.set(b, a.length);
    return all;
}

function pieces(bytes) {
    let at = 0;
    return {
        async read() {
            const value = bytes.subarray(at, at + PIECE);
            at += value.length;
            return { value, done: value.length === 0 };
        },
    };
}
