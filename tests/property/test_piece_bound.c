/* SPDX-License-Identifier: Apache-2.0 */
/* The lower bound for star-shaped pieces: what it rests on holds for decompositions, by the
 * definition of sight; it is never above the number of pieces, and meets it where that is known;
 * the verifier accepts it, and nothing more. */
#include "support.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "exact_oracle.h"
#include "models.h"
#include "starguard/decompose.h"
#include "starguard/guard.h"
#include "starguard/repair.h"
#include "starguard/verify.h"
#include "visibility_oracle.h"

enum { WORK = 300000, EFFORT = 40 };

/* In the search of a proof. */
static uint64_t work = WORK;

static starg_decompose_options options_of(bool prove) {
    starg_decompose_options options;
    starg_decompose_options_default(&options);
    options.effort = EFFORT;
    options.prove = prove;
    options.prove_work = work;
    return options;
}

/* ---- solids ---- */

/* A bar of cells along x with so many teeth, each too deep to be seen into from elsewhere: so many
 * pieces are needed, and are enough. */
static shape make_comb(int teeth) {
    char cells[256];
    int width = 2 * teeth - 1, height = 5;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++)
            cells[x + width * y] = y == 0 || x % 2 == 0 ? '#' : ' ';
    return shape_cells(cells, width, height, 1);
}

/* Embedded, or NULL. */
static starg_solid *random_solid(starg_context *context, uint64_t item) {
    shape made = item % 3 == 0 ? shape_blob(2, item) : shape_heap(4, item);
    starg_mesh *mesh = test_mesh_of(context, &made);
    starg_solid *solid = NULL;
    starg_check *check = NULL;
    shape_free(&made);
    test_ok(context, starg_mesh_check(context, mesh, &check));
    if (check->usable && check->embedded)
        test_ok(context, starg_solid_create(context, mesh, &solid));
    starg_check_free(context, check);
    starg_mesh_free(mesh);
    return solid;
}

/* ---- the verifier ---- */

typedef struct proof {
    starg_context *context;
    const starg_mesh *mesh;
    starg_decomposition *pieces;
    char *text;
    size_t size;
} proof;

static proof prove(starg_context *context, const starg_solid *solid) {
    const starg_decompose_options options = options_of(true);
    proof p = {.context = context, .mesh = starg_solid_mesh(solid)};
    test_ok(context,
            starg_decompose_certified(context, solid, &options, &p.pieces, &p.text, &p.size));
    return p;
}

static void proof_free(proof *p) {
    starg_text_free(p->context, p->text);
    starg_decomposition_free(p->context, p->pieces);
}

static starg_verdict *judge(const proof *p, const starg_certificate *why, size_t bound,
                            bool optimal) {
    const starg_decomposition *d = p->pieces;
    starg_verdict *verdict = NULL;
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
                                        .lower_bound = bound,
                                        .optimal = optimal};
    test_ok(p->context,
            starg_verify_pieces_with(p->context, p->mesh, why, &mesh, &report, &verdict));
    return verdict;
}

static bool says(const starg_verdict *verdict, bool holds, const char *words) {
    for (size_t i = 0; i < verdict->count; i++)
        if (verdict->claims[i].holds == holds && strstr(verdict->claims[i].text, words) != NULL)
            return true;
    return false;
}

static starg_certificate *read_text(const proof *p, const char *text) {
    starg_certificate *why = NULL;
    test_ok(p->context, starg_certificate_read_memory(p->context, text, strlen(text), "c", &why));
    return why;
}

/* All claims hold, among them that of the bound. */
static void check_right(const proof *p) {
    starg_certificate *why = read_text(p, p->text);
    starg_verdict *verdict = judge(p, why, p->pieces->lower_bound, p->pieces->optimal);
    for (size_t i = 0; i < verdict->count; i++)
        if (!verdict->claims[i].holds)
            print_error("%s\n", verdict->claims[i].text);
    assert_true(verdict->passed);
    assert_true(says(verdict, true, "no fewer than"));
    starg_verdict_free(p->context, verdict);
    starg_certificate_free(why);
}

