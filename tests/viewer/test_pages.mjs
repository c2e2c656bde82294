// SPDX-License-Identifier: Apache-2.0
// Pages as a browser shows them: they load, answer to mouse, touch and keys, ask for nothing, run
// nothing but their own script, and say what they show.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import os from "node:os";
import path from "node:path";
import test, { after, before } from "node:test";
import { pathToFileURL } from "node:url";
import { newPage, openBrowser, openPage, whatIsMissing } from "./browser.mjs";

const missing = whatIsMissing();
if (missing !== null) {
    console.log(`skipped: ${missing}`);
    process.exit();
}

const folder = mkdtempSync(path.join(os.tmpdir(), "starguard-pages-"));
const HOSTILE = "<script>alert(1)<\u2215script>.off"; // a file name cannot hold a slash
let browser, shared; // a page for all that need no options

function starguard(...words) {
    return execFileSync(process.env.STARGUARD, [...words, "--quiet"], {
        cwd: folder,
        encoding: "utf8",
    });
}

function fileOf(name) {
    return path.join(folder, name);
}

before(async () => {
    browser = await openBrowser();
    shared = await newPage(browser);
    starguard("sample", "horse", "--vertices", "500", "-o", "horse.off");
    starguard("sample", "horse", "--pose", "1", "--vertices", "500", "-o", "other.off");
    starguard("guard", "horse.off", "-o", "guards.json");
    starguard(
        "decompose",
        "horse.off",
        "-o",
        "pieces.vtk",
        "--report",
        "pieces.json",
        "--mode",
        "paper",
    );
    starguard("skeleton", "horse.off", "-o", "skeleton.obj", "--nodes", "80");
    starguard(
        "morph",
        "horse.off",
        "other.off",
        "--frames",
        "4",
        "--method",
        "linear",
        "-o",
        "frames",
        "--glb",
        "morph.glb",
    );
    writeFileSync(
        fileOf("table.csv"),
        `model,horse.off,"<img src=x onerror=alert(1)>",other.off\nhorse.off,0,2,1\n"<img src=x onerror=alert(1)>",2,0,3\nother.off,1,3,0\n`,
    );
    starguard(
        "view",
        "guards.json",
        "pieces.vtk",
        "pieces.json",
        "skeleton.obj",
        "frames",
        "table.csv",
        "-o",
        "all.html",
    );
});

after(async () => {
    await browser?.close();
    rmSync(folder, { recursive: true });
});

/** Opens a file, does something with it, and holds it to be quiet all along. Those without options are
 * loaded into one page after the other: to begin a page takes longer. */
async function look(name, options, work) {
    const plain = Object.keys(options).length === 0;
    const { page, watched, open, close } = plain ? shared : await newPage(browser, options);
    try {
        await open(fileOf(name));
        await work(page);
        assert.deepEqual(watched, { errors: [], requests: [], dialogs: 0 });
    } finally {
        if (!plain) await close();
    }
}

const said = (page) => page.textContent("#said");
const openTab = (page, name) => page.getByRole("tab", { name }).click();

/** Waits until nothing is drawn any more; how many frames were drawn until then. */
function settle(page) {
    return page.evaluate(async () => {
        const { stage } = window.starguard;
        for (let before = -1; before !== stage.frames || stage.waiting;) {
            before = stage.frames;
            for (let i = 0; i < 3; i++) await new Promise(requestAnimationFrame);
        }
        return stage.frames;
    });
}

/** The pixels of the canvas, and what is behind them. They are read as they are drawn: what a screenshot
 * shows may be older on a busy machine. */
async function picture(page) {
    await settle(page);
    return page.evaluate(() => {
        const { stage } = window.starguard;
        stage.draw();
        return stage.canvas.toDataURL() + getComputedStyle(document.body).backgroundColor;
    });
}

async function placeOfGuard(page, i) {
    const box = await page.locator("#canvas").boundingBox();
    const spot = await page.evaluate((guard) => {
        const { stage, views } = window.starguard;
        return stage.project(...views[0].points.place(guard));
    }, i);
    return { x: box.x + spot.x, y: box.y + spot.y };
}

/** Number of faces that are painted in a colour. */
const paintedFaces = (page) =>
    page.evaluate(() =>
        window.starguard.views[0].surface.kinds.reduce((sum, kind) => sum + (kind >= 2), 0),
    );

