// SPDX-License-Identifier: Apache-2.0
// Retrieval: the distance table as shades, darkest for the most similar of each shape, and for a picked
// shape the others by distance, with their pictures.
import page, { doubles, pictureAddress } from "./data.js";
import { commandLine, element, facts, heading, say } from "./panel.js";
import { themeColor } from "./theme.js";
import { amount, count, real } from "./text.js";
import { following, View } from "./view.js";

const EDGE = 2; // pixels around the table, for the frame of the picked cell
const LIST_MOST = 60; // largest number of neighbours in the list
const NAMES_SHARE = 0.4; // largest part of the table's room for names

export class RetrievalView extends View {
    name = "Retrieval";
    flat = true;

    constructor(stage, place) {
        super();
        this.stage = stage;
        this.place = place; // the element over the stage
        this.shapes = page.shapes.map((shape, i) => ({
            ...shape,
            address: shape.picture ? pictureAddress(`shape-picture-${i}`) : null,
        }));
        this.pictured = this.shapes.some((shape) => shape.picture);
        this.distances = doubles("shape-distances");
        this.ranks = this.rankAll();
        this.picked = 0;
        this.other = null; // the column of a picked cell
        this.node = this.makePanel();
        this.makeSheet();
        this.makeShades();
        this.update();
    }

    get count() {
        return this.shapes.length;
    }

    distance(i, k) {
        return this.distances[i * this.count + k];
    }

    /** For each row the rank of every other shape, scaled to 0 to 1; equal distances share a rank. */
    rankAll() {
        const n = this.shapes.length;
        const ranks = new Float32Array(n * n);
        for (let i = 0; i < n; i++) {
            const order = Array.from({ length: n }, (_, k) => k).sort(
                (a, b) => this.distance(i, a) - this.distance(i, b) || a - b,
            );
            order.forEach((k, place) => {
                const before = order[place - 1];
                const tied = place > 0 && this.distance(i, before) === this.distance(i, k);
                ranks[i * n + k] = tied ? ranks[i * n + before] : place / Math.max(n - 1, 1);
            });
        }
        return ranks;
    }

    /** The other shapes, most similar first. */
    neighbours(i) {
        const others = this.shapes.map((_, k) => k).filter((k) => k !== i);
        return others.sort((a, b) => this.distance(i, a) - this.distance(i, b) || a - b);
    }

    // ---- panel ----

    makePanel() {
        this.title = heading("");
        this.self = element("div", { className: "list" });
        this.list = element("div", { className: "list" });
        this.list.setAttribute("role", "group");
        return element(
            "div",
            {},
            facts([["Shapes", count(this.count)]]),
            legend(),
            this.self,
            this.title,
            this.list,
            ...(page.table_command
                ? [heading("The table as a file"), commandLine(page.table_command)]
                : []),
        );
    }

    entry(k, remark) {
        const { name, address } = this.shapes[k];
        const picture = address
            ? [element("img", { src: address, alt: "", width: 54, height: 40 })]
            : this.pictured
              ? [element("span", { className: "blank" })]
              : [];
        const button = element(
            "button",
            { type: "button", onclick: () => this.pick(k) },
            ...picture,
            element("span", { className: "name", title: name }, name),
            element("span", { className: "number" }, remark),
        );
        return button;
    }

    // ---- table ----

    makeSheet() {
        this.canvas = element("canvas", { tabIndex: 0 });
        this.canvas.setAttribute("role", "img");
        this.canvas.setAttribute(
            "aria-label",
            `Table of distances of ${amount(this.count, "shape", "shapes")}; arrow keys go from shape to shape`,
        );
        this.place.append(element("div", { className: "sheet" }, this.canvas));
        this.canvas.addEventListener("pointerdown", (event) => {
            const cell = this.cellAt(event);
            if (cell) this.pick(cell.row, cell.column);
        });
        this.canvas.addEventListener("pointermove", (event) => {
            const cell = this.cellAt(event);
            this.canvas.title = cell
                ? `${this.shapes[cell.row].name} – ${this.shapes[cell.column].name}: ${real(this.distance(cell.row, cell.column))}`
                : "";
        });
        this.canvas.addEventListener("keydown", (event) => {
            const by = { ArrowUp: -1, ArrowLeft: -1, ArrowDown: 1, ArrowRight: 1 }[event.key];
            if (by === undefined) return;
            event.preventDefault();
            event.stopPropagation();
            this.step(by);
        });
        new ResizeObserver(() => this.draw()).observe(this.place);
    }

    cellAt(event) {
        const box = this.canvas.getBoundingClientRect();
        const column = Math.floor((event.clientX - box.left - this.left) / this.cell);
        const row = Math.floor((event.clientY - box.top - this.top) / this.cell);
        const inside = row >= 0 && row < this.count && column >= 0 && column < this.count;
        return inside ? { row, column } : null;
    }

    /** Names are shown beside and above the cells if these are large enough. */
    measure(width, height) {
        const n = this.count;
        const context = this.canvas.getContext("2d");
        context.font = this.font();
        const room = Math.min(width, height);
        const longest = Math.min(
            170,
            NAMES_SHARE * room,
            Math.max(...this.shapes.map((shape) => context.measureText(shape.name).width)) + 8,
        );
        const named = (room - longest) / n >= 9;
        const frame = named ? longest : EDGE;
        this.left = this.top = frame;
        this.named = named;
        this.cell = Math.max(named ? Math.floor((room - frame) / n) : Math.floor(room / n), 3);
        this.cell = Math.min(this.cell, 56);
    }

