/* SPDX-License-Identifier: Apache-2.0 */
/* Every command ends on tiny solids, within a budget of counted work, with a result or a reason:
 * boxes apart, in contact and nested, prisms, combs, polycubes, and faces that bound nothing. */
#include "support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "models.h"
#include "shapes.h"
#include "starguard/check.h"
#include "starguard/decompose.h"
#include "starguard/guard.h"
#include "starguard/kernel.h"
#include "starguard/repair.h"
#include "starguard/skeleton.h"
#include "starguard/space.h"
#include "starguard/verify.h"

enum {
    SOLIDS = 2000, /* in check-long */
    SAMPLE = 100,
    KINDS = 8,
    DEFAULT_EVERY = 35, /* solids: one of them is searched by the default budget */
    ASKED = 20000,      /* work, where a command takes a budget */
    CANDIDATES = 40,    /* the search counts, not these */
    MOST_WORK = 6000000 /* of one command */
};

/* ---- solids ---- */

static shape box(const double lower[3], const double upper[3]) {
    shape s = shape_cube(1);
    for (size_t i = 0; i < 3 * s.vertex_count; i++)
        s.vertices[i] = s.vertices[i] > 0 ? upper[i % 3] : lower[i % 3];
    return s;
}

/* A polygon (x, y) from z = 0 to 1, of which corner 0 sees the rest. */
static shape prism(const double *xy, uint32_t n) {
    shape s = {.vertex_count = 2 * n, .face_count = 4 * n - 4};
    s.vertices = malloc(6 * n * sizeof *s.vertices);
    s.faces = malloc(3 * s.face_count * sizeof *s.faces);
    uint32_t *f = s.faces;
    for (uint32_t i = 0; i < 2 * n; i++) {
        s.vertices[3 * i] = xy[2 * (i % n)];
        s.vertices[3 * i + 1] = xy[2 * (i % n) + 1];
        s.vertices[3 * i + 2] = i >= n;
    }
    for (uint32_t i = 0; i < n; i++, f += 6) {
        const uint32_t j = (i + 1) % n, side[6] = {i, j, n + j, i, n + j, n + i};
        memcpy(f, side, sizeof side);
    }
    for (uint32_t i = 1; i + 1 < n; i++, f += 6) {
        const uint32_t ends[6] = {0, i + 1, i, n, n + i, n + i + 1};
        memcpy(f, ends, sizeof ends);
    }
    return s;
}

static shape random_prism(starg_rng *rng) {
    double xy[20];
    uint32_t n = 3 + (uint32_t)starg_rng_below(rng, 8);
    for (uint32_t i = 0; i < n; i++) { /* a fan about corner 0 */
        double turn = 3 * (double)i / n, radius = i == 0 ? 0 : 0.3 + starg_rng_unit(rng);
        xy[2 * i] = radius * cos(turn);
        xy[2 * i + 1] = radius * sin(turn);
    }
    return prism(xy, n);
}

/* Boxes on a grid: apart, or in contact at corners, edges or faces. */
static shape boxes(starg_rng *rng, double pitch) {
    shape all = {0};
    const double nowhere[3] = {0, 0, 0};
    size_t count = 1 + starg_rng_below(rng, 5);
    for (size_t i = 0; i < count; i++) {
        double lower[3], upper[3];
        for (int k = 0; k < 3; k++) {
            lower[k] = pitch * (double)starg_rng_below(rng, 3);
            upper[k] = lower[k] + 1;
        }
        shape next = box(lower, upper);
        shape_append(&all, &next, nowhere, (int)starg_rng_below(rng, 2));
        shape_free(&next);
    }
    return all;
}

static shape nested(starg_rng *rng) {
    shape all = {0};
    const double nowhere[3] = {0, 0, 0};
    size_t count = 2 + starg_rng_below(rng, 3);
    for (size_t i = 0; i < count; i++) {
        const double a = (double)i, b = 10 - (double)i;
        shape next = box((const double[]){a, a, a}, (const double[]){b, b, b});
        shape_append(&all, &next, nowhere, (int)starg_rng_below(rng, 2));
        shape_free(&next);
    }
    return all;
}

