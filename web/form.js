// SPDX-License-Identifier: Apache-2.0
// Fields for the options that people set most; each puts words on the command line, or none.
import { element } from "../viewer/panel.js";
import { split } from "./words.js";

function labelled(name, input) {
    input.setAttribute("aria-label", name);
    return { node: element("label", { className: "field" }, element("span", {}, name), input), input };
}

/** A choice: `words` by the text that is shown. The first is what the program does by itself. */
function select(name, words) {
    const { node, input } = labelled(
        name,
        element("select", {}, ...Object.keys(words).map((text) => element("option", {}, text))),
    );
    return { node, words: () => words[input.value] };
}

/** A value behind an option; nothing where the field is empty. */
function value(name, option, hint) {
    const { node, input } = labelled(
        name,
        element("input", { type: "text", placeholder: hint, spellcheck: false }),
    );
    return { node, words: () => (input.value.trim() === "" ? [] : [option, input.value.trim()]) };
}

/** Options as they are typed after a command. */
function line(name, hint) {
    const input = element("input", { type: "text", placeholder: hint, spellcheck: false });
    input.setAttribute("aria-label", name);
    return { node: input, words: () => split(input.value) };
}

const effort = () =>
    select("Effort", { normal: [], quick: ["--effort", "quick"], best: ["--effort", "best"] });

function form(fields) {
    const node = element("div", { className: "form" }, ...fields.map((field) => field.node));
    return { node, words: () => fields.flatMap((field) => field.words()) };
}

export const guardForm = () =>
    form([
        select("To be seen", {
            "every face": [],
            "every point": ["--target", "points"],
            "large faces in parts": ["--patch", "auto"],
        }),
        select("Guards stand", { inside: [], "around it": ["--outside"], "among loose faces": ["--soup"] }),
        value("At most", "--max-guards", "any number"),
        value("Field of view", "--fov", "90,60 degrees"),
        value("Range", "--range", "any distance"),
        effort(),
        line("Options of guard", "more: --prove --seed 7"),
    ]);

export const pieceForm = () => form([effort(), line("Options of decompose", "more: --max-pieces 12")]);
