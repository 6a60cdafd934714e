// SPDX-License-Identifier: MIT
// Usage: MESHOPT_JS=.../meshopt_simplifier.js node attributes.mjs DIR WEIGHTS
//        INDEX_COUNT [update]
// Simplifies the arrays in DIR with meshoptimizer, in place; see
// bench_attributes.cpp. WEIGHTS are separated by commas.
import { readFileSync, writeFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';

const [dir, list, count, update] = process.argv.slice(2);
const { MeshoptSimplifier } = await import(
    pathToFileURL(process.env.MESHOPT_JS));
await MeshoptSimplifier.ready;

const read = (name, Type) => {
    const bytes = readFileSync(`${dir}/${name}`);
    return new Type(bytes.buffer.slice(bytes.byteOffset,
                                       bytes.byteOffset + bytes.length));
};
let indices = read('indices', Uint32Array);
const positions = read('positions', Float32Array);
const attributes = read('attributes', Float32Array);
const weights = list.split(',').map(Number);
const width = weights.length;
const args = [positions, 3, attributes, width, weights, null, Number(count),
              1e9];
if (update) {
    const [kept] = MeshoptSimplifier.simplifyWithUpdate(indices, ...args);
    indices = indices.subarray(0, kept);
    writeFileSync(`${dir}/positions`, positions);
    writeFileSync(`${dir}/attributes`, attributes);
} else {
    [indices] = MeshoptSimplifier.simplifyWithAttributes(indices, ...args);
}
writeFileSync(`${dir}/indices`, indices);
