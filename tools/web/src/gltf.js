// SPDX-License-Identifier: MIT
// Scenes by three's GLTFLoader, sharpening while they load:
//
//   const gltf = await load("scene.glb", new GLTFLoader());   // or .pmesh
//   scene.add(gltf.scene);                        // the base meshes are there
//   await gltf.progressive.done;
//
// A .glb or .gltf has the extension PMESH_progressive: coarse meshes that every
// loader shows, and the stream of a scene file. A .pmesh scene is the other way
// round: its document is glTF without geometry (SPEC 11.4), which gets that of
// the base meshes here. In both, the plugin then puts the stream's buffers in
// the place of the coarse ones.
import { BufferGeometry, LoaderUtils } from "three";
import { Buffers, sphereOf } from "./buffers.js";
import { channelsOf, targetsOf } from "./channels.js";
import { dress, withoutTextures } from "./dress.js";
import { PmeshError } from "./module.js";
import { Scene } from "./scene.js";
import { Source } from "./source.js";
import { Rest, readHead } from "./rest.js";

const NAME = "PMESH_progressive";

// For loader.register((parser) => new ProgressivePlugin(parser, options)).
// options: those of openScene(); `target` as that of stream(), {} for all;
// `changed`, called with the handle after each step, which may return a
// promise to wait for. The result of the loader gets the handle as
// `progressive`, if the file has the extension.
export class ProgressivePlugin {
    name = NAME;
    #parser;
    #options;
    #scene;      // of pmesh; of a .glb made by afterRoot()
    #late = new Map(); // what is not there yet -> { promise, resolve, take }
    #left = null; // of the document: what is added when that is there

    constructor(parser, options = {}) {
        this.#parser = parser;
        this.#options = options;
        this.#scene = options.scene ?? null;
    }

