// SPDX-License-Identifier: MIT
// node bundle.mjs SOURCES PACKAGE OUT - puts the viewer's modules, three and
// the package "pmesh" into one page. Run where node_modules is.
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";

const [sources, pmesh, out] = process.argv.slice(2);
const { buildSync } = createRequire(join(process.cwd(), "x"))("esbuild");

function bundle(name) {
    const { outputFiles } = buildSync({
        entryPoints: [join(sources, name)],
        bundle: true,
        minify: true,
        write: false,
        format: "esm",
        target: "es2022",
        legalComments: "inline",
        nodePaths: [resolve("node_modules")],
        alias: {
            pmesh: resolve(pmesh, "index.js"),
            "pmesh/three": resolve(pmesh, "three.js"),
        },
    });
    return outputFiles[0].text.trim();
}

// A function as replacement: "$&" in a script is not a pattern.
const page = readFileSync(join(sources, "index.html"), "utf8")
    .replace("/*pmesh:style*/", () => bundle("style.css"))
    .replace("/*pmesh:script*/", () => bundle("app.js"));
writeFileSync(out, page);
