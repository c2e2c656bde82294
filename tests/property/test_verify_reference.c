/* SPDX-License-Identifier: Apache-2.0 */
/* Both verifiers against slow ones. A result is made, true or with a random change; brute force in
 * rationals, sharing no code with the verifier, determines whether all its claims hold, and the
 * verdict must agree. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "cut.h"
#include "exact_oracle.h"
#include "models.h"
#include "starguard/verify.h"
#include "tetrahedra.h"
#include "visibility_oracle.h"

static const double TOLERANCE = 1e-9; /* as documented, of areas, volumes and fractions */

static bool close_to(double a, double b) {
    return fabs(a - b) <= TOLERANCE * fabs(b);
}

static bool verdict_of(starg_context *context, starg_verdict *verdict) {
    bool passed = verdict->passed;
    starg_verdict_free(context, verdict);
    return passed;
}

/* ---- guards: the truth ---- */

enum { GUARDS = 2, FACES = 400, VERTICES = 200 };

typedef struct result {
    starg_guards guards;
    double positions[3 * GUARDS];
    size_t seen[GUARDS];
    uint32_t uncovered[FACES + 1];
} result;

/* What the guards of a result see, from their positions and the options alone. */
typedef struct truth {
    bool inside;
    size_t seen[GUARDS], covered, needed; /* needed: guards needed to see what both see */
    bool face[FACES];
    double area, all_area;
} truth;

static bool is_inside(const shape *s, const double p[3]) {
    bool on_surface;
    return oracle_winding(s->vertices, s->faces, s->face_count, p, &on_surface) > 0 && !on_surface;
}

static double area_of(const shape *s, size_t face) {
    const uint32_t *f = s->faces + 3 * face;
    double sum = 0;
    for (size_t k = 0; k < 3; k++) {
        size_t u = (k + 1) % 3, v = (k + 2) % 3;
        const double *a = s->vertices + 3 * (size_t)f[0], *b = s->vertices + 3 * (size_t)f[1];
        const double *c = s->vertices + 3 * (size_t)f[2];
        sum = hypot(sum, (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]));
    }
    return sum / 2;
}

static bool in_range(const shape *s, size_t face, const double p[3], double range) {
    for (size_t i = 0; i < 3 && range < INFINITY; i++)
        if (oracle_compare_distance(p, s->vertices + 3 * (size_t)s->faces[3 * face + i], range) > 0)
            return false;
    return true;
}

static truth find_truth(const shape *s, const result *r) {
    truth t = {.inside = true, .needed = GUARDS};
    const starg_visibility_options *view = &r->guards.options.visibility;
    for (size_t i = 0; i < GUARDS; i++) {
        const double *p = r->positions + 3 * i;
        bool faces[FACES];
        t.inside = t.inside && is_inside(s, p);
        visibility_oracle_faces(s->vertices, s->vertex_count, s->faces, s->face_count, p,
                                view->face_rule == STARG_FACES_WHOLE, faces);
        for (size_t f = 0; f < s->face_count; f++) {
            bool seen = faces[f] && in_range(s, f, p, view->range);
            t.seen[i] += seen;
            t.face[f] = t.face[f] || seen;
        }
    }
    for (size_t f = 0; f < s->face_count; f++) {
        t.all_area += area_of(s, f);
        t.area += t.face[f] ? area_of(s, f) : 0;
        t.covered += t.face[f];
    }
    for (size_t i = 0; i < GUARDS; i++)
        t.needed = t.seen[i] == t.covered && t.needed > 1 ? 1 : t.needed;
    t.needed = t.covered == 0 ? 0 : t.needed;
    return t;
}

/* Writes the truth into a result. */
static void fill_in(const shape *s, result *r) {
    truth t = find_truth(s, r);
    starg_guards *g = &r->guards;
    memcpy(r->seen, t.seen, sizeof r->seen);
    g->uncovered_count = 0;
    for (uint32_t f = 0; f < s->face_count; f++)
        if (!t.face[f])
            r->uncovered[g->uncovered_count++] = f;
    g->coverable_faces = s->face_count;
    g->lower_bound = t.needed < 1 ? t.needed : 1;
    g->coverage_faces = (double)t.covered / (double)s->face_count;
    g->coverage_area = t.area / t.all_area;
}

