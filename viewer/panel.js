// SPDX-License-Identifier: Apache-2.0
// Parts of the panel. Anything from a file is set as text, never as markup.

/** An element with properties and children; strings become text nodes. */
export function element(tag, properties = {}, ...children) {
    const made = document.createElement(tag);
    for (const [name, value] of Object.entries(properties)) {
        if (value === undefined) continue;
        if (name in made) made[name] = value;
        else made.setAttribute(name, value);
    }
    made.append(...children);
    return made;
}

/** An SVG element. */
export function drawn(tag, attributes = {}, ...children) {
    const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
    made.append(...children);
    return made;
}

const said = document.getElementById("said");

/** Announces a change to screen readers. */
export function say(text) {
    said.textContent = text;
}

/** A slider with its name and value. `show` formats a value, `change` is called with it. */
export function slider({ name, min = 0, max = 1, step = 0.01, value, show, change, id }) {
    const output = element("output", {}, show(value));
    const input = element("input", { type: "range", id, min, max, step, value });
    input.setAttribute("aria-label", name);
    const label = element(
        "label",
        { className: "control" },
        element("span", {}, name, output),
        input,
    );
    const update = () => {
        output.textContent = show(input.valueAsNumber);
        input.setAttribute("aria-valuetext", output.textContent);
    };
    input.addEventListener("input", () => {
        update();
        change(input.valueAsNumber);
    });
    update();
    return {
        node: label,
        input,
        get value() {
            return input.valueAsNumber;
        },
        /** Shows a value without calling `change`. */
        set value(x) {
            input.value = x;
            update();
        },
        /** Acts as if the slider had been moved. */
        move(x) {
            input.value = x;
            update();
            change(input.valueAsNumber);
        },
    };
}

export function check({ name, value, change, id }) {
    const input = element("input", { type: "checkbox", id, checked: value });
    input.addEventListener("change", () => change(input.checked));
    return element("label", { className: "check" }, input, name);
}

/** A choice between a few words; arrow keys move to the next. */
export function choice({ name, words, value, change }) {
    const group = element("div", { className: "choice" });
    group.setAttribute("role", "radiogroup");
    group.setAttribute("aria-label", name);
    const buttons = words.map((word, i) => {
        const button = element("button", { type: "button", onclick: () => set(i) }, word);
        button.setAttribute("role", "radio");
        return button;
    });
    let current = value;
    const show = () =>
        buttons.forEach((button, i) => {
            button.setAttribute("aria-checked", String(i === current));
            button.tabIndex = i === current ? 0 : -1;
        });
    const set = (i) => {
        current = i;
        show();
        change(i);
    };
    group.addEventListener("keydown", (event) => {
        const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
        if (step === undefined) return;
        event.preventDefault();
        event.stopPropagation();
        set((current + step + words.length) % words.length);
        buttons[current].focus();
    });
    group.append(...buttons);
    show();
    return {
        node: element("div", { className: "row" }, element("span", {}, name), group),
        set,
        get value() {
            return current;
        },
    };
}

/** Key figures: rows of [name, value, remark, kind of remark]. */
export function facts(rows) {
    const list = element("dl", { className: "facts" });
    for (const [name, value, remark, kind] of rows) {
        const dd = element("dd", {}, value);
        if (remark) dd.append(element("small", { className: kind ?? "" }, remark));
        list.append(element("div", {}, element("dt", {}, name), dd));
    }
    return list;
}

/** A command line with a button that copies it. */
export function commandLine(line) {
    const code = element("code", {}, line);
    const copy = element("button", { type: "button" }, "Copy");
    copy.onclick = async () => {
        await copyText(line, code);
        copy.textContent = "Copied";
        say("Copied");
    };
    return element("div", { className: "command" }, code, copy);
}

/** Pages from a disk may have no clipboard: then the text is selected. */
async function copyText(text, node) {
    try {
        await navigator.clipboard.writeText(text);
    } catch {
        getSelection().selectAllChildren(node);
        document.execCommand("copy");
    }
}

export function heading(text) {
    return element("h2", {}, text);
}

export function note(text) {
    return element("p", { className: "note" }, text);
}

/** A list of buttons, at most one of them pressed. `rows` are the children of each. */
export function pickList({ name, rows, pick }) {
    const list = element("div", { className: "list" });
    list.setAttribute("role", "group");
    list.setAttribute("aria-label", name);
    const buttons = rows.map((children, i) => {
        const button = element("button", { type: "button", onclick: () => pick(i) }, ...children);
        button.setAttribute("aria-pressed", "false");
        return button;
    });
    list.append(...buttons);
    let pressed = -1;
    return {
        node: list,
        /** Presses one, or none for -1, and scrolls to it. */
        press(i) {
            buttons[pressed]?.setAttribute("aria-pressed", "false");
            buttons[i]?.setAttribute("aria-pressed", "true");
            pressed = i;
            const button = buttons[i];
            if (button === undefined) return;
            const box = list.closest("#views");
            if (!box) return;
            const inside = box.getBoundingClientRect(),
                own = button.getBoundingClientRect();
            if (own.top < inside.top) box.scrollTop -= inside.top - own.top + 8;
            else if (own.bottom > inside.bottom) box.scrollTop += own.bottom - inside.bottom + 8;
        },
    };
}

export function swatch(kind, color) {
    const mark = element("span", { className: kind });
    mark.style.background = color;
    return mark;
}
