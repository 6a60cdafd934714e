// SPDX-License-Identifier: MIT
// A scene in the place of a mesh: what the page asks of either.
import { Box3, Group, Sphere } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { load } from "pmesh/three";

// `seen` is called after each step, with the view; what it returns is waited
// for.
export async function openScene(input, bytes, options, seen) {
    let view = null;
    const gltf = await load(input, new GLTFLoader(), {
        ...options, changed: () => view && seen(view),
    });
    view = new SceneView(gltf, bytes);
    return view;
}

export class SceneView {
    isScene = true;
    #gltf;
    #bytes;
    #base;

    constructor(gltf, bytes) {
        this.#gltf = gltf;
        this.#bytes = bytes;
        const { meshes } = gltf.progressive.scene;
        this.#base = meshes.reduce((n, m) => n + m.header.baseFaces, 0);
        this.object = new SceneObject(gltf, this);
    }

    get #scene() {
        return this.#gltf.progressive.scene;
    }

    get done() {
        return this.#gltf.progressive.done;
    }

    // As that of a mesh, as far as the page looks at it.
    get header() {
        const { header, meshes } = this.#scene;
        const { radius } = this.object.sphere;
        return {
            faces: header.faces,
            baseFaces: this.#base,
            bytes: this.#bytes ?? header.levels.at(-1).bytes,
            levels: header.levels,
            step: 1,
            bounds: [2 * radius, 0, 0],
            meshes: meshes.length,
        };
    }

    get progress() {
        return this.#scene.progress;
    }

    get faceCount() {
        return this.#scene.faceCount;
    }

    get vertexCount() {
        return this.#scene.meshes.reduce((n, m) => n + m.vertexCount, 0);
    }

    get error() {
        return this.#scene.error;
    }

    refine(target) {
        return this.#gltf.progressive.refine(target);
    }

    stop() {
        this.#scene.stop();
    }
}

class SceneObject extends Group {
    constructor(gltf, source) {
        super();
        this.source = source;
        this.add(gltf.scene);
        this.sphere = new Box3().setFromObject(this)
            .getBoundingSphere(new Sphere());
    }

    refine(target) {
        return this.source.refine(target);
    }

    set wireframe(on) {
        this.traverse(({ material }) => {
            if (material)
                material.wireframe = on;
        });
    }
}
