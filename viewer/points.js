// SPDX-License-Identifier: Apache-2.0
// Pickable points: guards of the solid or of its pieces, as discs that nothing hides.
import { BufferAttribute, BufferGeometry, Color, Points } from "three";
import { pointMaterial, shared } from "./materials.js";

const SIZE = 15,
    PICKED_SIZE = 22; // pixels
const REACH = { mouse: 12, touch: 24 };

export class PickPoints {
    /**
     * `away` is the direction of each when pieces are moved apart, or null; what is cut off is pale,
     * by `sources` instead of the points themselves if they are given.
     */
    constructor(points, colors, away = null, sources = points) {
        const count = points.length / 3;
        this.points = points;
        this.away = away ?? new Float32Array(points.length);
        this.sizes = new Float32Array(count).fill(SIZE);
        const tints = new Float32Array(points.length);
        colors.slice(0, count).forEach((color, i) => new Color(color).toArray(tints, 3 * i));
        const geometry = new BufferGeometry();
        geometry.setAttribute("position", new BufferAttribute(points, 3));
        geometry.setAttribute("source", new BufferAttribute(sources, 3));
        geometry.setAttribute("away", new BufferAttribute(this.away, 3));
        geometry.setAttribute("color", new BufferAttribute(tints, 3));
        geometry.setAttribute("size", new BufferAttribute(this.sizes, 1));
        this.geometry = geometry;
        this.object = new Points(geometry, pointMaterial());
        this.object.frustumCulled = false;
        this.object.renderOrder = 10;
    }

    get count() {
        return this.sizes.length;
    }

    /** Current position of a point. */
    place(i) {
        const by = shared.explode.value;
        return [0, 1, 2].map((k) => this.points[3 * i + k] + by * this.away[3 * i + k]);
    }

    pick(i) {
        this.sizes.fill(SIZE);
        if (i >= 0) this.sizes[i] = PICKED_SIZE;
        this.geometry.attributes.size.needsUpdate = true;
    }

    /** Draws only the first `count`. */
    showFirst(count) {
        this.geometry.setDrawRange(0, count);
    }

    /** The point nearest to a place on the stage, -1 if none is close. */
    under(stage, at, side = 0) {
        let best = -1,
            nearest = at.touch ? REACH.touch : REACH.mouse;
        const shown = Math.min(this.count, this.geometry.drawRange.count);
        for (let i = 0; i < shown; i++) {
            const p = stage.project(...this.place(i), side);
            const distance = p ? Math.hypot(p.x - at.x, p.y - at.y) : Infinity;
            if (distance < nearest) {
                nearest = distance;
                best = i;
            }
        }
        return best;
    }
}
