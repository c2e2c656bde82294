// SPDX-License-Identifier: Apache-2.0
// Guards: points inside the glass model; paints what a picked guard sees, or what the first few see
// when the slider moves.
import { BufferAttribute, BufferGeometry, Color, LineBasicMaterial, LineSegments } from "three";
import page, { bytes, floats, indices } from "./data.js";
import { coverageCurve } from "./curve.js";
import { Labels } from "./labels.js";
import {
    check,
    commandLine,
    element,
    facts,
    heading,
    note,
    pickList,
    say,
    slider,
    swatch,
} from "./panel.js";
import { PickPoints } from "./points.js";
import { Proof } from "./proof.js";
import { obstacleObject } from "./surface.js";
import { amount, count, percent, point } from "./text.js";
import { themeColor } from "./theme.js";
import { following, View } from "./view.js";

const POINTER = 0.14; // length of the line in a guard's viewing direction
const CONE_RIM = 24; // points of a cone's rim
const NONE = new Set();
const METHODS = { pilp: "progressive", ilp: "integer program", greedy: "greedy" };

export class GuardsView extends View {
    name = "Guards";
    trial = "Click a guard to see what it sees";
    withSurface = true;

    constructor(stage, surface) {
        super();
        const told = page.guards;
        this.stage = stage;
        this.surface = surface;
        this.told = told;
        this.points = new PickPoints(floats("guard-points"), page.colors);
        this.rowBytes = Math.ceil(told.faces / 8);
        this.seen = told.seen ? bytes("guard-seen") : null;
        this.unseen = new Set(told.uncovered);
        this.picked = -1;
        this.first = told.list.length;
        this.labels = new Labels(stage, this.points);
        this.objects = [this.points.object];
        if (told.list[0]?.direction) this.objects.push((this.pointers = this.makePointers()));
        if (told.list[0]?.corners || told.cone) this.objects.push((this.cones = this.makeCones()));
        if (told.tour) this.objects.push((this.tour = tourObject(floats("guard-tour"))));
        if (page.obstacles) this.objects.push((this.obstacles = obstacleObject()));
        if (told.proof) {
            this.proof = new Proof(told.proof, indices("model-faces"), () => this.update());
            this.objects.push(this.proof.object);
        }
        this.node = this.makePanel();
        this.update();
    }

    sees(i, face) {
        return (this.seen[i * this.rowBytes + (face >> 3)] >> (face & 7)) & 1;
    }

    /** By face the first guard that sees it, -1 for none. */
    firstViewers() {
        if (this.viewers) return this.viewers;
        this.viewers = new Int32Array(this.told.faces).fill(-1);
        for (let i = this.points.count - 1; i >= 0; i--)
            for (let f = 0; f < this.told.faces; f++) if (this.sees(i, f)) this.viewers[f] = i;
        return this.viewers;
    }

    sentence(i) {
        const { faces } = this.told.list[i];
        return `Guard ${i} sees ${amount(faces, "face", "faces")} of ${count(this.told.faces)} (${percent(faces / this.told.faces)})`;
    }

    /** Lines in the viewing directions of guards with a limited view. */
    makePointers() {
        const { points } = this.points;
        const ends = this.told.list.flatMap(({ direction }, i) => {
            const length = Math.hypot(...direction) || 1;
            return [0, 1].flatMap((end) =>
                direction.map((d, k) => points[3 * i + k] + (end * POINTER * d) / length),
            );
        });
        return lineObject(ends, null, themeColor("text"));
    }

    /** What limits the view of each: rays from the guard, and the rim that joins their ends. */
    makeCones() {
        const { points } = this.points;
        const ends = [],
            tints = [];
        this.told.list.forEach(({ direction, corners }, i) => {
            const guard = [0, 1, 2].map((k) => points[3 * i + k]);
            const rays = corners ?? coneRays(direction, this.told.cone);
            const rim = rays.map((ray) => guard.map((x, k) => x + POINTER * ray[k]));
            const step = corners ? 1 : CONE_RIM / 4; // a cone shows four of its rays
            rim.forEach((end, r) => {
                ends.push(...end, ...rim[(r + 1) % rim.length]);
                if (r % step === 0) ends.push(...guard, ...end);
            });
            const lines = ends.length / 3 - tints.length / 3;
            const tint = new Color(page.colors[i]).toArray();
            for (let k = 0; k < lines; k++) tints.push(...tint);
        });
        return lineObject(ends, tints, "#ffffff");
    }

