// SPDX-License-Identifier: Apache-2.0
// The page of `make web` as a browser runs it: what it computes is what the program of this machine
// computes and verifies, it can be cancelled, and it asks for nothing.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import os from "node:os";
import path from "node:path";
import test, { after, before } from "node:test";
import { openBrowser, openPage, whatIsMissing } from "../viewer/browser.mjs";

const PAGE = process.env.STARGUARD_PAGE;
const missing = whatIsMissing() ?? (existsSync(PAGE) ? null : `there is no ${PAGE} ('make web' builds it)`);
if (missing !== null) {
    console.log(`skipped: ${missing}`);
    process.exit();
}

const MOST = 5e6; // bytes of the page
const folder = mkdtempSync(path.join(os.tmpdir(), "starguard-web-"));
const fileOf = (name) => path.join(folder, name);
let browser;

/** The program of this machine, in the folder; its standard output. */
function native(...words) {
    return execFileSync(process.env.STARGUARD, words, { cwd: folder, encoding: "utf8" });
}

function sample(name, ...words) {
    native("sample", name, "-o", `${name}.off`, "--quiet", ...words);
    return `${name}.off`;
}

before(async () => {
    browser = await openBrowser();
});

after(async () => {
    await browser?.close();
    rmSync(folder, { recursive: true });
});

/** Opens the page, does something with it, and holds it to be quiet all along. */
async function look(work) {
    const { page, watched, close } = await openPage(browser, PAGE);
    try {
        await work(page);
        // blobs are the page's own memory: the workers
        watched.requests = watched.requests.filter((address) => !address.startsWith("blob:"));
        assert.deepEqual(watched, { errors: [], requests: [], dialogs: 0 });
    } finally {
        await close();
    }
}

const isIdle = (page) => page.waitForFunction(() => window.starguard.running === null);

async function open(page, file) {
    await page.setInputFiles("#picker", fileOf(file));
    await page.waitForFunction((name) => window.starguard.model === name, file);
    await isIdle(page);
}

async function press(page, name) {
    await page.getByRole("button", { name }).click();
    await isIdle(page);
}

/** Drops files, given by name and content, on the page. */
async function drop(page, files) {
    const data = await page.evaluateHandle((all) => {
        const carried = new DataTransfer();
        for (const [name, content] of all)
            carried.items.add(new File([Uint8Array.from(content)], name));
        return carried;
    }, files.map(([name, content]) => [name, [...Buffer.from(content)]]));
    await page.dispatchEvent("#stage", "drop", { dataTransfer: data });
}

const noticeOf = (page) => page.locator("#notice").innerText();

/** Keeps a file of the page in the folder, as a visitor does. */
async function keep(page, name, as) {
    const waiting = page.waitForEvent("download");
    await page.locator("#files button", { hasText: name }).click();
    const download = await waiting;
    assert.equal(download.suggestedFilename(), name);
    await download.saveAs(fileOf(as));
}

const readJson = (name) => JSON.parse(readFileSync(fileOf(name), "utf8"));