static shape polycube(starg_rng *rng) {
    char cells[28] = "...........................";
    int at = 13;
    for (uint64_t left = 1 + starg_rng_below(rng, 7); left > 0; left--) {
        static const int STEP[3] = {1, 3, 9};
        cells[at] = '#';
        int k = (int)starg_rng_below(rng, 3), place = at / STEP[k] % 3;
        int next = place == 0 ? 1 : place == 2 ? -1 : starg_rng_below(rng, 2) ? 1 : -1;
        at += next * STEP[k];
    }
    return shape_cells(cells, 3, 3, 3);
}

static shape comb(starg_rng *rng) {
    char cells[22] = ".....................";
    int length = 3 + (int)starg_rng_below(rng, 5), teeth = 1 + (int)starg_rng_below(rng, 2);
    for (int x = 0; x < length; x++)
        for (int y = 0; y < 3; y++)
            cells[x + length * y] = y == 0 || (x % 2 == 0 && y <= teeth) ? '#' : '.';
    return shape_cells(cells, length, 3, 1);
}

/* Any triangles on a few points. */
static shape rubble(starg_rng *rng) {
    shape s = {.vertex_count = 3 + starg_rng_below(rng, 6),
               .face_count = 1 + starg_rng_below(rng, 12)};
    s.vertices = malloc(3 * s.vertex_count * sizeof *s.vertices);
    s.faces = malloc(3 * s.face_count * sizeof *s.faces);
    for (size_t i = 0; i < 3 * s.vertex_count; i++)
        s.vertices[i] = (double)starg_rng_below(rng, 4);
    for (size_t i = 0; i < 3 * s.face_count; i++)
        s.faces[i] = (uint32_t)starg_rng_below(rng, s.vertex_count);
    return s;
}

static shape tiny(size_t number, starg_rng *rng) {
    switch (number % KINDS) {
    case 0:
        return boxes(rng, 2);
    case 1:
        return boxes(rng, 1);
    case 2:
        return boxes(rng, 0.75);
    case 3:
        return nested(rng);
    case 4:
        return random_prism(rng);
    case 5:
        return polycube(rng);
    case 6:
        return comb(rng);
    default:
        return rubble(rng);
    }
}

/* ---- commands ---- */

typedef struct run {
    starg_context *context;
    size_t number;
    uint64_t before; /* work */
} run;

/* A call has ended: within the budget, and with a reason if without a result. */
static void ended(run *r, const char *what, starg_status status) {
    uint64_t work = starg_context_work(r->context) - r->before;
    const char *reason = starg_context_error(r->context)->message;
    if (work > MOST_WORK || (status != STARG_OK && reason[0] == '\0'))
        fail_msg("solid %zu, %s: work %llu, status %d, '%s'", r->number, what,
                 (unsigned long long)work, (int)status, reason);
    r->before = starg_context_work(r->context);
}

static void verify(run *r, const starg_mesh *mesh, const starg_guards *guards) {
    starg_verdict *verdict;
    starg_status status = starg_verify_guards(r->context, mesh, guards, &verdict);
    ended(r, "verify", status);
    if (status == STARG_OK && !verdict->passed)
        fail_msg("solid %zu: the guards are refused", r->number);
    starg_verdict_free(r->context, verdict);
}

static void place_guards(run *r, const starg_mesh *mesh, const starg_solid *solid,
                         const starg_guard_options *options, const char *what) {
    starg_guards *guards;
    starg_status status = starg_guard(r->context, solid, options, &guards);
    ended(r, what, status);
    if (status == STARG_OK)
        verify(r, mesh, guards);
    starg_guards_free(r->context, guards);
}

