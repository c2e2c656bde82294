// SPDX-License-Identifier: Apache-2.0
// Appearance: one shader for surfaces, one for points. Uses the style sheet's colours unchanged; light
// comes from over the viewer's left shoulder.
import { BackSide, Color, DoubleSide, FrontSide, ShaderMaterial, Vector4 } from "three";

/** Uniforms shared by all materials: the cut, which hides points with dot(p, cut.xyz) > cut.w. */
export const shared = {
    cut: { value: new Vector4(0, 0, 0, 1) },
    explode: { value: 0 },
    time: { value: 0 },
    pixels: { value: 1 },
};

const INNER = 0.74;

const SURFACE_VERTEX = `
uniform float explode, time;
varying vec3 where, direction, view, tint;
#ifdef PIECES
attribute vec3 away;
attribute vec3 color;
attribute float piece;
uniform float picked;
varying float fade;
#endif
#ifdef MAPPED
attribute vec3 source;
#endif
#ifdef MOVING
attribute vec3 positionNext;
attribute vec3 normalNext;
#endif
void main() {
    vec3 p = position, n = normal;
    tint = vec3(1.0);
#ifdef MOVING
    p = mix(position, positionNext, time);
    n = mix(normal, normalNext, time);
#endif
#ifdef PIECES
    p += explode * away;
    tint = color;
    fade = picked < 0.0 || abs(picked - piece) < 0.5 ? 1.0 : 0.0;
#endif
#ifdef USE_INSTANCING
    p = (instanceMatrix * vec4(p, 1.0)).xyz;
    n = mat3(instanceMatrix) * n;
#endif
#ifdef USE_INSTANCING_COLOR
    tint = instanceColor;
#endif
#ifdef MAPPED
    where = source;
#else
    where = p;
#endif
    vec4 seen = modelViewMatrix * vec4(p, 1.0);
    direction = normalMatrix * n;
    view = -seen.xyz;
    gl_Position = projectionMatrix * seen;
}`;

const SURFACE_FRAGMENT = `
uniform vec4 cut;
uniform vec3 base;
uniform float opacity, rim, inner, pixels;
varying vec3 where, direction, view, tint;
#ifdef PIECES
varying float fade;
#endif
#ifdef MAPPED
uniform int pattern;
uniform vec4 grid;
/* Lines where a coordinate is whole, each coordinate in a colour, 1.5 pixels wide. */
vec3 lines(vec3 cell) {
    vec3 to = abs(fract(cell - 0.5) - 0.5) / max(fwidth(cell), 1e-6);
    vec3 on = 1.0 - smoothstep(0.9 * pixels, 1.9 * pixels, to);
    vec3 c = mix(vec3(0.93), vec3(0.80, 0.16, 0.14), on.x);
    c = mix(c, vec3(0.10, 0.52, 0.20), on.y);
    return mix(c, vec3(0.13, 0.32, 0.80), on.z);
}
/* Colours by place, darker in every other cube. */
vec3 checker(vec3 cell) {
    float odd = mod(floor(cell.x) + floor(cell.y) + floor(cell.z), 2.0);
    return mix(1.0, 0.6, odd) * (0.4 + 0.6 * clamp(cell / 16.0, 0.0, 1.0));
}
#endif
void main() {
    if (dot(where, cut.xyz) > cut.w) discard;
    vec3 n = normalize(direction), v = normalize(view);
#ifdef FLIP_SIDED
    bool outer = false; /* only inner sides are drawn, and count as front faces */
#else
    bool outer = gl_FrontFacing;
#endif
    if (!outer) n = -n;
    float facing = clamp(dot(n, v), 0.0, 1.0);
    float key = max(dot(n, normalize(vec3(-0.45, 0.65, 0.7))), 0.0);
    float light = 0.50 + 0.40 * key + 0.16 * facing;
    vec3 paint = base * tint;
#ifdef MAPPED
    vec3 cell = (where - grid.xyz) * grid.w;
    if (pattern == 1) paint = checker(cell);
    if (pattern == 2) paint = lines(cell);
#endif
    vec3 c = paint * light + 0.10 * pow(key, 24.0);
#ifdef STRIPED
    c *= mix(1.0, 0.45, step(0.5, fract((gl_FragCoord.x - gl_FragCoord.y) / (8.0 * pixels))));
#endif
    float a = mix(opacity, 1.0, rim * pow(1.0 - facing, 2.5));
    if (!outer) {
#ifdef SOLID
        /* what a cut lays open of a closed surface looks filled */
        float hatch = step(0.5, fract((gl_FragCoord.x + gl_FragCoord.y) / (9.0 * pixels)));
        c = paint * (0.72 + 0.05 * hatch);
#else
        c *= inner;
#endif
    }
#ifdef PIECES
    if (fade < 0.5) {
        /* a screen of dots: no sorting is needed */
        vec2 dot2 = mod(floor(gl_FragCoord.xy), 4.0);
        if (dot2.x + dot2.y > 0.5) discard;
    }
#endif
    gl_FragColor = vec4(c, a);
}`;

