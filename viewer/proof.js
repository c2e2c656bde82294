// SPDX-License-Identifier: Apache-2.0
// Why so many guards are needed: the faces that prove it, and the boxes from which a guard may see its
// share of them.
import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments } from "three";
import { floats } from "./data.js";
import { check, element, heading, note } from "./panel.js";
import { amount, count } from "./text.js";
import { themeColor } from "./theme.js";

// Corners of a box by bits: 1, 2 and 4 for the upper end along x, y and z.
const EDGES = [0, 1, 0, 2, 0, 4, 1, 3, 1, 5, 2, 3, 2, 6, 3, 7, 4, 5, 4, 6, 5, 7, 6, 7];

export class Proof {
    /** `corners` are three vertices a face; `change` is called when the proof is shown or hidden. */
    constructor(told, corners, change) {
        this.cells = floats("proof-cells");
        this.faces = witnessFaces(told, corners);
        this.shown = false;
        this.object = this.makeBoxes();
        this.node = element(
            "div",
            {},
            heading("Why so many are needed"),
            check({
                name: "Show the proof",
                id: "proof",
                value: false,
                change: (shown) => {
                    this.shown = this.object.visible = shown;
                    change();
                },
            }),
            note(
                `${amount(told.witnesses.length, "witness", "witnesses")} (painted) need ${count(told.bound)} guards. ` +
                    `A guard sees its share of them only within the ${amount(this.cells.length / 6, "box", "boxes")}.`,
            ),
        );
    }

    makeBoxes() {
        const boxes = this.cells.length / 6;
        const ends = new Float32Array(3 * EDGES.length * boxes);
        for (let i = 0, at = 0; i < boxes; i++)
            for (const corner of EDGES)
                for (let k = 0; k < 3; k++)
                    ends[at++] = this.cells[6 * i + k + ((corner >> k) & 1 ? 3 : 0)];
        const geometry = new BufferGeometry();
        geometry.setAttribute("position", new BufferAttribute(ends, 3));
        const material = new LineBasicMaterial({ transparent: true, opacity: 0.35 });
        const lines = new LineSegments(geometry, material);
        lines.frustumCulled = false;
        lines.visible = false;
        this.material = material;
        this.applyTheme();
        return lines;
    }

    applyTheme() {
        this.material.color.set(themeColor("accent"));
    }
}

/** The faces that are witnesses, or have a vertex that is one. */
function witnessFaces(told, corners) {
    const witnesses = new Set(told.witnesses);
    if (!told.vertices) return witnesses;
    const faces = new Set();
    corners.forEach((vertex, i) => witnesses.has(vertex) && faces.add(Math.floor(i / 3)));
    return faces;
}
