// SPDX-License-Identifier: MIT
// A .glb with coarse meshes and the stream behind them, and a .gltf beside
// which the stream lies, from a scene: by the text of the extension.
const NAME = "PMESH_progressive";

function chunk(type, bytes, fill) {
    const size = Math.ceil(bytes.length / 4) * 4;
    const out = new Uint8Array(8 + size).fill(fill);
    const view = new DataView(out.buffer);
    view.setUint32(0, size, true);
    view.setUint32(4, type, true);
    out.set(bytes, 8);
    return out;
}

export function glb(json, bin) {
    const text = new TextEncoder().encode(JSON.stringify(json));
    const parts = [chunk(0x4e4f534a, text, 32), chunk(0x004e4942, bin, 0)];
    const size = 12 + parts[0].length + parts[1].length;
    const out = new Uint8Array(size), view = new DataView(out.buffer);
    view.setUint32(0, 0x46546c67, true);
    view.setUint32(4, 2, true);
    view.setUint32(8, size, true);
    out.set(parts[0], 12);
    out.set(parts[1], 12 + parts[0].length);
    return out;
}

// `json` is a dressed document, `buffers` its bytes by number.
export function wrap(json, buffers, stream, uri) {
    const made = structuredClone(json), offsets = [], all = [];
    let size = 0;
    const add = (bytes) => {
        const at = size;
        all.push([at, bytes]);
        size += Math.ceil(bytes.length / 4) * 4;
        return at;
    };
    for (const bytes of buffers)
        offsets.push(add(bytes));
    for (const view of made.bufferViews) {
        view.byteOffset = (view.byteOffset ?? 0) + offsets[view.buffer];
        view.buffer = 0;
    }
    made.extensionsUsed = [...new Set([...made.extensionsUsed ?? [], NAME])];
    delete made.extensionsRequired;
    const place = uri ? { uri } : { bufferView: made.bufferViews.length };
    if (!uri)
        made.bufferViews.push({
            buffer: 0, byteOffset: add(stream), byteLength: stream.length,
        });
    made.buffers = [{ byteLength: size }];
    made.extensions = { ...made.extensions, [NAME]: place };
    const bin = new Uint8Array(size);
    for (const [at, bytes] of all)
        bin.set(bytes, at);
    return glb(made, bin);
}