test("a click on a guard shows what it sees", async () => {
    const guards = JSON.parse(readFileSync(fileOf("guards.json"), "utf8")).guards;
    await look("all.html", {}, async (page) => {
        await settle(page);
        for (const i of [0, guards.length - 1]) {
            const { x, y } = await placeOfGuard(page, i);
            await page.mouse.click(x, y);
            assert.match(
                await said(page),
                new RegExp(`^Guard ${i} sees ${guards[i].faces.toLocaleString("en")} faces? of `),
            );
            assert.equal(await paintedFaces(page), guards[i].faces);
            assert.equal(
                await page.getByRole("button", { name: `Guard ${i} `, pressed: true }).count(),
                1,
            );
            assert.match(await page.textContent("#tag"), new RegExp(`^Guard ${i} `));
        }
        await page.mouse.click(5, 5); // beside the model
        assert.equal(await paintedFaces(page), 0);
    });
});

test("the first guards' faces are those of the coverage curve", async () => {
    const { coverage, model } = JSON.parse(readFileSync(fileOf("guards.json"), "utf8"));
    await look("all.html", {}, async (page) => {
        const slider = page.locator("#first-guards");
        for (let k = coverage.curve.length - 1; k >= 0; k--) {
            await slider.fill(String(k));
            const fraction = k === 0 ? 0 : coverage.curve[k - 1][0];
            assert.equal(await paintedFaces(page), Math.round(fraction * model.faces));
        }
    });
});

test("obstacles are shown, and a switch hides them", async () => {
    const corners = [0, 1].flatMap((z) => [0, 1].flatMap((y) => [0, 1].map((x) => [x, y, z])));
    const faces = ["0 2 1", "1 2 3", "4 5 6", "5 7 6", "0 1 4", "1 5 4", "2 6 3", "3 6 7", "0 4 2", "2 4 6", "1 3 5", "3 7 5"];
    const points = corners.map((p) => p.map((x) => 0.3 + 0.4 * x).join(" "));
    writeFileSync(fileOf("box.off"), ["OFF", "8 12 0", ...points, ...faces.map((f) => `3 ${f}`)].join("\n"));
    starguard("sample", "l-room", "--vertices", "500", "-o", "room.off");
    starguard("guard", "room.off", "--obstacles", "box.off", "--count", "60", "-o", "crate.json");
    starguard("view", "crate.json", "-o", "crate.html");
    await look("crate.html", {}, async (page) => {
        const with_ = await picture(page);
        const box = page.getByRole("checkbox", { name: "Obstacles (12 faces)" });
        await box.uncheck();
        assert.notEqual(await picture(page), with_);
        await box.check();
        assert.equal(await picture(page), with_);
    });
});

test("every slider moves, by key and to both ends", async () => {
    await look("all.html", {}, async (page) => {
        for (const name of ["Guards", "Pieces", "Skeleton", "Morph"]) {
            await openTab(page, name);
            await page.getByRole("radio", { name: "X", exact: true }).click(); // lays open the slider of the cut
            const sliders = page.locator("input[type=range]:visible");
            for (let i = 0; i < (await sliders.count()); i++) {
                const slider = sliders.nth(i);
                const values = new Set();
                for (const key of ["Home", "End", "ArrowLeft"]) {
                    await slider.press(key);
                    values.add(await slider.getAttribute("aria-valuetext"));
                    await settle(page);
                }
                assert.ok(values.size >= 2, `${name}: slider ${i} says ${[...values]}`);
            }
            await page.getByRole("radio", { name: "Off", exact: true }).click();
        }
    });
});

test("pieces move apart, are cut and are picked", async () => {
    await look("all.html", {}, async (page) => {
        await openTab(page, "Pieces");
        const whole = await picture(page);
        await page.locator("#explode").fill("0.5");
        const apart = await picture(page);
        await page.keyboard.press("Escape");
        await page.locator("#explode").fill("0");
        assert.ok(whole !== apart);
        await page.getByRole("radio", { name: "Y", exact: true }).first().click();
        const cut = await picture(page);
        assert.ok(whole !== cut);
        await page.locator("#flip").click();
        assert.ok(cut !== (await picture(page)));
        await page.getByRole("radio", { name: "Off", exact: true }).click();
        const box = await page.locator("#canvas").boundingBox();
        await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
        assert.match(await said(page), /^Piece \d+: volume .*(star-shaped)/);
    });
});

