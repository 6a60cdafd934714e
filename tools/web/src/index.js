// SPDX-License-Identifier: MIT
// pmesh: a mesh that sharpens while it loads.
//
//   const mesh = await open("bunny.pmesh", { faces: 50_000 });
//   for await (const changes of mesh.stream())
//       upload(mesh, changes);
import { Decoder, ready } from "./decoder.js";
import { Loading } from "./load.js";
import { PmeshError, supported } from "./module.js";
import { Source } from "./source.js";

export { Decoder, PmeshError, Source, ready, supported };

// Resolves when the base mesh can be shown. `input`: URL, Response,
// ReadableStream, Blob, ArrayBuffer or a view.
export async function open(input, options = {}) {
    const mesh = new Mesh(new Source(input, options), options);
    await mesh.start();
    return mesh;
}

// A decoder that reads for itself.
export class Mesh extends Loading {
    constructor(source, options) {
        super(source, () => Decoder.create(options));
    }

    get positions() {
        return this.decoder.positions;
    }

    get indices() {
        return this.decoder.indices;
    }

    get attributes() {
        return this.decoder.attributes;
    }

    get vertexCount() {
        return this.decoder.vertexCount;
    }

    sorted() {
        return this.decoder.sorted();
    }

    morph(coarse) {
        return this.decoder.morph(coarse);
    }

    inflated() {
        return this.decoder.inflated();
    }
}
