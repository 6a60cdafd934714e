// SPDX-License-Identifier: MIT
// pmesh/worker: the same mesh, decoded in a worker. Its buffers are this
// side's own, brought up to date by the ranges that the worker sends.
import { PmeshError } from "./module.js";

// As open(); `worker`: a Worker or MessagePort that runs serve(), if the
// bundler needs it made elsewhere. Resolves when the base mesh is there.
export async function openInWorker(input, options = {}) {
    const { worker, ...rest } = options;
    const port = worker ?? new Worker(
        new URL("./worker-main.js", import.meta.url), { type: "module" });
    const mesh = new RemoteMesh(port);
    const absolute = typeof input === "string" ?
        new URL(input, globalThis.location?.href).href :
        input instanceof URL ? input.href : input;
    try {
        await mesh.run({ job: "open", input: absolute, options: rest });
    } catch (error) {
        mesh.dispose();
        throw error;
    }
    return mesh;
}

export class RemoteMesh {
    header = null;
    positions = null;
    indices = null;
    attributes = [];
    faceCount = 0;
    vertexCount = 0;
    error = 0;
    progress = null;
    #port;
    #next = 1;
    #jobs = new Map(); // id -> what waits for its messages

    constructor(port) {
        this.#port = port;
        port.onmessage = ({ data }) => this.#receive(data);
        port.onerror = (event) => {
            for (const job of this.#jobs.values())
                job.fail(new PmeshError(event.message, "worker"));
        };
    }

    #receive(message) {
        const job = this.#jobs.get(message.id);
        if (message.failure) {
            const { message: text, code, offset } = message.failure;
            this.#jobs.delete(message.id);
            job?.fail(new PmeshError(text, code ?? "unknown", offset));
        } else if (message.done) {
            this.#jobs.delete(message.id);
            job?.end();
        } else {
            this.#apply(message);
            job?.changed({
                vertices: message.vertices,
                faces: message.faces,
                more: message.more,
                restarted: message.restarted,
            });
        }
    }

    #apply(m) {
        if (m.header)
            this.#makeBuffers(m.header);
        const put = (array, size, ranges, parts) => ranges.forEach((r, i) =>
            array.set(parts[i], size * r.first));
        put(this.positions, 3, m.vertices, m.positions);
        put(this.indices, 3, m.faces, m.indices);
        this.attributes.forEach((a, i) =>
            put(a.values, a.components, m.vertices, m.attributes[i]));
        this.faceCount = m.faceCount;
        this.vertexCount = m.vertexCount;
        this.error = m.error;
        this.progress = m.progress;
    }

    #makeBuffers(header) {
        const Index = header.vertices <= 65536 ? Uint16Array : Uint32Array;
        this.header = header;
        this.positions = new Float32Array(3 * header.vertices);
        this.indices = new Index(3 * header.faces);
        this.attributes = header.attributes.map((a) => ({
            ...a, values: new Float32Array(a.components * header.vertices),
        }));
    }

    // Resolves with the last changes once the job is done.
    run(message) {
        const id = this.#next++;
        let last = null;
        const result = new Promise((resolve, reject) => {
            this.#jobs.set(id, {
                changed: (changes) => { last = changes; },
                end: () => resolve(last),
                fail: reject,
            });
        });
        this.#port.postMessage({ ...message, id });
        return result;
    }

    refine(target = {}) {
        return this.run({ job: "refine", target });
    }

    // As Mesh.stream(). What is yielded was already applied to the buffers, and
    // later changes may be, too: upload from the buffers, not in order.
    async *stream(target = {}) {
        const id = this.#next++, queue = [];
        let wake = () => {}, ended = false, failure = null;
        this.#jobs.set(id, {
            changed: (changes) => { queue.push(changes); wake(); },
            end: () => { ended = true; wake(); },
            fail: (error) => { failure = error; wake(); },
        });
        this.#port.postMessage({ job: "stream", target, id });
        try {
            for (;;) {
                while (queue.length > 0)
                    yield queue.shift();
                if (failure)
                    throw failure;
                if (ended)
                    return;
                await new Promise((resolve) => { wake = resolve; });
            }
        } finally {
            if (!ended)
                this.#port.postMessage({ job: "stop", of: id });
        }
    }

    dispose() {
        this.#port.terminate?.();
        this.#port.close?.();
    }
}
