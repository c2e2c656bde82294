/* SPDX-License-Identifier: Apache-2.0 */
/* Vases, busts, bearings, tables and tools (spanners), y up.
 *
 * Problem: classes of things that differ within the class, in proportions and genus, unlike poses
 * of one figure. Each random number is a proportion; what changes the genus (handles, holes,
 * stretchers) goes round with the member's number, so that every family has all of it. */
#include "sample/solids.h"

#include "core/rng.h"
#include "geometry/vec3.h"

static const double TURN = 6.28318530717958648;

enum { RNG_STAGE = 0x77617265 /* "ware" */, CURVE_STEPS = 6 };

/* ---- parts ---- */

static double between(starg_rng *rng, double least, double most) {
    return least + (most - least) * starg_rng_unit(rng);
}

static implicit_part *add(ware *w, const implicit_part *part) {
    implicit_part *added = &w->field.parts[w->field.count++];
    *added = *part;
    implicit_prepare(added);
    return added;
}

static void add_cone(ware *w, const double a[3], double ra, const double b[3], double rb,
                     double blend) {
    implicit_part part = {.ra = ra, .rb = rb, .blend = blend};
    vec3_copy(a, part.a);
    vec3_copy(b, part.b);
    add(w, &part);
}

static implicit_outline *new_outline(ware *w) {
    return &w->outlines[w->outline_count++];
}

static void add_point(implicit_outline *o, double x, double y) {
    o->points[o->count][0] = x;
    o->points[o->count++][1] = y;
}

/* Revolves an outline about the upright through a. */
static void revolve(ware *w, const implicit_outline *o, const double a[3], double round,
                    double thickness, double blend) {
    implicit_part part = {
        .ra = round, .rb = thickness, .blend = blend, .outline = o, .b = {a[0], a[1] + 1, a[2]}};
    vec3_copy(a, part.a);
    add(w, &part);
}

/* Of edges, where the solid is that thick; less would come out jagged at a few thousand vertices.
 */
static double rounding(double thickness) {
    return fmin(0.08, 0.4 * thickness);
}

/* An upright cylinder around (x, z). */
static void cylinder(ware *w, double x, double z, double radius, double low, double high,
                     bool carve) {
    implicit_outline *o = new_outline(w);
    double round = carve ? 0.01 : rounding(fmin(radius, high - low)), a[3] = {x, 0, z};
    add_point(o, -1, low + round);
    add_point(o, radius - round, low + round);
    add_point(o, radius - round, high - round);
    add_point(o, -1, high - round);
    revolve(w, o, a, round, fmin(radius, high - low), 0.04);
    w->field.parts[w->field.count - 1].carve = carve;
}

/* A block around `center`, with half sides along x, y and z, turned about y. */
static void block(ware *w, const double center[3], double x, double y, double z, double turn,
                  bool carve) {
    implicit_outline *o = new_outline(w);
    double round = carve ? 0.01 : rounding(2 * fmin(x, fmin(y, z)));
    o->extruded = true;
    add_point(o, round - x, round - z);
    add_point(o, x - round, round - z);
    add_point(o, x - round, z - round);
    add_point(o, round - x, z - round);
    implicit_part part = {.ra = round,
                          .rb = 2 * fmin(x, fmin(y, z)),
                          .blend = 0.04,
                          .flat = {cos(turn), 0, sin(turn)},
                          .outline = o,
                          .carve = carve};
    vec3_copy(center, part.a);
    vec3_copy(center, part.b);
    part.a[1] -= y - round;
    part.b[1] += y - round;
    add(w, &part);
}

/* ---- vases ---- */

/* Radii at heights; between them the curve is level at both ends. */
typedef struct curve {
    double heights[4], radii[4];
} curve;

static double curve_at(const curve *c, double height) {
    int i = 0;
    while (i < 2 && height > c->heights[i + 1])
        i++;
    double t = (height - c->heights[i]) / (c->heights[i + 1] - c->heights[i]);
    t = fmax(0, fmin(1, t));
    return c->radii[i] + (c->radii[i + 1] - c->radii[i]) * 0.5 * (1 - cos(0.5 * TURN * t));
}

/* Around a wall along the curve, and a floor. */
static void add_vessel(ware *w, const curve *c, double wall) {
    implicit_outline *o = new_outline(w);
    int steps = 3 * CURVE_STEPS;
    double top = c->heights[3], floor = 1.5 * wall, round = rounding(wall);
    add_point(o, -1, 0);
    for (int i = 0; i <= steps; i++)
        add_point(o, curve_at(c, top * i / steps), top * i / steps);
    for (int i = steps; i >= 0; i--) {
        double y = floor + (top - floor) * i / steps;
        add_point(o, curve_at(c, y) - wall, y);
    }
    add_point(o, -1, floor);
    revolve(w, o, (const double[3]){0, 0, 0}, round, wall, 0.05);
}