static bool claims_hold(const shape *s, const result *r) {
    truth t = find_truth(s, r);
    const starg_guards *g = &r->guards;
    bool listed[FACES] = {false}, ascending = true;
    for (size_t i = 0; i < g->uncovered_count; i++) {
        if (r->uncovered[i] >= s->face_count)
            return false;
        ascending = ascending && (i == 0 || r->uncovered[i - 1] < r->uncovered[i]);
        listed[r->uncovered[i]] = true;
    }
    for (size_t f = 0; f < s->face_count; f++)
        if (listed[f] == t.face[f])
            return false;
    return t.inside && ascending && memcmp(r->seen, t.seen, sizeof r->seen) == 0 &&
           g->vertex_count == s->vertex_count && g->face_count == s->face_count &&
           g->coverable_faces == s->face_count &&
           close_to(g->coverage_faces, (double)t.covered / (double)s->face_count) &&
           close_to(g->coverage_area, t.area / t.all_area) && g->lower_bound <= t.needed &&
           g->optimal == (g->lower_bound == g->count);
}

/* ---- guards: results ---- */

static shape make_shape(starg_rng *rng) {
    switch (starg_rng_below(rng, 5)) {
    case 0:
        return shape_tetrahedron();
    case 1:
        return shape_cube(1);
    case 2:
        return shape_cells("#####.###", 3, 3, 1);
    case 3:
        return shape_blob((int)starg_rng_below(rng, 2), starg_rng_next(rng));
    default:
        return shape_cells("##.#", 2, 2, 1);
    }
}

/* Anywhere around the shape; often on its lattice, in planes of faces, or on it. */
static void pick_point(starg_rng *rng, const shape *s, double p[3]) {
    const double *v = s->vertices;
    const double *a = v + 3 * starg_rng_below(rng, s->vertex_count);
    const double *b = v + 3 * starg_rng_below(rng, s->vertex_count);
    const double *c = v + 3 * starg_rng_below(rng, s->vertex_count);
    double u = starg_rng_unit(rng), w = starg_rng_unit(rng) * (1 - u);
    uint64_t kind = starg_rng_below(rng, 3);
    for (int k = 0; k < 3; k++) {
        const double kinds[3] = {0.5 * a[k] + 0.5 * b[k], 0.25 * a[k] + 0.25 * b[k] + 0.5 * c[k],
                                 a[k] + u * (b[k] - a[k]) + w * (c[k] - a[k])};
        p[k] = kinds[kind];
    }
}

static void make_result(starg_rng *rng, const shape *s, result *r) {
    *r = (result){.guards = {.vertex_count = s->vertex_count,
                             .face_count = s->face_count,
                             .options = {.coverage = 1, .redundancy = 1, .max_guards = GUARDS},
                             .count = GUARDS,
                             .candidate_count = 100,
                             .lower_bound = 1,
                             .area_bound = 1}};
    starg_visibility_options_default(&r->guards.options.visibility);
    r->guards.options.visibility.face_rule = (starg_face_rule)starg_rng_below(rng, 2);
    if (starg_rng_below(rng, 3) == 0)
        r->guards.options.visibility.range = 1 + (double)starg_rng_below(rng, 4);
    r->guards.positions = r->positions;
    r->guards.seen_faces = r->seen;
    r->guards.uncovered = r->uncovered;
    for (size_t i = 0; i < GUARDS; i++)
        for (int attempt = 0;
             attempt == 0 || (attempt < 100 && !is_inside(s, r->positions + 3 * i)); attempt++)
            pick_point(rng, s, r->positions + 3 * i);
    fill_in(s, r);
}