    applyTheme() {
        this.pointers?.material.color.set(themeColor("text"));
        this.proof?.applyTheme();
    }

    // ---- panel ----

    makeSwitch(name, id, object) {
        return check({
            name,
            id,
            value: true,
            change: (on) => {
                object.visible = on;
                this.stage.request();
            },
        });
    }

    makePanel() {
        const { told } = this;
        const number = told.list.length;
        this.list = pickList({
            name: "Guards",
            pick: (i) => this.pick(this.picked === i ? -1 : i),
            rows: told.list.map((guard, i) => [
                swatch("dot", page.colors[i]),
                element("span", { className: "name" }, `Guard ${i}`),
                element("span", { className: "number" }, amount(guard.faces, "face", "faces")),
            ]),
        });
        const node = element("div", {}, this.makeFacts());
        if (number > 0 && told.list[0].covered) node.append(...this.makeCurve());
        if (this.proof) node.append(this.proof.node);
        if (number > 0)
            node.append(
                check({
                    name: "Numbers",
                    id: "numbers",
                    value: true,
                    change: (on) => this.labels.want(on),
                }),
            );
        if (this.tour) node.append(this.makeSwitch("Tour", "tour", this.tour));
        if (this.obstacles) {
            const name = `Obstacles (${amount(page.obstacles, "face", "faces")})`;
            node.append(this.makeSwitch(name, "obstacles", this.obstacles));
        }
        node.append(heading("Pick a guard to see what it sees"), this.list.node);
        this.place = note("");
        node.append(this.place);
        if (told.uncovered.length > 0)
            node.append(
                note(
                    `${amount(told.uncovered.length, "face is", "faces are")} seen by no guard: striped in red.`,
                ),
            );
        if (told.command) node.append(heading("The same guards again"), commandLine(told.command));
        return node;
    }

    makeFacts() {
        const { told } = this;
        const number = told.list.length;
        return facts([
            ["Guards", count(number), METHODS[told.method]],
            ...this.makeBounds(),
            ["Area seen", percent(told.coverage_area), `${percent(told.coverage_faces)} of faces`],
            ...this.makeSearch(),
            ...(told.tour ? [["Tour", told.tour.toPrecision(4), "long"]] : []),
        ]);
    }

    /** How many guards the search began with, and when it had found fewer. */
    makeSearch() {
        const steps = this.told.search ?? [];
        if (steps.length < 2) return [];
        const [work] = steps[steps.length - 1];
        const numbers = steps.map(([, guards]) => guards).join(", ");
        return [["Search", numbers, `the last after ${(work / 1e6).toPrecision(2)} million steps`]];
    }

    /** "Needed" holds for guards anywhere. With a given number of guards the area counts. */
    makeBounds() {
        const { told } = this;
        if (told.max_guards > 0)
            return told.area_bound_everywhere > 0
                ? [["Possible", percent(told.area_bound_everywhere), "at most, anywhere"]]
                : [["Possible", percent(told.area_bound), "at most, of these candidates"]];
        const bounds = [];
        if (told.lower_bound_everywhere > 0)
            bounds.push(
                told.optimal_everywhere
                    ? ["Needed", count(told.lower_bound_everywhere), "anywhere: optimal", "good"]
                    : ["Needed", count(told.lower_bound_everywhere), "at least, anywhere"],
            );
        else bounds.push(["Needed", count(told.lower_bound), "at least, of these candidates"]);
        return bounds;
    }

    makeCurve() {
        const fractions = (this.fractions = [
            0,
            ...this.told.list.map((guard) => Math.min(Math.max(guard.covered[1], 0), 1)),
        ]);
        this.curve = coverageCurve(fractions, (k) => this.firstSlider?.move(k));
        const parts = [heading("Area seen by the first guards"), this.curve.node];
        if (this.seen === null) return parts;
        this.firstSlider = slider({
            name: "Paint what the first guards see",
            id: "first-guards",
            max: fractions.length - 1,
            step: 1,
            value: fractions.length - 1,
            show: (k) => `${k} · ${percent(fractions[k])}`,
            change: (k) => this.showFirst(k),
        });
        return [...parts, this.firstSlider.node];
    }

