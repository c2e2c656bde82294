// SPDX-License-Identifier: Apache-2.0
// The page of `make web`: a model, what `check` finds, guards and pieces of it in the viewer, files to
// keep, and the command lines that make the same files elsewhere.
import { commandLine, element, facts, heading, note, say } from "../viewer/panel.js";
import { amount, count, percent } from "../viewer/text.js";
import "../viewer/theme.js";
import { extension, isForeign, toPly } from "./foreign.js";
import { guardForm, pieceForm } from "./form.js";
import { Cancelled, Run } from "./program.js";
import samples from "samples";
import { join, quote, safeName, stem } from "./words.js";

const MESHES = ["off", "obj", "ply", "stl", "vtk", "vtp", "glb", "3mf"];

const at = (id) => document.getElementById(id);
const decoder = new TextDecoder();

function button(text, act, main = false) {
    return element("button", { type: "button", className: main ? "main" : "", onclick: act }, text);
}

/** A button that opens a file dialogue; `take` gets the files. */
function picker(id, text, take) {
    const accept = MESHES.map((each) => `.${each}`).join(",");
    const input = element("input", { type: "file", id, className: "picker", accept, multiple: true });
    input.addEventListener("change", () => {
        take([...input.files]);
        input.value = ""; // so that the same file can be taken again
    });
    return { input, label: element("label", { className: "button", htmlFor: id }, text) };
}

class App {
    constructor() {
        this.files = new Map(); // by name: the model and results
        this.model = null; // name of the model at work on
        this.obstacles = []; // names of files that block the view
        this.results = []; // names of files to view, besides the model
        this.commands = [];
        this.running = null;
        this.build();
        this.listenToDrops();
        this.show();
    }

    // ---- panel ----

    build() {
        this.modelPicker = picker("picker", "Open a mesh", (files) => this.take(files));
        this.obstaclePicker = picker("obstacle-picker", "Add an obstacle", (files) => this.addObstacles(files));
        this.obstacleList = element("div", { id: "obstacles" });
        this.sample = element(
            "select",
            { id: "sample" },
            element("option", { value: "" }, "or pick a sample"),
            ...samples.map(({ name, description }) =>
                element("option", { value: name }, `${name}: ${description}`),
            ),
        );
        this.sample.addEventListener("change", () => this.takeSample(this.sample.value));
        this.guardForm = guardForm();
        this.pieceForm = pieceForm();
        this.notice = element("div", { id: "notice" });
        this.found = element("div", { id: "found" });
        this.guarded = element("div", { id: "guarded" });
        this.divided = element("div", { id: "divided" });
        this.fileList = element("div", { className: "list", id: "files" });
        this.commandList = element("div", { id: "commands" });
        this.repair = button("Repair it", () => this.repairModel(), true);
        this.place = button("Place guards", () => this.placeGuards(), true);
        this.divide = button("Cut into star pieces", () => this.cutPieces(), true);
        this.steps = element(
            "div",
            { id: "steps" },
            heading("Guards"),
            this.guardForm.node,
            this.obstaclePicker.input,
            this.obstaclePicker.label,
            this.obstacleList,
            this.place,
            this.guarded,
            heading("Star-shaped pieces"),
            this.pieceForm.node,
            this.divide,
            this.divided,
        );
        this.kept = element("div", {}, heading("Files"), this.fileList);
        this.same = element("div", {}, heading("The same on a command line"), this.commandList);
        at("views").append(
            this.modelPicker.input,
            this.modelPicker.label,
            this.sample,
            this.notice,
            this.found,
            this.steps,
            this.kept,
            this.same,
            element(
                "p",
                { className: "note" },
                "Everything runs on this machine, in this page. ",
                button("Licences", () => at("licences").showModal()),
            ),
        );
        this.stage = element("span", {});
        this.bar = element("progress", { max: 1 });
        this.cancel = button("Cancel", () => this.running?.cancel());
        at("common").append(this.stage, this.bar, this.cancel);
        at("licences").append(...licences());
    }