static void change_list(starg_rng *rng, const shape *s, result *r) {
    starg_guards *g = &r->guards;
    uint64_t action = starg_rng_below(rng, 3);
    if (action == 0 && g->uncovered_count > 0)
        g->uncovered_count--;
    else if (action == 1 && g->uncovered_count < FACES)
        r->uncovered[g->uncovered_count++] = (uint32_t)starg_rng_below(rng, s->face_count + 1);
    else if (g->uncovered_count > 0)
        r->uncovered[starg_rng_below(rng, g->uncovered_count)] =
            (uint32_t)starg_rng_below(rng, s->face_count + 1);
}

static void change_guards(starg_rng *rng, const shape *s, result *r) {
    starg_guards *g = &r->guards;
    double *p = r->positions + 3 * starg_rng_below(rng, GUARDS);
    double *x = p + starg_rng_below(rng, 3);
    switch (starg_rng_below(rng, 9)) {
    case 0:
        r->seen[starg_rng_below(rng, GUARDS)] += starg_rng_below(rng, 2) ? 1 : SIZE_MAX;
        break;
    case 1:
        g->coverage_faces *= 1 + 1e-6;
        break;
    case 2:
        g->coverage_area *= 1 - 1e-6;
        break;
    case 3:
        change_list(rng, s, r);
        break;
    case 4: /* which may change what is visible, or not */
        pick_point(rng, s, p);
        break;
    case 5:
        *x = nextafter(*x, starg_rng_below(rng, 2) ? INFINITY : -INFINITY);
        break;
    case 6:
        g->lower_bound = starg_rng_below(rng, GUARDS + 2);
        break;
    case 7:
        g->optimal = !g->optimal;
        break;
    default:
        g->face_count += starg_rng_below(rng, 2);
    }
}

static void test_guards(void **state) {
    (void)state;
    size_t rounds = test_rounds(400, 60000), held = 0;
    starg_context *context = test_context(1);
    for (uint64_t round = 0; round < rounds; round++) {
        starg_rng rng = starg_rng_make(37, 0, round);
        shape s = make_shape(&rng);
        result r;
        starg_verdict *verdict = NULL;
        starg_mesh *mesh = test_mesh_of(context, &s);
        assert_true(s.face_count <= FACES && s.vertex_count <= VERTICES);
        make_result(&rng, &s, &r);
        for (uint64_t changes = starg_rng_below(&rng, 3); changes > 0; changes--)
            change_guards(&rng, &s, &r);
        bool expected = claims_hold(&s, &r);
        test_ok(context, starg_verify_guards(context, mesh, &r.guards, &verdict));
        if (verdict_of(context, verdict) != expected)
            fail_msg("guards, round %d: the claims %s", (int)round, expected ? "hold" : "fail");
        held += expected;
        starg_mesh_free(mesh);
        shape_free(&s);
    }
    assert_true(held > rounds / 5 && held < rounds - rounds / 5);
    test_context_free(context);
}

/* ---- pieces: the truth ---- */

static bool same_triangle(const uint32_t a[3], const uint32_t b[3]) {
    for (int i = 0; i < 3; i++)
        if (a[i] != b[0] && a[i] != b[1] && a[i] != b[2])
            return false;
    return true;
}

/* The side of another tetrahedron (of the same piece) that coincides with a side, or none. */
static bool has_mate(const cut *c, size_t t, int side, bool within_piece) {
    uint32_t own[3], other[3];
    cut_side(c, t, side, own);
    for (size_t i = 0; i < 4 * c->mesh.count; i++) {
        cut_side(c, i / 4, (int)(i % 4), other);
        if (i / 4 != t && (!within_piece || c->labels[i / 4] == c->labels[t]) &&
            cut_opposite(own, other))
            return true;
    }
    return false;
}