    font() {
        return `${Math.min(12.5, Math.max(9, (this.cell ?? 12) * 0.8))}px ${getComputedStyle(document.body).fontFamily}`;
    }

    draw() {
        const style = getComputedStyle(this.place);
        const width =
            this.place.clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight);
        const height =
            this.place.clientHeight -
            parseFloat(style.paddingTop) -
            parseFloat(style.paddingBottom);
        if (width <= 0 || height <= 0) return;
        this.measure(width, height);
        const size = this.count * this.cell + EDGE;
        const ratio = Math.min(window.devicePixelRatio || 1, 2);
        this.canvas.width = (this.left + size) * ratio;
        this.canvas.height = (this.top + size) * ratio;
        this.canvas.style.width = `${this.left + size}px`;
        this.canvas.style.height = `${this.top + size}px`;
        const context = this.canvas.getContext("2d");
        context.scale(ratio, ratio);
        this.drawCells(context);
        if (this.named) this.drawNames(context);
        this.drawPicked(context);
    }

    /** One pixel per cell, in the colours of the theme. */
    makeShades() {
        const near = parse(themeColor("cell-near")),
            far = parse(themeColor("cell-far"));
        const image = new ImageData(this.count, this.count);
        this.ranks.forEach((rank, i) => {
            const x = Math.pow(rank, 0.7);
            for (let k = 0; k < 3; k++) image.data[4 * i + k] = near[k] + (far[k] - near[k]) * x;
            image.data[4 * i + 3] = 255;
        });
        this.shades = element("canvas", { width: this.count, height: this.count });
        this.shades.getContext("2d").putImageData(image, 0, 0);
    }

    drawCells(context) {
        const size = this.count * this.cell;
        context.imageSmoothingEnabled = false;
        context.drawImage(this.shades, this.left, this.top, size, size);
        for (let k = 1; this.cell >= 8 && k <= this.count; k++) {
            context.clearRect(this.left + k * this.cell - 1, this.top, 1, size);
            context.clearRect(this.left, this.top + k * this.cell - 1, size, 1);
        }
    }

    drawNames(context) {
        const plain = themeColor("soft"),
            strong = themeColor("text");
        context.font = this.font();
        context.textBaseline = "middle";
        this.shapes.forEach(({ name }, i) => {
            const middle = (i + 0.5) * this.cell;
            context.fillStyle = i === this.picked ? strong : plain;
            context.textAlign = "right";
            const shown = shorten(context, name, this.left - 8);
            context.fillText(shown, this.left - 6, this.top + middle);
            context.save();
            context.translate(this.left + middle, this.top - 6);
            context.rotate(-Math.PI / 2);
            context.textAlign = "left";
            context.fillText(shown, 0, 0);
            context.restore();
        });
    }

    drawPicked(context) {
        context.strokeStyle = themeColor("warn");
        context.lineWidth = 2;
        context.strokeRect(
            this.left - 1,
            this.top + this.picked * this.cell - 1,
            this.count * this.cell + 1,
            this.cell + 1,
        );
        if (this.other !== null)
            context.strokeRect(
                this.left + this.other * this.cell - 1,
                this.top + this.picked * this.cell - 1,
                this.cell + 1,
                this.cell + 1,
            );
    }

    // ---- what is visible ----

    update() {
        const i = this.picked;
        const nearest = this.neighbours(i);
        this.self.replaceChildren(this.entry(i, ""));
        this.self.firstChild.setAttribute("aria-pressed", "true");
        if (this.other !== null)
            this.self.append(
                heading("The picked cell"),
                this.entry(this.other, real(this.distance(i, this.other))),
            );
        this.title.textContent = "Most like it, with distances";
        this.list.setAttribute("aria-label", `Most like ${this.shapes[i].name}`);
        this.list.replaceChildren(
            ...nearest.slice(0, LIST_MOST).map((k) => this.entry(k, real(this.distance(i, k)))),
        );
        this.list.scrollTop = 0;
        this.draw();
    }

    pick(i, other = null) {
        this.picked = i;
        this.other = other === i ? null : other;
        this.update();
        const nearest = this.neighbours(i)[0];
        const { name } = this.shapes[i];
        if (this.other !== null)
            say(
                `${name} and ${this.shapes[other].name}: distance ${real(this.distance(i, other))}`,
            );
        else say(nearest === undefined ? name : `${name}: most like ${this.shapes[nearest].name}`);
    }

    step(by) {
        this.pick(following(this.picked, by, this.count));
    }

    applyTheme() {
        this.makeShades();
        this.draw();
    }

    enter() {
        this.place.hidden = false;
        this.draw();
    }

    leave() {
        this.place.hidden = true;
    }
}

/** A name without its middle, if it is too long: the ends tell models apart. */
function shorten(context, name, room) {
    const fits = (text) => context.measureText(text).width <= room;
    if (fits(name)) return name;
    let kept = name.length - 1;
    const cut = () =>
        `${name.slice(0, Math.ceil(kept / 2))}…${name.slice(name.length - (kept >> 1))}`;
    while (kept > 1 && !fits(cut())) kept--;
    return cut();
}

/** The meaning of the shades in a row. */
function legend() {
    return element("p", { className: "legend" }, "alike", element("span"), "unlike");
}

function parse(hex) {
    return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
}
