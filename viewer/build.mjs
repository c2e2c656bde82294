// SPDX-License-Identifier: Apache-2.0
// Bundles the viewer: node build.mjs MODULES OUT.c
//
// page.html, page.css and the modules under main.js become one text, split where a page's data goes,
// and written as two C arrays. The page's content security policy contains the hashes of its style
// and its script: nothing else may run, and nothing may be fetched.
import { createHash } from "node:crypto";
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";
import { fileURLToPath } from "node:url";

const [modules, output] = process.argv.slice(2);
const here = path.dirname(fileURLToPath(import.meta.url));
const { build, transform } = createRequire(path.resolve(modules, "package.json"))("esbuild");

function hashOf(text) {
    return `'sha256-${createHash("sha256").update(text).digest("base64")}'`;
}

async function bundleScript() {
    const result = await build({
        entryPoints: [path.join(here, "main.js")],
        nodePaths: [path.resolve(modules, "node_modules")],
        bundle: true,
        minify: true,
        write: false,
        format: "iife",
        target: "es2020",
        charset: "ascii",
        legalComments: "inline",
    });
    return result.outputFiles[0].text;
}

async function bundleStyle() {
    const text = readFileSync(path.join(here, "page.css"), "utf8");
    return (await transform(text, { loader: "css", minify: true, charset: "ascii" })).code;
}

/** Replaces a mark, which must occur once, by a text. */
function fill(page, mark, text) {
    const parts = page.split(mark);
    if (parts.length !== 2) throw new Error(`page.html must hold ${mark} once`);
    return parts.join(text);
}

function toArray(name, text) {
    const bytes = Buffer.from(text, "utf8");
    const lines = [];
    for (let i = 0; i < bytes.length; i += 24)
        lines.push(Array.from(bytes.subarray(i, i + 24)).join(",") + ",");
    return (
        `const unsigned char starg_viewer_${name}[] = {\n${lines.join("\n")}\n};\n` +
        `const size_t starg_viewer_${name}_size = sizeof starg_viewer_${name};\n`
    );
}

const script = await bundleScript();
const style = await bundleStyle();
if (/<\/script|<!--/i.test(script) || /<\/style/i.test(style))
    throw new Error("the bundle would end its own element");
const policy = `default-src 'none'; img-src data:; style-src ${hashOf(style)}; script-src ${hashOf(script)}`;
let page = readFileSync(path.join(here, "page.html"), "utf8");
page = fill(page, "@policy@", policy);
page = fill(page, "@style@", style);
page = fill(page, "@script@", script);
const [head, tail] = page.split("@data@\n");
if (tail === undefined) throw new Error("page.html must hold @data@ on a line of its own");
writeFileSync(
    output,
    `#include "export/viewer.h"\n\n${toArray("head", head)}\n${toArray("tail", tail)}`,
);
