// SPDX-License-Identifier: MIT
// The worker's side of pmesh/worker: decodes, and sends what changed. `port`
// is the worker's global, or one end of a MessageChannel.
import { open } from "./index.js";

export function serve(port) {
    let mesh = null;
    let stopped = null; // generation of work that was stopped

    function state(changes, id, restarted) {
        const transfer = [];
        const cut = (array, size, ranges) => ranges.map(({ first, count }) => {
            const part = array.slice(size * first, size * (first + count));
            transfer.push(part.buffer);
            return part;
        });
        port.postMessage({
            id, restarted,
            header: restarted ? mesh.header : undefined,
            vertices: changes.vertices,
            faces: changes.faces,
            more: changes.more,
            positions: cut(mesh.positions, 3, changes.vertices),
            indices: cut(mesh.indices, 3, changes.faces),
            attributes: mesh.attributes.map((a) =>
                cut(a.values, a.components, changes.vertices)),
            faceCount: mesh.faceCount,
            vertexCount: mesh.vertexCount,
            error: mesh.error,
            progress: mesh.progress,
        }, transfer);
    }

    const jobs = {
        async open({ input, options }, id) {
            mesh = await open(input, options);
            state(mesh.refine(), id, true);
        },
        async stream({ target }, id) {
            for await (const changes of mesh.stream(target)) {
                state(changes, id, changes.restarted);
                if (stopped === id)
                    break;
            }
        },
        async refine({ target }, id) {
            state(mesh.refine(target), id, false);
        },
    };

    port.onmessage = async ({ data }) => {
        const { job, id } = data;
        if (job === "stop") {
            stopped = data.of;
            mesh?.stop();
            return;
        }
        try {
            await jobs[job](data, id);
            port.postMessage({ id, done: true });
        } catch (error) {
            const { name, message, code, offset } = error;
            port.postMessage({ id, failure: { name, message, code, offset } });
        }
    };
}
