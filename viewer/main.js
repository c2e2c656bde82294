// A page: reads its data, makes the views that there are results for, and joins them with stage, panel and
// keys.
import page from "./data.js";
import { Controls } from "./controls.js";
import { GuardsView } from "./guards.js";
import { fillHelp, listenToKeys, showHelp } from "./help.js";
import { ModelView } from "./model.js";
import { MorphView } from "./morph.js";
import { drawn, element, say } from "./panel.js";
import { PiecesView } from "./pieces.js";
import { RetrievalView } from "./retrieval.js";
import { Stage } from "./scene.js";
import { SkeletonView } from "./skeleton.js";
import { Surface } from "./surface.js";
import { amount } from "./text.js";
import { onTheme, toggleTheme } from "./theme.js";

const at = (id) => document.getElementById(id);
const canvas = at("canvas"), place = at("stage"), tag = at("tag");

function makeViews(stage, surface) {
    const views = [];
    if (page.guards) views.push(new GuardsView(stage, surface));
    if (page.pieces) views.push(new PiecesView(stage));
    if (page.skeleton) views.push(new SkeletonView(stage, surface));
    if (page.morph) views.push(new MorphView(stage));
    if (page.shapes) views.push(new RetrievalView(stage, at("matrix")));
    if (views.length === 0) views.push(new ModelView());
    return views;
}

// ---- stage ----

function openStage() {
    try {
        return new Stage(canvas, place);
    } catch {
        at("hint").textContent = "This browser shows no 3D graphics (WebGL 2 is missing or switched off).";
        return null;
    }
}

/** All that is drawn about a view; the radius of the model holds what stands in it. */
function ballOfView(view, surface) {
    return view.ball ?? surface?.ball ?? { center: [0, 0, 0], radius: 1 };
}

function addObjects(stage, surface, views) {
    const objects = views.flatMap((view) => view.objects);
    if (surface) {
        surface.object.renderOrder = 5; // glass comes after what stands in it
        objects.push(surface.object);
    }
    objects.forEach((object) => stage.scene.add(object));
}

// ---- header and tabs ----

function icon(path) {
    return drawn("svg", { viewBox: "0 0 16 16", "aria-hidden": "true" }, drawn("path", { d: path }));
}

function roundButton(name, path, act) {
    const button = element("button", { type: "button", className: "round", title: name, onclick: act }, icon(path));
    button.setAttribute("aria-label", name);
    return button;
}

function fillHeader() {
    document.title = `${page.title} – starguard`;
    at("title").textContent = page.title;
    at("subtitle").textContent = page.model
        ? `${amount(page.model.vertices, "vertex", "vertices")}, ${amount(page.model.faces, "face", "faces")}`
        : "";
    at("buttons").append(
        roundButton("Light or dark", "M8 1.5a6.5 6.5 0 1 0 0 13z M8 1.5a6.5 6.5 0 0 1 0 13", toggleTheme),
        roundButton("Keys and help", "M5.6 6a2.4 2.4 0 1 1 3.3 2.2c-.6.3-.9.7-.9 1.3v.4 M8 12.6v.1", showHelp),
    );
}

function makeTabs(views, open) {
    const tabs = views.map((view, i) => {
        const tab = element("button", { type: "button", id: `tab-${i}`, onclick: () => open(i) }, view.name);
        tab.setAttribute("role", "tab");
        tab.setAttribute("aria-controls", `view-${i}`);
        const panel = element("div", { id: `view-${i}`, hidden: true }, view.node);
        panel.setAttribute("role", "tabpanel");
        panel.setAttribute("aria-labelledby", tab.id);
        at("views").append(panel);
        return { tab, panel };
    });
    const list = at("tabs");
    list.append(...tabs.map(({ tab }) => tab));
    list.hidden = views.length < 2;
    list.addEventListener("keydown", (event) => {
        const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
        if (by === undefined) return;
        const next = (tabs.findIndex(({ tab }) => tab.tabIndex === 0) + by + tabs.length) % tabs.length;
        open(next);
        tabs[next].tab.focus();
    });
    return (chosen) =>
        tabs.forEach(({ tab, panel }, i) => {
            tab.setAttribute("aria-selected", String(i === chosen));
            tab.tabIndex = i === chosen ? 0 : -1;
            panel.hidden = i !== chosen;
        });
}

