// SPDX-License-Identifier: Apache-2.0
// Guarding in the page of `make web` against the program of this machine on one thread: a horse, by processor
// time, with the memory of the page's program; and a hall as GLB, dropped, guarded with a field of view and
// downloaded, by the clock.
//
//   STARGUARD=build/starguard STARGUARD_CHROMIUM=/usr/bin/chromium STARGUARD_MODULES=build/viewer \
//       STARGUARD_PAGE=build-web/starguard.html node bench/web.mjs [VERTICES]
//
// The browser's time is that of all its processes, so what it spends on compiling counts as well.
import { execFileSync, spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import os from "node:os";
import path from "node:path";
import { openBrowser, openPage, whatIsMissing } from "../tests/viewer/browser.mjs";

const missing = whatIsMissing();
if (missing !== null) {
    console.error(`bench/web.mjs: ${missing}`);
    process.exit(1);
}
const vertices = process.argv[2] ?? "5000";
const folder = mkdtempSync(path.join(os.tmpdir(), "starguard-bench-"));
const program = path.resolve(process.env.STARGUARD);
const words = ["guard", "horse.off", "-o", "guards.json"];

function nativeSeconds() {
    const script = `TIMEFORMAT='%U %S'; time "$@" > /dev/null`;
    const { stderr } = spawnSync(
        "bash",
        ["-c", script, "bash", program, ...words, "--threads", "1", "--quiet"],
        { cwd: folder, encoding: "utf8" },
    );
    const [user, system] = stderr.trim().split(" ").map(Number);
    return user + system;
}

async function browserSeconds(session) {
    const { processInfo } = await session.send("SystemInfo.getProcessInfo");
    return processInfo.reduce((sum, { cpuTime }) => sum + cpuTime, 0);
}

function run(...line) {
    execFileSync(program, [...line, "--quiet"], { cwd: folder });
}

async function secondsOf(work) {
    const start = Date.now();
    await work();
    return (Date.now() - start) / 1000;
}

function tell(what, native, web, more = "") {
    const ratio = (web / native).toFixed(2);
    console.log(`${what}: native ${native.toFixed(2)} s, page ${web.toFixed(2)} s, ratio ${ratio}${more}`);
}

async function guardHorse(browser) {
    run("sample", "horse", "--vertices", vertices, "-o", "horse.off");
    const native = nativeSeconds();
    const { page, close } = await openPage(browser, process.env.STARGUARD_PAGE);
    await page.setInputFiles("#picker", path.join(folder, "horse.off"));
    await page.waitForFunction(() => window.starguard.model && !window.starguard.running);
    const session = await browser.newBrowserCDPSession();
    const before = await browserSeconds(session);
    const memory = await page.evaluate(
        async (line) => (await window.starguard.run(line, ["guards.json"])).memory,
        words,
    );
    const web = (await browserSeconds(session)) - before;
    tell(`horse of ${vertices} vertices`, native, web, `, memory ${(memory / 1e6).toFixed(0)} MB`);
    await close();
}

async function guardHall(browser) {
    const options = ["--fov", "90,60", "--threads", "1"];
    run("sample", "gallery", "--vertices", vertices, "-o", "hall.off");
    run("export", "hall.off", "-o", "hall.glb");
    const native = await secondsOf(() => {
        run("check", "hall.glb");
        run("guard", "hall.glb", ...options, "-o", "guards.json");
    });
    const { page, close } = await openPage(browser, process.env.STARGUARD_PAGE);
    const content = [...readFileSync(path.join(folder, "hall.glb"))];
    const dropped = await page.evaluateHandle((bytes) => {
        const carried = new DataTransfer();
        carried.items.add(new File([Uint8Array.from(bytes)], "hall.glb"));
        return carried;
    }, content);
    const isIdle = () => page.waitForFunction(() => window.starguard.model && window.starguard.running === null);
    const web = await secondsOf(async () => {
        await page.dispatchEvent("#stage", "drop", { dataTransfer: dropped });
        await page.waitForFunction(() => window.starguard.model === "hall.ply");
        await isIdle();
        await page.fill("input[aria-label='Field of view']", "90,60");
        await page.getByRole("button", { name: "Place guards" }).click();
        await isIdle();
        const waiting = page.waitForEvent("download");
        await page.locator("#files button", { hasText: "guards.json" }).click();
        await (await waiting).saveAs(path.join(folder, "web.json"));
    });
    tell(`hall of ${vertices} vertices as GLB, on the clock`, native, web);
    await close();
}

const browser = await openBrowser();
await guardHorse(browser);
await guardHall(browser);
await browser.close();
rmSync(folder, { recursive: true });
