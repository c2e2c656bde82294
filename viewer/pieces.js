// SPDX-License-Identifier: Apache-2.0
// Star-shaped pieces in different colours, which can be moved apart; each with its guard.
import { BufferAttribute, BufferGeometry, Color, Mesh } from "three";
import page, { floats, indices } from "./data.js";
import { ballOf, shadedSurface } from "./geometry.js";
import { setCutOpen, shared, surfaceMaterial } from "./materials.js";
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
import { Labels } from "./labels.js";
import { PickPoints } from "./points.js";
import { normalAttribute } from "./surface.js";
import { amount, count, percent, real } from "./text.js";
import { following, View } from "./view.js";

export class PiecesView extends View {
    name = "Pieces";
    trial = "Click a piece for its share of the volume; the slider moves pieces apart";

    constructor(stage) {
        super();
        this.stage = stage;
        this.told = page.pieces;
        this.picked = -1;
        this.build();
        const guards = floats("piece-guards");
        this.points = guards && new PickPoints(guards, page.colors, this.away);
        this.labels = this.points && new Labels(stage, this.points);
        this.objects = this.points ? [this.object, this.points.object] : [this.object];
        this.node = this.makePanel();
    }

    enter() {
        this.labels?.enter();
    }

    leave() {
        this.labels?.leave();
    }

    // ---- geometry ----

    build() {
        this.away = new Float32Array(3 * this.told.list.length);
        this.radii = []; // of the bounding balls of pieces
        this.firstFace = [0];
        const geometry = this.join(this.makeParts());
        this.position = geometry.attributes.position.array;
        this.index = geometry.index.array;
        this.material = surfaceMaterial({ defines: { PIECES: "", SOLID: "" } });
        this.object = new Mesh(geometry, this.material);
        this.object.frustumCulled = false;
    }

    /** The surfaces of all pieces, each with its own vertices. */
    makeParts() {
        const points = floats("piece-points");
        const faces = indices("piece-faces");
        this.rest = ballOf(points); // around the pieces at their original places
        this.ball = this.rest;
        return this.told.list.map((piece, i) => {
            const first = this.firstFace[i];
            this.firstFace.push(first + piece.faces);
            return this.makePart(points, faces.subarray(3 * first, 3 * (first + piece.faces)), i);
        });
    }

    /** The surface of a piece, and its direction: from the common centre to its own. */
    makePart(points, faces, i) {
        const numbers = new Map();
        const own = new Uint32Array(faces.length);
        const used = [];
        faces.forEach((v, k) => {
            if (!numbers.has(v)) {
                numbers.set(v, numbers.size);
                used.push(points[3 * v], points[3 * v + 1], points[3 * v + 2]);
            }
            own[k] = numbers.get(v);
        });
        const local = Float32Array.from(used);
        const { center, radius } =
            used.length > 0 ? ballOf(local) : { center: this.rest.center, radius: 0 };
        this.radii.push(radius);
        for (let k = 0; k < 3; k++) this.away[3 * i + k] = center[k] - this.rest.center[k];
        return shadedSurface(local, own);
    }

    /** One mesh for all pieces: vertices store the piece, its colour and its direction. */
    join(parts) {
        const total = parts.reduce((sum, part) => sum + part.position.length / 3, 0);
        const position = new Float32Array(3 * total);
        const normal = new Int8Array(4 * total);
        const away = new Float32Array(3 * total);
        const color = new Uint8Array(4 * total);
        const piece = new Float32Array(total);
        const index = new Uint32Array(3 * this.firstFace[parts.length]);
        let vertices = 0;
        parts.forEach((part, i) => {
            const rgb = new Color(page.colors[i]).toArray().map((x) => Math.round(255 * x));
            const end = vertices + part.position.length / 3;
            position.set(part.position, 3 * vertices);
            normal.set(part.normal, 4 * vertices);
            index.set(
                part.index.map((corner) => corner + vertices),
                3 * this.firstFace[i],
            );
            piece.fill(i, vertices, end);
            for (; vertices < end; vertices++) {
                away.set(this.away.subarray(3 * i, 3 * i + 3), 3 * vertices);
                color.set(rgb, 4 * vertices);
            }
        });
        const geometry = new BufferGeometry();
        geometry.setAttribute("position", new BufferAttribute(position, 3));
        geometry.setAttribute("normal", normalAttribute(normal));
        geometry.setAttribute("away", new BufferAttribute(away, 3));
        geometry.setAttribute("color", new BufferAttribute(color, 4, true));
        geometry.setAttribute("piece", new BufferAttribute(piece, 1));
        return geometry.setIndex(new BufferAttribute(index, 1));
    }