/* A bow in the plane at `angle` from the wall at one height to that at another. */
static void add_handle(ware *w, const curve *c, double low, double high, double wall, double angle,
                       double out, double radius) {
    double last[3];
    for (int i = 0; i <= CURVE_STEPS; i++) {
        double t = (double)i / CURVE_STEPS,
               y = low + (high - low) * 0.5 * (1 - cos(0.5 * TURN * t));
        double start = curve_at(c, low), end = curve_at(c, high);
        double r = start + (end - start) * t - 0.5 * wall + out * sin(0.5 * TURN * t);
        double p[3] = {r * cos(angle), y, r * sin(angle)};
        if (i > 0)
            add_cone(w, last, radius, p, radius, 0.05);
        vec3_copy(p, last);
    }
}

static void build_vase(int member, starg_rng *rng, ware *w) {
    double height = between(rng, 1.6, 3), belly = between(rng, 0.7, 1.1), wall = 0.1;
    curve c = {
        .heights = {0, height * between(rng, 0.3, 0.55), height * between(rng, 0.75, 0.85), height},
        .radii = {belly * between(rng, 0.5, 0.8), belly, belly * between(rng, 0.5, 0.75), 0}};
    c.radii[3] = c.radii[2] * between(rng, 1, 1.5);
    add_vessel(w, &c, wall);
    double out = belly * between(rng, 0.45, 0.7), radius = between(rng, 0.1, 0.14);
    w->genus = member % 3;
    for (int i = 0; i < w->genus; i++)
        add_handle(w, &c, c.heights[1], c.heights[2], wall, 0.5 * TURN * i, out, radius);
}

/* ---- busts ---- */

static void build_bust(int member, starg_rng *rng, ware *w) {
    double foot = between(rng, 0.45, 0.75), plinth = between(rng, 0.25, 0.6);
    double broad = between(rng, 0.45, 0.75), thick = between(rng, 0.2, 0.3),
           drop = between(rng, 0.05, 0.2), neck = between(rng, 0.24, 0.36);
    double head = between(rng, 0.42, 0.55), lean = between(rng, -0.1, 0.2);
    double chest = plinth + between(rng, 0.35, 0.8), throat = chest + between(rng, 0.35, 0.6);
    double crown = throat + between(rng, 0.55, 0.8);
    cylinder(w, 0, 0, foot, 0, 0.5 * plinth, false);
    add_cone(w, (const double[3]){0, 0.2, 0}, 0.6 * foot, (const double[3]){0, plinth, 0},
             0.5 * foot, 0.1);
    for (int side = -1; side <= 1; side += 2) /* shoulders */
        add_cone(w, (const double[3]){0, chest, 0}, 0.42,
                 (const double[3]){0, chest - drop, side * broad}, thick, 0.25);
    add_cone(w, (const double[3]){0, plinth, 0}, 0.35, (const double[3]){0.05, chest, 0}, 0.5, 0.2);
    add_cone(w, (const double[3]){0, chest, 0}, 1.3 * neck, (const double[3]){lean, throat, 0},
             neck, 0.2);
    add_cone(w, (const double[3]){lean + 0.03, throat + 0.25, 0}, 0.75 * head,
             (const double[3]){lean, crown, 0}, head, 0.15);
    add_cone(w, (const double[3]){lean + 0.25, throat + 0.15, 0}, 0.2,
             (const double[3]){lean + 0.3, throat + 0.2, 0}, 0.18, 0.15); /* chin */
    add_cone(w, (const double[3]){lean + 0.9 * head, crown, 0}, 0.06,
             (const double[3]){lean + 1.1 * head, crown - 0.18, 0}, 0.09, 0.06); /* nose */
    if (member % 2 == 1)                                                         /* a bun */
        add_cone(w, (const double[3]){lean - head, crown, 0}, 0.2,
                 (const double[3]){lean - 1.2 * head, crown - 0.1, 0}, between(rng, 0.18, 0.3),
                 0.1);
    if (member % 3 == 1) /* a beard */
        add_cone(w, (const double[3]){lean + 0.3, throat + 0.1, 0}, 0.2,
                 (const double[3]){lean + 0.35, throat - between(rng, 0.1, 0.3), 0}, 0.1, 0.1);
}

/* ---- bearings ---- */

/* A boss with a bore, on a plate with two or four holes, or with a flange of three or five. */
static void build_bearing(int member, starg_rng *rng, ware *w) {
    double boss = between(rng, 0.55, 0.8), bore = boss * between(rng, 0.45, 0.7);
    double high = between(rng, 0.5, 1.2), thin = between(rng, 0.15, 0.3);
    double hole = between(rng, 0.14, 0.2), far = boss + hole + between(rng, 0.25, 0.7);
    int holes = (const int[]){2, 4, 3, 5}[member % 4];
    if (member % 4 < 2)
        block(w, (const double[3]){0, 0.5 * thin, 0}, far + hole + 0.15, 0.5 * thin,
              boss * between(rng, 1, 1.2), 0, false);
    else
        cylinder(w, 0, 0, far + hole + 0.15, 0, thin, false);
    cylinder(w, 0, 0, boss, 0, high, false);
    cylinder(w, 0, 0, bore, -1, high + 1, true);
    for (int i = 0; i < holes; i++) {
        double angle = TURN * i / holes, x = far * cos(angle), z = far * sin(angle);
        if (member % 4 == 1) {
            x = i & 1 ? far : -far;
            z = (i & 2 ? 1 : -1) * (0.8 * boss - hole);
        }
        cylinder(w, x, z, hole, -1, thin + high + 1, true);
    }
    w->genus = 1 + holes;
}

