// SPDX-License-Identifier: MIT
import type { BufferGeometry, Material, Sphere } from "three";
import { Mesh } from "three";
import type { GLTF, GLTFLoader, GLTFLoaderPlugin, GLTFParser } from
    "three/addons/loaders/GLTFLoader.js";
import type { Changes, Header, Input, Mesh as Source, OpenOptions, Target } from
    "./index.js";
import type { Scene, SceneChanges, SceneTarget } from "./scene.js";
import type { RemoteMesh } from "./worker.js";

export interface ProgressiveMeshOptions {
    /** Makes normals if the file has none; default true. */
    normals?: boolean;
    /** Coarse levels swell to the volume of the full mesh. The source was
        opened with { inflate: true }. */
    inflate?: boolean;
    /** morphTo() will be called. The source was opened with { morph: true }. */
    morph?: boolean;
}

export class ProgressiveMesh extends Mesh<BufferGeometry> {
    readonly isProgressiveMesh: true;
    readonly source: Source | RemoteMesh;
    constructor(source: Source | RemoteMesh, material: Material | Material[],
        options?: ProgressiveMeshOptions);
    /** Sends the ranges of a change with the next frame. */
    update(changes: Changes): void;
    refine(target?: Target): Changes | null | Promise<void>;
    /** The same, not at once: while tick() is called, within `milliseconds`;
        default 300. */
    morphTo(target?: Target, milliseconds?: number): void;
    /** Goes on by so many milliseconds; false once it has arrived. */
    tick(milliseconds: number): boolean;
    stream(target?: Target, seen?: (changes: Changes) => unknown):
        Promise<void>;
    dispose(): void;
}

/** Holds every level of a mesh. */
export function sphereOf(header: Header): Sphere;

export interface ProgressiveOptions extends OpenOptions {
    /** How far to stream; {} is everything. */
    target?: SceneTarget;
    /** Called after each step; what it returns is waited for. */
    changed?(progressive: Progressive): unknown;
}

/** loader.register((parser) => new ProgressivePlugin(parser)) */
export class ProgressivePlugin implements GLTFLoaderPlugin {
    readonly name: "PMESH_progressive";
    constructor(parser: GLTFParser, options?: ProgressiveOptions);
}

/** `progressive` of what GLTFLoader resolves with. */
export class Progressive {
    /** null until `ready`. */
    readonly scene: Scene | null;
    /** The stream's base meshes are there. */
    readonly ready: Promise<Scene>;
    /** What `target` asks for is there, or all there is. */
    readonly done: Promise<void>;
    readonly result: GLTF;
    refine(target?: SceneTarget): SceneChanges | null;
    stream(target?: SceneTarget, seen?: (changes: SceneChanges) => unknown):
        Promise<void>;
    dispose(): void;
}

/** A .glb or .gltf with PMESH_progressive, or a .pmesh scene: resolves as soon
    as there is something to show. */
export function load(input: Input, loader: GLTFLoader,
    options?: ProgressiveOptions): Promise<GLTF & { progressive: Progressive }>;
