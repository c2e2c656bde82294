/* SPDX-License-Identifier: Apache-2.0 */
/* Solids whose shells touch in corners, edges and faces, against counted cells.
 *
 * Polycubes: cells of a small grid are solid or not, at random. Where two solid cells meet in an
 * edge only, or two empty ones, the four faces there are joined in pairs, either way at random, so
 * that parts of the solid, and hollows, have shells of their own that touch. Nested boxes: each
 * lies within each earlier one or beside it, where it may touch it in edges and corners, of which
 * those of the other have no vertices, and for what is inside also parts of faces. Shells face
 * either way, at random; the solid is where the number of shells around is odd, which the cells
 * tell. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "boxes.h"
#include "core/bits.h"
#include "core/rng.h"
#include "mesh/solid.h"
#include "models.h"
#include "starguard/decompose.h"
#include "starguard/guard.h"
#include "starguard/tetra.h"
#include "starguard/verify.h"
#include "verify/surface.h"
#include "visibility/box.h"
#include "visibility_oracle.h"

enum { SIDE = 6, WIDE = SIDE + 2, CELLS = WIDE * WIDE * WIDE, FACES = 24 * SIDE * SIDE * SIDE };

typedef struct model {
    bool solid[CELLS]; /* with a border of empty cells */
    size_t count;      /* of solid cells */
    double slant[3];   /* shears, which keep volumes */
    shape s;
} model;

static const int STEP[3] = {1, WIDE, WIDE *WIDE};

static void free_model(model *m) {
    shape_free(&m->s);
    free(m);
}

static void place_at(const model *m, const double at[3], double out[3]) {
    out[0] = at[0] + m->slant[0] * at[1];
    out[1] = at[1] + m->slant[1] * at[2];
    out[2] = at[2] + m->slant[2] * out[0];
}

static void corner_of(const model *m, int cell, double out[3]) {
    const double at[3] = {cell % WIDE, cell / WIDE % WIDE, cell / WIDE / WIDE};
    place_at(m, at, out);
}

static void centre_of(const model *m, int cell, double out[3]) {
    const double at[3] = {cell % WIDE + 0.5, cell / WIDE % WIDE + 0.5, cell / WIDE / WIDE + 0.5};
    place_at(m, at, out);
}

/* ---- polycubes ---- */

/* A side of a solid cell: its corners, counter-clockwise from outside. */
typedef struct side {
    int solid, empty, corner[4];
} side;

typedef struct builder {
    model *m;
    side sides[FACES / 2];
    size_t side_count;
    uint32_t faces[3 * FACES], pair[3 * FACES]; /* grid corners; halfedges across edges */
    int of_solid[FACES], of_empty[FACES];
    size_t face_count;
} builder;

static uint32_t next_of(uint32_t h) {
    return h % 3 == 2 ? h - 2 : h + 1;
}

static uint32_t root_of(const uint32_t *parent, uint32_t i) {
    while (parent[i] != i)
        i = parent[i];
    return i;
}

static void join(uint32_t *parent, uint32_t a, uint32_t b) {
    a = root_of(parent, a);
    b = root_of(parent, b);
    parent[a < b ? b : a] = a < b ? a : b;
}

static void list_sides(builder *b) {
    for (int cell = 0; cell < CELLS; cell++)
        for (int k = 0; k < 6 && b->m->solid[cell]; k++) {
            int own = STEP[k % 3], u = STEP[(k + 1) % 3], v = STEP[(k + 2) % 3];
            int other = k < 3 ? cell + own : cell - own, first = k < 3 ? other : cell;
            side s = {cell, other, {first, first + u, first + u + v, first + v}};
            if (k >= 3) {
                s.corner[1] = first + v;
                s.corner[3] = first + u;
            }
            if (!b->m->solid[other])
                b->sides[b->side_count++] = s;
        }
}

static void add_face(builder *b, const side *s, int i, int j, int k) {
    uint32_t *f = b->faces + 3 * b->face_count;
    f[0] = (uint32_t)s->corner[i % 4];
    f[1] = (uint32_t)s->corner[j % 4];
    f[2] = (uint32_t)s->corner[k % 4];
    b->of_solid[b->face_count] = s->solid;
    b->of_empty[b->face_count++] = s->empty;
}

static void split_sides(builder *b, starg_rng *rng) {
    for (size_t i = b->side_count; i > 0; i--) { /* in any order */
        size_t other = starg_rng_below(rng, i);
        side s = b->sides[other];
        b->sides[other] = b->sides[i - 1];
        int first = (int)starg_rng_below(rng, 4);
        add_face(b, &s, first, first + 1, first + 2);
        add_face(b, &s, first + 2, first + 3, first);
    }
}