/* ---- tables ---- */

static void add_leg(ware *w, const double top[3], const double foot[3], double radius) {
    add_cone(w, top, radius, foot, 0.75 * radius, 0.05);
}

/* A round or square top on a pillar, or on legs with or without a shelf between them. */
static void build_table(int member, starg_rng *rng, ware *w) {
    bool round = member % 2 == 0, pillar = member % 5 == 4, shelf = member % 3 == 2 && !pillar;
    double x = between(rng, 0.7, 1.5), z = round ? x : between(rng, 0.5, 1),
           high = between(rng, 0.7, 1.4);
    double thin = between(rng, 0.07, 0.12), radius = between(rng, 0.06, 0.1);
    int legs = round ? 3 : 4;
    if (round)
        cylinder(w, 0, 0, x, high - thin, high + thin, false);
    else
        block(w, (const double[3]){0, high, 0}, x, thin, z, 0, false);
    if (pillar) {
        add_leg(w, (const double[3]){0, high + 0.5 * thin - 2 * radius, 0},
                (const double[3]){0, 0.1, 0}, 2 * radius);
        cylinder(w, 0, 0, 0.5 * x, 0, 0.14, false);
        return;
    }
    double spread = between(rng, 0.9, 1.15), inner = between(rng, 0.7, 0.85),
           level = between(rng, 0.25, 0.45);
    double corner = atan2(z, x), reach = inner * (round ? x : hypot(x, z));
    for (int i = 0; i < legs; i++) {
        double angle =
            round ? TURN * i / legs : (i % 2 == 0 ? corner : -corner) + (i < 2 ? 0 : 0.5 * TURN);
        double c = reach * cos(angle), s = reach * sin(angle);
        add_leg(w, (const double[3]){c, high + 0.5 * thin - radius, s},
                (const double[3]){spread * c, radius, spread * s}, radius);
    }
    if (!shelf)
        return;
    double part = inner * (1 + (spread - 1) * (1 - level));
    if (round)
        cylinder(w, 0, 0, part * x + 0.5 * radius, level * high - 0.06, level * high + 0.06, false);
    else
        block(w, (const double[3]){0, level * high, 0}, part * x, 0.06, part * z, 0, false);
    w->genus = legs - 1;
}

/* ---- spanners ---- */

/* A head at x with an open jaw that looks outwards, or a ring. */
static void add_head(ware *w, starg_rng *rng, double x, double radius, double thick, bool ring) {
    double gap = radius * between(rng, 0.4, 0.55), turn = between(rng, -0.3, 0.3),
           side = x < 0 ? -1 : 1;
    cylinder(w, x, 0, radius, -thick, thick, false);
    if (ring) {
        cylinder(w, x, 0, gap * 1.2, -1, 1, true);
        w->genus++;
    } else {
        double reach = radius * between(rng, 0.8, 1.1), along = side * (0.2 * radius + reach);
        block(w, (const double[3]){x + along * cos(turn), 0, along * sin(turn)}, reach, 1, gap,
              turn, true);
    }
}

static void build_tool(int member, starg_rng *rng, ware *w) {
    double half = between(rng, 1, 1.9), thick = between(rng, 0.1, 0.16),
           radius = between(rng, 0.32, 0.5);
    double broad = radius * between(rng, 0.35, 0.55);
    block(w, (const double[3]){0, 0, 0}, half, 0.8 * thick, broad, 0, false);
    add_head(w, rng, half + 0.5 * radius, radius, thick, member % 4 == 3);
    if (member % 4 != 0)
        add_head(w, rng, -half - 0.4 * radius, radius * between(rng, 0.75, 1), thick,
                 member % 2 == 1);
}

void ware_build(ware_kind kind, int member, ware *out) {
    typedef void build(int member, starg_rng *rng, ware *w);
    static build *const builds[] = {[WARE_VASE] = build_vase,
                                    [WARE_BUST] = build_bust,
                                    [WARE_BEARING] = build_bearing,
                                    [WARE_TABLE] = build_table,
                                    [WARE_TOOL] = build_tool};
    starg_rng rng = starg_rng_make(1, RNG_STAGE, (uint64_t)(WARE_MEMBERS * (int)kind + member));
    *out = (ware){0};
    builds[kind](member, &rng, out);
}
