// SPDX-License-Identifier: Apache-2.0
// The model alone, without results.
import page from "./data.js";
import { facts } from "./panel.js";
import { count } from "./text.js";
import { View } from "./view.js";

export class ModelView extends View {
    name = "Model";
    withSurface = true;

    constructor() {
        super();
        this.node = facts([
            ["Vertices", count(page.model.vertices)],
            ["Faces", count(page.model.faces)],
        ]);
    }
}
