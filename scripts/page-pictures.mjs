// SPDX-License-Identifier: Apache-2.0
// Draws the pictures of pages in docs/: guards, pieces moved apart, and a proof, all of samples.
//
//   STARGUARD=build/starguard STARGUARD_CHROMIUM=/usr/bin/chromium STARGUARD_MODULES=build/viewer \
//       node scripts/page-pictures.mjs
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import os from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { openBrowser, openPage, whatIsMissing } from "../tests/viewer/browser.mjs";

const missing = whatIsMissing();
if (missing !== null) {
    console.error(`page-pictures.mjs: ${missing}`);
    process.exit(1);
}
const program = path.resolve(process.env.STARGUARD);
const pictures = fileURLToPath(new URL("../docs/pictures/", import.meta.url));
const folder = mkdtempSync(path.join(os.tmpdir(), "starguard-pictures-"));
const starguard = (...words) => execFileSync(program, [...words, "--quiet"], { cwd: folder });

/** Opens a page, lets `act` do something in it, and keeps what it shows. */
async function picture(browser, file, name, colorScheme, act) {
    const viewport = { width: 1280, height: 800 };
    const { page, close } = await openPage(browser, path.join(folder, file), {
        viewport,
        colorScheme,
    });
    await act(page);
    await page.waitForTimeout(1000); // until it is drawn
    await page.screenshot({ path: path.join(pictures, name) });
    await close();
}

const browser = await openBrowser();
try {
    starguard("sample", "horse", "-o", "horse.off");
    starguard("guard", "horse.off", "-o", "guards.json");
    starguard("decompose", "horse.off", "-o", "pieces.vtk", "--report", "pieces.json");
    starguard("view", "guards.json", "pieces.vtk", "pieces.json", "-o", "horse.html");
    starguard("sample", "human", "--vertices", "1000", "-o", "human.off");
    starguard("guard", "human.off", "--prove", "--certificate", "why.txt", "-o", "proven.json");
    starguard("view", "proven.json", "why.txt", "-o", "human.html");
    await picture(browser, "horse.html", "view-guards.png", "light", (page) =>
        page.getByRole("button", { name: "Guard 0 " }).click(),
    );
    await picture(browser, "horse.html", "view-pieces.png", "dark", async (page) => {
        await page.getByRole("tab", { name: "Pieces" }).click();
        await page.locator("#explode").fill("0.35");
    });
    await picture(browser, "human.html", "view-proof.png", "light", (page) =>
        page.locator("#proof").check(),
    );
} finally {
    await browser.close();
    rmSync(folder, { recursive: true });
}
