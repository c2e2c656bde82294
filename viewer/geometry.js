// SPDX-License-Identifier: Apache-2.0
// Surfaces in the form of the graphics card: vertices with normals.

const CREASE = Math.cos((38 * Math.PI) / 180);

/** Unit normals of faces, and their areas (doubled). */
function faceNormals(points, faces) {
    const count = faces.length / 3;
    const normals = new Float32Array(3 * count);
    const areas = new Float32Array(count);
    for (let f = 0; f < count; f++) {
        const a = 3 * faces[3 * f],
            b = 3 * faces[3 * f + 1],
            c = 3 * faces[3 * f + 2];
        const ux = points[b] - points[a],
            uy = points[b + 1] - points[a + 1],
            uz = points[b + 2] - points[a + 2];
        const vx = points[c] - points[a],
            vy = points[c + 1] - points[a + 1],
            vz = points[c + 2] - points[a + 2];
        const x = uy * vz - uz * vy,
            y = uz * vx - ux * vz,
            z = ux * vy - uy * vx;
        const length = Math.hypot(x, y, z);
        areas[f] = length;
        const by = length > 0 ? 1 / length : 0;
        normals[3 * f] = x * by;
        normals[3 * f + 1] = y * by;
        normals[3 * f + 2] = z * by;
    }
    return { normals, areas };
}

/** Corners by vertex: those of vertex v are corners[first[v]] to corners[first[v + 1] - 1]. */
function cornersByVertex(vertexCount, faces) {
    const first = new Uint32Array(vertexCount + 1);
    for (const v of faces) first[v + 1]++;
    for (let v = 0; v < vertexCount; v++) first[v + 1] += first[v];
    const next = first.slice(0, vertexCount);
    const corners = new Uint32Array(faces.length);
    for (let i = 0; i < faces.length; i++) corners[next[faces[i]]++] = i;
    return { first, corners };
}

/**
 * A surface that is smooth except at creases: a vertex is split where the directions of its faces
 * differ much. `source` maps each new vertex to its original.
 */
export function shadedSurface(points, faces) {
    const { normals, areas } = faceNormals(points, faces);
    const vertexCount = points.length / 3;
    const { first, corners } = cornersByVertex(vertexCount, faces);
    const index = new Uint32Array(faces.length);
    const source = [];
    const sums = []; // of the normals, by new vertex
    for (let v = 0; v < vertexCount; v++) {
        const begin = source.length; // the new vertices of v
        for (let i = first[v]; i < first[v + 1]; i++) {
            const f = Math.floor(corners[i] / 3);
            const x = normals[3 * f],
                y = normals[3 * f + 1],
                z = normals[3 * f + 2];
            let k = begin;
            for (; k < source.length; k++) {
                const sx = sums[3 * k],
                    sy = sums[3 * k + 1],
                    sz = sums[3 * k + 2];
                if (x * sx + y * sy + z * sz >= CREASE * Math.hypot(sx, sy, sz)) break;
            }
            if (k === source.length) {
                source.push(v);
                sums.push(0, 0, 0);
            }
            const weight = areas[f] + 1e-12;
            sums[3 * k] += weight * x;
            sums[3 * k + 1] += weight * y;
            sums[3 * k + 2] += weight * z;
            index[corners[i]] = k;
        }
    }
    return { index, source: Uint32Array.from(source), ...gather(points, source, sums) };
}

function gather(points, source, sums) {
    const position = new Float32Array(3 * source.length);
    const normal = new Int8Array(4 * source.length);
    for (let k = 0; k < source.length; k++) {
        const length = Math.hypot(sums[3 * k], sums[3 * k + 1], sums[3 * k + 2]) || 1;
        for (let c = 0; c < 3; c++) {
            position[3 * k + c] = points[3 * source[k] + c];
            normal[4 * k + c] = Math.round((127 * sums[3 * k + c]) / length);
        }
    }
    return { position, normal };
}

/** Vertex normals of one frame of a moving surface, smooth everywhere. */
export function smoothNormals(points, faces) {
    const { normals, areas } = faceNormals(points, faces);
    const sums = new Float32Array(points.length);
    for (let i = 0; i < faces.length; i++) {
        const f = Math.floor(i / 3);
        for (let c = 0; c < 3; c++) sums[3 * faces[i] + c] += areas[f] * normals[3 * f + c];
    }
    const packed = new Int8Array((4 * points.length) / 3);
    for (let v = 0; v < points.length / 3; v++) {
        const length = Math.hypot(sums[3 * v], sums[3 * v + 1], sums[3 * v + 2]) || 1;
        for (let c = 0; c < 3; c++)
            packed[4 * v + c] = Math.round((127 * sums[3 * v + c]) / length);
    }
    return packed;
}

/** Centre of the bounding box of points, and their largest distance from it; one array or several. */
export function ballOf(...arrays) {
    const lower = [Infinity, Infinity, Infinity],
        upper = [-Infinity, -Infinity, -Infinity];
    for (const points of arrays)
        for (let i = 0; i < points.length; i++) {
            lower[i % 3] = Math.min(lower[i % 3], points[i]);
            upper[i % 3] = Math.max(upper[i % 3], points[i]);
        }
    const center = lower.map((x, k) => (x + upper[k]) / 2);
    let radius = 0;
    for (const points of arrays)
        for (let i = 0; i < points.length; i += 3)
            radius = Math.max(
                radius,
                Math.hypot(
                    points[i] - center[0],
                    points[i + 1] - center[1],
                    points[i + 2] - center[2],
                ),
            );
    return { center, radius: radius || 1 };
}
