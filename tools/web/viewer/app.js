// SPDX-License-Identifier: MIT
// The viewer of `pmesh view`: the page holds the file, or names where it is.
import { Decoder, open } from "pmesh";
import { Chart, size } from "./chart.js";
import { frame, throttle } from "./link.js";
import { openScene } from "./scene.js";
import { Stage } from "./stage.js";

const $ = (id) => document.getElementById(id);
const count = new Intl.NumberFormat("en").format;

const stage = new Stage($("view"));
const chart = new Chart($("chart"));
let mesh = null;      // of pmesh
let target = {};      // what was chosen: { faces } or { bytes }; {}: everything
let run = 0;          // loads begun: an older one ends when it sees a newer
let held = null;      // the file's bytes, as far as they are known
let finished = false; // the load
let first = null;     // what had arrived when something could be shown

const WAYS = { morph: true, inflate: true }; // in which levels may be shown

// ---- where the file comes from --------------------------------------------

const data = $("mesh");

function embedded() {
    const text = atob(data.textContent.trim());
    return Uint8Array.from(text, (c) => c.charCodeAt(0));
}

function link(response) {
    return throttle(response.body, () => Number($("speed").value));
}

async function slowFetch(...all) {
    const response = await fetch(...all);
    return response.ok ? new Response(link(response), {
        status: response.status, headers: response.headers,
    }) : response;
}

// Files say with their ninth byte what they hold.
const SCENE = 8;

async function connect(mine) {
    const { url } = data.dataset;
    if (!url)
        held ??= embedded();
    const start = held ?? new Uint8Array(await (await fetch(url, {
        headers: { Range: "bytes=0-15" },
    })).arrayBuffer());
    const options = url ? { fetch: slowFetch } : {};
    const input = () => url ?? link(new Response(held));
    return start[8] === SCENE ?
        openScene(input(), held?.length, options, (view) => seen(view, mine)) :
        open(input(), { ...options, ...WAYS });
}

// ---- loading ----------------------------------------------------------------

async function load() {
    const mine = ++run, again = mesh !== null;
    finished = false;
    mesh?.stop();
    $("message").hidden = true;
    $("progress").value = 0;
    try {
        const opened = await connect(mine);
        if (mine !== run)
            return opened.stop();
        mesh = opened;
        mesh.refine();
        first = mesh.progress;
        start(again);
        await (mesh.isScene ? fill(mine) : sharpen(mine));
    } catch (error) {
        if (mine === run)
            complain(error);
    }
}

function start(again) {
    stage.show(mesh, again);
    const { header } = mesh;
    document.body.classList.toggle("scene", mesh.isScene === true);
    $("about").textContent = `${count(header.faces)} faces, ` +
        `${size(header.bytes)}, ${header.levels.length} levels`;
    $("face-count").min = header.baseFaces;
    $("face-count").max = header.faces;
    chart.show(header.levels);
    update();
}

async function sharpen(mine) {
    const began = performance.now();
    for await (const changes of mesh.stream()) {
        if (mine !== run)
            return;
        stage.object.update(changes);
        if (changes.restarted)
            start(true);
        choose(target, null, false);
        arrived(began);
        await frame();
    }
    finished = mesh.progress.complete;
    arrived(began);
    if (!finished)
        complain(new Error("The file ends early: this is all it holds."));
    if ($("compare").checked)
        await compare();
}

// A scene streams by itself.
let began = 0;

async function seen(view, mine) {
    if (mine !== run)
        return view.stop();
    if (view === mesh) {
        choose(target, null, false);
        arrived(began);
    }
    return frame();
}

async function fill(mine) {
    began = performance.now();
    await mesh.done;
    if (mine === run) {
        finished = mesh.progress.complete;
        choose(target, null, false);
        arrived(began);
    }
}

function arrived(began) {
    const { received } = mesh.progress, { bytes } = mesh.header;
    const seconds = (performance.now() - began) / 1000;
    $("progress").value = Math.min(received / bytes, 1);
    $("arrived").textContent = `${size(received)} in ${seconds.toFixed(1)} s`;
}

function complain(error) {
    $("message").textContent = error.message;
    $("message").hidden = false;
}

// ---- level of detail --------------------------------------------------------

// `from`: the control that is being used keeps what it says. While a file
// arrives, levels do not take their time.
function choose(wanted, from, slowly = true) {
    target = wanted;
    if (!mesh || stage.object === null)
        return;
    if (slowly && $("morph").checked) {
        stage.go(wanted);
        stage.moved = () => update(from);
    } else {
        stage.object.refine(wanted);
        stage.draw();
    }
    update(from);
}

function levelOf(faces) {
    const { levels } = mesh.header;
    return Math.max(0, levels.findLastIndex((level) => level.faces <= faces));
}

// Bytes of the file up to the visible faces: exact at levels, a share between.
function bytesOf(faces) {
    const { levels } = mesh.header, i = levelOf(faces);
    const low = levels[i], high = levels[i + 1];
    if (!high)
        return mesh.header.bytes;
    const part = (faces - low.faces) / (high.faces - low.faces);
    return Math.round(low.bytes + part * (high.bytes - low.bytes));
}

