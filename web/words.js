// SPDX-License-Identifier: Apache-2.0
// Command lines: text to words and back, by the rules of a shell that matter here.

/** Words of a text; quotes keep blanks together. */
export function split(text) {
    const words = text.match(/(?:'[^']*'|"[^"]*"|[^\s'"])+/g) ?? [];
    return words.map((word) => word.replace(/'([^']*)'|"([^"]*)"/g, (_, single, double) => single ?? double));
}

export function quote(word) {
    return /^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`;
}

export function join(words) {
    return ["starguard", ...words].map(quote).join(" ");
}

/** A name for a dropped file: of one folder, and never taken for an option. */
export function safeName(name) {
    const plain = name.replace(/^.*[\\/]/, "").replace(/^-+/, "");
    return plain === "" || plain === "." || plain === ".." ? "model.off" : plain;
}

/** The name without its extension. */
export function stem(name) {
    return name.replace(/\.[^.]+$/, "");
}
