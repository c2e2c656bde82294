// SPDX-License-Identifier: Apache-2.0
// A GLB of `export`, opened by three.js: its cameras stand where guards do and see what these see, by
// the projection of three.js, and its colours tell by how many cameras each part of a face is seen.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import os from "node:os";
import path from "node:path";
import test, { after } from "node:test";
import { pathToFileURL } from "node:url";

const three = path.join(process.env.STARGUARD_MODULES ?? "", "node_modules", "three");
if (!existsSync(three)) {
    console.log("skipped: three.js is not there: this build has no viewer (docs/viewer.md)");
    process.exit();
}
const { Mesh, Vector3 } = await import(pathToFileURL(path.join(three, "build", "three.module.js")));
const { GLTFLoader } = await import(
    pathToFileURL(path.join(three, "examples", "jsm", "loaders", "GLTFLoader.js"))
);

const RANGE = 6;
const NEAR_LIMIT = 1e-4; // what stands so near a limit is not asked about: the file is in single precision
// A convex room: what is in the frustum of a camera, and in its range, is seen.
const ROOM = `v 0 0 0\nv 8 0 0\nv 8 0 6\nv 0 0 6\nv 0 3 0\nv 8 3 0\nv 8 3 6\nv 0 3 6
f 1 2 3 4\nf 5 8 7 6\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n`;
const NAMES = ["seen by none", "seen by 1", "seen by 2", "seen by 3 or more"];

const folder = mkdtempSync(path.join(os.tmpdir(), "starguard-cameras-"));
after(() => rmSync(folder, { recursive: true }));

function starguard(...words) {
    execFileSync(process.env.STARGUARD, [...words, "--quiet"], { cwd: folder });
}

async function open(file) {
    const bytes = readFileSync(path.join(folder, file));
    const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length);
    const model = await new GLTFLoader().parseAsync(buffer, "");
    model.scene.updateMatrixWorld(true);
    return model;
}

/** 1: all corners are in the view; 0: one is not; null: too near a limit to tell. */
function contains(camera, corners) {
    let inside = 1;
    for (const corner of corners) {
        const eye = new Vector3().setFromMatrixPosition(camera.matrixWorld);
        const seen = corner.clone().project(camera);
        const ahead = camera.getWorldDirection(new Vector3()).dot(corner.clone().sub(eye));
        const limits = [1 - Math.abs(seen.x), 1 - Math.abs(seen.y), RANGE - corner.distanceTo(eye)];
        if (ahead > 0 && limits.some((x) => Math.abs(x) < NEAR_LIMIT)) return null;
        if (ahead <= 0 || limits.some((x) => x < 0)) inside = 0;
    }
    return inside;
}

test("cameras and colours of a GLB in three.js", async () => {
    writeFileSync(path.join(folder, "room.obj"), ROOM);
    writeFileSync(path.join(folder, "stay.txt"), "0.5 2.8 0.5 1 -0.5 1\n7.5 2.8 5.5 -1 -0.5 -1\n");
    const sensor = ["--fov", "90,60", "--range", String(RANGE), "--keep", "stay.txt"];
    starguard("guard", "room.obj", ...sensor, "--patch", "0.9", "--max-guards", "4", "-o", "g.json");
    starguard("export", "g.json", "-o", "g.glb");
    const { guards } = JSON.parse(readFileSync(path.join(folder, "g.json")));
    const { cameras, scene } = await open("g.glb");

    assert.equal(cameras.length, guards.length);
    guards.forEach(({ position, direction }, i) => {
        const camera = scene.getObjectByName(`camera_${String(i).padStart(4, "0")}`);
        assert.ok(camera.isPerspectiveCamera);
        camera.updateProjectionMatrix();
        assert.ok(Math.abs(camera.fov - 60) < 1e-9);
        assert.ok(Math.abs(camera.aspect - Math.tan(Math.PI / 4) / Math.tan(Math.PI / 6)) < 1e-9);
        const place = new Vector3().setFromMatrixPosition(camera.matrixWorld);
        assert.ok(place.distanceTo(new Vector3(...position)) < 1e-5);
        const ahead = new Vector3(...direction).normalize();
        assert.ok(camera.getWorldDirection(new Vector3()).distanceTo(ahead) < 1e-6);
    });

    let told = 0;
    const classes = new Set();
    scene.getObjectByName("model").traverse((part) => {
        if (!(part instanceof Mesh)) return;
        const { index, attributes } = part.geometry;
        for (let face = 0; face < index.count / 3; face++) {
            const corners = [0, 1, 2].map((k) =>
                new Vector3()
                    .fromBufferAttribute(attributes.position, index.getX(3 * face + k))
                    .applyMatrix4(part.matrixWorld),
            );
            const seen = cameras.map((camera) => contains(camera, corners));
            if (seen.includes(null)) continue;
            const count = seen.reduce((a, b) => a + b);
            assert.equal(part.material.name, NAMES[Math.min(count, 3)]);
            classes.add(count);
            told++;
        }
    });
    assert.ok(told > 300, `only ${told} parts of faces are told`);
    assert.ok(classes.size >= 4);
});