test("the page is small, and its policy forbids all but itself", () => {
    assert.ok(statSync(PAGE).size <= MOST, `${statSync(PAGE).size} bytes`);
    const policy = readFileSync(PAGE, "utf8").match(/Content-Security-Policy" content="([^"]*)"/)[1];
    assert.match(policy, /^default-src 'none';/);
    assert.doesNotMatch(policy, /unsafe-inline|'unsafe-eval|https?:|\*/);
});

test("guards and bounds are those of this machine's program", async () => {
    const models = [
        [sample("l-room"), ["--prove"]],
        [sample("star"), []],
        [sample("plate", "--vertices", "500"), []],
        [sample("horse", "--vertices", "900"), []],
        [sample("dog", "--vertices", "600"), ["--seed", "3"]],
    ];
    await look(async (page) => {
        for (const [file, options] of models) {
            await open(page, file);
            await page.fill("input[aria-label='Options of guard']", options.join(" "));
            await press(page, "Place guards");
            await keep(page, "guards.json", "web.json");
            native("guard", file, "-o", "native.json", "--quiet", ...options);
            const [web, own] = [readJson("web.json"), readJson("native.json")];
            assert.ok(own.optimal, `${file}: chosen so that both prove`);
            for (const key of ["lower_bound", "optimal", "lower_bound_everywhere", "optimal_everywhere"])
                assert.equal(web[key], own[key], `${file}: ${key}`);
            assert.equal(web.guards.length, own.guards.length, file);
            native("verify", file, "web.json", "--quiet"); // throws if it is refused
            const shown = await page.locator("#guarded").innerText();
            assert.match(shown, new RegExp(`^Guards\\s+${web.guards.length}\\b`));
        }
    });
});

test("pieces are those of this machine's program, and shown in the viewer", async () => {
    const file = sample("torus", "--vertices", "500");
    await look(async (page) => {
        await open(page, file);
        await page.fill("input[aria-label='Options of decompose']", "--effort 5");
        await press(page, "Cut into star pieces");
        await keep(page, "pieces.vtk", "web.vtk");
        await keep(page, "pieces.json", "web-pieces.json");
        native("verify", file, "web.vtk", "web-pieces.json", "--quiet");
        native("decompose", file, "-o", "own.vtk", "--report", "own.json", "--effort", "5", "--quiet");
        assert.equal(readJson("web-pieces.json").pieces.length, readJson("own.json").pieces.length);
        const viewer = page.frameLocator("#view");
        await viewer.getByRole("tab", { name: "Pieces" }).or(viewer.locator("#title")).first().waitFor();
        assert.match(await viewer.locator("#views").innerText(), /star/i);
        const lines = await page.locator("#commands code").allInnerTexts();
        assert.deepEqual(lines, [
            "starguard check torus.off",
            "starguard decompose torus.off -o pieces.vtk --report pieces.json --effort 5",
        ]);
    });
});

test("a dropped mesh with a hole: findings, and its repair", async () => {
    const text = readFileSync(fileOf(sample("star")), "utf8").trimEnd().split("\n");
    const counts = text[1].split(" ").map(Number);
    text[1] = `${counts[0]} ${counts[1] - 1} 0`;
    writeFileSync(fileOf("open.off"), text.slice(0, -1).join("\n") + "\n");
    const own = JSON.parse(
        spawnSync(process.env.STARGUARD, ["check", "open.off", "--json"], { cwd: folder, encoding: "utf8" })
            .stdout,
    );
    await look(async (page) => {
        await drop(page, [["<b>open</b>.off", readFileSync(fileOf("open.off"))]]);
        // a name has no folders: what is before the last slash is cut off
        await page.waitForFunction(() => window.starguard.model === "b>.off");
        await isIdle(page);
        const found = await page.locator("#found").innerText();
        assert.match(found, new RegExp(`${own.findings.open_edges.count} open edges: `));
        assert.match(found, /not a usable solid/);
        await press(page, "Repair it");
        assert.match(await page.locator("#found").innerText(), /Solid\s+yes/);
    });
});

/** A GLB of boxes: nodes with a name, a material, a middle and half sizes; the first is mirrored. */
function glbOf(boxes) {
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [i & 1, (i >> 1) & 1, i >> 2].map((bit) => 2 * bit - 1));
    const quads = [0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5];
    const triangles = [0, 4, 8, 12, 16, 20].flatMap((q) =>
        [0, 1, 2, 0, 2, 3].map((k) => quads[q + k]));
    const binary = Buffer.concat([
        Buffer.from(Float32Array.from(corners.flat()).buffer),
        Buffer.from(Uint16Array.from(triangles).buffer),
    ]);
    const json = {
        asset: { version: "2.0" },
        scene: 0,
        scenes: [{ nodes: boxes.map((_, i) => i) }],
        nodes: boxes.map(({ name, middle, half }, i) => ({
            name,
            mesh: i,
            translation: middle,
            scale: i === 0 ? [-half[0], half[1], half[2]] : half,
            rotation: [0, 0, Math.SQRT1_2, Math.SQRT1_2],
        })),
        materials: boxes.map(({ material }) => ({ name: material })),
        meshes: boxes.map((_, i) => ({
            primitives: [{ attributes: { POSITION: 0 }, indices: 1, material: i }],
        })),
        accessors: [
            { bufferView: 0, componentType: 5126, count: 8, type: "VEC3", min: [-1, -1, -1], max: [1, 1, 1] },
            { bufferView: 1, componentType: 5123, count: 36, type: "SCALAR" },
        ],
        bufferViews: [
            { buffer: 0, byteOffset: 0, byteLength: 96 },
            { buffer: 0, byteOffset: 96, byteLength: 72 },
        ],
        buffers: [{ byteLength: binary.length }],
    };
    let text = JSON.stringify(json);
    text = text.padEnd(4 * Math.ceil(text.length / 4));
    const head = Buffer.alloc(20),
        chunk = Buffer.alloc(8);
    head.write("glTF");
    head.writeUInt32LE(2, 4);
    head.writeUInt32LE(28 + text.length + binary.length, 8);
    head.writeUInt32LE(text.length, 12);
    head.write("JSON", 16);
    chunk.writeUInt32LE(binary.length, 0);
    chunk.write("BIN\0", 4);
    return Buffer.concat([head, Buffer.from(text), chunk, binary]);
}

const hall = [
    { name: "Hall of glass", material: "Plaster", middle: [3, 4, 1.5], half: [4, 3, 1.5] },
    { name: "Crate", material: "Wood", middle: [3, 4, 0.5], half: [0.5, 0.5, 0.5] },
];

test("a dropped GLB, guarded with a field of view, is what starguard-import makes of it", async () => {
    writeFileSync(fileOf("hall.glb"), glbOf(hall));
    await look(async (page) => {
        await drop(page, [["hall.glb", readFileSync(fileOf("hall.glb"))]]);
        await page.waitForFunction(() => window.starguard.model === "hall.ply");
        await isIdle(page);
        await page.selectOption("select[aria-label='Guards stand']", "among loose faces");
        await page.selectOption("select[aria-label='To be seen']", "large faces in parts");
        await page.fill("input[aria-label='Field of view']", "90,60");
        await page.fill("input[aria-label='Options of guard']", "--see 'Hall of glass' --from 1,1,1 --two-sided --effort quick");
        await press(page, "Place guards");
        await keep(page, "guards.json", "web.json");
        await keep(page, "hall.ply", "hall.ply");
        native("verify", "hall.ply", "web.json", "--quiet");
        assert.ok(readJson("web.json").guards.length > 1);
        assert.deepEqual(await page.locator("#commands code").allInnerTexts(), [
            "starguard-import hall.glb > hall.ply",
            "starguard check hall.ply",
            "starguard guard hall.ply -o guards.json --patch auto --soup --fov 90,60 --see 'Hall of glass' --from 1,1,1 --two-sided --effort quick",
        ]);
    });
    // there the matrices of nodes are in single precision
    const check = (name) => JSON.parse(native("check", name, "--json"));
    const [own, made] = [check("hall.glb"), check("hall.ply")];
    assert.deepEqual([made.model.vertices, made.model.faces], [own.model.vertices, own.model.faces]);
    for (const key of ["area", "volume", "diagonal"])
        assert.ok(Math.abs(made[key] - own[key]) <= 1e-6 * own[key], `${key}: ${made[key]}, ${own[key]}`);
});

test("a second mesh is an obstacle, and can be taken away", async () => {
    const file = sample("l-room");
    writeFileSync(fileOf("crate.glb"), glbOf([{ ...hall[1], middle: [0.3, 0.3, 0.3], half: [0.1, 0.1, 0.1] }]));
    await look(async (page) => {
        await open(page, file);
        await page.setInputFiles("#obstacle-picker", fileOf("crate.glb"));
        await page.getByRole("button", { name: "Remove crate.ply" }).waitFor();
        await press(page, "Place guards");
        await keep(page, "guards.json", "web.json");
        await keep(page, "crate.ply", "crate.ply");
        assert.equal(readJson("web.json").scene.obstacles.length, 1);
        native("verify", file, "web.json", "--quiet");
        await page.getByRole("button", { name: "Remove crate.ply" }).click();
        await press(page, "Place guards");
        await keep(page, "guards.json", "web.json");
        assert.equal(readJson("web.json").scene, undefined);
    });
});

test("what is dropped and not taken is said", async () => {
    const file = sample("octopus", "--vertices", "3000");
    await look(async (page) => {
        await drop(page, [["picture.png", "no mesh"]]);
        assert.match(await noticeOf(page), /picture\.png is not taken: a mesh is a file named \.off, /);
        await drop(page, []);
        assert.match(await noticeOf(page), /no file/);
        await drop(page, [["broken.glb", "glTF that is none"]]);
        await page.waitForFunction(() => document.querySelector("#notice").textContent.includes("cannot be read"));
        await drop(page, [[file, readFileSync(fileOf(file))], [file, readFileSync(fileOf(file))]]);
        assert.match(await noticeOf(page), /Of 2 files octopus\.off is taken/);
        await page.waitForFunction(() => window.starguard.model === "octopus.off");
        await isIdle(page);
        await page.getByRole("button", { name: "Place guards" }).click();
        await drop(page, [[file, "OFF"]]);
        assert.match(await noticeOf(page), /A run is going on/);
        await page.getByRole("button", { name: "Cancel" }).click();
        await isIdle(page);
    });
});

test("a file that is no mesh is refused with the program's words", async () => {
    writeFileSync(fileOf("text.off"), "this is no mesh\n");
    await look(async (page) => {
        await page.setInputFiles("#picker", fileOf("text.off"));
        await page.locator("#found .warn").first().waitFor();
        assert.match(await page.locator("#found").innerText(), /text\.off/);
        assert.equal(await page.evaluate(() => window.starguard.files.size), 0);
    });
});

test("a run can be cancelled, and the next one works", async () => {
    const file = sample("octopus", "--vertices", "3000");
    await look(async (page) => {
        await open(page, file);
        await page.getByRole("button", { name: "Place guards" }).click();
        await page.getByRole("button", { name: "Cancel" }).click();
        await isIdle(page);
        assert.equal(await page.textContent("#said"), "Cancelled");
        assert.equal(await page.evaluate(() => window.starguard.files.has("guards.json")), false);
        await open(page, sample("l-room"));
        await press(page, "Place guards");
        assert.equal(await page.evaluate(() => window.starguard.files.has("guards.json")), true);
    });
});