    /** Shows what the state allows. */
    show() {
        const busy = this.running !== null;
        this.steps.hidden = this.model === null; // surfaces with holes have guards as well (--soup)
        this.kept.hidden = this.files.size === 0;
        this.same.hidden = this.commands.length === 0;
        at("common").hidden = !busy;
        at("welcome").hidden = busy || this.model !== null;
        at("view").hidden = this.model === null;
        const controls = [this.place, this.divide, this.repair, this.sample];
        controls.push(this.modelPicker.input, this.obstaclePicker.input);
        for (const node of controls) node.disabled = busy;
        at("subtitle").textContent = this.model ?? "in the browser";
        this.obstacleList.replaceChildren(
            ...this.obstacles.map((name) => button(`Remove ${name}`, () => this.removeObstacle(name))),
        );
        this.fileList.replaceChildren(...[...this.files].map(([name, bytes]) => download(name, bytes)));
    }

    // ---- runs ----

    /** Runs a command line; null if it was cancelled. `told`: it is worth repeating elsewhere. */
    async run(words, outputs, told = true) {
        const files = [...this.files];
        this.stage.textContent = words[0];
        this.bar.removeAttribute("value");
        this.running = new Run(words, files, outputs, (stage, fraction) => {
            this.stage.textContent = stage;
            this.bar.value = fraction;
        });
        this.show();
        try {
            const result = await this.running.done;
            for (const [name, bytes] of result.files) this.files.set(name, bytes);
            if (told && result.status === 0) this.tell(join(words));
            return result;
        } catch (error) {
            if (!(error instanceof Cancelled)) throw error;
            say("Cancelled");
            return null;
        } finally {
            this.running = null;
            this.show();
        }
    }

    tell(line) {
        this.commandList.append(commandLine(line));
        this.commands.push(line);
    }

    json(name) {
        return JSON.parse(decoder.decode(this.files.get(name)));
    }

    // ---- model ----

    listenToDrops() {
        const sign = at("drop");
        window.addEventListener("dragover", (event) => {
            event.preventDefault();
            sign.hidden = false;
        });
        window.addEventListener("dragleave", (event) => {
            if (event.relatedTarget === null) sign.hidden = true;
        });
        window.addEventListener("drop", (event) => {
            event.preventDefault();
            sign.hidden = true;
            this.take([...event.dataTransfer.files]);
        });
    }

    /** Says why something that was dropped or picked is not taken; without a reason, nothing. */
    tellOff(reason = "") {
        this.notice.replaceChildren(...(reason ? [element("p", { className: "note warn" }, reason)] : []));
        if (reason) say(reason);
    }

    /** The meshes among the files, read; says what is left out. */
    async read(files, most) {
        const isMesh = ({ name }) => MESHES.includes(extension(name));
        const meshes = files.filter(isMesh).slice(0, most);
        if (this.running) {
            this.tellOff("A run is going on: wait for its end, or cancel it.");
            return [];
        }
        if (files.length === 0) this.tellOff("What was dropped is no file: drop a mesh from a folder of this machine.");
        else if (meshes.length === 0)
            this.tellOff(`${files[0].name} is not taken: a mesh is a file named ${MESHES.map((each) => `.${each}`).join(", ")}.`);
        else if (meshes.length < files.length)
            this.tellOff(`Of ${files.length} files ${meshes.map(({ name }) => name).join(", ")} is taken.`);
        else this.tellOff();
        const read = [];
        for (const file of meshes) {
            const name = safeName(file.name);
            try {
                const bytes = new Uint8Array(await file.arrayBuffer());
                read.push(isForeign(name) ? await this.convert(name, bytes) : { name, bytes, lines: [] });
            } catch (error) {
                this.tellOff(`${file.name} cannot be read: ${error.message}`);
            }
        }
        return read;
    }

    /** What starguard-import makes of a scene on a machine. */
    async convert(name, bytes) {
        const file = `${stem(name)}.ply`;
        return { name: file, bytes: await toPly(name, bytes), lines: [importLine(name, file)] };
    }

