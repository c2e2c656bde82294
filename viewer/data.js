// SPDX-License-Identifier: Apache-2.0
// The page's data: a block of JSON, and arrays in base64 in blocks of their own.

const page = JSON.parse(document.getElementById("data").textContent);

/** What the page shows, as starg_page_write describes it. */
export default page;

function decode(text) {
    if (typeof Uint8Array.fromBase64 === "function") return Uint8Array.fromBase64(text);
    const binary = atob(text);
    const bytes = new Uint8Array(binary.length);
    for (let i = 0; i < bytes.length; i++) bytes[i] = binary.charCodeAt(i);
    return bytes;
}

/** The bytes of a block, which is then dropped from the document; null if there is none. */
export function bytes(name) {
    const block = document.getElementById(name);
    if (block === null) return null;
    const found = decode(block.textContent);
    block.remove();
    return found;
}

export function floats(name) {
    const found = bytes(name);
    return found && new Float32Array(found.buffer);
}

export function doubles(name) {
    const found = bytes(name);
    return found && new Float64Array(found.buffer);
}

export function indices(name) {
    const found = bytes(name);
    return found && new Uint32Array(found.buffer);
}

/** A picture as the address of an image: the base64 text itself. */
export function pictureAddress(name) {
    const block = document.getElementById(name);
    return block && `data:image/png;base64,${block.textContent}`;
}