/* Exactly this is refused. */
static void check_refused(const proof *p, const char *text, size_t bound, bool optimal,
                          const char *words) {
    starg_certificate *why = read_text(p, text);
    starg_verdict *verdict = judge(p, why, bound, optimal);
    assert_true(says(verdict, false, words));
    starg_verdict_free(p->context, verdict);
    starg_certificate_free(why);
}

/* ---- what the bound rests on ---- */

/* Each corner of each face is seen by the guard of a piece that is before the face. */
static void check_corners(const starg_solid *solid, const starg_decomposition *d) {
    const starg_mesh *mesh = starg_solid_mesh(solid);
    const double *points = starg_mesh_vertices(mesh);
    const uint32_t *faces = starg_mesh_faces(mesh);
    size_t vertices = starg_mesh_vertex_count(mesh), count = starg_mesh_face_count(mesh);
    bool *visible = malloc(vertices), *seen = calloc(3 * count, 1);
    assert_non_null(visible);
    assert_non_null(seen);
    for (size_t i = 0; i < d->piece_count; i++) {
        const double *guard = d->pieces[i].guard;
        visibility_oracle_vertices(points, vertices, faces, count, guard, visible);
        for (size_t k = 0; k < 3 * count; k++) {
            const uint32_t *c = faces + 3 * (k / 3);
            seen[k] =
                seen[k] || (visible[faces[k]] &&
                            oracle_orient3d(points + 3 * (size_t)c[0], points + 3 * (size_t)c[1],
                                            points + 3 * (size_t)c[2], guard) > 0);
        }
    }
    for (size_t k = 0; k < 3 * count; k++)
        if (!seen[k])
            fail_msg("no guard of a piece sees corner %zu of face %zu", k % 3, k / 3);
    free(visible);
    free(seen);
}

static void test_guards_see_corners(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    const starg_decompose_options options = options_of(false);
    size_t tried = 0, several = 0;
    for (uint64_t item = 0; item < test_rounds(24, 600); item++) {
        starg_solid *solid = random_solid(context, item);
        starg_decomposition *d = NULL;
        if (solid == NULL)
            continue;
        test_ok(context, starg_decompose(context, solid, &options, &d));
        assert_true(d->tetra.surface_kept);
        check_corners(solid, d);
        tried++;
        several += d->piece_count > 1;
        starg_decomposition_free(context, d);
        starg_solid_free(solid);
    }
    assert_true(tried > 5 && several > 2);
    test_context_free(context);
}

/* ---- the bound ---- */

/* It is right, and no other decomposition has fewer pieces. */
static void test_random_solids(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    size_t tried = 0, met = 0, above = 0;
    for (uint64_t item = 0; item < test_rounds(6, 400); item++) {
        starg_solid *solid = random_solid(context, item);
        if (solid == NULL)
            continue;
        proof p = prove(context, solid);
        size_t bound = p.pieces->lower_bound;
        check_right(&p);
        check_corners(solid, p.pieces);
        for (uint64_t effort = 1; effort < 400; effort *= 19) {
            starg_decompose_options options = options_of(false);
            starg_decomposition *d = NULL;
            options.effort = effort;
            test_ok(context, starg_decompose(context, solid, &options, &d));
            assert_true(d->lower_bound <= d->piece_count);
            assert_true(bound <= d->piece_count);
            starg_decomposition_free(context, d);
        }
        tried++;
        met += p.pieces->optimal;
        above += bound > 1;
        proof_free(&p);
        starg_solid_free(solid);
    }
    print_message("%zu solids: %zu bounds above 1, %zu met\n", tried, above, met);
    assert_true(above > 0 && met > 0);
    test_context_free(context);
}

/* With more teeth the search does not get as far: cells about reflex edges stay in its way. */
static void test_combs(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    for (int teeth = 1; teeth <= 4; teeth++) {
        shape made = make_comb(teeth);
        starg_solid *solid = test_solid_of(context, &made);
        proof p = prove(context, solid);
        check_right(&p);
        assert_int_equal(p.pieces->piece_count, teeth);
        assert_true(p.pieces->lower_bound <= (size_t)teeth);
        assert_true(p.pieces->optimal == (p.pieces->lower_bound == (size_t)teeth));
        assert_true(teeth > 2 || p.pieces->optimal);
        proof_free(&p);
        starg_solid_free(solid);
        shape_free(&made);
    }
    test_context_free(context);
}

