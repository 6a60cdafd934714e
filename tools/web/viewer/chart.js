// SPDX-License-Identifier: MIT
// The level table as a curve: error against bytes, both logarithmic.
const WIDTH = 260, HEIGHT = 78;
const SVG = "http://www.w3.org/2000/svg";

export class Chart {
    #svg;
    #here;
    #place = () => null;

    constructor(svg) {
        this.#svg = svg;
    }

    // The last level has no error: it stands where half of the one before is.
    show(levels) {
        const least = levels.length > 1 ? levels.at(-2).error / 2 : 1;
        const error = (level) => Math.log(Math.max(level.error, least, 1e-30));
        const low = Math.log(levels[0].bytes), high = Math.log(
            levels.at(-1).bytes);
        const top = error(levels[0]), bottom = error(levels.at(-1));
        const x = (bytes) => WIDTH * (Math.log(bytes) - low) /
            (high - low || 1);
        const y = (level) => 6 + (HEIGHT - 12) * (top - error(level)) /
            (top - bottom || 1);
        const steps = levels.map((level) => [x(level.bytes), y(level)]);
        this.#svg.replaceChildren(
            element("line", { class: "axis", x1: 0, x2: WIDTH, y1: HEIGHT,
                y2: HEIGHT }),
            element("polyline", { class: "curve", points: steps.join(" ") }),
            ...steps.map(([cx, cy]) =>
                element("circle", { class: "level", cx, cy, r: 1.8 })),
            label(0, "start", levels[0].bytes),
            label(WIDTH, "end", levels.at(-1).bytes),
            this.#here = element("circle", { class: "here", r: 4 }));
        this.#place = (i) => steps[Math.max(0, Math.min(i, steps.length - 1))];
    }

    set level(i) {
        const [cx, cy] = this.#place(i) ?? [0, 0];
        this.#here?.setAttribute("cx", cx);
        this.#here?.setAttribute("cy", cy);
    }
}

function element(name, attributes) {
    const made = document.createElementNS(SVG, name);
    for (const key in attributes)
        made.setAttribute(key, attributes[key]);
    return made;
}

function label(x, anchor, bytes) {
    const text = element("text", { x, y: HEIGHT + 12, "text-anchor": anchor });
    text.textContent = size(bytes);
    return text;
}

export function size(bytes) {
    if (bytes < 10_000)
        return `${bytes} B`;
    return bytes < 1e6 ? `${Math.round(bytes / 1000)} kB` :
        `${(bytes / 1e6).toFixed(bytes < 1e7 ? 2 : 1)} MB`;
}
