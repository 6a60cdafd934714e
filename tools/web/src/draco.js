// SPDX-License-Identifier: MIT
// pmesh/draco: files whose base mesh Draco coded (bake --base draco).
//
//   const draco = await DracoDecoderModule();      // npm draco3d, or a script
//   await open("bunny.pmesh", { base: dracoBase(draco) });
export function dracoBase(draco) {
    return (bytes, vertices, faces) => {
        const made = [];
        const make = (Type) => {
            made.push(new draco[Type]());
            return made.at(-1);
        };
        try {
            return decode(draco, make, bytes, vertices, faces);
        } finally {
            made.forEach((object) => draco.destroy(object));
        }
    };
}

// null: not what the file says it is.
function decode(draco, make, bytes, vertices, faces) {
    const buffer = make("DecoderBuffer"), decoder = make("Decoder");
    const mesh = make("Mesh");
    buffer.Init(new Int8Array(bytes.buffer), bytes.length);
    const status = decoder.DecodeBufferToMesh(buffer, mesh);
    if (!status.ok() || mesh.num_points() !== vertices ||
        mesh.num_faces() !== faces)
        return null;
    const id = decoder.GetAttributeId(mesh, draco.POSITION);
    if (id < 0)
        return null;
    const attribute = decoder.GetAttribute(mesh, id);
    if (attribute.num_components() !== 3 ||
        attribute.data_type() !== draco.DT_INT32)
        return null;
    const take = (count, fill) => {
        const at = draco._malloc(4 * count);
        try {
            fill(4 * count, at);
            return new Int32Array(draco.HEAPF32.buffer, at, count).slice();
        } finally {
            draco._free(at);
        }
    };
    return {
        indices: take(3 * faces, (size, at) =>
            decoder.GetTrianglesUInt32Array(mesh, size, at)),
        positions: take(3 * vertices, (size, at) =>
            decoder.GetAttributeDataArrayForAllPoints(mesh, attribute,
                draco.DT_INT32, size, at)),
    };
}