test("a morph plays, and stands still when it does not", async () => {
    await look("all.html", {}, async (page) => {
        await openTab(page, "Morph");
        const time = page.locator("#time");
        await page.locator("#canvas").focus();
        await page.keyboard.press(" ");
        await page.waitForFunction(() => document.getElementById("time").valueAsNumber > 0.02);
        assert.equal(await page.textContent("#play"), "Pause");
        await page.keyboard.press(" ");
        const still = await time.inputValue();
        const frames = await settle(page);
        await page.waitForTimeout(500);
        assert.equal(await time.inputValue(), still);
        assert.equal(await page.evaluate(() => window.starguard.stage.frames), frames);
        await time.fill("0");
        const first = await picture(page);
        await time.fill("1");
        assert.ok(first !== (await picture(page)));
    });
});

test("frames of a .glb are those of the folder", async () => {
    starguard("view", "morph.glb", "-o", "glb.html");
    starguard("view", "frames", "-o", "frames.html");
    const read = (page) =>
        page.evaluate(() => window.starguard.views[0].frames.map((points) => [...points]));
    let folderFrames, glbFrames;
    await look("frames.html", {}, async (page) => (folderFrames = await read(page)));
    await look("glb.html", {}, async (page) => (glbFrames = await read(page)));
    assert.equal(folderFrames.length, 4);
    folderFrames.forEach((points, i) =>
        points.forEach((x, k) => assert.ok(Math.abs(x - glbFrames[i][k]) < 1e-5)),
    );
});

test("the table of distances ranks and names", async () => {
    await look("all.html", {}, async (page) => {
        await openTab(page, "Retrieval");
        await page.locator("#matrix canvas").focus();
        await page.keyboard.press("ArrowDown");
        assert.equal(await said(page), "<img src=x onerror=alert(1)>: most like horse.off");
        assert.equal(
            await page
                .locator("#views .list")
                .last()
                .innerText()
                .then((text) => text.split("\n")[0]),
            "horse.off",
        );
        await page.keyboard.press("ArrowUp");
        assert.equal(await said(page), "horse.off: most like other.off");
        const pictures = page.locator("#views img");
        assert.equal(await pictures.count(), 2); // of the two models that are there
        for (const image of await pictures.all())
            assert.ok((await image.evaluate((node) => node.naturalWidth)) > 0);
    });
});

test("every key of the help does what it says", async () => {
    await look("all.html", {}, async (page) => {
        const pressed = () => page.locator(".list button[aria-pressed=true]:visible").innerText();
        await page.locator("#canvas").focus();
        await page.keyboard.press("Escape"); // what to try first goes away with the first key
        const start = await picture(page);
        for (const key of ["ArrowLeft", "ArrowUp", "+", "-"]) {
            const before = await picture(page);
            await page.keyboard.press(key);
            assert.ok(before !== (await picture(page)), `${key} changes the view`);
        }
        await page.keyboard.press("0");
        assert.ok(start === (await picture(page)), "0 gives the first view");
        await page.keyboard.press("n");
        assert.match(await pressed(), /^Guard 0\s/);
        await page.keyboard.press("n");
        assert.match(await pressed(), /^Guard 1\s/);
        await page.keyboard.press("p");
        assert.match(await pressed(), /^Guard 0\s/);
        await page.keyboard.press("Escape");
        assert.equal(await page.locator(".list button[aria-pressed=true]:visible").count(), 0);
        await page.keyboard.press("c");
        assert.equal(await said(page), "Cut across X");
        await page.keyboard.press("2");
        assert.equal(await page.getByRole("tab", { name: "Pieces", selected: true }).count(), 1);
        await page.keyboard.press("e");
        assert.equal(await page.locator("#explode").inputValue(), "0.5");
        await page.keyboard.press("?");
        assert.ok(await page.locator("dialog#help").isVisible());
        await page.keyboard.press("Escape");
        assert.ok(!(await page.locator("dialog#help").isVisible()));
    });
});

