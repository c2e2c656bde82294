// SPDX-License-Identifier: Apache-2.0
// The model: glass, with painted faces for what is seen, what nothing sees, or what proves a bound.
import { BufferAttribute, BufferGeometry, Mesh } from "three";
import page, { floats, indices } from "./data.js";
import { ballOf, shadedSurface } from "./geometry.js";
import { setOpacity, setSides, surfaceMaterial } from "./materials.js";
import { themeColor } from "./theme.js";

const GLASS = 0,
    UNSEEN = 1,
    WITNESS = 2,
    PAINTED = 3; // kinds of faces; PAINTED + i has colour i
const MOST_COLORS = 200; // colours with a draw call each; then they repeat

export class Surface {
    constructor() {
        const points = floats("model-points");
        const surface = shadedSurface(points, indices("model-faces"));
        this.faceCount = surface.index.length / 3;
        this.corners = surface.index;
        this.ball = ballOf(points);
        this.kinds = new Uint8Array(this.faceCount);
        this.opacity = 0.3;
        this.hollow = this.open = false;
        this.geometry = new BufferGeometry();
        this.geometry.setAttribute("position", new BufferAttribute(surface.position, 3));
        this.geometry.setAttribute("normal", normalAttribute(surface.normal));
        this.geometry.setIndex(new BufferAttribute(surface.index.slice(), 1));
        this.materials = [
            surfaceMaterial({ opacity: 0.3, rim: 0.45 }),
            surfaceMaterial({ defines: { STRIPED: "" } }),
            surfaceMaterial(),
        ];
        for (const color of page.colors.slice(0, MOST_COLORS))
            this.materials.push(surfaceMaterial({ color }));
        this.object = new Mesh(this.geometry, this.materials);
        this.object.frustumCulled = false;
        this.applyTheme();
        this.paint(null, new Set());
    }

    applyTheme() {
        this.materials[GLASS].uniforms.base.value.set(themeColor("surface"));
        this.materials[UNSEEN].uniforms.base.value.set(themeColor("warn"));
        this.materials[WITNESS].uniforms.base.value.set(themeColor("accent"));
    }

    setOpacity(opacity) {
        this.opacity = opacity;
        this.setHollow(this.hollow);
    }

    setCutOpen(open) {
        this.open = open;
        this.setHollow(this.hollow);
    }

    /** A doll's house: of a hollow model only what faces away from the viewer is drawn, and hides
     * what is behind. */
    setHollow(hollow) {
        this.hollow = hollow;
        setOpacity(this.materials[GLASS], hollow && this.opacity > 0 ? 1 : this.opacity);
        this.materials.forEach((material) => setSides(material, !hollow, hollow || this.open));
    }

    /**
     * Paints faces: `colorOf` returns the index of a face's colour, -1 for glass (null: all glass);
     * faces in `unseen` or `witnesses` without a colour are marked.
     */
    paint(colorOf, unseen, witnesses = new Set()) {
        const { kinds } = this;
        for (let f = 0; f < this.faceCount; f++) {
            const color = colorOf === null ? -1 : colorOf(f);
            if (color >= 0) kinds[f] = PAINTED + (color % MOST_COLORS);
            else kinds[f] = unseen.has(f) ? UNSEEN : witnesses.has(f) ? WITNESS : GLASS;
        }
        this.sortFaces();
    }

    /** Faces by kind, so that each kind is one range of the index. */
    sortFaces() {
        const { kinds, corners } = this;
        const next = new Uint32Array(this.materials.length + 1);
        for (const kind of kinds) next[kind + 1]++;
        this.geometry.clearGroups();
        for (let kind = 0; kind < this.materials.length; kind++) {
            if (next[kind + 1] > 0)
                this.geometry.addGroup(3 * next[kind], 3 * next[kind + 1], kind);
            next[kind + 1] += next[kind];
        }
        const index = this.geometry.index.array;
        for (let f = 0; f < this.faceCount; f++) {
            const place = 3 * next[kinds[f]]++;
            index[place] = corners[3 * f];
            index[place + 1] = corners[3 * f + 1];
            index[place + 2] = corners[3 * f + 2];
        }
        this.geometry.index.needsUpdate = true;
    }
}

/** What stands in the way: seen through a little, from both sides. */
export function obstacleObject() {
    const surface = shadedSurface(floats("obstacle-points"), indices("obstacle-faces"));
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(surface.position, 3));
    geometry.setAttribute("normal", normalAttribute(surface.normal));
    geometry.setIndex(new BufferAttribute(surface.index, 1));
    const material = surfaceMaterial({ color: "#967d5f", opacity: 0.6 });
    setSides(material, true, true);
    const object = new Mesh(geometry, material);
    object.frustumCulled = false;
    object.renderOrder = 4; // after what is inside, before the glass
    return object;
}

/** Normals as bytes, four each for alignment. */
export function normalAttribute(packed) {
    return new BufferAttribute(packed, 4, true);
}
