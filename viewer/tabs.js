// SPDX-License-Identifier: Apache-2.0
// The tabs, one for each view, with their panels. Arrow keys move to the next.
import { element } from "./panel.js";

function makeTab(view, i, open) {
    const tab = element(
        "button",
        { type: "button", id: `tab-${i}`, onclick: () => open(i) },
        view.name,
    );
    tab.setAttribute("role", "tab");
    tab.setAttribute("aria-controls", `view-${i}`);
    const panel = element("div", { id: `view-${i}`, hidden: true }, view.node);
    panel.setAttribute("role", "tabpanel");
    panel.setAttribute("aria-labelledby", tab.id);
    return { tab, panel };
}

/** Fills the list of tabs; `open` is called with a tab's number. Returns what marks a tab as open. */
export function makeTabs(views, open) {
    const tabs = views.map((view, i) => makeTab(view, i, open));
    const list = document.getElementById("tabs");
    list.append(...tabs.map(({ tab }) => tab));
    list.hidden = views.length < 2;
    document.getElementById("views").append(...tabs.map(({ panel }) => panel));
    list.addEventListener("keydown", (event) => {
        const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
        if (by === undefined) return;
        const next =
            (tabs.findIndex(({ tab }) => tab.tabIndex === 0) + by + tabs.length) % tabs.length;
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
