// SPDX-License-Identifier: Apache-2.0
// A page: creates the views for which there are results, and connects them with stage, panel and keys.
import page from "./data.js";
import { Controls } from "./controls.js";
import { GuardsView } from "./guards.js";
import { fillHeader } from "./header.js";
import { fillHelp, listenToKeys, showHelp } from "./help.js";
import { MapView } from "./map.js";
import { ModelView } from "./model.js";
import { MorphView } from "./morph.js";
import { say } from "./panel.js";
import { PiecesView } from "./pieces.js";
import { RetrievalView } from "./retrieval.js";
import { Stage } from "./scene.js";
import { SkeletonView } from "./skeleton.js";
import { Surface } from "./surface.js";
import { makeTabs } from "./tabs.js";
import { onTheme, toggleTheme } from "./theme.js";

const at = (id) => document.getElementById(id);

const EVERYTHING = { center: [0, 0, 0], radius: 1 }; // bounds all positions of a page
const TURN = 6; // degrees per press of an arrow key

class App {
    constructor(stage) {
        this.stage = stage;
        this.surface = page.model ? new Surface() : null;
        this.views = this.makeViews();
        this.view = null; // the open one
        this.pointer = null;
        this.controls = new Controls(stage, this.surface, (open) => this.setCutOpen(open));
        this.markTab = makeTabs(this.views, (i) => this.open(i));
        at("common").append(this.controls.node);
        this.addObjects();
        stage.resize();
        this.open(0);
        this.listen();
        const keys = this.keys();
        fillHelp(keys);
        listenToKeys(keys);
    }

    makeViews() {
        const { stage, surface } = this;
        const views = [];
        if (page.guards) views.push(new GuardsView(stage, surface));
        if (page.pieces) views.push(new PiecesView(stage));
        if (page.skeleton) views.push(new SkeletonView(stage, surface));
        if (page.map) views.push(new MapView(stage));
        if (page.morph) views.push(new MorphView(stage));
        if (page.shapes) views.push(new RetrievalView(stage, at("matrix")));
        return views.length > 0 ? views : [new ModelView()];
    }

    viewOf(kind) {
        return this.views.find((view) => view instanceof kind);
    }

    addObjects() {
        const { scene } = this.stage;
        for (const view of this.views) view.objects.forEach((object) => scene.add(object));
        if (this.surface === null) return;
        this.surface.object.renderOrder = 5; // glass is drawn after what is inside
        scene.add(this.surface.object);
    }

    setCutOpen(open) {
        this.surface?.setCutOpen(open);
        this.views.forEach((view) => view.setCutOpen(open));
    }

    // ---- views ----

    open(i) {
        const before = this.view;
        before?.leave();
        this.view = this.views[i];
        this.markTab(i);
        this.showObjects();
        this.aim(before === null);
        this.view.enter();
        this.stage.request();
        if (before !== null) say(this.view.name);
    }

    /** Objects of other views are on a layer hidden from the camera. */
    showObjects() {
        const { view, surface, stage } = this;
        stage.setSides(view.sides?.length ?? 1);
        for (const each of this.views)
            each.objects.forEach((object) => object.layers.set(each === view ? 0 : 1));
        view.sides?.forEach((objects, side) =>
            objects.forEach((object) => object.layers.set(stage.layerOf(side))),
        );
        if (surface) {
            surface.object.visible = view.withSurface;
            surface.paint(null, new Set());
        }
        at("canvas").hidden = view.flat;
        at("common").hidden = view.flat;
        at("tag").hidden = true;
        at("hint").textContent = view.flat ? "" : "Drag to turn, scroll to zoom, ? for keys";
        at("trial").textContent = view.flat ? "" : view.trial;
    }

    /** What to try first goes away with the first press or key. */
    endTrial() {
        at("trial").hidden = true;
    }

    /** Fits the camera to the view's contents, unless it already is. */
    aim(first) {
        const ball = this.view.ball ?? this.surface?.ball ?? EVERYTHING;
        if (!this.view.flat && (first || ball !== this.stage.ball)) this.stage.fit(ball, !first);
        this.controls.suit(this.view);
    }

    // ---- pointer ----

    listen() {
        const { stage } = this;
        stage.listen(
            (place) => this.view.click(place),
            (place) => {
                this.pointer = place;
                this.showTag();
            },
        );
        for (const kind of ["pointerdown", "keydown"])
            document.addEventListener(kind, () => this.endTrial(), { once: true });
        stage.beforeDraw.push(() => {
            stage.camera.updateMatrixWorld();
            this.showTag();
        });
        onTheme(() => {
            this.surface?.applyTheme();
            this.views.forEach((view) => view.applyTheme());
            stage.request();
        });
    }

    /** The text next to what is under the pointer or picked, kept within the stage. */
    showTag() {
        const tag = at("tag"),
            { place } = this.stage;
        const found = this.view.tag(this.pointer);
        const spot = found && this.stage.project(...found.place, found.side);
        this.stage.canvas.classList.toggle("over", found?.over ?? false);
        tag.hidden = !spot;
        if (!spot) return;
        tag.textContent = found.text;
        const x = Math.min(
            Math.max(spot.x - tag.offsetWidth / 2, 8),
            place.clientWidth - tag.offsetWidth - 8,
        );
        const y = spot.y > 60 ? spot.y - tag.offsetHeight - 16 : spot.y + 18;
        tag.style.transform = `translate(${Math.round(x)}px, ${Math.round(y)}px)`;
    }

    // ---- keys ----

    keys() {
        const { stage, views } = this;
        const apart = views.some((view) => view.toggleExplode),
            morph = this.viewOf(MorphView);
        const keys = [
            [["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"], "turn", (key) => this.turn(key)],
            [["+", "-"], "zoom in, out", (key) => stage.zoom(key === "+" ? 1 / 1.15 : 1.15)],
            [["0"], "the first view again", () => stage.fit(stage.ball)],
            [
                ["n", "p"],
                "next, previous guard, piece, frame or shape",
                (key) => this.view.step(key.toLowerCase() === "n" ? 1 : -1),
            ],
            [["Escape"], "pick nothing", () => this.view.clear()],
            [["c"], "cut across X, Y, Z, or not", () => this.controls.nextCut()],
        ];
        if (apart)
            keys.push([["e"], "pieces apart, together", () => this.view.toggleExplode?.()]);
        if (morph)
            keys.push([
                [" "],
                "play the morph, pause",
                () => this.view === morph && morph.toggle(),
            ]);
        if (views.length > 1) {
            const digits = views.map((_, i) => String(i + 1));
            keys.push([
                digits,
                views.map((view) => view.name.toLowerCase()).join(", "),
                (key) => this.open(Number(key) - 1),
            ]);
        }
        keys.push([["t"], "light or dark", toggleTheme], [["?"], "this help", showHelp]);
        return keys;
    }

    turn(key) {
        this.stage.turn(
            { ArrowLeft: -TURN, ArrowRight: TURN }[key] ?? 0,
            { ArrowUp: TURN, ArrowDown: -TURN }[key] ?? 0,
        );
    }
}

function start() {
    fillHeader();
    try {
        window.starguard = new App(new Stage(at("canvas"), at("stage"))); // for tests and benchmarks
    } catch (error) {
        at("panel").hidden = true;
        at("hint").textContent = /webgl/i.test(error.message)
            ? "This browser shows no 3D graphics: WebGL 2 is missing or switched off."
            : `This page cannot be shown: ${error.message}`;
        at("hint").className = "failure";
        return;
    }
    document.documentElement.dataset.ready = "true";
}

start();