/* Positive tetrahedra, at most two per triangle, on opposite sides. */
static bool is_conforming(const cut *c) {
    for (size_t t = 0; t < c->mesh.count; t++) {
        const uint32_t *v = c->tetrahedra + 4 * t;
        if (oracle_orient3d(cut_point(c, v[0]), cut_point(c, v[2]), cut_point(c, v[1]),
                            cut_point(c, v[3])) <= 0)
            return false;
    }
    for (size_t i = 0; i < 4 * c->mesh.count; i++) {
        uint32_t own[3], other[3];
        int shared = 0;
        cut_side(c, i / 4, (int)(i % 4), own);
        for (size_t j = 0; j < 4 * c->mesh.count; j++) {
            cut_side(c, j / 4, (int)(j % 4), other);
            if (i == j || !same_triangle(own, other))
                continue;
            shared++;
            if (!cut_opposite(own, other))
                return false;
        }
        if (shared > 1)
            return false;
    }
    return true;
}

/* Do two tetrahedra share a face? */
static bool are_neighbours(const cut *c, size_t s, size_t t) {
    uint32_t a[3], b[3];
    for (int i = 0; i < 16; i++) {
        cut_side(c, s, i / 4, a);
        cut_side(c, t, i % 4, b);
        if (cut_opposite(a, b))
            return true;
    }
    return false;
}

/* Propagates labels to unlabelled neighbours until none is left. */
static void spread_labels(const cut *c, int32_t *labels) {
    for (bool grew = true; grew;) {
        grew = false;
        for (size_t s = 0; s < c->mesh.count; s++)
            for (size_t t = 0; t < c->mesh.count && labels[s] >= 0; t++)
                if (labels[t] == -1 && are_neighbours(c, s, t)) {
                    labels[t] = labels[s];
                    grew = true;
                }
    }
}

static bool is_connected(const cut *c, int32_t piece) {
    enum { OTHER = -2 };
    int32_t reached[CUT_TETRAHEDRA];
    size_t first = c->mesh.count, size = 0, count = 0;
    for (size_t t = c->mesh.count; t-- > 0;) {
        bool own = c->labels[t] == piece;
        reached[t] = own ? -1 : OTHER;
        size += own;
        first = own ? t : first;
    }
    if (size == 0)
        return false;
    reached[first] = 0;
    spread_labels(c, reached);
    for (size_t t = 0; t < c->mesh.count; t++)
        count += reached[t] == 0;
    return count == size;
}

/* The walls of a piece, or of all (piece < 0). */
static size_t find_walls(const cut *c, int32_t piece, uint32_t *walls) {
    size_t count = 0;
    for (size_t t = 0; t < c->mesh.count; t++)
        for (int side = 0; side < 4; side++)
            if ((piece < 0 || c->labels[t] == piece) && !has_mate(c, t, side, piece >= 0))
                cut_side(c, t, side, walls + 3 * count++);
    return count;
}

static bool is_star(const cut *c, int32_t piece) {
    static uint32_t walls[12 * CUT_TETRAHEDRA];
    size_t count = find_walls(c, piece, walls);
    const double *g = c->pieces[piece].guard;
    bool on;
    for (size_t f = 0; f < count; f++)
        if (oracle_orient3d(cut_point(c, walls[3 * f]), cut_point(c, walls[3 * f + 1]),
                            cut_point(c, walls[3 * f + 2]), g) <= 0)
            return false;
    return oracle_winding(c->vertices, walls, count, g, &on) == 1;
}

/* The fraction of vertices that guards see past the outer boundary. */
static double find_visible(const cut *c) {
    static uint32_t walls[12 * CUT_TETRAHEDRA];
    size_t count = find_walls(c, -1, walls), all = 0, seen = 0;
    for (int32_t piece = 0; piece < (int32_t)c->report.piece_count; piece++) {
        bool used[CUT_VERTICES] = {false}, on;
        const double *g = c->pieces[piece].guard;
        bool inside = oracle_winding(c->vertices, walls, count, g, &on) > 0 && !on;
        for (size_t i = 0; i < 4 * c->mesh.count; i++)
            used[c->tetrahedra[i]] |= c->labels[i / 4] == piece;
        for (uint32_t v = 0; v < c->mesh.vertex_count; v++) {
            bool free = inside;
            for (size_t f = 0; f < count && used[v] && free; f++)
                free = !oracle_segment_meets_triangle(
                    g, cut_point(c, v), cut_point(c, walls[3 * f]), cut_point(c, walls[3 * f + 1]),
                    cut_point(c, walls[3 * f + 2]));
            all += used[v];
            seen += used[v] && free;
        }
    }
    return (double)seen / (double)all;
}

