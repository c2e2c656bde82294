// SPDX-License-Identifier: Apache-2.0
// V-HACD beside star-shaped pieces, on the samples of docs/convex.md.
//
//   npm install --prefix FOLDER vhacd-js
//   node bench/vhacd.mjs STARGUARD FOLDER [SAMPLE...]
//
// vhacd-js (BSD) is V-HACD as WebAssembly. For each sample: convex hulls by its defaults, and as many as
// `decompose` has star-shaped pieces; by how much the volumes of the hulls sum to more than the solid's;
// processor seconds.
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import os from "node:os";
import path from "node:path";
import { pathToFileURL } from "node:url";

const [program, modules, ...names] = process.argv.slice(2);
if (modules === undefined) {
    console.error("usage: node bench/vhacd.mjs STARGUARD FOLDER [SAMPLE...]");
    process.exit(1);
}
// What the bundle, made for Node's older modules, looks for.
globalThis.__dirname = process.cwd();
globalThis.require = createRequire(import.meta.url);
const { ConvexMeshDecomposition } = await import(
    pathToFileURL(path.join(modules, "node_modules", "vhacd-js", "lib", "vhacd.js")));
const decomposer = await ConvexMeshDecomposition.create();

function read(file) {
    const positions = [], indices = [];
    for (const line of readFileSync(file, "utf8").split("\n")) {
        const words = line.trim().split(/\s+/);
        if (words[0] === "v")
            positions.push(...words.slice(1, 4).map(Number));
        else if (words[0] === "f")
            indices.push(...words.slice(1, 4).map((word) => parseInt(word, 10) - 1));
    }
    return { positions: new Float64Array(positions), indices: new Uint32Array(indices) };
}

function volume({ positions, indices }) {
    let sum = 0;
    for (let i = 0; i < indices.length; i += 3) {
        const [a, b, c] = [0, 1, 2].map((k) => positions.subarray(3 * indices[i + k], 3 * indices[i + k] + 3));
        sum += a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    return Math.abs(sum) / 6;
}

const folder = mkdtempSync(path.join(os.tmpdir(), "starguard-vhacd-"));
try {
    console.log("| sample | hulls | beyond the solid | s |\n|---|--:|--:|--:|");
    for (const name of names.length > 0 ? names : ["horse", "octopus", "gallery"]) {
        const file = path.join(folder, "model.obj"), report = path.join(folder, "pieces.json");
        execFileSync(program, ["sample", name, "--vertices", "500", "-o", file, "--quiet"]);
        execFileSync(program, ["decompose", file, "-o", path.join(folder, "pieces.vtk"), "--report", report, "--quiet"]);
        const mesh = read(file), pieces = JSON.parse(readFileSync(report, "utf8")).strictly_star;
        for (const options of [{}, { maxHulls: pieces }]) {
            const before = process.cpuUsage();
            const hulls = decomposer.computeConvexHulls(mesh, options);
            const { user, system } = process.cpuUsage(before);
            const sum = hulls.reduce((total, hull) => total + volume(hull), 0);
            console.log(`| ${name} | ${hulls.length} | ${(100 * (sum / volume(mesh) - 1)).toFixed(0)} % | ` +
                `${((user + system) / 1e6).toFixed(1)} |`);
        }
    }
} finally {
    rmSync(folder, { recursive: true });
}
