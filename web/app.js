// SPDX-License-Identifier: Apache-2.0
// The page of `make web`: a model, what `check` finds, guards and pieces of it in the viewer, files to
// keep, and the command lines that make the same files elsewhere.
import { commandLine, element, facts, heading, note, say } from "../viewer/panel.js";
import { amount, count, percent } from "../viewer/text.js";
import "../viewer/theme.js";
import { Cancelled, Run } from "./program.js";
import samples from "samples";
import { join, safeName, split, stem } from "./words.js";

const at = (id) => document.getElementById(id);
const decoder = new TextDecoder();

function button(text, act, main = false) {
    return element("button", { type: "button", className: main ? "main" : "", onclick: act }, text);
}

/** A line of options, as typed after a command. */
function optionLine(name, hint) {
    const input = element("input", { type: "text", placeholder: hint, spellcheck: false });
    input.setAttribute("aria-label", name);
    return input;
}

class App {
    constructor() {
        this.files = new Map(); // by name: the model and results
        this.model = null; // name of the model at work on
        this.results = []; // names of files to view, besides the model
        this.commands = [];
        this.running = null;
        this.build();
        this.listenToDrops();
        this.show();
    }

    // ---- panel ----

    build() {
        this.picker = element("input", { type: "file", id: "picker", accept: ".off,.obj,.ply,.stl,.vtk,.vtp" });
        this.picker.addEventListener("change", () => this.take(this.picker.files[0]));
        this.sample = element(
            "select",
            { id: "sample" },
            element("option", { value: "" }, "or pick a sample"),
            ...samples.map(({ name, description }) =>
                element("option", { value: name }, `${name}: ${description}`),
            ),
        );
        this.sample.addEventListener("change", () => this.takeSample(this.sample.value));
        this.guardOptions = optionLine("Options of guard", "--prove --coverage 0.99");
        this.pieceOptions = optionLine("Options of decompose", "--effort 100");
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
            element("div", { className: "step" }, this.place, this.guardOptions),
            this.guarded,
            heading("Star-shaped pieces"),
            element("div", { className: "step" }, this.divide, this.pieceOptions),
            this.divided,
        );
        this.kept = element("div", {}, heading("Files"), this.fileList);
        this.same = element("div", {}, heading("The same on a command line"), this.commandList);
        at("views").append(
            element("label", { className: "button", htmlFor: "picker" }, "Open a mesh"),
            this.picker,
            this.sample,
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
        for (const node of [this.place, this.divide, this.repair, this.sample, this.picker])
            node.disabled = busy;
        at("subtitle").textContent = this.model ?? "in the browser";
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
            if (told && result.status === 0) this.tell(words);
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

    tell(words) {
        const line = join(words);
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
            this.take(event.dataTransfer.files[0]);
        });
    }

    async take(file) {
        if (!file || this.running) return;
        this.sample.value = "";
        await this.open(safeName(file.name), new Uint8Array(await file.arrayBuffer()), []);
    }

    async takeSample(name) {
        if (!name || this.running) return;
        const file = `${name}.off`,
            words = ["sample", name, "-o", file];
        this.forget();
        const result = await this.run(words, [file], false);
        if (result?.status === 0) await this.open(file, this.files.get(file), [words]);
        else if (result) this.complain(this.found, result);
    }

    forget() {
        this.files.clear();
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
        made.forEach((words) => this.tell(words));
        const result = await this.run(["check", name, "--json"], [], false);
        if (result === null) return;
        if (result.printed === "" || JSON.parse(result.printed).error) {
            this.complain(this.found, result);
            this.model = null;
            this.files.clear();
            this.show();
            return;
        }
        this.tell(["check", name]);
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
        const made = [...this.made(), words];
        const result = await this.run(words, [file], false);
        if (result?.status === 0) await this.open(file, this.files.get(file), made);
        else if (result) this.complain(this.found, result);
    }

    made() {
        return this.sample.value ? [["sample", this.sample.value, "-o", this.model]] : [];
    }

    // ---- guards and pieces ----

    async placeGuards() {
        const words = ["guard", this.model, "-o", "guards.json", ...split(this.guardOptions.value)];
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
        words.push(...split(this.pieceOptions.value));
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
    rows.push(["Of candidates", count(result.lower_bound), "needed at least"]);
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

/** Files that options name as outputs. */
function namedOutputs(words) {
    const outputs = ["--certificate", "--marks", "--picture", "--poses"];
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
