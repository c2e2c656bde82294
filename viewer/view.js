// SPDX-License-Identifier: Apache-2.0
/** The next (1) or previous (-1) index among `count`, cyclically; the first or last after -1. */
export function following(i, by, count) {
    if (count === 0) return -1;
    if (i < 0) return by > 0 ? 0 : count - 1;
    return (i + by + count) % count;
}

/** The contents of a tab. A view has a `name`, a `node` for the panel, `objects` for the scene and
 * `withSurface`; methods that it does not override do nothing. */
export class View {
    objects = [];
    withSurface = false; // show the glass model as well?
    flat = false; // does it cover the 3D stage?
    sides = null; // two lists of objects, for the left and the right half of the stage
    trial = "Drag to turn the model"; // what to try first

    enter() {}
    leave() {}

    /** Moves to the next (1) or previous (-1) item. */
    step() {}
    clear() {}

    /** A click on the stage at { x, y, touch }. */
    click() {}

    /** Text next to a point, { text, place, side, over }, for a pointer at a place or null. */
    tag() {
        return null;
    }

    applyTheme() {}

    /** Shows inner sides, because a cut reveals them. */
    setCutOpen() {}
}
