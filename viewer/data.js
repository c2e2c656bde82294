// SPDX-License-Identifier: Apache-2.0
// The page's data: a block of JSON, and arrays in separate base64 blocks.

const page = JSON.parse(document.getElementById("data").textContent);

/** The contents of the page, as described by starg_page_write. */
export default page;

function decode(text) {
    if (typeof Uint8Array.fromBase64 === "function") return Uint8Array.fromBase64(text);
    const binary = atob(text);
    const bytes = new Uint8Array(binary.length);
    for (let i = 0; i < bytes.length; i++) bytes[i] = binary.charCodeAt(i);
    return bytes;
}

/** The bytes of a block, which is then removed from the document; null if there is none. */
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

/** A picture as an image address: the base64 text itself. */
export function pictureAddress(name) {
    const block = document.getElementById(name);
    return block && `data:image/png;base64,${block.textContent}`;
}