/* By turns: each kind of solid meets each of them. */
static void guard_some(run *r, const starg_mesh *mesh, const starg_solid *solid) {
    starg_guard_options options;
    starg_guard_options_default(&options);
    options.candidate_count = CANDIDATES;
    if (r->number % DEFAULT_EVERY != 0)
        options.refine_lines = ASKED;
    options.prove_work = ASKED;
    options.prove = r->number / KINDS % 4 > 0;
    options.max_guards = r->number / KINDS % 4 == 2;
    options.redundancy = r->number / KINDS % 4 == 3 ? 2 : 1;
    char what[64];
    snprintf(what, sizeof what, "guard%s%s%s", options.prove ? " --prove" : "",
             options.max_guards ? " --max-guards 1" : "",
             options.redundancy > 1 ? " --redundancy 2" : "");
    place_guards(r, mesh, solid, &options, what);
}

static void cut_all(run *r, const starg_solid *solid) {
    starg_decompose_options options;
    starg_decomposition *pieces;
    starg_decompose_options_default(&options);
    starg_status status = starg_decompose(r->context, solid, &options, &pieces);
    ended(r, "decompose", status);
    if (status == STARG_OK && pieces->strictly_star != pieces->piece_count)
        fail_msg("solid %zu: pieces that are not star-shaped", r->number);
    if (status == STARG_OK && pieces->lower_bound > pieces->piece_count)
        fail_msg("solid %zu: fewer pieces than the bound", r->number);
    starg_decomposition_free(r->context, pieces);
    if (r->number / KINDS % 4 != 1)
        return;
    options.prove = true;
    options.prove_work = ASKED;
    options.effort = 16;
    ended(r, "decompose --prove", starg_decompose(r->context, solid, &options, &pieces));
    starg_decomposition_free(r->context, pieces);
}

static void look_from_outside(run *r, const starg_mesh *mesh) {
    starg_space_options space;
    starg_solid *outside;
    uint8_t *states;
    starg_space_options_default(&space);
    space.outside = true;
    starg_status status = starg_space_create(r->context, mesh, NULL, 0, &space, &outside);
    ended(r, "outside", status);
    if (status != STARG_OK)
        return;
    ended(r, "visible --unseen", starg_unseen(r->context, outside, NULL, 0, ASKED, &states));
    starg_unseen_free(r->context, states);
    starg_solid_free(outside);
}

static void run_all(run *r, const starg_mesh *mesh) {
    starg_check *check;
    starg_mesh *repaired;
    starg_repair_report report;
    starg_kernel_result kernel;
    starg_solid *solid;
    starg_skeleton *skeleton;
    ended(r, "check", starg_mesh_check(r->context, mesh, &check));
    starg_check_free(r->context, check);
    ended(r, "repair", starg_mesh_repair(r->context, mesh, NULL, &repaired, &report));
    starg_mesh_free(repaired);
    ended(r, "kernel", starg_kernel(r->context, mesh, NULL, &kernel));
    look_from_outside(r, mesh);
    starg_status status = starg_solid_create(r->context, mesh, &solid);
    ended(r, "solid", status);
    if (status != STARG_OK)
        return;
    ended(r, "skeleton", starg_skeleton_create(r->context, solid, NULL, &skeleton));
    starg_skeleton_free(r->context, skeleton);
    guard_some(r, mesh, solid);
    cut_all(r, solid);
    starg_solid_free(solid);
}

static void test_commands_end(void **state) {
    (void)state;
    for (size_t i = 0; i < test_rounds(SAMPLE, SOLIDS); i++) {
        starg_rng rng = starg_rng_make(1, 2026, i);
        run r = {.context = test_context(1), .number = i};
        shape s = tiny(i, &rng);
        starg_mesh *mesh;
        test_ok(r.context, starg_mesh_create(r.context, s.vertices, s.vertex_count, s.faces,
                                             s.face_count, &mesh));
        run_all(&r, mesh);
        starg_mesh_free(mesh);
        shape_free(&s);
        test_context_free(r.context);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_commands_end)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
