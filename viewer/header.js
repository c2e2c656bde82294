// SPDX-License-Identifier: Apache-2.0
// The header above the tabs: the model's name and size, and two buttons.
import page from "./data.js";
import { showHelp } from "./help.js";
import { drawn, element } from "./panel.js";
import { amount } from "./text.js";
import { toggleTheme } from "./theme.js";

const HALF_MOON = "M8 1.5a6.5 6.5 0 1 0 0 13z M8 1.5a6.5 6.5 0 0 1 0 13";
const QUESTION = "M5.6 6a2.4 2.4 0 1 1 3.3 2.2c-.6.3-.9.7-.9 1.3v.4 M8 12.6v.1";

function roundButton(name, path, act) {
    const icon = drawn(
        "svg",
        { viewBox: "0 0 16 16", "aria-hidden": "true" },
        drawn("path", { d: path }),
    );
    const button = element(
        "button",
        { type: "button", className: "round", title: name, onclick: act },
        icon,
    );
    button.setAttribute("aria-label", name);
    return button;
}

export function fillHeader() {
    const { title, model } = page;
    document.title = `${title} – starguard`;
    document.getElementById("title").textContent = title;
    document.getElementById("subtitle").textContent = model
        ? `${amount(model.vertices, "vertex", "vertices")}, ${amount(model.faces, "face", "faces")}`
        : "";
    document
        .getElementById("buttons")
        .append(
            roundButton("Light or dark", HALF_MOON, toggleTheme),
            roundButton("Keys and help", QUESTION, showHelp),
        );
}
