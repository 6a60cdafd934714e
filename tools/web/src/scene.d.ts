// SPDX-License-Identifier: MIT
import type {
    Changes, DecoderOptions, Detail, Input, OpenOptions, Source, Target,
} from "./index.js";

/** Meshes that a step changed. */
export interface SceneChanges {
    meshes: (Changes & { mesh: number })[];
    /** Of streams: the file was replaced by another one; buffers are new. */
    restarted?: boolean;
}

export interface SceneLevel {
    bytes: number;
    /** Of all meshes, each counted once. */
    faces: number;
    vertices: number;
    /** Of the worst mesh, in units of the world. */
    error: number;
}

export interface SceneHeader {
    contentHash: string;
    meshCount: number;
    resourceCount: number;
    documentPacked: boolean;
    faces: number;
    levels: SceneLevel[];
}

export interface SceneProgress {
    bytes: number;
    faces: number;
    /** Meshes whose base mesh is there. */
    bases: number;
    document: boolean;
    complete: boolean;
}

/** Faces of all meshes together, error in units of the world. */
export type SceneTarget = Omit<Target, "maxOps">;

/** What a scene shows; views of buffers are to be taken anew after each step,
    as memory grows while meshes begin to arrive. */
export interface SceneView {
    readonly header: SceneHeader;
    readonly meshes: (Detail | null)[];
    readonly faceCount: number;
    readonly error: number;
    refine(target?: SceneTarget): SceneChanges | null;
    /** The document's text, or null until all of it is there. */
    document(): Promise<string | null>;
    /** A copy of a resource, or null until all of it is there. */
    resource(number: number): Uint8Array | null;
}

export interface SceneDecoder extends SceneView {}
export class SceneDecoder {
    static create(options?: DecoderOptions): Promise<SceneDecoder>;
    constructor(module: WebAssembly.Module, options?: DecoderOptions);
    readonly progress: SceneProgress;
    readonly memory: number;
    feed(bytes: Uint8Array): boolean;
    /** Largest scale of a mesh's instances. */
    scale(mesh: number): number;
}

export interface Scene extends SceneView {}
export class Scene {
    constructor(source: Source, options?: DecoderOptions);
    readonly progress: SceneProgress & { received: number };
    readonly source: Source;
    readonly decoder: SceneDecoder;
    start(): Promise<void>;
    stream(target?: SceneTarget): AsyncGenerator<SceneChanges, void>;
    load(target?: SceneTarget): Promise<SceneChanges | null>;
    stop(): void;
    dispose(): void;
}

/** Resolves when all base meshes and the document are there. */
export function openScene(input: Input, options?: OpenOptions): Promise<Scene>;
