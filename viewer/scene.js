// SPDX-License-Identifier: Apache-2.0
// The stage: canvas, camera, rotation and zoom; draws when something has changed.
import {
    ColorManagement,
    LinearSRGBColorSpace,
    PerspectiveCamera,
    Scene,
    Vector3,
    WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { shared } from "./materials.js";

ColorManagement.enabled = false;

const VIEW_ANGLE = 32;
const CLICK_SLACK = 5; // pixels between press and release
const DIRECTION = new Vector3(0.62, 0.34, 0.9).normalize();

export class Stage {
    constructor(canvas, place) {
        this.canvas = canvas;
        this.place = place; // the element that the canvas fills
        this.scene = new Scene();
        this.camera = new PerspectiveCamera(VIEW_ANGLE, 1, 0.01, 100);
        this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
        this.renderer.outputColorSpace = LinearSRGBColorSpace;
        this.sides = 1; // 2: the left and the right half show objects of their own, by one camera
        this.controls = this.makeControls();
        this.ball = { center: [0, 0, 0], radius: 1 }; // contains everything shown
        this.onBall = () => {};
        this.frames = 0; // drawn so far
        this.waiting = false;
        this.beforeDraw = [];
        new ResizeObserver(() => this.resize()).observe(place);
        canvas.addEventListener("webglcontextrestored", () => this.request());
    }

    makeControls() {
        const controls = new OrbitControls(this.camera, this.canvas);
        controls.rotateSpeed = 0.9;
        controls.zoomToCursor = this.sides === 1;
        controls.addEventListener("change", () => this.request());
        return controls;
    }

    resize() {
        const { clientWidth: width, clientHeight: height } = this.place;
        if (width === 0 || height === 0) return;
        const ratio = Math.min(window.devicePixelRatio || 1, 2);
        this.renderer.setPixelRatio(ratio);
        this.renderer.setSize(width, height, false);
        shared.pixels.value = ratio;
        const before = this.reach();
        this.camera.aspect = width / this.sides / height;
        this.camera.updateProjectionMatrix();
        this.moveOut(this.reach() / before);
        this.draw(); // at once: a resized canvas is empty
    }

    /** From how many radii away a ball fills the view. */
    reach() {
        const narrower = Math.min(this.camera.aspect, 1);
        return 1 / Math.sin(Math.atan(Math.tan((VIEW_ANGLE * Math.PI) / 360) * narrower));
    }

    /** The camera moves to so many times its distance: what was in view stays so. */
    moveOut(factor) {
        const { target } = this.controls;
        this.camera.position.sub(target).multiplyScalar(factor).add(target);
    }

    /** Draws in the next frame, once for any number of requests. */
    request() {
        if (this.waiting) return;
        this.waiting = true;
        requestAnimationFrame(() => {
            this.waiting = false;
            this.draw();
        });
    }

    draw() {
        const { clientWidth, clientHeight: height } = this.place;
        const width = clientWidth / this.sides;
        this.beforeDraw.forEach((work) => work());
        this.renderer.setScissorTest(this.sides > 1);
        for (let side = 0; side < this.sides; side++) {
            this.renderer.setViewport(side * width, 0, width, height);
            this.renderer.setScissor(side * width, 0, width, height);
            this.camera.layers.set(this.layerOf(side));
            this.renderer.render(this.scene, this.camera);
        }
        this.frames++;
    }

    /** Objects on this layer are drawn in a side; those on layer 1 nowhere. */
    layerOf(side) {
        return this.sides === 1 ? 0 : 2 + side;
    }

    setSides(sides) {
        if (sides === this.sides) return;
        this.sides = sides;
        this.controls.zoomToCursor = sides === 1; // the cursor is over one of two pictures
        this.resize();
    }

    /** Shows all of a ball from the initial direction. */
    fit(ball, keepDirection = false) {
        const distance = ball.radius * 1.02 * this.reach();
        const from = keepDirection
            ? this.camera.position.clone().sub(this.controls.target).normalize()
            : DIRECTION.clone().applyQuaternion(this.turnOfUp());
        this.setBall(ball);
        this.controls.target.set(...ball.center);
        this.camera.position.copy(from).multiplyScalar(distance).add(this.controls.target);
        this.camera.near = ball.radius / 500;
        this.camera.far = distance + 200 * ball.radius;
        this.camera.updateProjectionMatrix();
        this.controls.minDistance = ball.radius / 50;
        this.controls.maxDistance = 40 * ball.radius;
        this.controls.update();
        this.request();
    }

    /** The contents have grown or shrunk. */
    setBall(ball) {
        this.ball = ball;
        this.onBall();
    }

    /** The rotation from y up to the current up direction. */
    turnOfUp() {
        const turn = this.camera.quaternion.clone();
        return turn.setFromUnitVectors(new Vector3(0, 1, 0), this.camera.up);
    }

    /** Axis 1 (y) or 2 (z) points up. OrbitControls read the axis when they are created. */
    setUp(axis) {
        this.camera.up.set(0, axis === 1 ? 1 : 0, axis === 2 ? 1 : 0);
        this.controls.dispose();
        this.controls = this.makeControls();
        this.fit(this.ball);
    }

    /** Rotates about the target by angles in degrees, right and up. */
    turn(right, upward) {
        const offset = this.camera.position.clone().sub(this.controls.target);
        const axis = this.camera.up;
        offset.applyAxisAngle(axis, (right * Math.PI) / 180);
        const angle = offset.angleTo(axis) - (upward * Math.PI) / 180;
        if (angle > 0.02 && angle < Math.PI - 0.02) {
            const side = new Vector3().crossVectors(axis, offset).normalize();
            offset.applyAxisAngle(side, (-upward * Math.PI) / 180);
        }
        this.camera.position.copy(this.controls.target).add(offset);
        this.controls.update();
        this.request();
    }

    zoom(factor) {
        const offset = this.camera.position.clone().sub(this.controls.target);
        const wanted = offset.length() * factor;
        offset.setLength(
            Math.min(Math.max(wanted, this.controls.minDistance), this.controls.maxDistance),
        );
        this.camera.position.copy(this.controls.target).add(offset);
        this.controls.update();
        this.request();
    }

    /** Projection of a point, in pixels of the place; null behind the camera. */
    project(x, y, z, side = 0) {
        const p = new Vector3(x, y, z).project(this.camera);
        if (p.z > 1) return null;
        return {
            x: (((p.x + 1) / 2 + side) * this.place.clientWidth) / this.sides,
            y: ((1 - p.y) / 2) * this.place.clientHeight,
        };
    }

    /** The ray under a pixel of the place, and the side that it is in. */
    ray(x, y) {
        const along = (x / this.place.clientWidth) * this.sides;
        const side = Math.min(Math.max(Math.floor(along), 0), this.sides - 1);
        const near = new Vector3(
            (along - side) * 2 - 1,
            1 - (y / this.place.clientHeight) * 2,
            0.5,
        ).unproject(this.camera);
        const origin = this.camera.position.clone();
        return { origin, direction: near.sub(origin).normalize(), side };
    }

    /** Calls `click` for presses without a drag, `hover` for moves with no button down. */
    listen(click, hover) {
        let pressed = null;
        const at = (event) => {
            const box = this.canvas.getBoundingClientRect();
            return {
                x: event.clientX - box.left,
                y: event.clientY - box.top,
                touch: event.pointerType === "touch",
            };
        };
        this.canvas.addEventListener("pointerdown", (event) => {
            pressed = event.isPrimary && event.button === 0 ? at(event) : null;
        });
        this.canvas.addEventListener("pointerup", (event) => {
            const released = at(event);
            if (pressed && Math.hypot(released.x - pressed.x, released.y - pressed.y) < CLICK_SLACK)
                click(released);
            pressed = null;
        });
        this.canvas.addEventListener("pointermove", (event) => {
            if (event.buttons === 0 && event.pointerType !== "touch") hover(at(event));
        });
        this.canvas.addEventListener("pointerleave", () => hover(null));
    }
}
