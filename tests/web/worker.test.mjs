// SPDX-License-Identifier: MIT
// pmesh/worker: this side's buffers follow the worker's by ranges alone.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { open } from "pmesh";
import { openInWorker } from "pmesh/worker";
import { serve } from "../pmesh/remote.js";

const data = readFileSync(process.env.PMESH_SAMPLE);

function worker() {
    const { port1, port2 } = new MessageChannel();
    serve(port2);
    return port1;
}

function assertSame(remote, mesh) {
    const v = 3 * mesh.vertexCount, f = 3 * mesh.faceCount;
    assert.equal(remote.faceCount, mesh.faceCount);
    assert.deepEqual(remote.positions.subarray(0, v),
        mesh.positions.subarray(0, v));
    assert.deepEqual(remote.indices.subarray(0, f),
        mesh.indices.subarray(0, f));
    remote.attributes.forEach((a, i) => {
        const n = a.components * mesh.vertexCount;
        assert.deepEqual(a.values.subarray(0, n),
            mesh.attributes[i].values.subarray(0, n));
    });
}

test("streams and refines as the mesh itself", async () => {
    const remote = await openInWorker(new Blob([data]), { worker: worker() });
    const mesh = await open(data);
    mesh.refine();
    assertSame(remote, mesh);
    for await (const changes of remote.stream({ faces: 4000 }))
        assert.ok(changes.vertices);
    await mesh.load({ faces: 4000 });
    assertSame(remote, mesh);
    for (const faces of [700, 3900, 300, 2000]) {
        await remote.refine({ faces });
        mesh.refine({ faces });
        assertSame(remote, mesh);
    }
    for await (const _ of remote.stream());
    await mesh.load();
    assertSame(remote, mesh);
    remote.dispose();
});

test("errors come over", async () => {
    await assert.rejects(
        openInWorker(new Uint8Array(100), { worker: worker() }),
        { code: "magic" });
});
