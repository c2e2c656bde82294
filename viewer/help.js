// SPDX-License-Identifier: Apache-2.0
// The keys, as a table of actions and help texts.
import { element } from "./panel.js";

const dialog = document.getElementById("help");

/** `keys` are [[key...], text, action]; an action receives the key. */
export function listenToKeys(keys) {
    document.addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey || dialog.open) return;
        const onControl =
            event.target.closest("input, select, textarea, button, [role=radio]") !== null;
        if (onControl && /^(Arrow|Home|End| |Enter)/.test(event.key)) return; // handled by the control itself
        const entry = keys.find(
            ([names]) => names.includes(event.key) || names.includes(event.key.toLowerCase()),
        );
        if (entry === undefined) return;
        event.preventDefault();
        entry[2](event.key);
    });
}

const SHOWN = {
    ArrowLeft: "←",
    ArrowRight: "→",
    ArrowUp: "↑",
    ArrowDown: "↓",
    " ": "Space",
    Escape: "Esc",
};

function shown(key) {
    return SHOWN[key] ?? (key.length === 1 ? key.toUpperCase() : key);
}

export function fillHelp(keys) {
    const table = element("table");
    for (const [names, text] of keys) {
        const cell = element("th", { scope: "row" });
        names.forEach((name, i) => cell.append(i > 0 ? " " : "", element("kbd", {}, shown(name))));
        table.append(element("tr", {}, cell, element("td", {}, text)));
    }
    dialog.append(
        element("h2", { id: "help-title" }, "Keys"),
        table,
        element(
            "p",
            { className: "note" },
            "Mouse: drag to turn, wheel to zoom, right button to move, click to pick. Touch: one finger turns, two zoom and move, a tap picks.",
        ),
        element(
            "p",
            { className: "note" },
            "This page holds all that it shows. It fetches nothing and sends nothing.",
        ),
        element(
            "button",
            { type: "button", className: "main", onclick: () => dialog.close() },
            "Close",
        ),
    );
    dialog.addEventListener("click", (event) => {
        if (event.target === dialog) dialog.close();
    });
}

export function showHelp() {
    dialog.showModal();
}