/* Sizes, volumes and contacts, recounted. */
static bool numbers_hold(const cut *c) {
    cut *counted = cut_copy(c);
    cut_recount(counted);
    const starg_pieces_report *own = &c->report, *found = &counted->report;
    bool hold = own->tetrahedra == c->mesh.count && own->contact_count == found->contact_count;
    for (size_t p = 0; p < own->piece_count; p++)
        hold = hold && own->pieces[p].tetrahedra == found->pieces[p].tetrahedra &&
               close_to(own->pieces[p].volume, found->pieces[p].volume);
    for (size_t i = 0; i < own->contact_count && hold; i++) {
        bool listed = false;
        for (size_t j = 0; j < found->contact_count; j++)
            listed = listed || (own->contacts[i].first == found->contacts[j].first &&
                                own->contacts[i].second == found->contacts[j].second &&
                                close_to(own->contacts[i].area, found->contacts[j].area));
        hold = hold && listed;
    }
    free(counted);
    return hold;
}

/* All claims of a decomposition of these tetrahedra, with their boundary as the model. */
static bool decomposition_holds(const cut *c) {
    size_t stars = 0;
    if (!is_conforming(c) || !numbers_hold(c))
        return false;
    for (int32_t p = 0; p < (int32_t)c->report.piece_count; p++) {
        bool star = is_connected(c, p) && is_star(c, p);
        if (!is_connected(c, p) || c->pieces[p].star != star)
            return false;
        stars += star;
    }
    return c->report.strictly_star == stars &&
           (c->report.mode == STARG_DECOMPOSE_PAPER || stars == c->report.piece_count) &&
           fabs(c->report.visible_vertices - find_visible(c)) <= TOLERANCE;
}

/* ---- pieces: decompositions ---- */

/* Labels grown from some tetrahedra; unreached ones get new labels. */
static void grow_labels(starg_rng *rng, cut *c) {
    size_t pieces = 1 + starg_rng_below(rng, 4);
    for (size_t t = 0; t < c->mesh.count; t++)
        c->labels[t] = -1;
    for (size_t p = 0; p < pieces; p++) {
        int32_t *label = &c->labels[starg_rng_below(rng, c->mesh.count)];
        if (*label < 0)
            *label = (int32_t)c->report.piece_count++;
    }
    for (size_t t = 0; t < c->mesh.count; t++) {
        spread_labels(c, c->labels);
        if (c->labels[t] < 0 && c->report.piece_count < CUT_PIECES)
            c->labels[t] = (int32_t)c->report.piece_count++;
        else if (c->labels[t] < 0)
            c->labels[t] = CUT_PIECES - 1;
    }
}

/* In a tetrahedron of the piece, at one of its vertices or the midpoint of two; in another
 * tetrahedron if the piece is empty. */
static void place_guard(starg_rng *rng, cut *c, int32_t piece) {
    double *g = c->pieces[piece].guard;
    size_t t = starg_rng_below(rng, c->mesh.count);
    for (int attempt = 0; attempt < 1000 && c->labels[t] != piece; attempt++)
        t = starg_rng_below(rng, c->mesh.count);
    const uint32_t *v = c->tetrahedra + 4 * t;
    uint64_t kind = starg_rng_below(rng, 6);
    for (int k = 0; k < 3; k++) {
        double a = cut_point(c, v[0])[k], b = cut_point(c, v[1])[k];
        double d = cut_point(c, v[2])[k], e = cut_point(c, v[3])[k];
        g[k] = kind == 0 ? 0.5 * (a + b) : kind == 1 ? a : 0.25 * (a + b + d + e);
    }
}

