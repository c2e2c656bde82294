// SPDX-License-Identifier: Apache-2.0
// Light or dark: the system's setting, until the switch changes it.

const system = window.matchMedia("(prefers-color-scheme: dark)");
const listeners = [];
let chosen = null;

export function isDark() {
    return chosen ?? system.matches;
}

function apply() {
    document.documentElement.dataset.theme = isDark() ? "dark" : "light";
    listeners.forEach((listener) => listener());
}

export function toggleTheme() {
    chosen = !isDark();
    apply();
}

/** Calls `listener` after every change. */
export function onTheme(listener) {
    listeners.push(listener);
}

/** A colour of page.css, as "#rrggbb". */
export function themeColor(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

system.addEventListener("change", apply);
apply();
