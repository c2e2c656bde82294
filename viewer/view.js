// SPDX-License-Identifier: Apache-2.0
/** The one after (by 1) or before (-1) among `count`, around the ends; the first or last after -1. */
export function following(i, by, count) {
    if (count === 0) return -1;
    if (i < 0) return by > 0 ? 0 : count - 1;
    return (i + by + count) % count;
}

/** What a tab shows. A view has a `name`, a `node` for the panel, `objects` for the scene and `withSurface`;
 * what it does not answer to does nothing. */
export class View {
    objects = [];
    withSurface = false; // is the glass model shown as well?
    flat = false; // does it stand over the 3D stage?

    enter() {}
    leave() {}

    /** To the next (1) or the one before (-1). */
    step() {}
    clear() {}

    /** A click on the stage at { x, y, touch }. */
    click() {}

    /** The text beside a point, { text, place, over }, for a pointer at a place or null. */
    tag() {
        return null;
    }

    applyTheme() {}

    /** Shows inner sides, because a cut lays them open. */
    setCutOpen() {}
}
