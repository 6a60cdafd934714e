// SPDX-License-Identifier: MIT

export interface Range {
    first: number;
    count: number;
}

/** What a step changed: ranges of output vertices and of faces. */
export interface Changes {
    vertices: Range[];
    faces: Range[];
    /** maxOps ended the way to the target. */
    more: boolean;
    /** Of streams: the file was replaced by another one; buffers are new. */
    restarted?: boolean;
}

/** As fine as decoded within every limit given; 0 or nothing is no limit. */
export interface Target {
    faces?: number;
    /** Distance to the full mesh, in units of the model. */
    error?: number;
    bytes?: number;
    /** Splits shown or hidden in one call. */
    maxOps?: number;
}

export interface Level {
    /** Of the file, from its start. */
    bytes: number;
    faces: number;
    meshVertices: number;
    vertices: number;
    error: number;
    /** Of a measured file, else 0: distance to the full mesh, root mean square
     * and largest. */
    rms: number;
    furthest: number;
}

export interface Attribute {
    kind: "normal" | "texcoord" | "color" | "generic";
    set: number;
    components: number;
    bits: number;
}

export interface Header {
    formatVersion: number;
    contentHash: string;
    bytes: number;
    exactBytes: number;
    memory: number;
    profile: "compact" | "balanced" | "quality";
    placement: "subset" | "optimal";
    baseCoder: "native" | "draco";
    positionBits: number;
    step: number;
    origin: [number, number, number];
    bounds: [number, number, number];
    faces: number;
    meshVertices: number;
    vertices: number;
    baseFaces: number;
    baseMeshVertices: number;
    baseVertices: number;
    materialCount: number;
    measured: boolean;
    levels: Level[];
    attributes: Attribute[];
}

export interface Progress {
    /** Consumed by complete chunks. */
    bytes: number;
    faces: number;
    levels: number;
    exactVertices: number;
    complete: boolean;
}

export type Vector = [number, number, number];

export class PmeshError extends Error {
    readonly code: "argument" | "memory" | "limit" | "magic" | "version" |
        "corrupt" | "checksum" | "unsupported" | "cut" | "http" | "worker" |
        "unknown";
    /** Byte of the stream. */
    readonly offset: number;
    constructor(message: string, code: string, offset?: number);
}

/** WebAssembly with vectors and DecompressionStream are there. */
export const supported: boolean;

/** Decodes a Draco buffer of so many vertices and faces; null: it is none. */
export type BaseDecoder = (bytes: Uint8Array, vertices: number,
    faces: number) => { positions: Int32Array; indices: Int32Array } | null;

/** Compiles the decoder, once. */
export function ready(): Promise<WebAssembly.Module>;

export interface DecoderOptions {
    /** Bytes that a file may need for decoding; default 1 GiB. */
    maxMemory?: number;
    /** morph() will be called. */
    morph?: boolean;
    /** inflated() will be called. */
    inflate?: boolean;
    /** For base meshes coded by Draco (dracoBase of "pmesh/draco"); without it
        such files are refused. */
    base?: BaseDecoder;
}

/** Buffers that refine() changes in place, as large as full detail needs. */
export interface Buffers {
    readonly positions: Float32Array | null;
    readonly indices: Uint16Array | Uint32Array | null;
    readonly attributes: (Attribute & { values: Float32Array })[] | null;
    readonly faceCount: number;
    readonly vertexCount: number;
    /** Of the visible level, in units of the model. */
    readonly error: number;
}

export interface Sorted {
    indices: Uint16Array | Uint32Array;
    groups: (Range & { material: number })[];
}

/** A mesh at any level of what has been decoded of it. */
export interface Detail extends Buffers {
    readonly header: Header | null;
    readonly progress: Progress;
    /** Bytes of the module's memory. */
    readonly memory: number;
    refine(target?: Target): Changes | null;
    /** The visible faces sorted by material. */
    sorted(): Sorted;
    /** Where the visible vertices lie on a coarser mesh: for geomorphs. */
    morph(coarse?: Target): Float32Array | null;
    /** Positions swollen to the volume of the full mesh; all change with every
        refine(). As long as positions; views of the same memory each time. */
    inflated(): Float32Array | null;
    bounds(): { minimum: Vector; maximum: Vector } | null;
    raycast(origin: Vector, direction: Vector):
        { face: number; distance: number; weights: Vector } | null;
    materialName(material: number): string;
}

export interface Decoder extends Detail {}
export class Decoder {
    static create(options?: DecoderOptions): Promise<Decoder>;
    constructor(module: WebAssembly.Module, options?: DecoderOptions);
    /** True once the file is complete; throws PmeshError where it is damaged. */
    feed(bytes: Uint8Array): boolean;
}

export type Input = string | URL | Response | ReadableStream<Uint8Array> |
    Blob | ArrayBuffer | ArrayBufferView;

export interface SourceOptions {
    signal?: AbortSignal;
    fetch?: typeof fetch;
    headers?: HeadersInit;
    /** Of a response that breaks off, without a byte in between; default 2. */
    retries?: number;
}

/** Bytes of a file, read forwards, with stops. */
export class Source {
    constructor(input: Input, options?: SourceOptions);
    readonly at: number;
    readonly generation: number;
    readonly requests: number;
    expected: number;
    next(): Promise<Uint8Array | null>;
    stop(): void;
    reset(): void;
}

export interface OpenOptions extends SourceOptions, DecoderOptions {}

/** Resolves when the base mesh can be shown. */
export function open(input: Input, options?: OpenOptions): Promise<Mesh>;

export class Mesh implements Buffers {
    constructor(source: Source, options?: DecoderOptions);
    readonly positions: Float32Array | null;
    readonly indices: Uint16Array | Uint32Array | null;
    readonly attributes: (Attribute & { values: Float32Array })[] | null;
    readonly faceCount: number;
    readonly vertexCount: number;
    readonly error: number;
    readonly header: Header;
    readonly progress: Progress & { received: number };
    readonly source: Source;
    readonly decoder: Decoder;
    start(): Promise<void>;
    stream(target?: Target): AsyncGenerator<Changes, void>;
    load(target?: Target): Promise<Changes | null>;
    refine(target?: Target): Changes | null;
    sorted(): Sorted;
    morph(coarse?: Target): Float32Array | null;
    inflated(): Float32Array | null;
    stop(): void;
    dispose(): void;
}
