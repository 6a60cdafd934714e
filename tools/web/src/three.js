// SPDX-License-Identifier: MIT
// pmesh/three: a progressive mesh as an object of three.js. Buffers are made
// once and are as large as full detail needs; what changed is sent again, and
// nothing else.
//
//   const object = new ProgressiveMesh(await open("bunny.pmesh"), material);
//   scene.add(object);
//   await object.stream({ faces: 50_000 });
import {
    BufferAttribute, BufferGeometry, Mesh, Sphere, Vector3,
} from "three";

const NAMES = { normal: "normal", texcoord: "uv", color: "color" };

export class ProgressiveMesh extends Mesh {
    #source;       // Mesh or RemoteMesh of pmesh
    #ownNormals;   // the file has none: made of the visible faces

    // normals: false leaves a mesh without normals as it is (flat shading
    // needs none).
    constructor(source, material, { normals = true } = {}) {
        super(new BufferGeometry(), material);
        this.isProgressiveMesh = true;
        this.#source = source;
        this.#ownNormals = normals &&
            !source.attributes.some((a) => a.kind === "normal");
        this.#bind();
    }

    get source() {
        return this.#source;
    }

    #bind() {
        const g = this.geometry, source = this.#source;
        this.#set("position", source.positions, 3);
        for (const a of source.attributes)
            if (a.kind in NAMES)
                this.#set(NAMES[a.kind] + (a.kind !== "normal" && a.set ?
                    a.set : ""), a.values, a.components);
        if (this.#ownNormals)
            this.#set("normal", new Float32Array(source.positions.length), 3);
        g.setIndex(new BufferAttribute(source.indices, 1));
        g.boundingSphere = sphereOf(source.header);
        this.#refresh();
    }

    #set(name, array, size) {
        this.geometry.setAttribute(name, new BufferAttribute(array, size));
    }

    // Sends the ranges of a change to the graphics card with the next frame.
    update(changes) {
        const g = this.geometry, source = this.#source;
        if (changes.restarted) {
            this.geometry.dispose();
            this.geometry = new BufferGeometry();
            this.#bind();
            return;
        }
        for (const name in g.attributes)
            if (name !== "normal" || !this.#ownNormals)
                mark(g.attributes[name], changes.vertices,
                    g.attributes[name].itemSize);
        if (!this.#isSorted)
            mark(g.index, changes.faces, 3);
        if (changes.faces.length + changes.vertices.length > 0 ||
            g.drawRange.count !== 3 * source.faceCount)
            this.#refresh();
    }

    get #isSorted() {
        return this.#source.header.materialCount > 1 &&
            Array.isArray(this.material);
    }

    // What depends on all visible faces.
    #refresh() {
        this.geometry.setDrawRange(0, 3 * this.#source.faceCount);
        if (this.#isSorted)
            this.#sort();
        if (this.#ownNormals)
            this.#makeNormals();
    }

    // Several materials: faces sorted by them, a group each.
    #sort() {
        const { indices, groups } = this.#source.decoder.sorted(), g = this.geometry;
        if (g.index.array !== indices)
            g.setIndex(new BufferAttribute(indices, 1));
        mark(g.index, [{ first: 0, count: this.#source.faceCount }], 3);
        g.clearGroups();
        for (const { material, first, count } of groups)
            if (count > 0)
                g.addGroup(3 * first, 3 * count, material);
    }

    // Smooth normals, weighed by area.
    #makeNormals() {
        const { positions: p, indices, faceCount, vertexCount } = this.#source;
        const attribute = this.geometry.attributes.normal, n = attribute.array;
        n.fill(0, 0, 3 * vertexCount);
        for (let i = 0; i < 3 * faceCount; i += 3)
            addNormal(n, p, 3 * indices[i], 3 * indices[i + 1],
                3 * indices[i + 2]);
        mark(attribute, [{ first: 0, count: vertexCount }], 3);
    }

    // Moves to a target among what is decoded.
    refine(target) {
        const changes = this.#source.refine(target);
        if (changes?.then)
            return changes.then((c) => c && this.update(c));
        if (changes)
            this.update(changes);
        return changes;
    }

    // Reads until the target can be shown, sharpening on the way; `seen` is
    // called after each step.
    async stream(target, seen = () => {}) {
        for await (const changes of this.#source.stream(target)) {
            this.update(changes);
            await seen(changes);
        }
    }

    // Has three's own ray cast look at the visible faces only.
    raycast(raycaster, hits) {
        const sphere = this.geometry.boundingSphere.clone();
        if (raycaster.ray.intersectsSphere(sphere.applyMatrix4(
            this.matrixWorld)))
            super.raycast(raycaster, hits);
    }

    dispose() {
        this.geometry.dispose();
        this.#source.dispose();
    }
}

// three forgets ranges when it has sent them; an object that is not drawn must
// not collect them without end.
const MOST_RANGES = 256;

function mark(attribute, ranges, size) {
    if (ranges.length === 0)
        return;
    if (attribute.updateRanges.length + ranges.length > MOST_RANGES) {
        attribute.clearUpdateRanges();
        ranges = [{ first: 0, count: attribute.array.length / size }];
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
function sphereOf({ origin, step, bounds }) {
    const size = new Vector3(...bounds).multiplyScalar(step / 2);
    return new Sphere(new Vector3(...origin).add(size), size.length());
}
