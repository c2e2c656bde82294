// SPDX-License-Identifier: Apache-2.0
// Controls shared by all 3D views: opacity of the model, the cut, the up direction.
import { shared } from "./materials.js";
import page from "./data.js";
import { check, choice, element, heading, say, slider } from "./panel.js";
import { percent } from "./text.js";

const AXES = ["Off", "X", "Y", "Z"];

export class Controls {
    constructor(stage, surface, openCut) {
        this.stage = stage;
        this.openCut = openCut; // called with true or false when inner sides become visible or hidden
        this.flipped = false;
        this.open = false;
        this.opacity =
            surface &&
            slider({
                name: "Model",
                id: "opacity",
                value: 0.3,
                show: (x) => (x === 0 ? "hidden" : x === 1 ? "solid" : `${percent(x)} opaque`),
                change: (x) => {
                    surface.setOpacity(x);
                    stage.request();
                },
            });
        const hollow = page.guards?.hollow ?? false;
        this.hollow =
            surface &&
            check({
                name: "Doll's house: hide walls towards you",
                id: "hollow",
                value: hollow,
                change: (on) => {
                    surface.setHollow(on);
                    stage.request();
                },
            });
        if (surface) surface.setHollow(hollow);
        this.axis = choice({ name: "Cut", words: AXES, value: 0, change: () => this.cut() });
        this.place = slider({
            name: "Cut at",
            id: "cut",
            value: 0.5,
            show: (x) => percent(x),
            change: () => this.cut(),
        });
        this.flip = element(
            "button",
            { type: "button", id: "flip", onclick: () => this.turnOver() },
            "Other side",
        );
        this.up = choice({ name: "Up", words: ["Y", "Z"], value: 0, change: (i) => this.setUp(i) });
        this.reset = element(
            "button",
            { type: "button", id: "reset", onclick: () => stage.fit(stage.ball) },
            "Reset view",
        );
        this.cutParts = element("div", { className: "beside" }, this.place.node, this.flip);
        this.surfacePart = element("div", {}, ...(surface ? [this.opacity.node, this.hollow] : []));
        this.node = element(
            "div",
            {},
            heading("View"),
            this.surfacePart,
            this.axis.node,
            this.cutParts,
            element("div", { className: "ends" }, this.reset, this.up.node),
        );
        stage.onBall = () => this.cut();
        this.cut();
    }

    setUp(i) {
        this.stage.setUp(i + 1);
        say(`${"YZ"[i]} points up`);
    }

    turnOver() {
        this.flipped = !this.flipped;
        this.cut();
        say("The other side is cut off");
    }

    /** Cycles through off, x, y, z. */
    nextCut() {
        this.axis.set((this.axis.value + 1) % AXES.length);
        say(this.axis.value === 0 ? "No cut" : `Cut across ${AXES[this.axis.value]}`);
    }

    cut() {
        const axis = this.axis.value - 1;
        const { center, radius } = this.stage.ball;
        const sign = this.flipped ? -1 : 1;
        const cut = shared.cut.value.set(0, 0, 0, 1);
        if (axis >= 0) {
            cut.setComponent(axis, sign);
            cut.w = sign * (center[axis] + radius * (2 * this.place.value - 1));
        }
        this.cutParts.hidden = axis < 0;
        if (this.open !== axis >= 0) this.openCut((this.open = axis >= 0));
        this.stage.request();
    }

    /** The view has changed its model, or has none. */
    suit(view) {
        this.surfacePart.hidden = !view.withSurface;
    }
}