test("light and dark follow the system and the switch", async () => {
    const theme = (page) => page.evaluate(() => document.documentElement.dataset.theme);
    await look("all.html", { colorScheme: "dark" }, async (page) => {
        assert.equal(await theme(page), "dark");
        await page.emulateMedia({ colorScheme: "light" });
        await page.waitForFunction(() => document.documentElement.dataset.theme === "light");
        const light = await picture(page);
        await page.getByRole("button", { name: "Light or dark" }).click();
        assert.equal(await theme(page), "dark");
        assert.ok(light !== (await picture(page)));
    });
});

test("no view is wider than a narrow window, and a tap picks", async () => {
    for (const width of [320, 740]) {
        await look(
            "all.html",
            { viewport: { width, height: 700 }, hasTouch: true, isMobile: true },
            async (page) => {
                for (const name of ["Guards", "Pieces", "Skeleton", "Morph", "Retrieval"]) {
                    await openTab(page, name);
                    await settle(page);
                    const widths = await page.evaluate(() => [
                        document.documentElement.scrollWidth,
                        document.getElementById("panel").scrollWidth,
                        window.innerWidth,
                    ]);
                    assert.ok(
                        widths[0] <= width && widths[1] <= width && widths[2] === width,
                        `${name}: ${widths}`,
                    );
                }
                const table = page.locator("#matrix canvas");
                const [room, shown] = [page.locator("#matrix"), table].map((at) => at.boundingBox());
                const [outer, inner] = [await room, await shown];
                assert.ok(inner.x >= outer.x && inner.x + inner.width <= outer.x + outer.width);
                await table.tap({ position: { x: inner.width - 4, y: 0.6 * inner.height } });
                assert.match(await said(page), / and .*: distance /);
                assert.ok(await page.getByText("The picked cell").isVisible());
                await openTab(page, "Guards");
                await settle(page);
                const { x, y } = await placeOfGuard(page, 0);
                await page.touchscreen.tap(x, y);
                assert.match(await said(page), /^Guard \d+ sees /);
            },
        );
    }
});

test("controls have names, tabs are tabs", async () => {
    await look("all.html", {}, async (page) => {
        const nameless = await page.evaluate(
            () =>
                [
                    ...document.querySelectorAll(
                        "button, input, canvas, svg[role=img], dialog, [role]",
                    ),
                ].filter(
                    (node) =>
                        !(
                            node.getAttribute("aria-label") ||
                            node.getAttribute("aria-labelledby") ||
                            node.textContent.trim() ||
                            node.closest("label")?.textContent.trim() ||
                            node.id === "said"
                        ),
                ).length,
        );
        assert.equal(nameless, 0);
        await page.getByRole("tab", { name: "Guards" }).focus();
        await page.keyboard.press("ArrowRight");
        assert.equal(await page.getByRole("tab", { name: "Pieces", selected: true }).count(), 1);
        assert.ok(await page.getByRole("tabpanel", { name: "Pieces" }).isVisible());
        assert.equal(await page.locator("[role=tabpanel]:visible").count(), 1);
    });
});

test("names are text, whatever they are", async () => {
    mkdirSync(fileOf("hostile"));
    const model = path.join("hostile", HOSTILE);
    writeFileSync(fileOf(model), readFileSync(fileOf("horse.off")));
    starguard("guard", model, "-o", "hostile.json", "--method", "greedy", "--count", "60");
    starguard("view", "hostile.json", "-o", "hostile.html");
    await look("hostile.html", {}, async (page) => {
        assert.equal(await page.textContent("#title"), HOSTILE);
        assert.equal(await page.title(), `${HOSTILE} – starguard`);
        assert.equal(await page.locator("script").count(), 2); // the data and the viewer; blocks of arrays are gone
    });
});

test("a folder named </script> stays text too", async () => {
    mkdirSync(path.join(fileOf("<"), "script><script>alert(1)<", "script>"), { recursive: true });
    const model = "</script><script>alert(1)</script>/horse.off";
    writeFileSync(fileOf(model), readFileSync(fileOf("horse.off")));
    starguard("guard", model, "-o", "folder.json", "--method", "greedy", "--count", "60");
    starguard("view", "folder.json", "-o", "folder.html");
    await look("folder.html", {}, async (page) =>
        assert.equal(await page.textContent("#title"), "horse.off"),
    );
});