/* Where four faces meet at an edge, those of the same solid cell belong together, or those of the
 * same empty one; false where one face across the edge is not like the other. */
static bool pair_faces(builder *b, starg_rng *rng) {
    uint64_t seed = starg_rng_below(rng, 1 << 30);
    uint64_t kind = starg_rng_below(rng, 3); /* all solid, all empty, or edge by edge */
    for (uint32_t h = 0; h < 3 * b->face_count; h++) {
        uint32_t found = UINT32_MAX, from = b->faces[h], to = b->faces[next_of(h)];
        uint32_t low = from < to ? from : to, step = from < to ? to - from : from - to;
        low -= low / step % WIDE % 2 == 0 ? step : 0; /* both halves of a coarse edge alike */
        starg_rng edge = starg_rng_make(seed, low, step);
        bool by_solid = kind == 0 || (kind == 2 && starg_rng_below(&edge, 2));
        size_t count = 0;
        for (uint32_t g = 0; g < 3 * b->face_count; g++) {
            if (b->faces[g] != to || b->faces[next_of(g)] != from)
                continue;
            bool alike = by_solid ? b->of_solid[g / 3] == b->of_solid[h / 3]
                                  : b->of_empty[g / 3] == b->of_empty[h / 3];
            found = count == 0 || alike ? g : found;
            count++;
        }
        b->pair[h] = found;
    }
    for (uint32_t h = 0; h < 3 * b->face_count; h++)
        if (b->pair[h] == UINT32_MAX || b->pair[b->pair[h]] != h)
            return false;
    return true;
}

/* Turns some of the shells inside out. */
static void turn_shells(shape *s, const uint32_t *shell, starg_rng *rng) {
    uint64_t seed = starg_rng_below(rng, 1 << 30);
    for (size_t f = 0; f < s->face_count; f++) {
        starg_rng own = starg_rng_make(seed, 1, root_of(shell, (uint32_t)f));
        uint32_t *corner = s->faces + 3 * f, second = corner[1];
        if (starg_rng_below(&own, 2)) {
            corner[1] = corner[2];
            corner[2] = second;
        }
    }
}

/* The mesh, with a vertex of its own for every fan of faces, or with one for all at a position. */
static void make_mesh(builder *b, bool shared, starg_rng *rng) {
    shape *s = &b->m->s;
    uint32_t corners = (uint32_t)(3 * b->face_count), count = 0;
    uint32_t *fan = malloc(corners * sizeof *fan), *shell = malloc(corners * sizeof *shell);
    uint32_t *name = malloc((corners + CELLS) * sizeof *name);
    assert_true(fan != NULL && shell != NULL && name != NULL);
    for (uint32_t h = 0; h < corners; h++)
        fan[h] = shell[h] = h;
    for (uint32_t h = 0; h < corners; h++) {
        join(fan, h, next_of(b->pair[h]));
        join(shell, h / 3, b->pair[h] / 3);
    }
    s->face_count = b->face_count;
    s->faces = malloc(corners * sizeof *s->faces);
    s->vertices = malloc(3 * corners * sizeof *s->vertices);
    assert_true(s->faces != NULL && s->vertices != NULL);
    memset(name, 0xff, (corners + CELLS) * sizeof *name);
    for (uint32_t h = 0; h < corners; h++) {
        uint32_t *own = &name[shared ? corners + b->faces[h] : root_of(fan, h)];
        if (*own == UINT32_MAX) {
            corner_of(b->m, (int)b->faces[h], s->vertices + 3 * (size_t)count);
            *own = count++;
        }
        s->faces[h] = *own;
    }
    s->vertex_count = count;
    turn_shells(s, shell, rng);
    free(fan);
    free(shell);
    free(name);
}

/* Cells of a grid of 3, some of them of half the size, so that no edge has both ends in one fan,
 * twice. */
static void fill_cells(model *m, starg_rng *rng, bool fine) {
    uint64_t share = 2 + starg_rng_below(rng, 6), checkered = starg_rng_below(rng, 4);
    for (int cell = 0; cell < 27; cell++) {
        int at[3] = {cell % 3, cell / 3 % 3, cell / 9};
        bool solid = starg_rng_below(rng, 9) < share;
        if (checkered == 0)
            solid = (at[0] + at[1] + at[2]) % 2 == (int)(share % 2);
        for (int i = 0; i < (fine ? 8 : 1) && solid; i++) {
            int scale = fine ? 2 : 1;
            m->solid[(scale * at[0] + 1 + i % 2) + WIDE * (scale * at[1] + 1 + i / 2 % 2) +
                     WIDE * WIDE * (scale * at[2] + 1 + i / 4)] = true;
        }
    }
    for (int i = 0; i < CELLS; i++)
        m->count += m->solid[i];
}