/* Real models, by the defaults: the fewest pieces possible. */
static void test_shared(void **state) {
    (void)state;
    static const char *const names[] = {"table2/kitten_400", "solids/screwdriver", "solids/spot"};
    const size_t fewest[] = {3, 4, 4};
    const char *data = test_shared_data();
    if (data == NULL)
        skip();
    for (size_t i = 0; i < test_rounds(1, 3); i++) {
        char path[4400];
        starg_context *context = test_context(2);
        starg_decompose_options options;
        starg_mesh *mesh = NULL;
        starg_solid *solid = NULL;
        proof p = {.context = context};
        snprintf(path, sizeof path, "%s/%s.off", data, names[i]);
        starg_decompose_options_default(&options);
        options.prove = true;
        test_ok(context, starg_mesh_read(context, path, &mesh));
        test_ok(context, starg_solid_create(context, mesh, &solid));
        test_ok(context,
                starg_decompose_certified(context, solid, &options, &p.pieces, &p.text, &p.size));
        p.mesh = starg_solid_mesh(solid);
        check_right(&p);
        assert_int_equal(p.pieces->lower_bound, fewest[i]);
        assert_true(p.pieces->optimal);
        proof_free(&p);
        starg_mesh_free(mesh);
        starg_solid_free(solid);
        test_context_free(context);
    }
}

static void test_samples(void **state) {
    (void)state;
    static const char *const names[] = {"l-room", "horse", "octopus"};
    work = test_size(WORK / 3, WORK);
    for (size_t i = 0; i < test_size(2, 3); i++) {
        starg_context *context = test_context(2);
        starg_solid *solid = test_sample(context, names[i], 500);
        proof p = prove(context, solid);
        check_right(&p);
        print_message("%s: %zu pieces, bound %zu\n", names[i], p.pieces->piece_count,
                      p.pieces->lower_bound);
        proof_free(&p);
        starg_solid_free(solid);
        test_context_free(context);
    }
    work = WORK;
}

static void test_same_bytes(void **state) {
    (void)state;
    shape made = make_comb(3);
    starg_context *one = test_context(1), *five = test_context(5);
    starg_solid *solid = test_solid_of(one, &made);
    proof a = prove(one, solid), b = prove(five, solid);
    assert_string_equal(a.text, b.text);
    assert_int_equal(a.pieces->lower_bound, b.pieces->lower_bound);
    proof_free(&a);
    proof_free(&b);
    starg_solid_free(solid);
    shape_free(&made);
    test_context_free(one);
    test_context_free(five);
}

/* ---- forged ones ---- */

static void test_forged(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    shape made = make_comb(2), other = make_comb(3);
    starg_solid *solid = test_solid_of(context, &made), *stranger = test_solid_of(context, &other);
    proof p = prove(context, solid), q = prove(context, stranger);
    check_refused(&p, p.text, 3, false, "the lower bound is at most");
    check_refused(&p, p.text, 3, false, "says no more than 2");
    check_refused(&p, p.text, 2, false, "not proven optimal");
    check_refused(&p, p.text, 1, true, "called optimal");
    check_refused(&p, q.text, 2, false, "it is of another model");
    /* what faces or vertices need, pieces need not */
    starg_guard_options options;
    starg_guard_options_default(&options);
    options.prove = true;
    options.prove_work = work;
    for (int k = 0; k < 2; k++) {
        starg_guards *guards = NULL;
        char *text = NULL;
        size_t size;
        options.visibility.target = k == 0 ? STARG_TARGET_FACES : STARG_TARGET_VERTICES;
        test_ok(context, starg_guard_certified(context, solid, &options, &guards, &text, &size));
        check_refused(&p, text, 2, true, "it is not about corners");
        starg_text_free(context, text);
        starg_guards_free(context, guards);
    }
    /* without a certificate it is not checked */
    starg_verdict *verdict = judge(&p, NULL, 2, true);
    assert_true(verdict->passed);
    assert_false(says(verdict, true, "no fewer than"));
    assert_non_null(
        strstr(verdict->not_checked[verdict->not_checked_count - 1].text, "no fewer than 2"));
    starg_verdict_free(context, verdict);
    proof_free(&p);
    proof_free(&q);
    starg_solid_free(solid);
    starg_solid_free(stranger);
    shape_free(&made);
    shape_free(&other);
    test_context_free(context);
}

