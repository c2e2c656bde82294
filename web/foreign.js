// SPDX-License-Identifier: Apache-2.0
// Scenes (GLB, 3MF) as the binary PLY that starguard-import makes of them on a machine: transforms of
// nodes applied in doubles, corners of a mesh at equal positions one vertex, names of nodes and of
// materials as groups (docs/formats.md). three.js reads them; images are not needed and not read.
import { Vector3 } from "three";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import { ThreeMFLoader } from "three/examples/jsm/loaders/3MFLoader.js";

const nothing = () => Promise.resolve(null);

/** The scene of a GLB, and the name that it gives the node of a mesh. */
async function readGlb(bytes) {
    const loader = new GLTFLoader().register(() => ({ name: "no images", loadTexture: nothing }));
    const { scene, parser } = await loader.parseAsync(bytes.buffer, "");
    const nodeOf = (object) => parser.associations.get(object)?.nodes;
    const nameOf = (mesh) => {
        const node = nodeOf(mesh) ?? nodeOf(mesh.parent);
        return parser.json.nodes?.[node]?.name ?? mesh.name;
    };
    return { scene, nameOf };
}

function read3mf(bytes) {
    const scene = new ThreeMFLoader().parse(bytes.buffer);
    return { scene, nameOf: (mesh) => mesh.name || mesh.parent?.name || "" };
}

const readers = { glb: readGlb, "3mf": read3mf };

/** The extension of a name, in small letters, without the dot. */
export const extension = (name) => name.match(/\.([^.]+)$/)?.[1].toLowerCase() ?? "";

export const isForeign = (name) => extension(name) in readers;

/** A number for each distinct text, in the order in which they are met. */
class Names {
    numbers = new Map();

    number(text) {
        if (!this.numbers.has(text)) this.numbers.set(text, this.numbers.size);
        return this.numbers.get(text);
    }

    comments(kind) {
        // one line each: what a header cannot hold becomes _
        const named = [...this.numbers].filter(([text]) => text !== "");
        return named.map(([text, i]) => `comment ${kind} ${i} ${text.replace(/[\x00-\x1f]/g, "_")}\n`);
    }
}

/** Vertices of one mesh in space, equal ones once, and for each corner the number of its vertex. */
function placed(mesh, base) {
    const positions = mesh.geometry.attributes.position;
    const seen = new Map(),
        points = [],
        numbers = [],
        p = new Vector3();
    for (let i = 0; i < positions.count; i++) {
        p.fromBufferAttribute(positions, i).applyMatrix4(mesh.matrixWorld);
        const key = `${p.x + 0},${p.y + 0},${p.z + 0}`;
        if (!seen.has(key)) {
            seen.set(key, base + seen.size);
            points.push(p.x + 0, p.y + 0, p.z + 0);
        }
        numbers.push(seen.get(key));
    }
    return { points, numbers };
}

/** Material of each triangle: geometries may have several, by ranges of their corners. */
function materialAt(mesh, corner) {
    if (!Array.isArray(mesh.material)) return mesh.material;
    const range = mesh.geometry.groups.find(({ start, count }) => corner >= start && corner < start + count);
    return mesh.material[range?.materialIndex ?? 0];
}

function collect({ scene, nameOf }) {
    const groups = new Names(),
        materials = new Names(),
        points = [],
        faces = []; // a, b, c, group, material
    scene.updateMatrixWorld(true);
    scene.traverse((mesh) => {
        if (!mesh.isMesh) return;
        const { points: own, numbers } = placed(mesh, points.length / 3);
        for (const coordinate of own) points.push(coordinate);
        const { index } = mesh.geometry;
        const corners = index ? index.count : numbers.length;
        const cornerAt = (i) => numbers[index ? index.getX(i) : i];
        const group = groups.number(nameOf(mesh));
        const [second, third] = mesh.matrixWorld.determinant() < 0 ? [2, 1] : [1, 2];
        for (let i = 0; i + 2 < corners; i += 3)
            faces.push(
                cornerAt(i),
                cornerAt(i + second),
                cornerAt(i + third),
                group,
                materials.number(materialAt(mesh, i)?.name ?? ""),
            );
    });
    return { groups, materials, points, faces };
}

/** Binary PLY of the scene that a file's bytes hold. */
export async function toPly(name, bytes) {
    const { groups, materials, points, faces } = collect(await readers[extension(name)](bytes));
    if (faces.length === 0) throw new Error("the file has no faces");
    const header = new TextEncoder().encode(
        "ply\nformat binary_little_endian 1.0\n" +
            groups.comments("group").join("") +
            materials.comments("material").join("") +
            `element vertex ${points.length / 3}\nproperty double x\nproperty double y\nproperty double z\n` +
            `element face ${faces.length / 5}\nproperty list uchar int vertex_indices\n` +
            "property int group\nproperty int material\nend_header\n",
    );
    const result = new Uint8Array(header.length + 8 * points.length + (21 * faces.length) / 5);
    const view = new DataView(result.buffer);
    result.set(header);
    let at = header.length;
    for (const coordinate of points) {
        view.setFloat64(at, coordinate, true);
        at += 8;
    }
    for (let i = 0; i < faces.length; i++) {
        if (i % 5 === 0) view.setUint8(at++, 3);
        view.setInt32(at, faces[i], true);
        at += 4;
    }
    return result;
}