static model *new_model(starg_rng *rng) {
    model *m = calloc(1, sizeof *m);
    assert_non_null(m);
    for (int k = 0; k < 3 && starg_rng_below(rng, 2); k++)
        m->slant[k] = (double)starg_rng_below(rng, 3) - 1;
    return m;
}

static model *make_polycube(starg_rng *rng, bool shared, bool fine) {
    model *m = new_model(rng);
    builder *b = calloc(1, sizeof *b);
    assert_non_null(b);
    b->m = m;
    while (m->count == 0)
        fill_cells(m, rng, fine);
    list_sides(b);
    split_sides(b, rng);
    assert_true(pair_faces(b, rng));
    make_mesh(b, shared, rng);
    free(b);
    return m;
}

/* ---- nested boxes ---- */

enum { BOXES = 7 };

typedef struct block {
    int low[3], high[3];
} block;

/* 1: the inner one lies within the other, 0: they are apart but for edges and corners, -1: neither.
 * If `flush`, they may also have parts of faces in common. */
static int lies_in(const block *inner, const block *outer, int flush) {
    bool in = true, apart = false;
    int edges = flush;
    for (int k = 0; k < 3; k++) {
        in = in && outer->low[k] < inner->low[k] + flush && inner->high[k] < outer->high[k] + flush;
        apart = apart || inner->high[k] < outer->low[k] || outer->high[k] < inner->low[k];
        edges += inner->high[k] == outer->low[k] || outer->high[k] == inner->low[k];
    }
    return apart || edges >= 2 ? 0 : in ? 1 : -1;
}

static void add_box(model *m, const block *own, bool turned) {
    static const uint32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    shape *s = &m->s;
    uint32_t base = (uint32_t)s->vertex_count;
    for (int i = 0; i < 8; i++) {
        const int *end[2] = {own->low, own->high};
        corner_of(m, end[i & 1][0] + WIDE * end[i >> 1 & 1][1] + WIDE * WIDE * end[i >> 2][2],
                  s->vertices + 3 * s->vertex_count++);
    }
    for (int i = 0; i < 12; i++) {
        const uint32_t *q = quads[i / 2];
        uint32_t *f = s->faces + 3 * s->face_count++;
        f[0] = base + q[0];
        f[turned ? 2 : 1] = base + q[1 + i % 2];
        f[turned ? 1 : 2] = base + q[2 + i % 2];
    }
}

static model *make_boxes(starg_rng *rng, int flush) {
    model *m = new_model(rng);
    block all[BOXES];
    size_t count = 0;
    m->s.vertices = malloc(sizeof(double[BOXES * 8 * 3]));
    m->s.faces = malloc(sizeof(uint32_t[BOXES * 12 * 3]));
    assert_true(m->s.vertices != NULL && m->s.faces != NULL);
    for (int tries = 0; tries < 200 && count < BOXES; tries++) {
        block own;
        bool fits = true;
        for (int k = 0; k < 3; k++) {
            own.low[k] = 1 + (int)starg_rng_below(rng, SIDE);
            own.high[k] =
                own.low[k] + 1 + (int)starg_rng_below(rng, (uint64_t)(WIDE - 1 - own.low[k]));
        }
        for (size_t i = 0; i < count && fits; i++)
            fits = memcmp(&own, &all[i], sizeof own) != 0 &&
                   (lies_in(&own, &all[i], flush) >= 0 || lies_in(&all[i], &own, flush) > 0);
        if (!fits)
            continue;
        all[count++] = own;
        add_box(m, &own, starg_rng_below(rng, 2));
        for (int cell = 0; cell < CELLS; cell++) {
            int at[3] = {cell % WIDE, cell / WIDE % WIDE, cell / WIDE / WIDE};
            bool in = true;
            for (int k = 0; k < 3; k++)
                in = in && own.low[k] <= at[k] && at[k] < own.high[k];
            m->solid[cell] ^= in;
        }
    }
    for (int i = 0; i < CELLS; i++)
        m->count += m->solid[i];
    return m;
}

static model *make_model(starg_rng *rng, uint64_t round) {
    return round % 3 == 0 ? make_boxes(rng, 0) : make_polycube(rng, round % 3 == 1, true);
}

/* ---- inside ---- */