    // ---- what is visible ----

    /** Picks one guard, or none for -1. */
    pick(i) {
        this.picked = i;
        this.painted = false;
        this.first = this.points.count;
        this.update();
        say(i < 0 ? "No guard is picked" : this.sentence(i));
    }

    showFirst(k) {
        this.picked = -1;
        this.painted = true;
        this.first = k;
        this.update();
        say(
            `The first ${amount(k, "guard sees", "guards see")} ${percent(this.fractions[k])} of the area`,
        );
    }

    step(by) {
        this.pick(following(this.picked, by, this.points.count));
    }

    clear() {
        this.pick(-1);
    }

    update() {
        const { picked, first } = this;
        this.points.pick(picked);
        this.points.showFirst(first);
        this.list.press(picked);
        if (this.firstSlider) this.firstSlider.value = first;
        this.curve?.mark(first);
        this.place.textContent =
            picked < 0 ? "" : `Guard ${picked} stands at ${point(this.told.list[picked].position)}`;
        this.place.hidden = picked < 0;
        this.paint();
        this.stage.request();
    }

    paint() {
        if (this.surface === null) return;
        if (this.seen !== null && this.picked >= 0) {
            this.surface.paint((f) => (this.sees(this.picked, f) ? this.picked : -1), new Set());
        } else if (this.seen !== null && this.painted) {
            const viewers = this.firstViewers();
            this.surface.paint((f) => (viewers[f] < this.first ? viewers[f] : -1), this.unseen);
        } else {
            this.surface.paint(null, this.unseen, this.proof?.shown ? this.proof.faces : NONE);
        }
    }

    // ---- pointer ----

    click(at) {
        const i = this.points.under(this.stage, at);
        if (i >= 0) this.pick(i === this.picked ? -1 : i);
        else if (this.picked >= 0) this.clear();
    }

    /** Text and position of the tag under the pointer; null for none. */
    tag(at) {
        const i = at === null ? -1 : this.points.under(this.stage, at);
        if (i >= 0)
            return {
                text: `Guard ${i} · ${amount(this.told.list[i].faces, "face", "faces")}`,
                place: this.points.place(i),
                over: true,
            };
        if (this.picked < 0) return null;
        return {
            text: `Guard ${this.picked} · ${amount(this.told.list[this.picked].faces, "face", "faces")}`,
            place: this.points.place(this.picked),
            over: false,
        };
    }

    enter() {
        this.labels.enter();
        this.paint();
    }

    leave() {
        this.labels.leave();
    }
}

/** The way through the guards. */
function tourObject(points) {
    const ends = [];
    for (let i = 3; i < points.length; i += 3) ends.push(...points.slice(i - 3, i + 3));
    return lineObject(ends, null, "#e69f00");
}

/** Line segments between pairs of ends that nothing hides, in one colour or `tints` of the ends. */
function lineObject(ends, tints, color) {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(Float32Array.from(ends), 3));
    if (tints) geometry.setAttribute("color", new BufferAttribute(Float32Array.from(tints), 3));
    const lines = new LineSegments(
        geometry,
        new LineBasicMaterial({ color, vertexColors: tints !== null, depthTest: false }),
    );
    lines.frustumCulled = false;
    lines.renderOrder = 9;
    return lines;
}

/** Unit vectors on the rim of a cone about a direction, of an opening angle in degrees. */
function coneRays(direction, angle) {
    const length = Math.hypot(...direction) || 1;
    const d = direction.map((x) => x / length);
    const least = d.map(Math.abs).indexOf(Math.min(...d.map(Math.abs)));
    const axis = [0, 1, 2].map((k) => Number(k === least));
    const cross = (a, b) =>
        [0, 1, 2].map((k) => a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
    const side = cross(d, axis);
    const size = Math.hypot(...side);
    const u = side.map((x) => x / size),
        v = cross(d, u);
    const half = (angle * Math.PI) / 360;
    return Array.from({ length: CONE_RIM }, (_, r) => {
        const t = (2 * Math.PI * r) / CONE_RIM;
        return d.map(
            (x, k) =>
                Math.cos(half) * x + Math.sin(half) * (Math.cos(t) * u[k] + Math.sin(t) * v[k]),
        );
    });
}