// ---- the page ----

function start() {
    const stage = openStage();
    if (stage === null) return;
    const surface = page.model ? new Surface() : null;
    const views = makeViews(stage, surface);
    let current = null;

    const controls = new Controls(stage, surface, (open) => {
        surface?.setCutOpen(open);
        views.forEach((view) => view.setCutOpen(open));
    });
    at("common").append(controls.node);

    const open = (i) => {
        const before = current;
        before?.leave();
        current = views[i];
        mark(i);
        for (const view of views) for (const object of view.objects) object.layers.set(view === current ? 0 : 1);
        if (surface) surface.object.visible = current.withSurface;
        canvas.hidden = current.flat;
        tag.hidden = true;
        if (current.withSurface && !(current instanceof GuardsView)) surface?.paint(null, new Set());
        const ball = ballOfView(current, surface);
        if (!current.flat && (before === null || ball !== stage.ball)) stage.fit(ball, before !== null);
        controls.suit(current);
        at("common").hidden = current.flat;
        current.enter();
        at("hint").textContent = current.flat ? "" : "Drag to turn, scroll to zoom, ? for keys";
        stage.request();
        if (before !== null) say(`${current.name}`);
    };
    const mark = makeTabs(views, open);

    const showTag = (pointer) => {
        const found = current.tag(pointer);
        canvas.classList.toggle("over", found?.over ?? false);
        const spot = found && stage.project(...found.place);
        tag.hidden = !spot;
        if (!spot) return;
        tag.textContent = found.text;
        const x = Math.min(Math.max(spot.x - tag.offsetWidth / 2, 8), place.clientWidth - tag.offsetWidth - 8);
        const y = spot.y > 60 ? spot.y - tag.offsetHeight - 16 : spot.y + 18;
        tag.style.transform = `translate(${Math.round(x)}px, ${Math.round(y)}px)`;
    };
    let pointer = null;
    stage.listen(
        (p) => current.click(p),
        (p) => showTag((pointer = p)),
    );

    onTheme(() => {
        surface?.applyTheme();
        views.forEach((view) => view.applyTheme());
        stage.request();
    });

    const morph = views.find((view) => view instanceof MorphView);
    const explode = views.find((view) => view instanceof PiecesView)?.explode;
    const keys = [
        [["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"], "turn", (key) => turn(stage, key)],
        [["+", "-"], "zoom in, out", (key) => stage.zoom(key === "+" ? 1 / 1.15 : 1.15)],
        [["0"], "the first view again", () => stage.fit(stage.ball)],
        [["n", "p"], "next, previous guard, piece, frame or shape", (key) => current.step(key.toLowerCase() === "n" ? 1 : -1)],
        [["Escape"], "pick nothing", () => current.clear()],
        [["c"], "cut across X, Y, Z, or not", () => controls.nextCut()],
        ...(explode ? [[["e"], "pieces apart, together", () => explode.move(explode.value > 0 ? 0 : 0.5)]] : []),
        ...(morph ? [[[" "], "play the morph, pause", () => current === morph && morph.toggle()]] : []),
        ...(views.length > 1 ? [[views.map((_, i) => String(i + 1)), views.map((view) => view.name.toLowerCase()).join(", "), (key) => open(Number(key) - 1)]] : []),
        [["t"], "light or dark", toggleTheme],
        [["?"], "this help", showHelp],
    ];
    fillHelp(keys);
    listenToKeys(keys);

    fillHeader();
    stage.resize();
    addObjects(stage, surface, views);
    open(0);
    stage.beforeDraw.push(() => {
        stage.camera.updateMatrixWorld();
        showTag(pointer);
    });
    document.documentElement.dataset.ready = "true";
    window.starguard = { stage, views, open }; // for tests and benchmarks
}

function turn(stage, key) {
    const step = 6;
    stage.turn(
        key === "ArrowLeft" ? -step : key === "ArrowRight" ? step : 0,
        key === "ArrowUp" ? step : key === "ArrowDown" ? -step : 0,
    );
}

start();
