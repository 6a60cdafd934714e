// SPDX-License-Identifier: MIT
// The picture: the level shown, and beside it the original.
import {
    BufferAttribute, Color, DirectionalLight, DoubleSide, HemisphereLight, Mesh,
    MeshBasicMaterial, MeshStandardMaterial, PerspectiveCamera, Scene,
    WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { ProgressiveMesh, sphereOf } from "pmesh/three";

const GREY = 0xb9b4aa;
const INK = 0x2a2d31;
const NEAR = 0.01, FAR = 30; // in radii of the mesh

export class Stage {
    #renderer;
    #camera = new PerspectiveCamera(35, 1, 0.1, 100);
    #scene = new Scene();
    #controls;
    #object = null;
    #original = null;
    #wire = null;
    #material;
    #lines;
    #dirty = true;
    #way = {}; // how levels are shown: { inflate } or { morph }
    #moving = false; // between two levels
    #last = 0;       // time of the last frame then
    #divider = 0.5;
    #paper = new Color();
    frames = 0;
    moved = () => {}; // called when go() has arrived

    constructor(canvas) {
        this.#renderer = new WebGLRenderer({ canvas, antialias: true });
        this.#renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
        this.#material = clay();
        this.#lines = new MeshBasicMaterial({
            color: INK, wireframe: true, transparent: true, opacity: 0.4,
        });
        this.#lights();
        this.#controls = new OrbitControls(this.#camera, canvas);
        this.#controls.addEventListener("change", () => this.draw());
        new ResizeObserver(() => this.#resize()).observe(canvas.parentElement);
        matchMedia("(prefers-color-scheme: dark)").addEventListener("change",
            () => this.#theme());
        this.#theme();
        this.#resize();
    }

    // One light above, one from the camera's left: shape without glare.
    #lights() {
        const sky = new HemisphereLight(0xffffff, 0x77705f, 1.15);
        const key = new DirectionalLight(0xffffff, 2.5);
        key.position.set(-2.2, 2, 1.8);
        this.#camera.add(key);
        this.#scene.add(sky, this.#camera);
    }

    #theme() {
        const style = getComputedStyle(document.documentElement);
        this.#paper.set(style.getPropertyValue("--paper").trim());
        this.#scene.background = this.#paper;
        this.draw();
    }

    #resize() {
        const { clientWidth: w, clientHeight: h } =
            this.#renderer.domElement.parentElement;
        this.#renderer.setSize(w, h, false);
        this.#camera.aspect = w / Math.max(h, 1);
        this.#camera.updateProjectionMatrix();
        this.draw();
    }

    // Takes a mesh of pmesh; the camera stays if it is the same one again.
    show(source, keepCamera) {
        this.#object?.removeFromParent();
        this.#object?.geometry?.dispose();
        this.#object = source.isScene ? source.object :
            new ProgressiveMesh(source, this.#material, this.#way);
        this.#scene.add(this.#object);
        this.#paint();
        this.wireframe = this.#wire !== null;
        if (!keepCamera)
            this.#frame();
        this.draw();
        return this.#object;
    }

    #frame() {
        const { sphere, source } = this.#object;
        const { center, radius } = sphere ?? sphereOf(source.header);
        this.#camera.near = NEAR * radius;
        this.#camera.far = FAR * radius;
        this.#camera.position.copy(center)
            .addScaledVector(this.#camera.up.clone().set(0.45, 0.32, 1)
                .normalize(), 3.3 * radius);
        this.#controls.target.copy(center);
        this.#controls.minDistance = 0.05 * radius;
        this.#controls.maxDistance = 12 * radius;
        this.#camera.updateProjectionMatrix();
        this.#controls.update();
    }

    // { inflate: true }, { morph: true } or {}.
    set way(way) {
        this.#way = way;
        this.#moving = false;
        if (this.#object)
            this.show(this.#object.source, true);
    }

    // Goes to a level by and by; calls moved() once it is there.
    go(target) {
        this.#last = performance.now();
        this.#moving = true;
        this.#object.morphTo(target);
        this.draw();
    }

    // The same geometry once more: three makes its lines from the indices.
    set wireframe(on) {
        this.#wire?.removeFromParent();
        if (this.#object?.source.isScene) {
            this.#object.wireframe = on;
            this.draw();
            return;
        }
        this.#wire = on && this.#object ?
            new Mesh(this.#object.geometry, this.#lines) : null;
        if (this.#wire)
            this.#scene.add(this.#wire);
        this.draw();
    }

    set flat(on) {
        this.#material.flatShading = on;
        this.#material.needsUpdate = true;
        this.draw();
    }

    set tint(on) {
        this.#material.vertexColors = on;
        this.#material.color.set(on ? 0xffffff : GREY);
        this.#material.needsUpdate = true;
        this.#paint();
        this.draw();
    }

    // Vertices by the level they came with: numbers never change, so colours
    // are made once.
    #paint() {
        const g = this.#object?.geometry;
        if (!g || !this.#material.vertexColors || g.userData.painted)
            return;
        g.setAttribute("color", new BufferAttribute(
            ages(this.#object.source.header), 3, true));
        g.userData.painted = true;
    }

    // The original to compare with; null: none.
    set original(source) {
        this.#original?.geometry.dispose();
        this.#original = source && new ProgressiveMesh(source, clay());
        this.draw();
    }

    set divider(part) {
        this.#divider = part;
        this.draw();
    }

    // Turns by keys, in steps of angles.
    turn(x, y) {
        const c = this.#controls, offset = this.#camera.position.clone()
            .sub(c.target);
        const up = this.#camera.up;
        offset.applyAxisAngle(up, x);
        const side = offset.clone().cross(up).normalize();
        const angle = offset.angleTo(up);
        if (angle + y > 0.05 && angle + y < Math.PI - 0.05)
            offset.applyAxisAngle(side, -y);
        this.#camera.position.copy(c.target).add(offset);
        c.update();
        this.draw();
    }

    zoom(factor) {
        const c = this.#controls;
        this.#camera.position.sub(c.target).multiplyScalar(factor)
            .add(c.target);
        c.update();
        this.draw();
    }

    // Draws with the next frame, once.
    draw() {
        if (!this.#dirty)
            return;
        this.#dirty = false;
        requestAnimationFrame(() => {
            this.#dirty = true;
            this.#render();
        });
    }

    #move() {
        if (!this.#moving)
            return;
        const now = performance.now();
        this.#moving = this.#object.tick(now - this.#last);
        this.#last = now;
        if (this.#moving)
            this.draw();
        else
            this.moved();
    }

    #render() {
        this.#move();
        const r = this.#renderer, canvas = r.domElement;
        const w = canvas.clientWidth, h = canvas.clientHeight;
        const cut = this.#original ? Math.round(w * this.#divider) : w;
        r.setScissorTest(true);
        r.setScissor(0, 0, cut, h);
        r.render(this.#scene, this.#camera);
        if (this.#original) {
            const shown = [this.#object, this.#wire].filter(Boolean);
            shown.forEach((object) => { object.visible = false; });
            this.#scene.add(this.#original);
            r.setScissor(cut, 0, w - cut, h);
            r.render(this.#scene, this.#camera);
            this.#original.removeFromParent();
            shown.forEach((object) => { object.visible = true; });
        }
        this.frames++;
    }

    get info() {
        return this.#renderer.info;
    }

    get object() {
        return this.#object;
    }
}

// Faces are drawn a little behind, so that lines on them show.
function clay() {
    return new MeshStandardMaterial({
        color: GREY, roughness: 0.78, metalness: 0, side: DoubleSide,
        polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    });
}

// From coarse to fine: dark blue, green, pale yellow.
const RAMP = [[36, 45, 88], [43, 92, 122], [46, 138, 133], [111, 178, 118],
    [197, 207, 116], [247, 239, 190]];

function ages({ vertices, levels }) {
    const colors = new Uint8Array(3 * vertices);
    let first = 0;
    levels.forEach((level, i) => {
        const at = levels.length > 1 ?
            i / (levels.length - 1) * (RAMP.length - 1) : 0;
        const low = RAMP[Math.floor(at)], high = RAMP[Math.ceil(at)];
        const color = low.map((c, k) => c + (high[k] - c) * (at % 1));
        for (let v = first; v < level.vertices; v++)
            colors.set(color, 3 * v);
        first = level.vertices;
    });
    return colors;
}
