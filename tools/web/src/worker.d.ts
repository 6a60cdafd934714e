// SPDX-License-Identifier: MIT
import type {
    Attribute, Changes, DecoderOptions, Header, Input, Progress, Target,
} from "./index.js";

export interface WorkerOptions extends DecoderOptions {
    /** Runs pmesh/worker-main, if a bundler has to make it elsewhere. */
    worker?: Worker | MessagePort;
    headers?: Record<string, string>;
    retries?: number;
}

export function openInWorker(input: Input, options?: WorkerOptions):
    Promise<RemoteMesh>;

export class RemoteMesh {
    constructor(port: Worker | MessagePort);
    readonly header: Header;
    readonly positions: Float32Array;
    readonly indices: Uint16Array | Uint32Array;
    readonly attributes: (Attribute & { values: Float32Array })[];
    readonly faceCount: number;
    readonly vertexCount: number;
    readonly error: number;
    readonly progress: Progress & { received: number };
    refine(target?: Target): Promise<Changes | null>;
    stream(target?: Target): AsyncGenerator<Changes, void>;
    dispose(): void;
}
