// SPDX-License-Identifier: Apache-2.0
// The curve skeleton: rods along its edges, and balls with the nodes' radii, scaled by the slider.
import {
    Color,
    CylinderGeometry,
    IcosahedronGeometry,
    InstancedMesh,
    Matrix4,
    Quaternion,
    Vector3,
} from "three";
import page, { floats, indices } from "./data.js";
import { ballOf } from "./geometry.js";
import { setSides, surfaceMaterial } from "./materials.js";
import { facts, note, slider } from "./panel.js";
import { themeColor } from "./theme.js";
import { count, percent } from "./text.js";
import { View } from "./view.js";

const ROD = 0.0045,
    KNOB = 0.011; // relative to the radius of the contents
const MANY = 3000; // nodes above which balls have fewer faces

export class SkeletonView extends View {
    name = "Skeleton";
    withSurface = true;

    constructor(stage, surface) {
        super();
        this.stage = stage;
        this.points = floats("skeleton-points");
        this.edges = indices("skeleton-edges");
        this.radii = floats("skeleton-radii");
        this.ball = surface?.ball ?? ballOf(this.points);
        this.degrees = new Uint32Array(page.skeleton.nodes);
        this.edges.forEach((v) => this.degrees[v]++);
        this.build();
        this.objects = [this.rods, this.knobs, ...(this.balls ? [this.balls] : [])];
        this.node = this.makePanel();
        this.applyTheme();
        this.setBalls(0);
    }

    node3(i) {
        return new Vector3(this.points[3 * i], this.points[3 * i + 1], this.points[3 * i + 2]);
    }

    build() {
        const { nodes, edges } = page.skeleton;
        const detail = nodes > MANY ? 1 : 3;
        this.rods = new InstancedMesh(
            new CylinderGeometry(1, 1, 1, 8, 1, true),
            surfaceMaterial(),
            edges,
        );
        this.knobs = new InstancedMesh(new IcosahedronGeometry(1, 2), surfaceMaterial(), nodes);
        const matrix = new Matrix4(),
            turn = new Quaternion(),
            up = new Vector3(0, 1, 0);
        const rod = ROD * this.ball.radius;
        for (let e = 0; e < edges; e++) {
            const a = this.node3(this.edges[2 * e]),
                b = this.node3(this.edges[2 * e + 1]);
            const along = b.clone().sub(a),
                length = along.length();
            turn.setFromUnitVectors(up, length > 0 ? along.divideScalar(length) : up);
            matrix.compose(a.add(b).multiplyScalar(0.5), turn, new Vector3(rod, length, rod));
            this.rods.setMatrixAt(e, matrix);
        }
        for (let i = 0; i < nodes; i++)
            this.knobs.setMatrixAt(i, this.ballMatrix(i, this.knobSize(i)));
        this.balls =
            this.radii &&
            new InstancedMesh(
                new IcosahedronGeometry(1, detail),
                surfaceMaterial({ defines: { SOLID: "" } }),
                nodes,
            );
        for (const object of [this.rods, this.knobs, this.balls])
            if (object) object.frustumCulled = false;
    }

    /** Joints and ends are knobs, other nodes as thick as their rods. */
    knobSize(i) {
        return (this.degrees[i] === 2 ? ROD : KNOB) * this.ball.radius;
    }

    ballMatrix(i, radius) {
        return new Matrix4().makeScale(radius, radius, radius).setPosition(this.node3(i));
    }

    makePanel() {
        const joints = this.degrees.filter((d) => d > 2).length,
            ends = this.degrees.filter((d) => d === 1).length;
        const node = document.createElement("div");
        node.append(
            facts([
                ["Nodes", count(page.skeleton.nodes)],
                ["Joints", count(joints)],
                ["Ends", count(ends)],
            ]),
        );
        node.append(note("Joints are red, ends dark, or light on a dark page."));
        if (this.radii)
            node.append(
                slider({
                    name: "Balls of the nodes",
                    id: "balls",
                    value: 0,
                    show: (x) => (x === 0 ? "off" : `${percent(x)} of their radii`),
                    change: (x) => this.setBalls(x),
                }).node,
                note("At 100 % each ball touches the surface."),
            );
        else
            node.append(
                note(
                    "Radii are not known: the file has none, and there is no model to measure them by.",
                ),
            );
        return node;
    }

    setBalls(x) {
        if (!this.balls) return;
        this.balls.visible = x > 0;
        for (let i = 0; x > 0 && i < page.skeleton.nodes; i++)
            this.balls.setMatrixAt(i, this.ballMatrix(i, x * this.radii[i]));
        this.balls.instanceMatrix.needsUpdate = true;
        this.stage.request();
    }

    applyTheme() {
        const line = themeColor("accent"),
            joint = themeColor("warn"),
            end = themeColor("text"); // green is for what is proven
        this.rods.material.uniforms.base.value.set(line);
        this.degrees.forEach((d, i) =>
            this.knobs.setColorAt(i, new Color(d > 2 ? joint : d === 2 ? line : end)),
        );
        if (this.knobs.instanceColor) this.knobs.instanceColor.needsUpdate = true;
        this.balls?.material.uniforms.base.value.set(themeColor("accent"));
    }

    setCutOpen(open) {
        for (const object of this.objects) setSides(object.material, true, open);
    }
}
