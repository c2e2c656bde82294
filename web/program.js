// SPDX-License-Identifier: Apache-2.0
// The command line as a function: each run is a worker of its own, with nothing left of earlier ones,
// so results are those of the program on a disk, and cancelling is ending the worker.
import workerText from "worker-text";

let compiled = null;

async function unpack() {
    const block = document.getElementById("program");
    const binary = atob(block.textContent);
    block.remove();
    const packed = Uint8Array.from(binary, (letter) => letter.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    return WebAssembly.compile(await new Response(stream).arrayBuffer());
}

/** The compiled program, at most once. */
function compile() {
    compiled ??= unpack();
    return compiled;
}

export class Cancelled extends Error {}

export class Run {
    /** `files` are pairs of name and bytes, `outputs` the names of files to bring back. */
    constructor(words, files, outputs, onProgress) {
        this.words = words;
        this.done = new Promise((resolve, reject) => {
            this.reject = reject;
            compile().then((module) => {
                if (this.over) return;
                const address = URL.createObjectURL(new Blob([workerText], { type: "text/javascript" }));
                this.worker = new Worker(address);
                URL.revokeObjectURL(address);
                this.worker.onmessage = ({ data }) => {
                    if (data.status === undefined) return onProgress(data.stage, data.fraction);
                    this.end();
                    resolve(data);
                };
                this.worker.onerror = (event) => {
                    this.end();
                    reject(new Error(event.message || "the worker does not start"));
                };
                this.worker.postMessage({ module, words, files, outputs });
            }, reject);
        });
    }

    end() {
        this.over = true;
        this.worker?.terminate();
    }

    cancel() {
        this.end();
        this.reject(new Cancelled("cancelled"));
    }
}