    async take(files) {
        const [model] = await this.read(files, 1);
        if (model === undefined) return;
        this.sample.value = "";
        await this.open(model.name, model.bytes, model.lines);
    }

    async addObstacles(files) {
        for (const { name, bytes, lines } of await this.read(files, Infinity)) {
            if (name === this.model) {
                this.tellOff(`${name} is the model: an obstacle needs another name.`);
                continue;
            }
            this.files.set(name, bytes);
            if (!this.obstacles.includes(name)) this.obstacles.push(name);
            lines.forEach((line) => this.tell(line));
        }
        this.show();
    }

    removeObstacle(name) {
        this.obstacles = this.obstacles.filter((each) => each !== name);
        this.files.delete(name);
        this.show();
    }

    async takeSample(name) {
        if (!name || this.running) return;
        const file = `${name}.off`,
            words = ["sample", name, "-o", file];
        this.forget();
        this.tellOff();
        const result = await this.run(words, [file], false);
        if (result?.status === 0) await this.open(file, this.files.get(file), [join(words)]);
        else if (result) this.complain(this.found, result);
    }

    forget() {
        this.files.clear();
        this.obstacles = [];
        this.results = [];
        this.commands = [];
        this.model = null;
        for (const node of [this.commandList, this.found, this.guarded, this.divided])
            node.replaceChildren();
    }

    async open(name, bytes, made) {
        this.forget();
        this.files.set(name, bytes);
        this.model = name;
        this.made = made;
        made.forEach((line) => this.tell(line));
        const result = await this.run(["check", name, "--json"], [], false);
        if (result === null) return;
        if (result.printed === "" || JSON.parse(result.printed).error) {
            this.complain(this.found, result);
            this.model = null;
            this.files.clear();
            this.show();
            return;
        }
        this.tell(join(["check", name]));
        this.showFindings(JSON.parse(result.printed), result);
        await this.view();
    }

    showFindings(report, result) {
        const findings = Object.entries(report.findings);
        const nodes = [
            facts([
                ["Vertices", count(report.model.vertices)],
                ["Faces", count(report.model.faces)],
                ["Solid", report.usable ? "yes" : "no", ...verdict(report)],
            ]),
            ...findings.map(([kind, finding]) => note(findingText(kind, finding))),
        ];
        this.found.replaceChildren(...nodes);
        if (!report.usable) {
            this.found.append(...result.errors.map(note), this.repair);
        } else if (findings.length === 0) this.found.append(note("check finds nothing wrong."));
        this.show();
        say(report.usable ? "The model is a usable solid" : "The model is not a usable solid");
    }

    async repairModel() {
        const file = `${stem(this.model)}-repaired.off`;
        const words = ["repair", this.model, "-o", file];
        const made = [...this.made, join(words)];
        const result = await this.run(words, [file], false);
        if (result?.status === 0) await this.open(file, this.files.get(file), made);
        else if (result) this.complain(this.found, result);
    }

    // ---- guards and pieces ----

    async placeGuards() {
        const words = ["guard", this.model, "-o", "guards.json", ...this.guardForm.words()];
        for (const name of this.obstacles) words.push("--obstacles", name);
        const outputs = ["guards.json", ...namedOutputs(words)];
        const result = await this.run(words, outputs);
        if (result === null) return;
        if (result.status !== 0) return this.complain(this.guarded, result);
        this.guarded.replaceChildren(guardFacts(this.json("guards.json")), ...result.errors.map(note));
        this.keep("guards.json");
        await this.view();
    }

    async cutPieces() {
        const words = ["decompose", this.model, "-o", "pieces.vtk", "--report", "pieces.json"];
        words.push(...this.pieceForm.words());
        const result = await this.run(words, ["pieces.vtk", "pieces.json", ...namedOutputs(words)]);
        if (result === null) return;
        if (result.status !== 0) return this.complain(this.divided, result);
        this.divided.replaceChildren(pieceFacts(this.json("pieces.json")), ...result.errors.map(note));
        this.keep("pieces.vtk", "pieces.json");
        await this.view();
    }

