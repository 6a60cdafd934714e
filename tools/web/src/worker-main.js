// SPDX-License-Identifier: MIT
// What the worker of pmesh/worker runs.
import { serve } from "./remote.js";

serve(globalThis);
