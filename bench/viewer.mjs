// SPDX-License-Identifier: Apache-2.0
// Frame times of a page against a plain three.js page of the same mesh, in one headless browser.
//
//   STARGUARD=build/starguard STARGUARD_CHROMIUM=/usr/bin/chromium STARGUARD_MODULES=build/viewer \
//       node bench/viewer.mjs [VERTICES]
//
// The plain page is a typical first three.js program: MeshStandardMaterial under two lights, vertex
// normals, the same canvas, antialiasing and camera. Both rotate the model by one degree per frame; a
// frame ends when a pixel has been read back. Frames of both pages alternate in pairs, so that other
// load affects both; the ratio is the median over the pairs. The graphics card here is software
// (SwiftShader): only the ratio applies to other machines.
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import os from "node:os";
import path from "node:path";
import { openBrowser, openPage, whatIsMissing } from "../tests/viewer/browser.mjs";

const missing = whatIsMissing();
if (missing !== null) {
    console.error(`bench/viewer.mjs: ${missing}`);
    process.exit(1);
}
const vertices = process.argv[2] ?? "100000";
const PAIRS = 25;
const FRAMES = 2; // per page and pair; the faster one counts
const SIZE = { width: 1280, height: 800 };
const folder = mkdtempSync(path.join(os.tmpdir(), "starguard-bench-"));
const fileOf = (name) => path.join(folder, name);
const require = createRequire(path.resolve(process.env.STARGUARD_MODULES, "package.json"));

function starguard(...words) {
    execFileSync(process.env.STARGUARD, [...words, "--quiet"], { cwd: folder });
}

/** The plain page: a canvas of the same size, and `frame(opacity)`, which draws one more. */
async function writePlainPage() {
    writeFileSync(
        fileOf("plain.js"),
        `import * as THREE from "three";
const numbers = JSON.parse(document.getElementById("mesh").textContent);
const geometry = new THREE.BufferGeometry();
geometry.setAttribute("position", new THREE.Float32BufferAttribute(numbers.points, 3));
geometry.setIndex(numbers.faces);
geometry.computeVertexNormals();
geometry.computeBoundingSphere();
const { center, radius } = geometry.boundingSphere;
const material = new THREE.MeshStandardMaterial({ color: 0x9fb2c6 });
const scene = new THREE.Scene();
scene.add(new THREE.Mesh(geometry, material), new THREE.AmbientLight(0xffffff, 1));
const light = new THREE.DirectionalLight(0xffffff, 2);
light.position.set(-1, 2, 2);
scene.add(light);
const width = ${SIZE.width} - 340, height = ${SIZE.height};
const camera = new THREE.PerspectiveCamera(32, width / height, radius / 500, radius * 200);
const renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true });
renderer.setSize(width, height);
document.body.append(renderer.domElement);
let turned = 0;
window.frame = (opacity) => {
    material.opacity = opacity;
    if (material.transparent !== opacity < 1) {
        material.transparent = opacity < 1;
        material.needsUpdate = true;
    }
    turned += Math.PI / 180;
    const direction = new THREE.Vector3(Math.sin(turned), 0.34, Math.cos(turned)).normalize();
    camera.position.copy(direction.multiplyScalar((1.02 * radius) / Math.sin((16 * Math.PI) / 180))).add(center);
    camera.lookAt(center);
    renderer.render(scene, camera);
    const gl = renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
};
document.documentElement.dataset.ready = "true";`,
    );
    const { outputFiles } = await require("esbuild").build({
        entryPoints: [fileOf("plain.js")],
        nodePaths: [path.resolve(process.env.STARGUARD_MODULES, "node_modules")],
        bundle: true,
        minify: true,
        write: false,
    });
    const words = readFileSync(fileOf("model.off"), "utf8").split(/\s+/).slice(1);
    const [v, f] = words.map(Number);
    const points = words.slice(3, 3 + 3 * v).map(Number);
    const faces = words.slice(3 + 3 * v).map(Number);
    const corners = Array.from({ length: f }, (_, i) => faces.slice(4 * i + 1, 4 * i + 4)).flat();
    writeFileSync(
        fileOf("plain.html"),
        `<!doctype html><meta charset="utf-8"><title>plain</title><link rel="icon" href="data:,"><body style="margin:0">
<script type="application/json" id="mesh">${JSON.stringify({ points, faces: corners })}</script>
<script>${outputFiles[0].text}</script>`,
    );
    return f;
}

/** Milliseconds per frame in a block. */
const drawPlain = (page, opacity) =>
    page.evaluate(
        ([frames, clear]) => {
            const times = [];
            for (let i = 0; i < frames; i++) {
                const begun = performance.now();
                window.frame(clear);
                times.push(performance.now() - begun);
            }
            return times;
        },
        [FRAMES, opacity],
    );

const drawOurs = (page) =>
    page.evaluate((frames) => {
        const { stage } = window.starguard;
        const gl = stage.renderer.getContext();
        const times = [];
        for (let i = 0; i < frames; i++) {
            const begun = performance.now();
            stage.turn(1, 0);
            stage.draw();
            gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
            times.push(performance.now() - begun);
        }
        return times;
    }, FRAMES);

function median(numbers) {
    return [...numbers].sort((a, b) => a - b)[Math.floor(numbers.length / 2)];
}

async function compare(name, ours, plain, opacity) {
    await drawOurs(ours);
    await drawPlain(plain, opacity);
    const pairs = [];
    for (let i = 0; i < PAIRS; i++)
        pairs.push([
            Math.min(...(await drawOurs(ours))),
            Math.min(...(await drawPlain(plain, opacity))),
        ]);
    const a = median(pairs.map((pair) => pair[0]));
    const b = median(pairs.map((pair) => pair[1]));
    const ratio = median(pairs.map((pair) => pair[0] / pair[1]));
    console.log(
        `${name.padEnd(34)} ${a.toFixed(1).padStart(8)} ms ${b.toFixed(1).padStart(8)} ms   ratio ${ratio.toFixed(2)}`,
    );
}

const setOpacity = (page, x) =>
    page.evaluate((value) => {
        const slider = document.getElementById("opacity");
        slider.value = value;
        slider.dispatchEvent(new Event("input"));
    }, x);

starguard("sample", "horse", "--vertices", vertices, "-o", "model.off");
starguard("guard", "model.off", "-o", "guards.json", "--method", "greedy", "--count", "100");
starguard("view", "guards.json", "-o", "ours.html");
const faces = await writePlainPage();
const browser = await openBrowser();
try {
    const ours = await openPage(browser, fileOf("ours.html"), { viewport: SIZE });
    const plain = await openPage(browser, fileOf("plain.html"), { viewport: SIZE });
    console.log(
        `${faces} triangles, ${SIZE.width - 340} x ${SIZE.height} pixels: page, plain three.js page`,
    );
    await compare("half transparent", ours.page, plain.page, 0.3);
    await setOpacity(ours.page, 1);
    await compare("solid", ours.page, plain.page, 1);
    await setOpacity(ours.page, 0.3);
    await ours.page.evaluate(() => window.starguard.views[0].pick(0));
    await compare("a guard picked; plain: solid", ours.page, plain.page, 1);
    await ours.page.keyboard.press("c");
    await compare("and cut open; plain: solid", ours.page, plain.page, 1);
} finally {
    await browser.close();
    rmSync(folder, { recursive: true });
}