    get #extension() {
        return this.#parser.json.extensions?.[NAME];
    }

    // Where only a part of the file is there, shapes come first.
    beforeRoot() {
        const { json } = this.#parser;
        if (!this.#options.scene && !this.#options.tail)
            return null;
        this.#left = { materials: json.materials, animations: json.animations };
        json.materials = withoutTextures(json.materials);
        delete json.animations;
        return null;
    }

    // A buffer of a .pmesh scene is a resource, and a view may lie in the tail of
    // a .glb; null leaves it to the loader.
    loadBufferView(number) {
        const { scene, tail } = this.#options;
        const { bufferViews } = this.#parser.json, view = bufferViews[number];
        const first = view.byteOffset ?? 0, size = view.byteLength;
        if (scene)
            return this.#buffer(view.buffer).then((buffer) =>
                buffer.slice(first, first + size));
        if (!tail || view.buffer !== 0)
            return null;
        const start = bufferViews[this.#extension.bufferView].byteOffset ?? 0;
        return first < start ? null : this.#wait(`view ${number}`, () =>
            tail.take(first - start, size)?.buffer);
    }

    #buffer(number) {
        const { scene, coarse } = this.#options;
        return number === coarse.number ? Promise.resolve(coarse.data) :
            this.#wait(number, () => scene.resource(number)?.buffer);
    }

    // `take` gives something as soon as it is there.
    #wait(key, take) {
        const bytes = take();
        if (bytes)
            return Promise.resolve(bytes);
        if (!this.#late.has(key))
            this.#late.set(key, { ...deferred(), take });
        return this.#late.get(key).promise;
    }

    async afterRoot(result) {
        const { bufferView, uri } = this.#extension ?? {};
        if (!this.#scene && bufferView === undefined && uri === undefined)
            return;
        const handle = new Progressive(this.#parser, result, this.#options,
            await this.#primitives());
        result.progressive = handle;
        if (this.#scene)
            handle.begin(this.#scene);
        handle.done = this.#run(handle);
        // Told to those who wait for it.
        handle.done.catch((error) => handle.fail(error));
    }

    // Primitives by their accessor of indices, which copies of an object share;
    // the loader tells places in the file for one of its scenes only.
    async #primitives() {
        const places = new Map();
        for (const { primitives } of this.#parser.json.meshes ?? [])
            for (const primitive of primitives)
                if (primitive.extensions?.[NAME])
                    places.set(await this.#parser.getDependency("accessor",
                        primitive.indices ?? primitive.attributes.POSITION),
                    primitive);
        return places;
    }

    async #run(handle) {
        if (!this.#scene) {
            this.#scene = new Scene(await this.#open(), this.#options);
            await this.#scene.start();
            handle.begin(this.#scene);
        }
        handle.arrived = () => this.#arrive();
        const looks = this.#finish(handle);
        looks.catch(() => {});
        await handle.stream(this.#options.target);
        if (this.#scene.progress.complete)
            await looks;
    }

    // Where the stream of a .glb or .gltf is.
    async #open() {
        const { bufferView, uri } = this.#extension, { tail } = this.#options;
        if (tail)
            return tail;
        if (uri === undefined)
            return new Source(await this.#parser.getDependency("bufferView",
                bufferView));
        const { path } = this.#parser.options;
        return new Source(LoaderUtils.resolveURL(uri, path), this.#options);
    }

    // Gives what has come to those who wait for it.
    #arrive() {
        for (const [key, { resolve, take }] of this.#late) {
            const bytes = take();
            if (bytes) {
                this.#late.delete(key);
                resolve(bytes);
            }
        }
    }

    // Textures and animations, as they arrive.
    async #finish(handle) {
        const { json, cache } = this.#parser;
        if (!this.#left)
            return;
        Object.assign(json, this.#left);
        const { materials = [], animations = [] } = json;
        await Promise.all([
            ...materials.map(async (unused, i) => {
                cache.remove(`material:${i}`);
                handle.dress(i, await this.#parser.getDependency("material", i));
            }),
            ...animations.map(async (unused, i) =>
                handle.result.animations.push(
                    await this.#parser.getDependency("animation", i))),
        ]);
    }
}

// What a loaded scene can do besides: `scene` is that of pmesh.
export class Progressive {
    scene = null;
    arrived = () => {}; // for the plugin: more of the file is there
    ready; // promise: the stream's base meshes are there, and `scene`
    done = null; // promise: what `target` asks for is there, or all there is
    result;
    #parser;
    #options;
    #primitives;
    #begun = deferred();
    #buffers = new Map(); // of a mesh with a set of attributes -> Buffers
    #parts = new Map(); // mesh of the stream -> [{ buffers, geometry, ... }]

    constructor(parser, result, options, primitives) {
        this.#parser = parser;
        this.result = result;
        this.#options = options;
        this.#primitives = primitives;
        this.ready = this.#begun.promise;
    }

    // Puts the stream's buffers in the place of the coarse ones.
    begin(scene) {
        this.scene = scene;
        scene.refine({ faces: 1 });
        const geometries = new Map(); // by primitive, which may be in many places
        for (const object of this.#objects()) {
            const { index, attributes } = object.geometry;
            const primitive = this.#primitives.get(index ?? attributes.position);
            if (!primitive)
                continue;
            if (!geometries.has(primitive))
                geometries.set(primitive,
                    this.#makeGeometry(primitive.extensions[NAME]));
            object.geometry.dispose();
            object.geometry = geometries.get(primitive);
        }
        this.refine(this.#options.target);
        this.#begun.resolve(scene);
    }

    fail(error) {
        this.#begun.reject(error);
    }

    *#objects() {
        for (const scene of this.result.scenes) {
            const found = [];
            scene.traverse((object) => object.isMesh && found.push(object));
            yield* found;
        }
    }

    // Primitives of one stream share them.
    #buffersOf(source, record) {
        const key = `${record.mesh} ${JSON.stringify(record.attributes)}`;
        if (!this.#buffers.has(key))
            this.#buffers.set(key, new Buffers(source, {
                channels: channelsOf(source, record),
                sorted: source.header.materialCount > 1,
            }));
        return this.#buffers.get(key);
    }

    #makeGeometry(record) {
        const source = this.scene.meshes[record.mesh], g = new BufferGeometry();
        const buffers = this.#buffersOf(source, record);
        for (const [name, attribute] of Object.entries(buffers.attributes))
            g.setAttribute(name, attribute);
        g.setIndex(buffers.index);
        g.boundingSphere = sphereOf(source.header);
        const targets = targetsOf(source, record);
        Object.assign(g.morphAttributes, targets.attributes);
        g.morphTargetsRelative = true;
        const part = { buffers, geometry: g, material: record.material, targets };
        if (!this.#parts.has(record.mesh))
            this.#parts.set(record.mesh, []);
        this.#parts.get(record.mesh).push(part);
        draw(part);
        return g;
    }

    // Sends what changed with the next frame.
    update({ meshes, restarted }) {
        if (restarted)
            throw new PmeshError("the file was replaced", "http");
        for (const buffers of this.#buffers.values())
            buffers.moveAlong();
        for (const changes of meshes) {
            const parts = this.#parts.get(changes.mesh) ?? [];
            for (const buffers of new Set(parts.map((part) => part.buffers)))
                buffers.update(changes);
            for (const part of parts) {
                part.targets.update(part.geometry, changes);
                draw(part);
            }
        }
    }

    // Moves to { faces, error, bytes } among what is decoded; faces are those of
    // all meshes together, error in units of the world.
    refine(target) {
        const changes = this.scene.refine(target);
        if (changes)
            this.update(changes);
        return changes;
    }

    // Reads until the target can be shown, sharpening on the way.
    async stream(target, seen = () => {}) {
        for await (const changes of this.scene.stream(target)) {
            this.update(changes);
            this.arrived();
            seen(changes);
            await this.#options.changed?.(this);
        }
        this.arrived();
    }

    // The loader's own material, with its textures.
    dress(number, material) {
        const { associations } = this.#parser;
        for (const object of this.#objects())
            if (associations.get(object.material)?.materials === number) {
                object.material = material;
                this.#parser.assignFinalMaterial(object);
            }
        this.#options.changed?.(this);
    }

    dispose() {
        this.scene?.dispose();
        for (const parts of this.#parts.values())
            for (const { geometry } of parts)
                geometry.dispose();
    }
}

function draw({ buffers, geometry, material }) {
    const { groups } = buffers;
    const { first, count } = groups.length > 1 ? groups[material] : groups[0];
    geometry.setDrawRange(3 * first, 3 * count);
}

function deferred() {
    const made = {};
    made.promise = new Promise((resolve, reject) =>
        Object.assign(made, { resolve, reject }));
    made.promise.catch(() => {}); // told to those who wait for it
    return made;
}

// Loads a .glb whose stream comes last, a .gltf or .glb beside which it lies,
// or a .pmesh scene, by a loader that is to be GLTFLoader; resolves with what
// that resolves with as soon as the base meshes can be shown.
export async function load(input, loader, options = {}) {
    const source = new Source(input, options);
    const path = typeof input === "string" || input instanceof URL ?
        LoaderUtils.extractUrlBase(String(input)) : "";
    const head = await readHead(source, NAME);
    const more = { ...options };
    let data = head.data;
    if (head.kind === "pmesh") {
        const scene = new Scene(new Rest(source, data), options);
        await scene.start();
        const json = JSON.parse(await scene.document());
        Object.assign(more, { scene }, dress(json, scene, NAME));
        data = more.json;
    } else if (head.tail) {
        more.tail = head.tail;
    }
    return parse(loader, data, path, more);
}

// Registers the plugin for this one file.
async function parse(loader, data, path, options) {
    const plugin = (parser) => new ProgressivePlugin(parser, options);
    loader.register(plugin);
    try {
        return await loader.parseAsync(data, path);
    } finally {
        loader.unregister(plugin);
    }
}