test("the page's policy keeps other scripts and the network out", async () => {
    const { page, watched, close } = await openPage(browser, fileOf("all.html"));
    const reached = await page.evaluate(async () => {
        const script = document.createElement("script");
        script.textContent = "window.intruder = true";
        document.body.append(script);
        const answer = await fetch("http://127.0.0.1:9/").then(
            () => "fetched",
            () => "refused",
        );
        return [window.intruder === true, answer];
    });
    assert.deepEqual(reached, [false, "refused"]);
    assert.ok(watched.errors.some((text) => text.includes("Content Security Policy")));
    await close();
});

test("without WebGL a page says so", async () => {
    const context = await browser.newContext();
    const page = await context.newPage();
    await page.addInitScript(() => (HTMLCanvasElement.prototype.getContext = () => null));
    await page.goto(pathToFileURL(fileOf("all.html")).href);
    assert.match(await page.innerText("#hint"), /WebGL 2 is missing/);
    assert.equal(await page.textContent("#title"), "horse.off");
    await context.close();
});

test("results with next to nothing in them are shown", async () => {
    const guards = JSON.parse(readFileSync(fileOf("guards.json"), "utf8"));
    guards.guards = [];
    guards.coverage.curve = [];
    writeFileSync(fileOf("none.json"), JSON.stringify(guards));
    writeFileSync(fileOf("dot.obj"), "v 0 0.5 0\n");
    const points = "POINTS 5 double\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n";
    const cells = "CELLS 2 10\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES 2\n10\n10\n";
    const labels = "CELL_DATA 2\nSCALARS piece int 1\nLOOKUP_TABLE default\n1\n1\n"; // there is no piece 0
    writeFileSync(
        fileOf("gap.vtk"),
        `# vtk DataFile Version 3.0\npieces\nASCII\nDATASET UNSTRUCTURED_GRID\n${points}${cells}${labels}`,
    );
    writeFileSync(fileOf("one.csv"), "model,a\na,0\n");
    starguard("view", "none.json", "gap.vtk", "dot.obj", "one.csv", "-o", "little.html");
    await look("little.html", {}, async (page) => {
        for (const name of ["Guards", "Pieces", "Skeleton", "Retrieval"]) {
            await openTab(page, name);
            for (const key of ["n", "p", "Escape", "c", "e", "0"]) await page.keyboard.press(key);
            await settle(page);
        }
    });
});

test("guards with a cone of view point to where they look", async () => {
    starguard("guard", "horse.off", "-o", "cone.json", "--cone", "120", "--method", "greedy", "--count", "100");
    starguard("view", "cone.json", "-o", "cone.html");
    const directions = JSON.parse(readFileSync(fileOf("cone.json"), "utf8")).guards.map(
        (guard) => guard.direction,
    );
    await look("cone.html", {}, async (page) => {
        const ends = await page.evaluate(() => [
            ...window.starguard.views[0].pointers.geometry.attributes.position.array,
        ]);
        directions.forEach((direction, i) =>
            direction.forEach((d, k) =>
                assert.ok(Math.abs((ends[6 * i + 3 + k] - ends[6 * i + k]) / 0.14 - d) < 1e-4),
            ),
        );
    });
});

test("cameras show the outline of what they see", async () => {
    const words = ["guard", "horse.off", "-o", "fov.json", "--fov", "100,70", "--method", "greedy", "--count", "100"];
    starguard(...words);
    starguard("view", "fov.json", "-o", "fov.html");
    const { guards } = JSON.parse(readFileSync(fileOf("fov.json"), "utf8"));
    const half = [50, 35].map((degrees) => Math.tan((degrees * Math.PI) / 180));
    const diagonal = 1 / Math.hypot(1, ...half); // cosine between the direction and a corner
    const dot = (a, b) => a.reduce((sum, x, k) => sum + x * b[k], 0);
    await look("fov.html", {}, async (page) => {
        const told = await page.evaluate(() => window.starguard.views[0].told.list);
        told.forEach(({ direction, corners }, i) => {
            assert.equal(corners.length, 4);
            for (const corner of corners)
                assert.ok(Math.abs(dot(corner, guards[i].direction) - diagonal) < 1e-6);
            // opposite corners are twice the diagonal apart, neighbours lie on one side
            const across = dot(corners[0], corners[2]);
            assert.ok(Math.abs(across - (2 * diagonal * diagonal - 1)) < 1e-6);
            assert.ok(Math.abs(dot(direction, corners[1]) - diagonal) < 1e-6);
        });
        const drawn = await page.evaluate(
            () => window.starguard.views[0].cones.geometry.attributes.position.count,
        );
        assert.equal(drawn, guards.length * 16); // four rays and four edges
    });
});

