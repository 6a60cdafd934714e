// SPDX-License-Identifier: MIT
// The document of a scene, unpacked: a zlib stream, which may claim any size.
import { PmeshError } from "./module.js";

const MOST = 2 ** 28;

// As much as the native program takes: 64 MiB and 256 times what is stored.
export async function unpack(bytes) {
    let room = Math.min(MOST, 2 ** 26 + 256 * bytes.length);
    const bounded = new TransformStream({
        transform(piece, controller) {
            room -= piece.length;
            if (room < 0)
                throw new PmeshError(
                    "the document unpacks to more than its size allows",
                    "limit");
            controller.enqueue(piece);
        },
    });
    const stream = new Blob([bytes]).stream()
        .pipeThrough(new DecompressionStream("deflate")).pipeThrough(bounded);
    return new Response(stream).text();
}
