// The model: glass, with faces painted that are seen, or that nothing sees.
import { BufferAttribute, BufferGeometry, Mesh } from "three";
import { floats, indices } from "./data.js";
import { ballOf, shadedSurface } from "./geometry.js";
import { setCutOpen, setOpacity, surfaceMaterial } from "./materials.js";
import { themeColor } from "./theme.js";

const GLASS = 0, SEEN = 1, UNSEEN = 2;

export class Surface {
    constructor() {
        const points = floats("model-points");
        const surface = shadedSurface(points, indices("model-faces"));
        this.faceCount = surface.index.length / 3;
        this.corners = surface.index;
        this.ball = ballOf(points);
        this.kinds = new Uint8Array(this.faceCount);
        this.geometry = new BufferGeometry();
        this.geometry.setAttribute("position", new BufferAttribute(surface.position, 3));
        this.geometry.setAttribute("normal", normalAttribute(surface.normal));
        this.geometry.setIndex(new BufferAttribute(surface.index.slice(), 1));
        this.materials = [
            surfaceMaterial({ opacity: 0.3, rim: 0.45 }),
            surfaceMaterial(),
            surfaceMaterial(),
        ];
        this.object = new Mesh(this.geometry, this.materials);
        this.object.frustumCulled = false;
        this.color = null; // of what is seen; null: the accent
        this.applyTheme();
        this.paint(() => GLASS);
    }

    applyTheme() {
        this.materials[GLASS].uniforms.base.value.set(themeColor("surface"));
        this.materials[SEEN].uniforms.base.value.set(this.color ?? themeColor("accent"));
        this.materials[UNSEEN].uniforms.base.value.set(themeColor("warn"));
    }

    setOpacity(opacity) {
        setOpacity(this.materials[GLASS], opacity);
    }

    setCutOpen(open) {
        this.materials.forEach((material) => setCutOpen(material, open));
    }

    /** Sorts faces by kind, so that each kind is one range of the index. */
    paint(kindOf) {
        const ends = [0, 0, 0];
        for (let f = 0; f < this.faceCount; f++) ends[(this.kinds[f] = kindOf(f))]++;
        const next = [0, ends[0], ends[0] + ends[1]];
        this.geometry.clearGroups();
        next.forEach((start, kind) => {
            if (ends[kind] > 0) this.geometry.addGroup(3 * start, 3 * ends[kind], kind);
        });
        const index = this.geometry.index.array;
        for (let f = 0; f < this.faceCount; f++) {
            const place = 3 * next[this.kinds[f]]++;
            index[place] = this.corners[3 * f];
            index[place + 1] = this.corners[3 * f + 1];
            index[place + 2] = this.corners[3 * f + 2];
        }
        this.geometry.index.needsUpdate = true;
    }

    /** Paints what a row of bits holds in a colour (null: the accent), and the listed faces. */
    paintSeen(bits, color, unseen) {
        this.color = color;
        this.applyTheme();
        this.paint((f) =>
            bits !== null && (bits[f >> 3] >> (f & 7)) & 1 ? SEEN : unseen.has(f) ? UNSEEN : GLASS,
        );
    }
}

/** Normals as bytes, four each so that they stay aligned. */
export function normalAttribute(packed) {
    return new BufferAttribute(packed, 4, true);
}
