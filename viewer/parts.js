// SPDX-License-Identifier: Apache-2.0
// The surfaces of pieces as one mesh: coloured, movable apart, and found by rays.
import { BufferAttribute, BufferGeometry, Color, Mesh } from "three";
import page from "./data.js";
import { ballOf, shadedSurface } from "./geometry.js";
import { setSides, shared, surfaceMaterial } from "./materials.js";
import { normalAttribute } from "./surface.js";

export class Parts {
    /**
     * Piece i has counts[i] of the faces, in turn. With `sources`, a place for each point, cuts and
     * patterns follow these places instead of the points.
     */
    constructor(points, faces, counts, sources = null) {
        this.away = new Float32Array(3 * counts.length);
        this.radii = []; // of the bounding balls of pieces
        this.firstFace = [0];
        this.rest = ballOf(points); // around the pieces at their original places
        const parts = counts.map((count, i) => {
            const first = this.firstFace[i];
            this.firstFace.push(first + count);
            return this.makePart(points, faces.subarray(3 * first, 3 * (first + count)), i);
        });
        const geometry = this.join(parts, sources);
        this.position = geometry.attributes.position.array;
        this.source = geometry.attributes.source?.array ?? null;
        this.index = geometry.index.array;
        const defines = sources ? { PIECES: "", SOLID: "", MAPPED: "" } : { PIECES: "", SOLID: "" };
        this.material = surfaceMaterial({ defines });
        this.object = new Mesh(geometry, this.material);
        this.object.frustumCulled = false;
    }

    /** The surface of a piece, and its direction: from the common centre to its own. */
    makePart(points, faces, i) {
        const numbers = new Map();
        const own = new Uint32Array(faces.length);
        const used = [];
        faces.forEach((v, k) => {
            if (!numbers.has(v)) numbers.set(v, numbers.size);
            own[k] = numbers.get(v);
        });
        for (const v of numbers.keys()) used.push(...points.subarray(3 * v, 3 * v + 3));
        const local = Float32Array.from(used);
        const { center, radius } =
            used.length > 0 ? ballOf(local) : { center: this.rest.center, radius: 0 };
        this.radii.push(radius);
        for (let k = 0; k < 3; k++) this.away[3 * i + k] = center[k] - this.rest.center[k];
        return { ...shadedSurface(local, own), vertices: [...numbers.keys()] };
    }

    /** One mesh for all pieces: vertices store the piece, its colour and its direction. */
    join(parts, sources) {
        const total = parts.reduce((sum, part) => sum + part.position.length / 3, 0);
        const position = new Float32Array(3 * total);
        const normal = new Int8Array(4 * total);
        const away = new Float32Array(3 * total);
        const color = new Uint8Array(4 * total);
        const piece = new Float32Array(total);
        const source = sources && new Float32Array(3 * total);
        const index = new Uint32Array(3 * this.firstFace[parts.length]);
        let vertices = 0;
        parts.forEach((part, i) => {
            const rgb = new Color(page.colors[i]).toArray().map((x) => Math.round(255 * x));
            const begin = vertices,
                end = begin + part.position.length / 3;
            position.set(part.position, 3 * begin);
            normal.set(part.normal, 4 * begin);
            index.set(
                part.index.map((corner) => corner + begin),
                3 * this.firstFace[i],
            );
            piece.fill(i, begin, end);
            for (; vertices < end; vertices++) {
                away.set(this.away.subarray(3 * i, 3 * i + 3), 3 * vertices);
                color.set(rgb, 4 * vertices);
                if (source === null) continue;
                const v = part.vertices[part.source[vertices - begin]];
                source.set(sources.subarray(3 * v, 3 * v + 3), 3 * vertices);
            }
        });
        const geometry = new BufferGeometry();
        geometry.setAttribute("position", new BufferAttribute(position, 3));
        geometry.setAttribute("normal", normalAttribute(normal));
        geometry.setAttribute("away", new BufferAttribute(away, 3));
        geometry.setAttribute("color", new BufferAttribute(color, 4, true));
        geometry.setAttribute("piece", new BufferAttribute(piece, 1));
        if (source) geometry.setAttribute("source", new BufferAttribute(source, 3));
        return geometry.setIndex(new BufferAttribute(index, 1));
    }

    /** Distance from the common centre to the displaced pieces. */
    reach(by) {
        let most = this.rest.radius;
        this.radii.forEach((radius, i) => {
            const [dx, dy, dz] = this.away.subarray(3 * i, 3 * i + 3);
            most = Math.max(most, (1 + by) * Math.hypot(dx, dy, dz) + radius);
        });
        return most;
    }

    pick(i) {
        this.material.uniforms.picked.value = i;
    }

    setCutOpen(open) {
        setSides(this.material, true, open);
    }

    /** The first piece that a ray meets, -1 for none: tests every triangle. */
    hit({ origin, direction }) {
        const { position, index, firstFace } = this;
        const by = shared.explode.value;
        let best = -1,
            nearest = Infinity;
        for (let i = 0; i + 1 < firstFace.length; i++) {
            const o = [origin.x, origin.y, origin.z].map((x, k) => x - by * this.away[3 * i + k]);
            for (let c = 3 * firstFace[i]; c < 3 * firstFace[i + 1]; c += 3) {
                const met = meet(
                    o,
                    direction,
                    position,
                    3 * index[c],
                    3 * index[c + 1],
                    3 * index[c + 2],
                );
                if (met === null || met.t >= nearest || this.isCutOff(met, c, i)) continue;
                nearest = met.t;
                best = i;
            }
        }
        return best;
    }

    /** Is what a ray meets in a triangle of piece i cut off? */
    isCutOff({ s, r }, c, i) {
        const cut = shared.cut.value,
            by = this.source ? 0 : shared.explode.value;
        const places = this.source ?? this.position;
        const [x, y, z] = [0, 1, 2].map(
            (k) =>
                by * this.away[3 * i + k] +
                (1 - s - r) * places[3 * this.index[c] + k] +
                s * places[3 * this.index[c + 1] + k] +
                r * places[3 * this.index[c + 2] + k],
        );
        return x * cut.x + y * cut.y + z * cut.z > cut.w;
    }
}

/** Distance t > 0 along a ray to a triangle, and the weights s and r of its last two corners there;
 * null if they do not meet. */
function meet(o, d, p, a, b, c) {
    const ux = p[b] - p[a],
        uy = p[b + 1] - p[a + 1],
        uz = p[b + 2] - p[a + 2];
    const vx = p[c] - p[a],
        vy = p[c + 1] - p[a + 1],
        vz = p[c + 2] - p[a + 2];
    const hx = d.y * vz - d.z * vy,
        hy = d.z * vx - d.x * vz,
        hz = d.x * vy - d.y * vx;
    const scale = 1 / (ux * hx + uy * hy + uz * hz);
    const sx = o[0] - p[a],
        sy = o[1] - p[a + 1],
        sz = o[2] - p[a + 2];
    const s = (sx * hx + sy * hy + sz * hz) * scale;
    if (!(s >= 0 && s <= 1)) return null;
    const qx = sy * uz - sz * uy,
        qy = sz * ux - sx * uz,
        qz = sx * uy - sy * ux;
    const r = (d.x * qx + d.y * qy + d.z * qz) * scale;
    if (!(r >= 0 && s + r <= 1)) return null;
    const t = (vx * qx + vy * qy + vz * qz) * scale;
    return t > 0 ? { t, s, r } : null;
}