static cut *make_cut(starg_rng *rng, const starg_tetmesh *mesh) {
    cut *c = cut_new(&(grid){"", {0, 0, 0}});
    size_t n = starg_tetmesh_vertex_count(mesh);
    c->mesh.vertex_count = n;
    c->mesh.count = starg_tetmesh_count(mesh);
    memcpy(c->vertices, starg_tetmesh_vertices(mesh), 24 * n);
    memcpy(c->tetrahedra, starg_tetmesh_tetrahedra(mesh), 16 * c->mesh.count);
    grow_labels(rng, c);
    cut_recount(c);
    c->report.mode = STARG_DECOMPOSE_PAPER;
    for (int32_t p = 0; p < (int32_t)c->report.piece_count; p++) {
        place_guard(rng, c, p);
        c->pieces[p].star = is_star(c, p);
        c->report.strictly_star += c->pieces[p].star;
    }
    c->report.visible_vertices = find_visible(c);
    return c;
}

static void change_cut(starg_rng *rng, cut *c) {
    size_t p = starg_rng_below(rng, c->report.piece_count);
    size_t t = starg_rng_below(rng, c->mesh.count);
    uint32_t *v = c->tetrahedra + 4 * t, first = v[0];
    double *x = c->pieces[p].guard + starg_rng_below(rng, 3);
    switch (starg_rng_below(rng, 11)) {
    case 0:
        c->pieces[p].star = !c->pieces[p].star;
        break;
    case 1:
        c->report.strictly_star += starg_rng_below(rng, 2) ? 1 : SIZE_MAX;
        break;
    case 2:
        place_guard(rng, c, (int32_t)p);
        break;
    case 3:
        *x = nextafter(*x, starg_rng_below(rng, 2) ? INFINITY : -INFINITY);
        break;
    case 4:
        c->report.visible_vertices -= 1e-3;
        break;
    case 5:
    case 6: /* often leaves a disconnected piece, or an empty one */
        c->labels[t] = (int32_t)p;
        cut_recount(c);
        break;
    case 7:
        c->pieces[p].volume *= 1 + 1e-6;
        break;
    case 8:
        if (c->report.contact_count > 0)
            c->report.contact_count--;
        break;
    case 9:
        v[0] = v[1];
        v[1] = first;
        break;
    default:
        c->report.mode = STARG_DECOMPOSE_STRICT;
    }
}

static void test_pieces(void **state) {
    (void)state;
    size_t rounds = test_rounds(160, 10000), held = 0;
    starg_context *context = test_context(1);
    for (uint64_t round = 0; round < rounds; round++) {
        starg_rng rng = starg_rng_make(41, 0, round);
        starg_tetmesh *mesh =
            random_tetmesh(context, round, 8 + starg_rng_below(&rng, 5), round % 2 == 0, 1);
        cut *c = make_cut(&rng, mesh);
        starg_verdict *verdict = NULL;
        for (uint64_t changes = starg_rng_below(&rng, 3); changes > 0; changes--)
            change_cut(&rng, c);
        bool expected = decomposition_holds(c);
        test_ok(context,
                starg_verify_pieces_of_tetmesh(context, mesh, &c->mesh, &c->report, &verdict));
        for (size_t i = 0; i < verdict->count && verdict->passed != expected; i++)
            print_error("%d %s\n", verdict->claims[i].holds, verdict->claims[i].text);
        if (verdict_of(context, verdict) != expected)
            fail_msg("pieces, round %d: the claims %s", (int)round, expected ? "hold" : "fail");
        held += expected;
        free(c);
        starg_tetmesh_free(mesh);
    }
    assert_true(held > rounds / 5 && held < rounds - rounds / 5);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_guards),
                                       cmocka_unit_test(test_pieces)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