test("numbers stand beside the guards, and go with the box", async () => {
    await look("all.html", {}, async (page) => {
        await settle(page);
        const labels = page.locator(".labels:visible span:visible");
        const shown = await labels.allInnerTexts();
        assert.ok(shown.length > 0);
        for (const number of shown) {
            const spot = await placeOfGuard(page, Number(number));
            const box = await page
                .locator(".labels:visible span:visible", { hasText: new RegExp(`^${number}$`) })
                .boundingBox();
            assert.ok(Math.hypot(box.x - spot.x, box.y + box.height / 2 - spot.y) < 20, number);
        }
        await page.locator("#numbers").uncheck();
        await settle(page);
        assert.equal(await labels.count(), 0);
    });
});

test("the commands that make results again are copied", async () => {
    const lines = {
        Guards: "starguard guard horse.off -o guards.json",
        Pieces: "starguard decompose horse.off -o pieces.vtk --report pieces.json --mode paper",
        Retrieval: "starguard db matrix shapes.db -o distances.csv --distance d2",
    };
    starguard("sample", "cat", "--vertices", "500", "-o", "cat.off");
    starguard("db", "create", "shapes.db");
    starguard("db", "add", "shapes.db", "cat.off");
    const results = ["guards.json", "pieces.vtk", "pieces.json", "shapes.db"];
    starguard("view", ...results, "--distance", "d2", "-o", "commands.html");
    await look("commands.html", {}, async (page) => {
        await page.evaluate(() => {
            window.copied = [];
            const writeText = async (text) => window.copied.push(text);
            Object.defineProperty(navigator, "clipboard", { value: { writeText } });
        });
        for (const [tab, line] of Object.entries(lines)) {
            await openTab(page, tab);
            const command = page.locator(".command:visible");
            assert.equal(await command.locator("code").textContent(), line);
            await command.getByRole("button", { name: "Copy" }).click();
            await command.getByRole("button", { name: "Copied" }).waitFor();
        }
        assert.deepEqual(await page.evaluate(() => window.copied), Object.values(lines));
        // without a clipboard the line is selected
        await page.evaluate(() => (navigator.clipboard.writeText = () => Promise.reject()));
        await page.locator(".command:visible button").click();
        await page.waitForFunction(
            (line) => getSelection().toString() === line,
            Object.values(lines).at(-1),
        );
    });
});

test("a proof shows its witnesses and the boxes of guards", async () => {
    starguard("sample", "gallery", "--vertices", "500", "-o", "room.off");
    const proof = ["--prove", "--prove-work", "60000", "--count", "100", "--certificate", "why.txt"];
    starguard("guard", "room.off", ...proof, "-o", "proven.json");
    starguard("view", "proven.json", "why.txt", "-o", "proof.html");
    const lines = readFileSync(fileOf("why.txt"), "utf8").split("\n");
    const witnesses = Number(lines.find((line) => line.startsWith("witnesses ")).slice(10));
    await look("proof.html", {}, async (page) => {
        const shown = () =>
            page.evaluate(() => window.starguard.views[0].proof.object.visible);
        assert.equal(await shown(), false);
        await page.check("#proof");
        assert.equal(await shown(), true);
        assert.equal(await paintedFaces(page), witnesses);
        await page.uncheck("#proof");
        assert.equal(await paintedFaces(page), 0);
    });
});