    // ---- panel ----

    makePanel() {
        const { told } = this;
        const number = told.list.length;
        const stars = told.list.filter((piece) => piece.star).length;
        const volume = told.list.reduce((sum, piece) => sum + (piece.volume ?? 0), 0);
        const rows = [
            [
                "Pieces",
                count(number),
                told.reported && stars === number ? "all proven star-shaped" : "",
                "good",
            ],
        ];
        if (told.reported && stars < number) rows.push(["Star-shaped", count(stars), "proven"]);
        if (told.lower_bound > 0)
            rows.push(
                told.optimal
                    ? ["Needed", count(told.lower_bound), "however it is cut: optimal", "good"]
                    : ["Needed", count(told.lower_bound), "at least, however it is cut"],
            );
        rows.push(["Tetrahedra", count(told.tetrahedra)]);
        this.explode = slider({
            name: "Explode",
            id: "explode",
            max: 1,
            value: 0,
            show: (x) => percent(x),
            change: (x) => this.setExplode(x),
        });
        this.list = pickList({
            name: "Pieces",
            pick: (i) => this.pick(this.picked === i ? -1 : i),
            rows: told.list.map((piece, i) => [
                swatch("square", page.colors[i]),
                element("span", { className: "name" }, `Piece ${i}`),
                element(
                    "span",
                    { className: "number" },
                    piece.volume !== undefined && volume > 0
                        ? percent(piece.volume / volume)
                        : amount(piece.faces, "face", "faces"),
                ),
            ]),
        });
        const node = element("div", {}, facts(rows), this.explode.node);
        if (this.points)
            node.append(
                check({
                    name: "Show guards",
                    id: "piece-guards-shown",
                    value: true,
                    change: (on) => {
                        this.points.object.visible = on;
                        this.stage.request();
                    },
                }),
            );
        node.append(
            heading(
                told.reported
                    ? "Pieces by number, and their share of the volume"
                    : "Pieces by number",
            ),
            this.list.node,
        );
        if (!told.reported)
            node.append(note("Without PIECES.json, guards and proofs are not known."));
        if (told.command) node.append(heading("The same pieces again"), commandLine(told.command));
        return node;
    }

    sentence(i) {
        const piece = this.told.list[i];
        if (piece.volume === undefined)
            return `Piece ${i} has ${amount(piece.faces, "face", "faces")}`;
        return `Piece ${i}: volume ${real(piece.volume)}, ${amount(piece.tetrahedra, "tetrahedron", "tetrahedra")}, ${piece.star ? "star-shaped, proven" : "not star-shaped"}`;
    }

    // ---- what is visible ----

    /** The camera moves back with the pieces, so that all stay visible. */
    setExplode(x) {
        const before = this.ball.radius;
        shared.explode.value = x;
        this.ball = { center: this.rest.center, radius: this.reach(x) };
        this.stage.setBall(this.ball);
        this.stage.zoom(this.ball.radius / before);
    }

    toggleExplode() {
        this.explode.move(this.explode.value > 0 ? 0 : 0.5);
    }

