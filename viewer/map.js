// SPDX-License-Identifier: Apache-2.0
// A map between solids: A and B side by side, under one camera, with their pieces in the same colours or
// with A's checker or coordinate lines and what the map makes of them. A cut is across A, and carried over.
import page, { floats, indices } from "./data.js";
import { ballOf } from "./geometry.js";
import { Labels } from "./labels.js";
import { check, choice, element, facts, heading, note, say } from "./panel.js";
import { Parts } from "./parts.js";
import { PartsView } from "./parts_view.js";
import { PickPoints } from "./points.js";
import { amount, count, percent, real } from "./text.js";

const PATTERNS = ["Pieces", "Checker", "Lines"];
const CELLS = 16; // of the patterns along A's longest side
const NAMES = ["A", "B"];

export class MapView extends PartsView {
    name = "Map";
    trial = "Drag to turn both; a cut across A is carried over to B";

    constructor(stage) {
        super(stage, page.map);
        this.guardsWanted = true;
        const points = [0, 1].map((end) => floats(`map-points-${end}`));
        const guards = [0, 1].map((end) => floats(`map-guards-${end}`));
        const faces = indices("map-faces");
        this.ball = ballOf(points[0]);
        moveInto(this.ball, points[1], guards[1]);
        this.ends = [0, 1].map((end) => this.makeEnd(end, points, guards, faces));
        this.surfaces = this.ends.map(({ parts }) => parts);
        this.dots = this.ends.map(({ points: dots }) => dots);
        this.sides = this.ends.map(({ parts, points: dots }) => [parts.object, dots.object]);
        this.objects = this.sides.flat();
        this.captions = element(
            "div",
            { className: "sides", hidden: true },
            ...NAMES.map((name) => element("span", {}, name)),
        );
        stage.place.append(this.captions);
        this.setGrid(points[0]);
        this.node = this.makePanel(points, faces);
    }

    makeEnd(end, points, guards, faces) {
        const counts = this.told.list.map((piece) => piece.faces);
        const parts = new Parts(points[end], faces, counts, points[0]);
        const dots = new PickPoints(guards[end], page.colors, parts.away, guards[0]);
        return { parts, points: dots, labels: new Labels(this.stage, dots, end) };
    }

    /** Cells begin a little before the box, so that its sides lie in none of their walls. */
    setGrid(points) {
        const lower = [Infinity, Infinity, Infinity],
            upper = [-Infinity, -Infinity, -Infinity];
        points.forEach((x, i) => {
            lower[i % 3] = Math.min(lower[i % 3], x);
            upper[i % 3] = Math.max(upper[i % 3], x);
        });
        const size = Math.max(...upper.map((x, k) => x - lower[k])) || 1;
        const cells = CELLS / size;
        for (const { parts } of this.ends)
            parts.material.uniforms.grid.value.set(...lower.map((x) => x - 0.3 / cells), cells);
    }

    // ---- panel ----

    makePanel(points, faces) {
        const { told } = this;
        const volumes = points.map((each) => this.volumesOf(each, faces));
        this.pattern = choice({
            name: "Colours",
            words: PATTERNS,
            value: 0,
            change: (i) => this.setPattern(i),
        });
        this.makeExplode("map-explode");
        this.makeList((i) => volumes.map((each) => percent(each[i])).join(", "));
        return element(
            "div",
            {},
            facts([
                ["Pieces", count(told.list.length), "the same in A and B"],
                ["Tetrahedra", count(told.tetrahedra)],
                ["Distortion", real(told.mean), `on average, ${real(told.worst)} at worst`],
                ["Above 10", percent(told.above_10), "of A's volume"],
            ]),
            this.pattern.node,
            this.explode.node,
            check({
                name: "Show guards",
                id: "map-guards-shown",
                value: true,
                change: (on) => {
                    this.guardsWanted = on;
                    this.showGuards();
                },
            }),
            note(
                "A is on the left, B on the right, drawn at the same size. Distortion: largest over smallest stretch.",
            ),
            heading("Pieces by number, and their share of A and of B"),
            this.list.node,
        );
    }

    /** The share of each piece in the volume, from the faces around it. */
    volumesOf(points, faces) {
        let c = 0;
        const volumes = this.told.list.map((piece) => {
            let sum = 0;
            for (const end = c + 3 * piece.faces; c < end; c += 3) {
                const [p, q, r] = [0, 1, 2].map((k) => {
                    const v = 3 * faces[c + k];
                    return [points[v], points[v + 1], points[v + 2]];
                });
                sum +=
                    p[0] * (q[1] * r[2] - q[2] * r[1]) +
                    p[1] * (q[2] * r[0] - q[0] * r[2]) +
                    p[2] * (q[0] * r[1] - q[1] * r[0]);
            }
            return sum / 6;
        });
        const total = volumes.reduce((sum, volume) => sum + volume, 0);
        return volumes.map((volume) => (total > 0 ? volume / total : 0));
    }

    // ---- what is visible ----

    enter() {
        super.enter();
        this.captions.hidden = false;
        this.ends.forEach(({ labels }) => labels.enter());
    }

    leave() {
        this.captions.hidden = true;
        this.ends.forEach(({ labels }) => labels.leave());
    }

    setPattern(i) {
        this.ends.forEach(({ parts }) => (parts.material.uniforms.pattern.value = i));
        this.showGuards();
        say(`Colours: ${PATTERNS[i].toLowerCase()}`);
    }

    /** Guards belong to pieces: patterns stay free of them. */
    showGuards() {
        const on = this.guardsWanted && this.pattern.value === 0;
        this.ends.forEach((end) => (end.points.object.visible = on));
        this.stage.request();
    }

    sentence(i) {
        const { tetrahedra } = this.told.list[i];
        return `Piece ${i}: ${amount(tetrahedra, "tetrahedron", "tetrahedra")}, in A and in B`;
    }

    // ---- pointer ----

    /** The guard of a side under a place, -1 for none. */
    guardUnder(at, side) {
        const { points } = this.ends[side];
        return points.object.visible ? points.under(this.stage, at, side) : -1;
    }

    click(at) {
        const ray = this.stage.ray(at.x, at.y);
        const guard = this.guardUnder(at, ray.side);
        this.toggle(guard >= 0 ? guard : this.surfaces[ray.side].hit(ray));
    }

    tag(at) {
        if (at === null) return null;
        const { side } = this.stage.ray(at.x, at.y);
        const guard = this.guardUnder(at, side);
        if (guard < 0) return null;
        const place = this.ends[side].points.place(guard);
        return { text: `Guard of piece ${guard} in ${NAMES[side]}`, place, side, over: true };
    }
}

/** Moves and scales points, and others with them, until they fill a ball. */
function moveInto(ball, points, others) {
    const own = ballOf(points);
    const scale = ball.radius / own.radius;
    for (const each of [points, others])
        for (let i = 0; i < each.length; i++)
            each[i] = ball.center[i % 3] + scale * (each[i] - own.center[i % 3]);
}
