// SPDX-License-Identifier: Apache-2.0
// Runs one command line in a program that nobody has used before, with files in memory. The build puts
// emscripten's createStarguard before this.
"use strict";

const FOLDER = "/files";

/** The program, instantiated from compiled code. */
function instantiate(module, hooks) {
    return createStarguard({
        ...hooks,
        thisProgram: "starguard",
        instantiateWasm(imports, done) {
            WebAssembly.instantiate(module, imports).then((instance) => done(instance, module));
            return {};
        },
    });
}

/** Exit status; a program that breaks off counts as unfinished. */
function call(program, words, errors) {
    try {
        return program.callMain(words);
    } catch (error) {
        errors.push(
            /memory|allocation/i.test(error.message)
                ? "starguard: out of memory"
                : `starguard: the program broke off: ${error.message}`,
        );
        return 3;
    }
}

async function run({ module, words, files, outputs }) {
    const printed = [],
        errors = [];
    const program = await instantiate(module, {
        print: (line) => printed.push(line),
        printErr: (line) => errors.push(line),
        onProgress: (stage, fraction) => postMessage({ stage, fraction }),
    });
    program.FS.mkdir(FOLDER);
    program.FS.chdir(FOLDER);
    for (const [name, bytes] of files) program.FS.writeFile(name, bytes);
    // one thread is all there is; results do not depend on it
    const status = call(program, [...words, "--threads", "1"], errors);
    const made = [];
    if (status === 0 || status === 2)
        for (const name of outputs)
            if (program.FS.analyzePath(name).exists) made.push([name, program.FS.readFile(name)]);
    postMessage(
        { status, printed: printed.join("\n"), errors, files: made, memory: program.HEAPU8?.length },
        made.map(([, bytes]) => bytes.buffer),
    );
}

onmessage = ({ data }) =>
    run(data).catch((error) => postMessage({ status: 3, printed: "", errors: [String(error)], files: [] }));