function facesOf(bytes) {
    const { levels } = mesh.header;
    const i = levels.findLastIndex((level) => level.bytes <= bytes);
    if (i < 0)
        return levels[0].faces;
    const low = levels[i], high = levels[i + 1];
    if (!high)
        return low.faces;
    const part = (bytes - low.bytes) / (high.bytes - low.bytes);
    return Math.floor(low.faces + part * (high.faces - low.faces));
}

// Sliders are logarithmic: equal ways are equal ratios.
function logarithmic(low, high) {
    const ratio = Math.log(high / low) || 1;
    return {
        to: (value) => Math.log(value / low) / ratio,
        from: (part) => part >= 1 ? high :
            Math.round(low * Math.exp(part * ratio)),
    };
}

function faceScale() {
    return logarithmic(mesh.header.baseFaces, mesh.header.faces);
}

function byteScale() {
    const { levels } = mesh.header;
    return logarithmic(levels[0].bytes, levels.at(-1).bytes);
}

function update(from = null) {
    const { header, faceCount, vertexCount, error } = mesh;
    const diagonal = header.step * Math.hypot(...header.bounds);
    const bytes = bytesOf(faceCount);
    if (from !== $("faces"))
        $("faces").value = faceScale().to(faceCount);
    if (from !== $("bytes"))
        $("bytes").value = byteScale().to(bytes);
    if (from !== $("face-count"))
        $("face-count").value = faceCount;
    $("faces").ariaValueText = `${count(faceCount)} faces`;
    $("bytes").ariaValueText = size(bytes);
    $("byte-count").textContent = `${count(bytes)} of ${count(header.bytes)}`;
    $("error").textContent = error === 0 ? "none: the full mesh" :
        `${(100 * error / diagonal).toPrecision(2)} % of the diagonal`;
    $("vertices").textContent = count(vertexCount);
    $("level").textContent = `${levelOf(faceCount) + 1} of ` +
        header.levels.length;
    $("side-left").textContent = `${count(faceCount)} faces`;
    chart.level = levelOf(faceCount);
}

$("faces").addEventListener("input", ({ target: slider }) => {
    const part = Number(slider.value);
    const faces = mesh && faceScale().from(part);
    choose(part >= 1 ? {} : { faces }, slider);
});
$("bytes").addEventListener("input", ({ target: slider }) => {
    const part = Number(slider.value);
    const faces = mesh && facesOf(byteScale().from(part));
    choose(part >= 1 ? {} : { faces }, slider);
});
$("face-count").addEventListener("input", ({ target: field }) => {
    if (Number(field.value) > 0)
        choose({ faces: Number(field.value) }, field);
});
$("face-count").addEventListener("change", () => {
    $("face-count").value = mesh?.faceCount ?? "";
});

// ---- what is shown ----------------------------------------------------------

$("wire").addEventListener("change", ({ target: { checked } }) => {
    stage.wireframe = checked;
});
$("tint").addEventListener("change", ({ target: { checked } }) => {
    stage.tint = checked;
});
$("flat").addEventListener("change", ({ target: { checked } }) => {
    stage.flat = checked;
});
// One or the other: a swollen mesh has no coarser one that it grows out of.
for (const [id, way, other] of [["swell", { inflate: true }, "morph"],
    ["morph", { morph: true }, "swell"]])
    $(id).addEventListener("change", ({ target: { checked } }) => {
        if (checked)
            $(other).checked = false;
        stage.way = checked ? way : {};
    });
$("compare").addEventListener("change", compare);
$("divider").addEventListener("input", ({ target: { value } }) => {
    $("line").style.left = `${value}%`;
    stage.divider = value / 100;
});

// The original is a second mesh at full detail.
async function compare() {
    const on = $("compare").checked;
    $("split").hidden = !on;
    if (!on || !finished) {
        stage.original = null;
        return;
    }
    if (data.dataset.url && !held)
        held = new Uint8Array(await (await fetch(data.dataset.url))
            .arrayBuffer());
    const full = await open(held, {});
    await full.load();
    stage.original = $("compare").checked ? full : null;
}

$("replay").addEventListener("click", () => {
    target = {};
    load();
});

// ---- keys -------------------------------------------------------------------

const TOGGLES = {
    w: "wire", l: "tint", f: "flat", s: "compare", v: "swell", m: "morph",
};

addEventListener("keydown", (event) => {
    const { key, target: where } = event;
    if (event.ctrlKey || event.metaKey || event.altKey ||
        where.matches("input[type=number], select"))
        return;
    if (key.toLowerCase() in TOGGLES)
        $(TOGGLES[key.toLowerCase()]).click();
    else if (key.toLowerCase() === "r")
        $("replay").click();
});

const TURNS = {
    ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1],
    ArrowDown: [0, 0.1],
};

$("view").addEventListener("keydown", (event) => {
    if (event.key in TURNS)
        stage.turn(...TURNS[event.key]);
    else if (event.key === "+" || event.key === "-")
        stage.zoom(event.key === "+" ? 0.9 : 1 / 0.9);
    else
        return;
    event.preventDefault();
});

// For tests, and for those who like to look inside.
globalThis.viewer = {
    stage, load, choose, Decoder,
    get mesh() { return mesh; },
    get finished() { return finished; },
    get first() { return first; },
};

$("name").textContent = document.title;
load();
