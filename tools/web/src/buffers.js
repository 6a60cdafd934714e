// SPDX-License-Identifier: MIT
// The buffers of a progressive mesh as attributes of three.js. They are made
// once and are as large as full detail needs; what changed is sent again, and
// nothing else.
import { BufferAttribute, Sphere, Vector3 } from "three";

const NAMES = { normal: "normal", texcoord: "uv", color: "color" };

// The attributes that three knows, of a mesh that tells no more.
function usualChannels(attributes) {
    return attributes.map((a, channel) => ({
        name: a.kind in NAMES && NAMES[a.kind] +
            (a.kind !== "normal" && a.set ? a.set : ""),
        channel,
    })).filter(({ name }) => name);
}

export class Buffers {
    attributes = {};
    index;
    groups = [];
    #source; // Mesh, RemoteMesh or Detail of pmesh
    #options;
    #entries = []; // { attribute, size, view } or { attribute, size, derive }

    // channels: { name, channel } each, and `derive` if the values are not
    // those of the file: (out, first, end) fills that range of vertices.
    // normals: makes them if there are none. sorted: faces by material.
    constructor(source, options) {
        const { channels = usualChannels(source.attributes), inflate, morph,
            sorted } = options;
        this.#source = source;
        this.#options = options;
        if (inflate && morph)
            throw new TypeError("morph is not for inflated meshes");
        this.#add("position", 3, morph ? { derive: (out, first, end) => {
            out.set(source.positions.subarray(3 * first, 3 * end), 3 * first);
        } } : { view: () => inflate ? source.inflated() : source.positions });
        for (const { name, channel, components, derive } of channels)
            this.#add(name, components ?? source.attributes[channel].components,
                derive ? { derive } :
                    { view: () => source.attributes[channel].values });
        if (options.normals && !this.attributes.normal)
            this.attributes.normal = new BufferAttribute(
                new Float32Array(source.positions.length), 3);
        else
            this.#options = { ...options, normals: false };
        this.index = new BufferAttribute(
            sorted ? source.sorted().indices : source.indices, 1);
        this.#refresh();
    }

    #add(name, size, how) {
        const { vertices } = this.#source.header;
        const attribute = new BufferAttribute(
            how.view?.() ?? new Float32Array(size * vertices), size);
        how.derive?.(attribute.array, 0, this.#source.vertexCount);
        this.attributes[name] = attribute;
        this.#entries.push({ attribute, size, ...how });
    }

    // Takes a change of the source; sends it with the next frame.
    update({ vertices, faces }) {
        const { inflate, sorted } = this.#options, source = this.#source;
        this.moveAlong();
        for (const { attribute, size, derive } of this.#entries) {
            if (derive)
                for (const { first, count } of vertices)
                    derive(attribute.array, first, first + count);
            mark(attribute, vertices, size);
        }
        if (!sorted)
            mark(this.index, faces, 3);
        if (inflate)
            mark(this.attributes.position, all(source.vertexCount), 3);
        this.#refresh();
    }

    // The memory that the views looked at may have grown, and left them empty.
    moveAlong() {
        for (const { attribute, view } of this.#entries)
            if (view && attribute.array.length === 0)
                attribute.array = view();
        if (this.index.array.length === 0)
            this.index.array = this.#options.sorted ?
                this.#source.sorted().indices : this.#source.indices;
    }

    // What depends on all visible faces.
    #refresh() {
        const { faceCount } = this.#source, { inflate, normals, sorted } =
            this.#options;
        if (sorted) {
            this.groups = this.#source.sorted().groups;
            mark(this.index, all(faceCount), 3);
        } else {
            this.groups = [{ material: 0, first: 0, count: faceCount }];
        }
        if (inflate)
            this.#source.inflated();
        if (normals)
            this.#makeNormals();
    }

    // Smooth normals, weighed by area.
    #makeNormals() {
        const { indices, faceCount, vertexCount } = this.#source;
        const { position, normal } = this.attributes, p = position.array;
        const n = normal.array;
        n.fill(0, 0, 3 * vertexCount);
        for (let i = 0; i < 3 * faceCount; i += 3)
            addNormal(n, p, 3 * indices[i], 3 * indices[i + 1],
                3 * indices[i + 2]);
        mark(normal, all(vertexCount), 3);
    }

    // Positions from + t (to - from), `to` being those of the visible mesh, of
    // the vertices from `first` on.
    blend(from, first, t) {
        const { position } = this.attributes, out = position.array;
        const to = this.#source.positions, end = 3 * this.#source.vertexCount;
        for (let i = 3 * first; i < end; i++)
            out[i] = t < 1 ? from[i] + t * (to[i] - from[i]) : to[i];
        mark(position, [{ first, count: end / 3 - first }], 3);
    }
}

function all(count) {
    return [{ first: 0, count }];
}

// three forgets ranges when it has sent them; an object that is not drawn must
// not collect them without end.
const MOST_RANGES = 256;

function mark(attribute, ranges, size) {
    if (ranges.length === 0)
        return;
    if (attribute.updateRanges.length + ranges.length > MOST_RANGES) {
        attribute.clearUpdateRanges();
        ranges = all(attribute.array.length / size);
    }
    for (const { first, count } of ranges)
        attribute.addUpdateRange(size * first, size * count);
    attribute.needsUpdate = true;
}

function addNormal(n, p, a, b, c) {
    const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
    const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    for (const v of [a, b, c]) {
        n[v] += x;
        n[v + 1] += y;
        n[v + 2] += z;
    }
}

// Around the grid: every level lies in it.
export function sphereOf({ origin, step, bounds }) {
    const size = new Vector3(...bounds).multiplyScalar(step / 2);
    return new Sphere(new Vector3(...origin).add(size), size.length());
}
