// SPDX-License-Identifier: Apache-2.0
// A morph: frames of one surface, linearly interpolated.
import { BufferAttribute, BufferGeometry, Mesh } from "three";
import page, { floats, indices } from "./data.js";
import { ballOf, smoothNormals } from "./geometry.js";
import { setSides, shared, surfaceMaterial } from "./materials.js";
import { Labels } from "./labels.js";
import { element, facts, note, say, slider } from "./panel.js";
import { PickPoints } from "./points.js";
import { themeColor } from "./theme.js";
import { normalAttribute } from "./surface.js";
import { count } from "./text.js";
import { View } from "./view.js";

const SECONDS = 2.4,
    REST = 0.35; // seconds of one pass, and of the pause at each end

export class MorphView extends View {
    name = "Morph";

    constructor(stage) {
        super();
        this.stage = stage;
        const { frames } = page.morph;
        this.frames = Array.from({ length: frames }, (_, i) => floats(`morph-points-${i}`));
        this.faces = indices("morph-faces");
        this.normals = [];
        this.ball = ballOf(...this.frames);
        this.build();
        this.ends = page.morph.guards > 0 ? [0, 1].map((end) => this.makeEnd(end)) : [];
        this.objects = [this.object, ...this.ends.map(({ points }) => points.object)];
        this.playing = false;
        this.node = this.makePanel();
        this.applyTheme();
        this.show(0);
    }

    build() {
        const geometry = new BufferGeometry();
        geometry.setIndex(new BufferAttribute(this.faces, 1));
        this.attributes = this.frames.map((points) => new BufferAttribute(points, 3));
        this.material = surfaceMaterial({ defines: { MOVING: "", SOLID: "" } });
        this.object = new Mesh(geometry, this.material);
        this.object.frustumCulled = false;
    }

    /** The guards of the first or the last shape, with their numbers. */
    makeEnd(end) {
        const points = new PickPoints(floats(`morph-guards-${end}`), page.colors);
        return { points, labels: new Labels(this.stage, points) };
    }

    normalsOf(i) {
        return (this.normals[i] ??= normalAttribute(smoothNormals(this.frames[i], this.faces)));
    }

    makePanel() {
        const { frames, vertices, faces } = page.morph;
        this.button = element(
            "button",
            { type: "button", className: "main", id: "play", onclick: () => this.toggle() },
            "Play",
        );
        this.time = slider({
            name: "Time",
            id: "time",
            step: 0.001,
            value: 0,
            show: (t) => t.toFixed(2),
            change: (t) => {
                this.pause();
                this.show(t);
            },
        });
        return element(
            "div",
            {},
            facts([
                ["Frames", count(frames)],
                ["Vertices", count(vertices)],
                ["Faces", count(faces)],
                ...(this.ends.length > 0 ? [["Guards", count(page.morph.guards)]] : []),
            ]),
            this.time.node,
            element(
                "div",
                { className: "row" },
                this.button,
                element("span", { className: "number" }, "Space"),
            ),
            note("0 is the first shape, 1 the last one."),
            ...(this.ends.length > 0
                ? [note("At either end its guards; those of one number correspond.")]
                : []),
        );
    }

    /** Shows the moment t in [0, 1]. */
    show(t) {
        const along = t * (this.frames.length - 1);
        const i = Math.min(Math.floor(along), this.frames.length - 2);
        const { geometry } = this.object;
        if (i !== this.interval) {
            this.interval = i;
            geometry.setAttribute("position", this.attributes[i]);
            geometry.setAttribute("normal", this.normalsOf(i));
            geometry.setAttribute("positionNext", this.attributes[i + 1]);
            geometry.setAttribute("normalNext", this.normalsOf(i + 1));
        }
        shared.time.value = along - i;
        this.ends.forEach(({ points }, end) => (points.object.visible = t === end));
        this.stage.request();
    }

    // ---- playing ----

    toggle() {
        if (this.playing) this.pause();
        else this.play();
    }

    play() {
        this.playing = true;
        this.button.textContent = "Pause";
        const period = 2 * (SECONDS + REST);
        const begun = performance.now() / 1000 - this.time.value * SECONDS;
        const tick = (now) => {
            if (!this.playing) return;
            const at = Math.max(now / 1000 - begun, 0) % period;
            const way = at < SECONDS + REST ? at / SECONDS : 1 - (at - SECONDS - REST) / SECONDS;
            const t = Math.min(Math.max(way, 0), 1);
            this.time.value = t;
            this.show(t);
            requestAnimationFrame(tick);
        };
        requestAnimationFrame(tick);
        say("Playing");
    }

    pause() {
        if (!this.playing) return;
        this.playing = false;
        this.button.textContent = "Play";
        say(`Paused at ${this.time.value.toFixed(2)}`);
    }

    enter() {
        this.ends.forEach(({ labels }) => labels.enter());
    }

    leave() {
        this.ends.forEach(({ labels }) => labels.leave());
        this.pause();
    }

    step(by) {
        this.time.move(Math.min(Math.max(this.time.value + by / (this.frames.length - 1), 0), 1));
    }

    applyTheme() {
        this.material.uniforms.base.value.set(themeColor("surface"));
    }

    setCutOpen(open) {
        setSides(this.material, true, open);
    }
}
