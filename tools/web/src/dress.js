// SPDX-License-Identifier: MIT
// The document of a .pmesh scene with accessors put in, so that GLTFLoader makes
// its objects, materials and skins from it: those of the base meshes.
import { Buffers, sphereOf } from "./buffers.js";
import { channelsOf } from "./channels.js";

const FLOAT = 5126, UNSIGNED_SHORT = 5123, UNSIGNED_INT = 5125;
const TYPES = ["", "SCALAR", "VEC2", "VEC3", "VEC4"];

// Returns { json, coarse }: coarse is the buffer that was added.
export function dress(json, scene, extension) {
    scene.refine({ faces: 1 });
    for (const list of ["accessors", "bufferViews", "buffers"])
        json[list] ??= [];
    const coarse = new Coarse(json);
    for (const { primitives } of json.meshes ?? [])
        for (const primitive of primitives) {
            const record = primitive.extensions?.[extension];
            if (record)
                dressOne(primitive, record, scene, coarse);
        }
    return { json, coarse: coarse.finish() };
}

function dressOne(primitive, record, scene, coarse) {
    const source = scene.meshes[record.mesh];
    if (!source)
        throw new TypeError(`${record.mesh}: the scene has no such mesh`);
    const channels = channelsOf(source, record);
    const { attributes, groups, index } = new Buffers(source, {
        channels, sorted: source.header.materialCount > 1,
    });
    const count = source.vertexCount;
    const of = (name, components) =>
        attributes[name].array.slice(0, components * count);
    primitive.attributes = {
        POSITION: coarse.add(of("position", 3), 3, boxOf(source.header)),
    };
    for (const { semantic, name, components } of channels)
        primitive.attributes[semantic] = coarse.add(
            semantic.startsWith("JOINTS_") ?
                Uint16Array.from(of(name, components)) : of(name, components),
            components);
    const group = groups.length > 1 ? groups[record.material] : groups[0];
    primitive.indices = coarse.add(group?.count > 0 ?
        Uint32Array.from(index.array.subarray(3 * group.first,
            3 * (group.first + group.count))) : new Uint32Array(3), 1);
    if (record.targets)
        primitive.targets = record.targets.map((target) => {
            const zeros = new Float32Array(3 * count);
            return Object.fromEntries(Object.keys(target).map((semantic) =>
                [semantic, coarse.add(zeros, 3,
                    semantic === "POSITION" ? boxOf(source.header) : {})]));
        });
}

function boxOf(header) {
    const { center, radius } = sphereOf(header);
    return {
        min: center.toArray().map((c) => c - radius),
        max: center.toArray().map((c) => c + radius),
    };
}

// The buffer behind the others.
class Coarse {
    #json;
    #pieces = [];
    #size = 0;

    constructor(json) {
        this.#json = json;
        this.number = json.buffers.length;
    }

    // The number of an accessor to `array`.
    add(array, components, bounds = {}) {
        const { bufferViews, accessors } = this.#json;
        bufferViews.push({
            buffer: this.number, byteOffset: this.#size,
            byteLength: array.byteLength,
        });
        this.#pieces.push(array);
        this.#size += Math.ceil(array.byteLength / 4) * 4;
        accessors.push({
            bufferView: bufferViews.length - 1,
            componentType: array instanceof Float32Array ? FLOAT :
                array instanceof Uint16Array ? UNSIGNED_SHORT : UNSIGNED_INT,
            count: array.length / components,
            type: TYPES[components],
            ...bounds,
        });
        return accessors.length - 1;
    }

    finish() {
        const data = new Uint8Array(this.#size);
        let at = 0;
        for (const { buffer, byteOffset, byteLength } of this.#pieces) {
            data.set(new Uint8Array(buffer, byteOffset, byteLength), at);
            at += Math.ceil(byteLength / 4) * 4;
        }
        this.#json.buffers.push({ byteLength: this.#size });
        return { number: this.number, data: data.buffer };
    }
}

// Materials as they look before their textures are there: no metal, which is
// black where nothing is reflected.
export function withoutTextures(materials) {
    return materials && JSON.parse(JSON.stringify(materials), (key, value) => {
        if (/texture$/i.test(key))
            return undefined;
        return key === "pbrMetallicRoughness" ?
            { ...value, metallicFactor: 0, roughnessFactor: 0.8 } : value;
    });
}
