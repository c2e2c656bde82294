// SPDX-License-Identifier: Apache-2.0
// Guarding in the page of `make web` against the program of this machine on one thread: processor time,
// and the memory of the page's program.
//
//   STARGUARD=build/starguard STARGUARD_CHROMIUM=/usr/bin/chromium STARGUARD_MODULES=build/viewer \
//       STARGUARD_PAGE=build-web/starguard.html node bench/web.mjs [VERTICES]
//
// The browser's time is that of all its processes, so what it spends on compiling counts as well.
import { execFileSync, spawnSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
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

execFileSync(program, ["sample", "horse", "--vertices", vertices, "-o", "horse.off", "--quiet"], {
    cwd: folder,
});
const native = nativeSeconds();
const browser = await openBrowser();
const { page } = await openPage(browser, process.env.STARGUARD_PAGE);
await page.setInputFiles("#picker", path.join(folder, "horse.off"));
await page.waitForFunction(() => window.starguard.model && !window.starguard.running);
const session = await browser.newBrowserCDPSession();
const before = await browserSeconds(session);
const memory = await page.evaluate(
    async (line) => (await window.starguard.run(line, ["guards.json"])).memory,
    words,
);
const web = (await browserSeconds(session)) - before;
console.log(
    `${vertices} vertices: native ${native.toFixed(2)} s, page ${web.toFixed(2)} s, ` +
        `ratio ${(web / native).toFixed(2)}, memory ${(memory / 1e6).toFixed(0)} MB`,
);
await browser.close();
rmSync(folder, { recursive: true });