/**
 * A lit surface; `defines` may contain PIECES, MOVING, SOLID (closed: cuts look filled), STRIPED, or
 * MAPPED: cuts and patterns follow the attribute `source` (pattern: 0 none, 1 checker, 2 lines).
 */
export function surfaceMaterial({ color = "#ffffff", opacity = 1, rim = 0, defines = {} } = {}) {
    const material = new ShaderMaterial({
        vertexShader: SURFACE_VERTEX,
        fragmentShader: SURFACE_FRAGMENT,
        defines,
        uniforms: {
            ...shared,
            base: { value: new Color(color) },
            opacity: { value: opacity },
            rim: { value: rim },
            picked: { value: -1 },
            inner: { value: INNER }, // brightness of inner sides
            pattern: { value: 0 },
            grid: { value: new Vector4(0, 0, 0, 1) }, // origin, and cells in a unit
        },
        side: FrontSide,
    });
    setOpacity(material, opacity);
    return material;
}

/** Half transparent surfaces do not write depth, so that they hide nothing behind them. */
export function setOpacity(material, opacity) {
    const solid = opacity > 0.995;
    material.uniforms.opacity.value = opacity;
    material.transparent = !solid;
    material.depthWrite = solid;
    material.visible = opacity > 0.005;
}

/** Which sides of faces are drawn; inner sides are darker beside outer ones. */
export function setSides(material, outer, inner) {
    material.uniforms.inner.value = outer ? INNER : 1;
    material.side = !inner ? FrontSide : outer ? DoubleSide : BackSide;
    material.needsUpdate = true;
}

const POINT_VERTEX = `
attribute vec3 color, away, source;
attribute float size;
uniform float pixels, explode;
uniform vec4 cut;
varying vec3 tint;
varying float large, kept;
void main() {
    tint = color;
    large = size * pixels;
    vec3 p = position + explode * away;
    kept = dot(source + explode * away, cut.xyz) > cut.w ? 0.35 : 1.0;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(p, 1.0);
    gl_PointSize = large;
}`;

const POINT_FRAGMENT = `
uniform vec3 edge;
varying vec3 tint;
varying float large, kept;
void main() {
    float r = length(gl_PointCoord - 0.5) * large;
    float outer = 0.5 * large - 0.5, inner = outer - max(0.16 * large, 1.5);
    float a = 1.0 - smoothstep(outer - 0.75, outer + 0.5, r);
    if (a <= 0.0) discard;
    gl_FragColor = vec4(mix(tint, edge, smoothstep(inner - 0.75, inner + 0.75, r)), a * kept);
}`;

/** Discs with a size in pixels that nothing hides; pale where they are cut off. */
export function pointMaterial() {
    return new ShaderMaterial({
        vertexShader: POINT_VERTEX,
        fragmentShader: POINT_FRAGMENT,
        uniforms: { ...shared, edge: { value: new Color("#ffffff") } },
        transparent: true,
        depthTest: false,
        depthWrite: false,
    });
}
