// SPDX-License-Identifier: MIT
import type { BaseDecoder } from "./index.js";

/** `draco`: what DracoDecoderModule() of draco3d resolves with. */
export function dracoBase(draco: unknown): BaseDecoder;
