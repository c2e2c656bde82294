// SPDX-License-Identifier: Apache-2.0
// Numbers beside points, as text over the canvas. One that would cover another is left out; the points
// nearer to the eye come first.
import { element } from "./panel.js";

const MOST = 300; // points with numbers
const APART = { x: 16, y: 13 }; // pixels between numbers
const BESIDE = 9; // pixels from the point's middle

export class Labels {
    constructor(stage, points, side = 0) {
        this.side = side;
        this.stage = stage;
        this.points = points;
        this.wanted = true;
        this.open = false; // is the view of these points open?
        this.node = element("div", { className: "labels", hidden: true });
        this.node.setAttribute("aria-hidden", "true"); // the list says the same
        this.spans = Array.from({ length: Math.min(points.count, MOST) }, (_, i) =>
            element("span", {}, String(i)),
        );
        this.node.append(...this.spans);
        stage.place.append(this.node);
        stage.beforeDraw.push(() => this.follow());
    }

    enter() {
        this.open = true;
    }

    leave() {
        this.open = false;
        this.node.hidden = true;
    }

    want(on) {
        this.wanted = on;
        this.stage.request();
    }

    /** Moves the numbers to where the points are drawn. */
    follow() {
        this.node.hidden = !(this.open && this.wanted && this.points.object.visible);
        if (this.node.hidden) return;
        const { stage, points } = this;
        stage.camera.updateMatrixWorld();
        const eye = stage.camera.position;
        const shown = Math.min(points.count, points.geometry.drawRange.count);
        const spots = this.spans.map((span, i) => {
            const place = points.place(i);
            const spot = i < shown ? stage.project(...place, this.side) : null;
            const far = Math.hypot(place[0] - eye.x, place[1] - eye.y, place[2] - eye.z);
            return { span, spot, far };
        });
        spots.sort((a, b) => a.far - b.far);
        const taken = [];
        for (const { span, spot } of spots) {
            const free =
                spot !== null &&
                taken.every(
                    (t) => Math.abs(t.x - spot.x) > APART.x || Math.abs(t.y - spot.y) > APART.y,
                );
            span.hidden = !free;
            if (!free) continue;
            taken.push(spot);
            span.style.transform = `translate(${(spot.x + BESIDE).toFixed(1)}px, ${(spot.y - BESIDE).toFixed(1)}px) translateY(-50%)`;
        }
    }
}
