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
        [sample("dog", "--vertices", "600"), ["--seed", "7"]],
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
        const data = await page.evaluateHandle((content) => {
            const carried = new DataTransfer();
            carried.items.add(new File([content], "<b>open</b>.off"));
            return carried;
        }, readFileSync(fileOf("open.off"), "utf8"));
        await page.dispatchEvent("#stage", "drop", { dataTransfer: data });
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