    keep(...names) {
        this.results = [...this.results.filter((name) => !names.includes(name)), ...names];
    }

    async view() {
        const page = `${stem(this.model)}.html`;
        const shown = this.results.length > 0 ? this.results : [this.model];
        const words = ["view", ...shown];
        if (this.results.length > 0) words.push("--model", this.model);
        const result = await this.run([...words, "-o", page], [page], false);
        if (result === null || result.status !== 0) return;
        at("view").srcdoc = decoder.decode(this.files.get(page));
    }

    complain(node, result) {
        node.replaceChildren(
            ...result.errors.map((line) => element("p", { className: "note warn" }, line)),
        );
        say(result.errors.at(-1) ?? "The program failed");
        this.show();
    }
}

// ---- texts ----

function verdict({ usable, embedded }) {
    if (!usable) return ["see below", "warn"];
    return embedded ? [] : ["intersects itself", "warn"];
}

function findingText(kind, { count: number, first }) {
    const shown = first.map((each) => (Array.isArray(each) ? each.join("-") : each)).join(", ");
    const more = number > first.length ? ", ..." : "";
    return `${count(number)} ${kind.replaceAll("_", " ")}: ${shown}${more}`;
}

/** Green is what is proven, for guards anywhere. */
function guardFacts(result) {
    const rows = [["Guards", count(result.guards.length)]];
    const everywhere = result.lower_bound_everywhere;
    if (everywhere > 0)
        rows.push([
            "Needed",
            count(everywhere),
            ...(result.optimal_everywhere ? ["anywhere: optimal", "good"] : ["at least, anywhere"]),
        ]);
    else rows.push(["Needed", count(result.lower_bound), "at least, of its candidates"]);
    rows.push(["Area seen", percent(result.coverage.area)]);
    return facts(rows);
}

function pieceFacts(result) {
    const number = result.pieces.length;
    const all = result.strictly_star === number;
    return facts([
        ["Pieces", count(number)],
        [
            "Star-shaped",
            count(result.strictly_star),
            ...(all ? ["all, proven", "good"] : [`${amount(number - result.strictly_star, "is", "are")} not`]),
        ],
    ]);
}

function importLine(file, made) {
    return `starguard-import ${quote(file)} > ${quote(made)}`;
}

/** Files that options name as outputs. */
function namedOutputs(words) {
    const outputs = ["--certificate", "--curve", "--leak", "--marks", "--matrix", "--picture", "--poses", "--summary", "--table"];
    return words.filter((_, i) => i > 0 && outputs.includes(words[i - 1]));
}

function download(name, bytes) {
    return element(
        "button",
        {
            type: "button",
            onclick: () => {
                const address = URL.createObjectURL(new Blob([bytes]));
                element("a", { href: address, download: name }).click();
                setTimeout(() => URL.revokeObjectURL(address), 1000);
            },
        },
        element("span", { className: "name" }, name),
        element("span", { className: "number" }, size(bytes.length)),
    );
}

function size(bytes) {
    return bytes < 1e6 ? `${count(Math.ceil(bytes / 1e3))} kB` : `${(bytes / 1e6).toFixed(1)} MB`;
}

function licences() {
    const close = button("Close", () => at("licences").close());
    return [
        element("h2", { id: "licences-title" }, "Licences"),
        note("starguard: Apache License 2.0."),
        note(
            "CBC 2.10.8, Cgl 0.60.3, Clp 1.17.6, Osi 0.108.6 and CoinUtils 2.11.4 of COIN-OR: Eclipse Public License 2.0, unchanged; their sources are the Debian 12 packages coinor-cbc, coinor-cgl, clp, coinor-osi and coinutils.",
        ),
        note("Jansson 2.14, musl, three.js and emscripten: MIT. zlib 1.2.13: zlib licence. libc++: Apache License 2.0 with LLVM exceptions."),
        close,
    ];
}

window.starguard = new App(); // for tests
document.documentElement.dataset.ready = "true";
