// SPDX-License-Identifier: Apache-2.0
// What the tests of pages and their benchmark share: a browser, and watching what a page does.
import { existsSync } from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";
import { pathToFileURL } from "node:url";

const FLAGS = [
    "--headless",
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
];

/** Why no page can be looked at, or null. */
export function whatIsMissing() {
    const { STARGUARD_CHROMIUM: chromium, STARGUARD_MODULES: modules } = process.env;
    if (!chromium || !existsSync(chromium))
        return "Chromium is not installed (apt-get install chromium)";
    if (!modules || !existsSync(path.join(modules, "node_modules", "playwright-core")))
        return "playwright-core is not there: this build has no viewer (docs/viewer.md)";
    return null;
}

export async function openBrowser() {
    const require = createRequire(path.resolve(process.env.STARGUARD_MODULES, "package.json"));
    const { chromium } = require("playwright-core");
    return chromium.launch({
        executablePath: process.env.STARGUARD_CHROMIUM,
        args: FLAGS,
        timeout: 0,
    });
}

/** A page to open files in, one after the other, that keeps all errors and requests since the last was opened. */
export async function newPage(browser, options = {}) {
    const context = await browser.newContext({
        viewport: { width: 800, height: 560 },
        ...options,
    });
    const page = await context.newPage();
    page.setDefaultTimeout(0); // a busy machine takes as long as it takes
    const watched = {};
    let address;
    page.on("console", (message) =>
        watched.errors.push(`${message.type()}: ${message.text()}`),
    );
    page.on("pageerror", (error) => watched.errors.push(String(error)));
    page.on("request", (request) => {
        if (request.url() !== address && !request.url().startsWith("data:"))
            watched.requests.push(request.url());
    });
    page.on("dialog", (dialog) => {
        watched.dialogs++;
        dialog.dismiss();
    });
    /** Opens a file, and waits until it is ready. */
    const open = async (file) => {
        Object.assign(watched, { errors: [], requests: [], dialogs: 0 });
        address = pathToFileURL(file).href;
        await page.goto(address);
        await page.waitForSelector("html[data-ready=true]");
    };
    return { page, watched, open, close: () => context.close() };
}

export async function openPage(browser, file, options = {}) {
    const opened = await newPage(browser, options);
    await opened.open(file);
    return opened;
}
