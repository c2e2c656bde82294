// SPDX-License-Identifier: Apache-2.0
// Star-shaped pieces in different colours, which can be moved apart; each with its guard.
import page, { floats, indices } from "./data.js";
import { check, commandLine, element, facts, heading, note } from "./panel.js";
import { Labels } from "./labels.js";
import { Parts } from "./parts.js";
import { PartsView } from "./parts_view.js";
import { PickPoints } from "./points.js";
import { amount, count, percent, real } from "./text.js";

export class PiecesView extends PartsView {
    name = "Pieces";
    trial = "Click a piece for its share of the volume; the slider moves pieces apart";

    constructor(stage) {
        super(stage, page.pieces);
        this.parts = new Parts(
            floats("piece-points"),
            indices("piece-faces"),
            this.told.list.map((piece) => piece.faces),
        );
        this.ball = this.parts.rest;
        const guards = floats("piece-guards");
        this.points = guards && new PickPoints(guards, page.colors, this.parts.away);
        this.labels = this.points && new Labels(stage, this.points);
        this.surfaces = [this.parts];
        this.dots = this.points ? [this.points] : [];
        this.objects = [...this.surfaces, ...this.dots].map(({ object }) => object);
        this.node = this.makePanel();
    }

    enter() {
        super.enter();
        this.labels?.enter();
    }

    leave() {
        this.labels?.leave();
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
        this.makeExplode("explode");
        this.makeList((i) => {
            const piece = told.list[i];
            return piece.volume !== undefined && volume > 0
                ? percent(piece.volume / volume)
                : amount(piece.faces, "face", "faces");
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

    // ---- pointer ----

    under(at) {
        const guard = this.points?.object.visible ? this.points.under(this.stage, at) : -1;
        return guard >= 0 ? guard : this.parts.hit(this.stage.ray(at.x, at.y));
    }

    click(at) {
        this.toggle(this.under(at));
    }

    tag(at) {
        const guard =
            at !== null && this.points?.object.visible ? this.points.under(this.stage, at) : -1;
        if (guard >= 0)
            return { text: `Guard of piece ${guard}`, place: this.points.place(guard), over: true };
        if (this.picked < 0 || !this.points) return null;
        return { text: `Piece ${this.picked}`, place: this.points.place(this.picked), over: false };
    }
}