static void check_cells(const model *m, const starg_solid *solid, const verify_surface *surface,
                        uint64_t round) {
    for (int cell = 0; cell < CELLS; cell++) {
        double p[3];
        bool on;
        centre_of(m, cell, p);
        if (starg_solid_contains(solid, p) != m->solid[cell])
            fail_msg("model %d: cell %d is %ssolid", (int)round, cell,
                     m->solid[cell] ? "" : "not ");
        int winding = verify_winding(surface, NULL, surface->face_count, p, &on);
        if (on || winding != m->solid[cell])
            fail_msg("model %d: verify winds %d times about cell %d, which is %ssolid", (int)round,
                     winding, cell, m->solid[cell] ? "" : "not ");
    }
}

static void test_cells(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (uint64_t round = 0; round < test_rounds(80, 8000); round++) {
        starg_rng rng = starg_rng_make(55, 1, round);
        model *m = round % 4 == 3 ? make_boxes(&rng, 1) : make_model(&rng, round);
        starg_mesh *mesh = test_mesh_of(context, &m->s);
        starg_solid *solid = NULL;
        verify_surface *surface = NULL;
        if (starg_solid_create(context, mesh, &solid) != STARG_OK)
            fail_msg("model %d: %s", (int)round, starg_context_error(context)->message);
        if (verify_surface_create(context, mesh, &surface) != STARG_OK)
            fail_msg("model %d: %s", (int)round, starg_context_error(context)->message);
        const starg_check *check = starg_solid_check(solid);
        if (fabs(check->volume - (double)m->count) > 1e-9)
            fail_msg("model %d: volume %g of %zu cells", (int)round, check->volume, m->count);
        check_cells(m, solid, surface, round);
        verify_surface_free(surface);
        starg_solid_free(solid);
        starg_mesh_free(mesh);
        free_model(m);
    }
    test_context_free(context);
}

/* ---- what is seen ---- */

typedef struct subject {
    starg_context *context;
    uint64_t round;
    model *m;
    starg_mesh *mesh;
    starg_solid *solid;
} subject;

static subject make_subject(starg_context *context, uint64_t round) {
    starg_rng rng = starg_rng_make(55, 2, round);
    subject s = {.context = context, .round = round, .m = make_model(&rng, round)};
    s.mesh = test_mesh_of(context, &s.m->s);
    test_ok(context, starg_solid_create(context, s.mesh, &s.solid));
    return s;
}

static void free_subject(subject *s) {
    starg_solid_free(s->solid);
    starg_mesh_free(s->mesh);
    free_model(s->m);
}

/* All engines against the definition. */
static void check_engines(const subject *s, const double p[3], const bool *expected) {
    size_t count = starg_mesh_face_count(s->mesh);
    for (int engine = 0; engine <= STARG_VISIBILITY_FASTEST; engine++) {
        starg_visibility_options options;
        starg_bits *seen = NULL;
        starg_visibility_options_default(&options);
        options.engine = (starg_visibility_engine)engine;
        test_ok(s->context, starg_visibility(s->context, s->solid, p, 1, &options, &seen));
        for (size_t f = 0; f < count; f++)
            if (starg_bits_test(seen, 0, f) != expected[f])
                fail_msg("model %d: engine %d is wrong about face %zu from (%g, %g, %g)",
                         (int)s->round, engine, f, p[0], p[1], p[2]);
        starg_bits_free(seen);
    }
}

/* What is hidden from a box is hidden from points of it. */
static void check_box(const subject *s, box_worker *worker, const bvh_box *box,
                      const double *points, size_t count) {
    const starg_mesh *own = starg_solid_mesh(s->solid);
    box_question q = {.box = *box, .range = INFINITY, .count = starg_mesh_face_count(own)};
    uint64_t *open = calloc(starg_bit_words(q.count), sizeof *open);
    bool *seen = calloc(q.count, sizeof *seen);
    assert_true(open != NULL && seen != NULL);
    box_look(worker, &q, open, NULL);
    for (size_t i = 0; i < count; i++) {
        visibility_oracle_faces(starg_mesh_vertices(own), starg_mesh_vertex_count(own),
                                starg_mesh_faces(own), q.count, points + 3 * i, false, seen);
        for (size_t f = 0; f < q.count; f++)
            if (seen[f] && !starg_bit_test(open, f))
                fail_msg("model %d: (%g, %g, %g) sees face %zu, which is hidden from its box",
                         (int)s->round, points[3 * i], points[3 * i + 1], points[3 * i + 2], f);
        if (i == 0)
            check_engines(s, points, seen);
    }
    free(open);
    free(seen);
}