/* Another number in place of one of the text's, not in its first line. */
static char *damage(const char *text, starg_rng *rng) {
    size_t length = strlen(text), at = 0;
    const char *second = strchr(text, '\n');
    do
        at = (size_t)(second - text) +
             (size_t)starg_rng_below(rng, length - (size_t)(second - text));
    while (!isdigit((unsigned char)text[at]));
    size_t first = at, end = at;
    while (isdigit((unsigned char)text[first - 1]))
        first--;
    while (isdigit((unsigned char)text[end]))
        end++;
    unsigned long long value = strtoull(text + first, NULL, 10);
    unsigned long long next =
        starg_rng_below(rng, 2) ? value + 1 : starg_rng_below(rng, 2 * value + 2);
    char *out = malloc(length + 32);
    assert_non_null(out);
    sprintf(out, "%.*s%llu%s", (int)first, text, next, text + end);
    return out;
}

/* Two pieces are enough: no bound of three is ever accepted. */
static void test_damaged(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    shape made = make_comb(2);
    starg_solid *solid = test_solid_of(context, &made);
    proof p = prove(context, solid);
    size_t unread = 0, refused = 0, rounds = test_rounds(100, 10000);
    for (size_t i = 0; i < rounds; i++) {
        starg_rng rng = starg_rng_make(21, 4, i);
        starg_certificate *why = NULL;
        char *text = damage(p.text, &rng);
        char *line = strstr(text, "\nbound 2\n");
        if (line != NULL && i % 2 == 0)
            line[7] = '3';
        if (starg_certificate_read_memory(context, text, strlen(text), "damaged", &why) != STARG_OK)
            unread++;
        else {
            starg_verdict *verdict = judge(&p, why, line != NULL && i % 2 == 0 ? 3 : 2, i % 2 == 1);
            bool follows =
                says(verdict, true, "no fewer than 3") && says(verdict, true, "cells hold");
            assert_false(follows);
            refused += !verdict->passed;
            starg_verdict_free(context, verdict);
        }
        starg_certificate_free(why);
        free(text);
    }
    print_message("of %zu damages %zu are unreadable, %zu refused\n", rounds, unread, refused);
    assert_true(refused > rounds / 4);
    proof_free(&p);
    starg_solid_free(solid);
    shape_free(&made);
    test_context_free(context);
}

/* ---- where there is none ---- */

static void test_refusals(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape made = make_comb(2), twice = make_comb(2);
    const double inside[3] = {0.25, 0.25, 0.25};
    starg_solid *solid = test_solid_of(context, &made);
    shape_append(&made, &twice, inside, 0);
    starg_solid *crossed = test_solid_of(context, &made);
    starg_decompose_options options = options_of(true);
    starg_decomposition *d = NULL;
    char *text = NULL;
    size_t size = 0;
    assert_int_equal(starg_decompose(context, crossed, &options, &d), STARG_ERROR_MESH);
    assert_null(d);
    options.mode = STARG_DECOMPOSE_PAPER;
    assert_int_equal(starg_decompose(context, solid, &options, &d), STARG_ERROR_ARGUMENT);
    options = options_of(false);
    assert_int_equal(starg_decompose_certified(context, solid, &options, &d, &text, &size),
                     STARG_ERROR_ARGUMENT);
    assert_true(d == NULL && text == NULL && size == 0);
    starg_solid_free(solid);
    starg_solid_free(crossed);
    shape_free(&made);
    shape_free(&twice);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_guards_see_corners),
        cmocka_unit_test(test_random_solids),
        cmocka_unit_test(test_combs),
        cmocka_unit_test(test_samples),
        cmocka_unit_test(test_shared),
        cmocka_unit_test(test_same_bytes),
        cmocka_unit_test(test_forged),
        cmocka_unit_test(test_damaged),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
