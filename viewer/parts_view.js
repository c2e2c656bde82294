// SPDX-License-Identifier: Apache-2.0
// What views of pieces have in common: a list to pick from, pieces moved apart, and cuts.
import page from "./data.js";
import { shared } from "./materials.js";
import { element, pickList, say, slider, swatch } from "./panel.js";
import { percent } from "./text.js";
import { following, View } from "./view.js";

/** A view defines `surfaces` (Parts) and `dots` (PickPoints), one of each for a solid, and sentence(i). */
export class PartsView extends View {
    picked = -1;

    constructor(stage, told) {
        super();
        this.stage = stage;
        this.told = told; // its list has an entry for each piece
    }

    makeExplode(id) {
        this.explode = slider({
            name: "Explode",
            id,
            value: 0,
            show: (x) => percent(x),
            change: (x) => this.setExplode(x),
        });
    }

    /** `share(i)`: what is said beside the name of piece i. */
    makeList(share) {
        this.list = pickList({
            name: "Pieces",
            pick: (i) => this.toggle(i),
            rows: this.told.list.map((_, i) => [
                swatch("square", page.colors[i]),
                element("span", { className: "name" }, `Piece ${i}`),
                element("span", { className: "number" }, share(i)),
            ]),
        });
    }

    enter() {
        shared.explode.value = this.explode.value;
    }

    /** The camera moves back with the pieces, so that all stay visible. */
    setExplode(x) {
        const before = this.ball.radius;
        shared.explode.value = x;
        const { center } = this.ball;
        this.ball = { center, radius: Math.max(...this.surfaces.map((parts) => parts.reach(x))) };
        this.stage.setBall(this.ball);
        this.stage.zoom(this.ball.radius / before);
    }

    toggleExplode() {
        this.explode.move(this.explode.value > 0 ? 0 : 0.5);
    }

    pick(i) {
        this.picked = i;
        for (const each of [...this.surfaces, ...this.dots]) each.pick(i);
        this.list.press(i);
        this.stage.request();
        say(i < 0 ? "No piece is picked" : this.sentence(i));
    }

    /** Picks a piece (-1: none), or none if it was picked. */
    toggle(i) {
        if (i !== this.picked || i >= 0) this.pick(i === this.picked ? -1 : i);
    }

    step(by) {
        this.pick(following(this.picked, by, this.told.list.length));
    }

    clear() {
        this.pick(-1);
    }

    setCutOpen(open) {
        for (const parts of this.surfaces) parts.setCutOpen(open);
    }
}
