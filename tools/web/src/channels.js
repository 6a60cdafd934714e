// SPDX-License-Identifier: MIT
// Attributes of a glTF primitive from the channels of its mesh, as a record of
// PMESH_progressive tells (SPEC 11.4): under the names that GLTFLoader gives,
// and made valid where quantised values are not quite.
import { BufferAttribute } from "three";

const SIZES = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };
const NAMES = {
    POSITION: "position", NORMAL: "normal", TANGENT: "tangent",
    TEXCOORD_0: "uv", TEXCOORD_1: "uv1", TEXCOORD_2: "uv2", TEXCOORD_3: "uv3",
    COLOR_0: "color", WEIGHTS_0: "skinWeight", JOINTS_0: "skinIndex",
};

export function channelsOf(source, { attributes }) {
    return Object.entries(attributes)
        .filter(([semantic]) => semantic !== "POSITION")
        .map(([semantic, form]) => {
            const channel = channelOf(source, form);
            return {
                name: NAMES[semantic] ?? semantic.toLowerCase(),
                semantic, channel, components: SIZES[form.type],
                derive: deriverOf(source, semantic, form, attributes),
            };
        });
}

function channelOf(source, { channel, type }) {
    const width = source.attributes[channel]?.components ?? 0;
    if (!(SIZES[type] <= width))
        throw new TypeError("PMESH_progressive: no such channel");
    return channel;
}

// How values differ from those of the file; undefined: they do not.
function deriverOf(source, semantic, form, attributes) {
    const size = SIZES[form.type];
    const { components: width } = source.attributes[form.channel];
    const values = () => source.attributes[form.channel].values;
    if (semantic === "TANGENT" && size === 4)
        return (out, first, end) =>
            tidyTangents(out, values(), width, first, end);
    if (semantic === "WEIGHTS_0" && size === 4)
        return (out, first, end) =>
            tidyWeights(out, values(), width, first, end);
    if (semantic === "JOINTS_0" && size === 4) {
        const { channel } = attributes.WEIGHTS_0 ?? {};
        return (out, first, end) => tidyJoints(out, values(), width,
            source.attributes[channel], first, end);
    }
    if (size === width && !form.exact)
        return undefined;
    return (out, first, end) => {
        const from = values();
        for (let v = first; v < end; v++)
            for (let k = 0; k < size; k++) {
                const value = from[width * v + k];
                out[size * v + k] = form.exact ? Math.round(value) : value;
            }
    };
}

// Unit vectors with a handedness of 1 or -1.
function tidyTangents(out, from, width, first, end) {
    for (let v = first; v < end; v++) {
        const [x, y, z, w] = from.subarray(width * v, width * v + 4);
        const length = Math.hypot(x, y, z);
        if (length > 0)
            out.set([x / length, y / length, z / length], 4 * v);
        else
            out.set([1, 0, 0], 4 * v);
        out[4 * v + 3] = w < 0 ? -1 : 1;
    }
}

// Their sum is 1.
function tidyWeights(out, from, width, first, end) {
    for (let v = first; v < end; v++) {
        let sum = 0;
        for (let k = 0; k < 4; k++)
            sum += Math.max(from[width * v + k], 0);
        for (let k = 0; k < 4; k++)
            out[4 * v + k] = sum > 0 ?
                Math.max(from[width * v + k], 0) / sum : Number(k === 0);
    }
}

// One without weight is joint 0.
function tidyJoints(out, from, width, weights, first, end) {
    for (let v = first; v < end; v++)
        for (let k = 0; k < 4; k++)
            out[4 * v + k] = !weights ||
                weights.values[weights.components * v + k] > 0 ?
                Math.round(from[width * v + k]) : 0;
}

// Morph targets: attributes by name, a list each. three packs them into a
// texture once, so a geometry that has some is sent whole after each change.
export function targetsOf(source, { targets = [] }) {
    const attributes = {}, updates = [];
    for (const target of targets)
        for (const [semantic, form] of Object.entries(target)) {
            const name = NAMES[semantic], size = SIZES[form.type];
            const { components: width } =
                source.attributes[channelOf(source, form)];
            const made = new BufferAttribute(
                new Float32Array(size * source.header.vertices), size);
            const fill = (first, end) => {
                const from = source.attributes[form.channel].values;
                for (let v = first; v < end; v++)
                    for (let k = 0; k < size; k++)
                        made.array[size * v + k] = from[width * v + k];
            };
            fill(0, source.vertexCount);
            updates.push(fill);
            (attributes[name] ??= []).push(made);
        }
    return {
        attributes,
        update(geometry, { vertices }) {
            for (const fill of updates)
                for (const { first, count } of vertices)
                    fill(first, first + count);
            if (updates.length > 0)
                geometry.dispose();
        },
    };
}
