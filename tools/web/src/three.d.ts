// SPDX-License-Identifier: MIT
import type { BufferGeometry, Material } from "three";
import { Mesh } from "three";
import type { Changes, Mesh as Source, Target } from "./index.js";
import type { RemoteMesh } from "./worker.js";

export class ProgressiveMesh extends Mesh<BufferGeometry> {
    readonly isProgressiveMesh: true;
    readonly source: Source | RemoteMesh;
    constructor(source: Source | RemoteMesh, material: Material | Material[],
        options?: { normals?: boolean });
    /** Sends the ranges of a change with the next frame. */
    update(changes: Changes): void;
    refine(target?: Target): Changes | null | Promise<void>;
    stream(target?: Target, seen?: (changes: Changes) => unknown):
        Promise<void>;
    dispose(): void;
}