    /** Distance from the common centre to the displaced pieces. */
    reach(x) {
        let most = this.rest.radius;
        this.radii.forEach((radius, i) => {
            const [dx, dy, dz] = this.away.subarray(3 * i, 3 * i + 3);
            most = Math.max(most, (1 + x) * Math.hypot(dx, dy, dz) + radius);
        });
        return most;
    }

    pick(i) {
        this.picked = i;
        this.material.uniforms.picked.value = i;
        this.points?.pick(i);
        this.list.press(i);
        this.stage.request();
        say(i < 0 ? "No piece is picked" : this.sentence(i));
    }

    step(by) {
        this.pick(following(this.picked, by, this.told.list.length));
    }

    clear() {
        this.pick(-1);
    }

    // ---- pointer ----

    /** The first piece that a ray meets, -1 for none: tests every triangle. */
    hit({ origin, direction }) {
        const { position, index, firstFace } = this;
        const cut = shared.cut.value,
            by = shared.explode.value;
        let best = -1,
            nearest = Infinity;
        for (let i = 0; i + 1 < firstFace.length; i++) {
            const o = [origin.x, origin.y, origin.z].map((x, k) => x - by * this.away[3 * i + k]);
            const moved = [0, 1, 2].map((k) => by * this.away[3 * i + k]);
            for (let c = 3 * firstFace[i]; c < 3 * firstFace[i + 1]; c += 3) {
                const t = meet(
                    o,
                    direction,
                    position,
                    3 * index[c],
                    3 * index[c + 1],
                    3 * index[c + 2],
                );
                if (!(t > 0 && t < nearest)) continue;
                const x = o[0] + moved[0] + t * direction.x,
                    y = o[1] + moved[1] + t * direction.y,
                    z = o[2] + moved[2] + t * direction.z;
                if (x * cut.x + y * cut.y + z * cut.z > cut.w) continue;
                nearest = t;
                best = i;
            }
        }
        return best;
    }

    under(at) {
        const guard = this.points?.object.visible ? this.points.under(this.stage, at) : -1;
        return guard >= 0 ? guard : this.hit(this.stage.ray(at.x, at.y));
    }

    click(at) {
        const i = this.under(at);
        if (i !== this.picked || i >= 0) this.pick(i === this.picked ? -1 : i);
    }

    tag(at) {
        const guard =
            at !== null && this.points?.object.visible ? this.points.under(this.stage, at) : -1;
        if (guard >= 0)
            return { text: `Guard of piece ${guard}`, place: this.points.place(guard), over: true };
        if (this.picked < 0 || !this.points) return null;
        return { text: `Piece ${this.picked}`, place: this.points.place(this.picked), over: false };
    }

    setCutOpen(open) {
        setCutOpen(this.material, open);
    }
}

/** Distance along a ray to a triangle; NaN if they do not meet. */
function meet(o, d, p, a, b, c) {
    const ux = p[b] - p[a],
        uy = p[b + 1] - p[a + 1],
        uz = p[b + 2] - p[a + 2];
    const vx = p[c] - p[a],
        vy = p[c + 1] - p[a + 1],
        vz = p[c + 2] - p[a + 2];
    const hx = d.y * vz - d.z * vy,
        hy = d.z * vx - d.x * vz,
        hz = d.x * vy - d.y * vx;
    const scale = 1 / (ux * hx + uy * hy + uz * hz);
    const sx = o[0] - p[a],
        sy = o[1] - p[a + 1],
        sz = o[2] - p[a + 2];
    const s = (sx * hx + sy * hy + sz * hz) * scale;
    if (!(s >= 0 && s <= 1)) return NaN;
    const qx = sy * uz - sz * uy,
        qy = sz * ux - sx * uz,
        qz = sx * uy - sy * ux;
    const t = (d.x * qx + d.y * qy + d.z * qz) * scale;
    if (!(t >= 0 && s + t <= 1)) return NaN;
    return (vx * qx + vy * qy + vz * qz) * scale;
}