test("a map shows both solids by one camera, alike in colours, patterns and cuts", async () => {
    starguard("sample", "human", "--vertices", "500", "-o", "a.off");
    starguard("sample", "human", "--pose", "1", "--vertices", "500", "-o", "b.off");
    starguard("map", "--solid", "a.off", "b.off", "--steps", "5", "-o", "map.vtu");
    starguard("view", "map.vtu", "-o", "map.html");
    /** Colours of the pixels of either half that are not the background: their number. */
    const colors = (page) =>
        page.evaluate(() => {
            const { stage } = window.starguard;
            stage.draw();
            const gl = stage.renderer.getContext();
            const [w, h] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
            const pixels = new Uint8Array(4 * w * h);
            gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
            const counts = [0, 0];
            for (let i = 0; i < w * h; i++)
                if (pixels[4 * i + 3] > 0) counts[i % w < w / 2 ? 0 : 1]++;
            return counts;
        });
    await look("map.html", {}, async (page) => {
        await settle(page);
        const told = await page.evaluate(() => {
            const { ends, told } = window.starguard.views[0];
            const ofEnd = ({ parts }) => ({
                position: [...parts.position],
                source: [...parts.source],
            });
            return { list: told.list, ends: ends.map(ofEnd) };
        });
        // A's own places, of which those of the images are a selection too
        assert.deepEqual(told.ends[0].position, told.ends[0].source);
        const places = new Set(told.ends[0].source.map(String));
        assert.ok(told.ends[1].source.every((x) => places.has(String(x))));
        assert.notDeepEqual(told.ends[1].position, told.ends[1].source);
        const whole = await colors(page);
        assert.ok(whole[0] > 1000 && whole[1] > 1000, `both are drawn: ${whole}`);
        // one camera: a turn changes both halves
        const before = await picture(page);
        await page.locator("#canvas").focus();
        await page.keyboard.press("ArrowLeft");
        assert.ok(before !== (await picture(page)));
        // a click on a guard in either half picks the piece in both
        for (const side of [0, 1]) {
            const spot = await page.evaluate((end) => {
                const { stage, views } = window.starguard;
                return stage.project(...views[0].ends[end].points.place(0), end);
            }, side);
            const box = await page.locator("#canvas").boundingBox();
            assert.ok(side === 0 ? spot.x < box.width / 2 : spot.x > box.width / 2);
            await page.mouse.click(box.x + spot.x, box.y + spot.y);
            assert.match(await said(page), /^Piece 0: \d+ tetrahedra, in A and in B$/);
            const picked = await page.evaluate(() =>
                window.starguard.views[0].ends.map(
                    ({ parts }) => parts.material.uniforms.picked.value,
                ),
            );
            assert.deepEqual(picked, [0, 0]);
            await page.keyboard.press("Escape");
        }
        // patterns, and a cut that takes from both
        const plain = await picture(page);
        for (const name of ["Checker", "Lines"]) {
            await page.getByRole("radio", { name }).click();
            assert.equal(await said(page), `Colours: ${name.toLowerCase()}`);
            assert.ok(plain !== (await picture(page)), name);
        }
        await page.keyboard.press("c");
        await settle(page);
        const cut = await colors(page);
        assert.ok(cut[0] < 0.9 * whole[0] && cut[1] < 0.9 * whole[1], `${cut} of ${whole}`);
        await page.getByRole("radio", { name: "Pieces" }).click();
        await page.keyboard.press("e");
        assert.equal(await page.locator("#map-explode").inputValue(), "0.5");
    });
});

test("a map beside pieces: tabs change between one picture and two", async () => {
    starguard("view", "map.vtu", "pieces.vtk", "pieces.json", "-o", "both.html");
    await look("both.html", {}, async (page) => {
        const told = () =>
            page.evaluate(() => {
                const { stage } = window.starguard;
                return { sides: stage.sides, aspect: stage.camera.aspect };
            });
        await openTab(page, "Map");
        const two = await told();
        await page.keyboard.press("e");
        await openTab(page, "Pieces");
        const one = await told();
        assert.deepEqual([two.sides, one.sides], [2, 1]);
        assert.ok(Math.abs(one.aspect - 2 * two.aspect) < 1e-9);
        assert.equal(await page.locator(".sides").isVisible(), false);
    });
});

test("a model alone, and a skeleton alone, are shown", async () => {
    starguard("view", "horse.off", "-o", "model.html");
    starguard("view", "skeleton.obj", "-o", "skeleton.html");
    await look("model.html", {}, async (page) =>
        assert.match(await page.textContent("#views"), new RegExp(`Vertices${readFileSync(fileOf("horse.off"), "utf8").split(/\s/)[1]}`)),
    );
    await look("skeleton.html", {}, async (page) =>
        assert.match(await page.textContent("#views"), /Radii are not known/),
    );
});
