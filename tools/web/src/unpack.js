// SPDX-License-Identifier: MIT
// The document of a scene, unpacked: a zlib stream, which may claim any size.
import { PmeshError } from "./module.js";

const MOST = 2 ** 28, VALUE = 64;
const COMMA = 44, LIST = 91, OBJECT = 123, QUOTE = 34, BACKSLASH = 92;

// Counts the values of JSON that comes in pieces, as SPEC.md 11.4 says.
function counter() {
    let quoted = false, escaped = false;
    return (piece) => {
        let values = 0;
        for (const byte of piece) {
            if (!quoted)
                values += byte === COMMA || byte === LIST || byte === OBJECT;
            if (byte === QUOTE && !escaped)
                quoted = !quoted;
            escaped = quoted && byte === BACKSLASH && !escaped;
        }
        return values;
    };
}

// The text and 64 bytes a value have to fit into 64 MiB and 256 times what is
// stored, as in the native program.
export async function unpack(bytes) {
    const valuesOf = counter();
    let text = MOST, room = 2 ** 26 + 256 * bytes.length - VALUE;
    const bounded = new TransformStream({
        transform(piece, controller) {
            text -= piece.length;
            room -= piece.length + VALUE * valuesOf(piece);
            if (text < 0 || room < 0)
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