static void test_sight(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (uint64_t round = 0; round < test_rounds(9, 1000); round++) {
        subject s = make_subject(context, round);
        box_scene *scene = NULL;
        box_worker *worker = NULL;
        test_ok(context, box_scene_create(context, s.solid, &scene));
        test_ok(context, box_worker_create(scene, &worker));
        for (size_t i = 0; i < 6; i++) {
            starg_rng rng = starg_rng_make(55, 3, 6 * round + i);
            double points[9];
            bvh_box box = box_about(s.solid, &rng, i);
            check_box(&s, worker, &box, points, box_points(s.solid, &box, &rng, 3, points));
        }
        box_worker_free(worker);
        box_scene_free(scene);
        free_subject(&s);
    }
    test_context_free(context);
}

/* ---- results ---- */

static void expect_passed(const subject *s, starg_verdict *verdict) {
    for (size_t i = 0; i < verdict->count; i++)
        if (!verdict->claims[i].holds)
            fail_msg("model %d: %s", (int)s->round, verdict->claims[i].text);
    starg_verdict_free(s->context, verdict);
}

static void check_guards(const subject *s) {
    starg_guard_options options;
    starg_guards *guards = NULL;
    starg_certificate *why = NULL;
    starg_verdict *verdict = NULL;
    char *text = NULL;
    size_t size;
    starg_guard_options_default(&options);
    options.candidate_count = 100;
    options.prove = true;
    options.prove_work = 100000;
    test_ok(s->context,
            starg_guard_certified(s->context, s->solid, &options, &guards, &text, &size));
    test_ok(s->context, starg_certificate_read_memory(s->context, text, size, "c", &why));
    const starg_guards_evidence evidence = {.certificate = why};
    test_ok(s->context, starg_verify_guards_with(s->context, s->mesh, &evidence, guards, &verdict));
    expect_passed(s, verdict);
    assert_int_equal(guards->vertex_count, starg_mesh_vertex_count(s->mesh));
    starg_certificate_free(why);
    starg_text_free(s->context, text);
    starg_guards_free(s->context, guards);
}

static void check_pieces(const subject *s) {
    starg_decompose_options options;
    starg_decomposition *d = NULL;
    starg_certificate *why = NULL;
    starg_verdict *verdict = NULL;
    char *text = NULL;
    size_t size;
    starg_decompose_options_default(&options);
    options.effort = 1;
    options.prove = true;
    options.prove_work = 20000;
    test_ok(s->context,
            starg_decompose_certified(s->context, s->solid, &options, &d, &text, &size));
    test_ok(s->context, starg_certificate_read_memory(s->context, text, size, "c", &why));
    const starg_pieces_mesh mesh = {
        .vertex_count = starg_tetmesh_vertex_count(d->mesh),
        .count = starg_tetmesh_count(d->mesh),
        .vertices = (double *)(uintptr_t)starg_tetmesh_vertices(d->mesh),
        .tetrahedra = (uint32_t *)(uintptr_t)starg_tetmesh_tetrahedra(d->mesh),
        .labels = d->labels};
    const starg_pieces_report report = {.mode = d->mode,
                                        .tetrahedra = mesh.count,
                                        .piece_count = d->piece_count,
                                        .pieces = d->pieces,
                                        .contact_count = d->contact_count,
                                        .contacts = d->contacts,
                                        .strictly_star = d->strictly_star,
                                        .visible_vertices = d->visible_vertices,
                                        .flattest = d->flattest,
                                        .lower_bound = d->lower_bound,
                                        .optimal = d->optimal};
    test_ok(s->context,
            starg_verify_pieces_with(s->context, s->mesh, why, &mesh, &report, &verdict));
    expect_passed(s, verdict);
    assert_true(d->tetra.surface_kept && d->strictly_star == d->piece_count);
    assert_int_equal(d->model_vertices, starg_mesh_vertex_count(s->mesh));
    assert_true(fabs(starg_tetmesh_volume(d->mesh) - (double)s->m->count) < 1e-9);
    starg_certificate_free(why);
    starg_text_free(s->context, text);
    starg_decomposition_free(s->context, d);
}

static void test_results(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (uint64_t round = 0; round < test_rounds(4, 300); round++) {
        subject s = make_subject(context, round);
        check_guards(&s);
        if (round % 3 > 0) /* boxes touch where others have no vertices */
            check_pieces(&s);
        free_subject(&s);
    }
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_cells), cmocka_unit_test(test_sight),
                                       cmocka_unit_test(test_results)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
