// SPDX-License-Identifier: Apache-2.0
// Makes the page of `make web`: node build.mjs MODULES PROGRAM.js NATIVE OUT.html, with PROGRAM.wasm
// beside PROGRAM.js, and NATIVE the same command line for this machine.
//
// The page contains the program, compressed, the worker that runs it, and its own script. Its content
// security policy names the hashes of its script and style and of the viewer's, whose pages it shows
// in a frame: nothing else may run, and nothing may be fetched.
import { execFileSync } from "node:child_process";
import { createHash } from "node:crypto";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import os from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

const [modules, program, native, output] = process.argv.slice(2);
const here = path.dirname(fileURLToPath(import.meta.url));
const { build, transform } = createRequire(path.resolve(modules, "package.json"))("esbuild");

const hashOf = (text) => `'sha256-${createHash("sha256").update(text).digest("base64")}'`;
const textOf = (name) => readFileSync(path.join(here, name), "utf8");
const starguard = (words) => execFileSync(native, words, { encoding: "utf8", maxBuffer: 1 << 26 });

async function workerScript() {
    const text = readFileSync(program, "utf8") + textOf("worker.js");
    return (await transform(text, { minify: true, charset: "ascii" })).code;
}

/** Modules that exist only here. */
function given(texts) {
    return {
        name: "given",
        setup(building) {
            const filter = new RegExp(`^(${Object.keys(texts).join("|")})$`);
            building.onResolve({ filter }, ({ path: name }) => ({ path: name, namespace: "given" }));
            building.onLoad({ filter: /.*/, namespace: "given" }, ({ path: name }) => texts[name]);
        },
    };
}

async function pageScript() {
    const { samples } = JSON.parse(starguard(["sample", "--list", "--json"]));
    const result = await build({
        entryPoints: [path.join(here, "app.js")],
        nodePaths: [path.resolve(modules, "node_modules")],
        plugins: [
            given({
                "worker-text": { contents: await workerScript(), loader: "text" },
                samples: { contents: JSON.stringify(samples), loader: "json" },
            }),
        ],
        bundle: true,
        minify: true,
        write: false,
        format: "iife",
        target: "es2020",
        charset: "ascii",
    });
    return result.outputFiles[0].text.replaceAll("</script", "<\\/script");
}

async function pageStyle() {
    const text = textOf("../viewer/page.css") + textOf("page.css");
    return (await transform(text, { loader: "css", minify: true, charset: "ascii" })).code;
}

/** The hashes of the viewer's style and script, from a page of it. */
function viewerHashes() {
    const folder = mkdtempSync(path.join(os.tmpdir(), "starguard-web-"));
    const model = path.join(folder, "torus.off");
    starguard(["sample", "torus", "-o", model, "--quiet"]);
    const page = starguard(["view", model, "-o", "-", "--quiet"]);
    rmSync(folder, { recursive: true });
    const [, style, script] = page.match(/style-src ('[^']*'); script-src ('[^']*')/);
    return { style, script };
}

function fill(page, mark, text) {
    const parts = page.split(mark);
    if (parts.length !== 2) throw new Error(`page.html must hold ${mark} once`);
    return parts.join(text);
}

const script = await pageScript();
const style = await pageStyle();
const viewer = viewerHashes();
const policy = [
    "default-src 'none'",
    "img-src data: blob:",
    `style-src ${hashOf(style)} ${viewer.style}`,
    `script-src ${hashOf(script)} ${viewer.script} 'wasm-unsafe-eval'`,
    "worker-src blob:",
].join("; ");
const packed = gzipSync(readFileSync(program.replace(/js$/, "wasm")), { level: 9 });
let page = textOf("page.html");
page = fill(page, "@policy@", policy);
page = fill(page, "@style@", style);
page = fill(page, "@program@", packed.toString("base64"));
page = fill(page, "@script@", script);
writeFileSync(output, page);
console.log(`${output}: ${(page.length / 1e6).toFixed(2)} MB`);
