// SPDX-License-Identifier: Apache-2.0
// The coverage curve: what the first 1, 2, ... guards see, with a movable mark.
import { drawn } from "./panel.js";
import { percent } from "./text.js";

const WIDTH = 300,
    HEIGHT = 128,
    LEFT = 42,
    RIGHT = 8,
    TOP = 8,
    BOTTOM = 22;

/** Grid lines along the axis of guards: a few round numbers. */
function ticks(count) {
    const step =
        [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000].find((s) => count / s <= 6) ?? count;
    const list = [];
    for (let k = 0; k <= count; k += step) list.push(k);
    return list;
}

/** `fractions` are for 0, 1, 2, ... guards; `choose` is called with a number of guards. */
export function coverageCurve(fractions, choose) {
    const count = fractions.length - 1;
    const x = (k) => LEFT + ((WIDTH - LEFT - RIGHT) * k) / Math.max(count, 1);
    const y = (fraction) => TOP + (HEIGHT - TOP - BOTTOM) * (1 - fraction);
    const svg = drawn("svg", {
        viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
        class: "curve",
        role: "img",
        "aria-label": `Seen area by number of guards: from ${percent(fractions[Math.min(1, count)])} by the first to ${percent(fractions[count])} by all ${count}`,
    });
    for (const fraction of [0, 0.5, 1]) {
        svg.append(
            drawn("line", {
                class: "grid",
                x1: LEFT,
                x2: WIDTH - RIGHT,
                y1: y(fraction),
                y2: y(fraction),
            }),
            drawn(
                "text",
                { x: LEFT - 6, y: y(fraction) + 4, "text-anchor": "end" },
                `${100 * fraction} %`,
            ),
        );
    }
    for (const k of ticks(count))
        svg.append(drawn("text", { x: x(k), y: HEIGHT - 6, "text-anchor": "middle" }, String(k)));
    const steps = fractions.map((fraction, k) => `${x(k)} ${y(fraction)}`).join(" L ");
    const mark = drawn("circle", { class: "mark", r: 4.5 });
    svg.append(
        drawn("path", { class: "area", d: `M ${steps} L ${x(count)} ${y(0)} Z` }),
        drawn("path", { class: "line", d: `M ${steps}` }),
        mark,
    );
    svg.addEventListener("pointerdown", (event) => {
        const box = svg.getBoundingClientRect();
        const along = ((event.clientX - box.left) / box.width) * WIDTH;
        const k = Math.round(((along - LEFT) / (WIDTH - LEFT - RIGHT)) * count);
        choose(Math.min(Math.max(k, 0), count));
    });
    return {
        node: svg,
        mark(k) {
            mark.setAttribute("cx", x(k));
            mark.setAttribute("cy", y(fractions[k]));
        },
    };
}
