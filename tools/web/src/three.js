// SPDX-License-Identifier: MIT
// pmesh/three: a progressive mesh as an object of three.js, and scenes by its
// GLTFLoader (gltf.js).
//
//   const object = new ProgressiveMesh(await open("bunny.pmesh"), material);
//   scene.add(object);
//   await object.stream({ faces: 50_000 });
import { BufferGeometry, Mesh } from "three";
import { Buffers, sphereOf } from "./buffers.js";

export { sphereOf };
export { ProgressivePlugin, load } from "./gltf.js";

export class ProgressiveMesh extends Mesh {
    #source; // Mesh or RemoteMesh of pmesh
    #options;
    #buffers;
    #moving = null; // between two levels

    // normals: false leaves a mesh without normals as it is (flat shading
    // needs none). inflate: coarse levels swell to the volume of the full mesh.
    // morph: morphTo() will be called. The source is to be opened with the same
    // { inflate } or { morph }, and is not one of a worker then.
    constructor(source, material,
        { normals = true, inflate = false, morph = false } = {}) {
        super(new BufferGeometry(), material);
        this.isProgressiveMesh = true;
        this.#source = source;
        this.#options = { normals, inflate, morph };
        this.#bind();
    }

    get source() {
        return this.#source;
    }

    #bind() {
        const g = this.geometry, source = this.#source;
        this.#buffers = new Buffers(source, {
            ...this.#options,
            sorted: source.sorted && source.header.materialCount > 1 &&
                Array.isArray(this.material),
        });
        for (const [name, attribute] of Object.entries(this.#buffers.attributes))
            g.setAttribute(name, attribute);
        g.setIndex(this.#buffers.index);
        g.boundingSphere = sphereOf(source.header);
        if (this.#options.inflate) // by less than a vertex's way to others
            g.boundingSphere.radius *= 3;
        this.#draw();
    }

    #draw() {
        const g = this.geometry;
        g.setDrawRange(0, 3 * this.#source.faceCount);
        g.clearGroups();
        if (Array.isArray(this.material))
            for (const { material, first, count } of this.#buffers.groups)
                if (count > 0)
                    g.addGroup(3 * first, 3 * count, material);
    }

    // Sends the ranges of a change to the graphics card with the next frame.
    update(changes) {
        this.#arrive();
        if (changes.restarted) {
            this.geometry.dispose();
            this.geometry = new BufferGeometry();
            this.#bind();
        } else if (changes.faces.length + changes.vertices.length > 0 ||
            this.geometry.drawRange.count !== 3 * this.#source.faceCount) {
            this.#buffers.update(changes);
            this.#draw();
        }
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

    // The same, not at once: while tick() is called, new vertices leave those
    // they were split from for their own places, evenly within `milliseconds`,
    // and the other way round if the target is coarser.
    morphTo(target, milliseconds = 300) {
        this.#arrive();
        const source = this.#source, before = source.faceCount;
        const coarse = { faces: before };
        const changes = source.refine(target);
        const finer = source.faceCount > before;
        if (source.faceCount < before) {
            source.refine(coarse); // and what changed is as it was
            this.#move(source.morph(target), false, target, milliseconds);
        } else if (changes) {
            this.update(changes);
            if (finer)
                this.#move(source.morph(coarse), true, target, milliseconds);
        }
    }

    #move(from, finer, target, milliseconds) {
        const to = this.#source.positions, n = from.length;
        let first = 0;
        while (first < n && from[first] === to[first])
            first++;
        this.#moving = {
            from, first: Math.floor(first / 3), finer, target, milliseconds,
            passed: 0,
        };
        this.tick(0);
    }

    // Goes on with morphTo(); false once it has arrived.
    tick(milliseconds) {
        const m = this.#moving;
        if (!m)
            return false;
        m.passed += milliseconds;
        const part = Math.min(m.passed / m.milliseconds, 1);
        if (part === 1)
            this.#arrive();
        else
            this.#buffers.blend(m.from, m.first, m.finer ? part : 1 - part);
        return part < 1;
    }

    #arrive() {
        const m = this.#moving;
        this.#moving = null;
        if (!m)
            return;
        this.#buffers.blend(m.from, m.first, 1);
        if (!m.finer)
            this.refine(m.target);
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
