/* SPDX-License-Identifier: Apache-2.0 */
/* Two pieces are not enough: shadows by definition, in samples of the rays; proofs for blended
 * round cones, of which verify checks every reason, and rejects those that are changed; and none
 * for solids that are cut in two. */
#include "support.h"

#include <math.h>
#include <string.h>

#include "core/bits.h"
#include "core/rng.h"
#include "exact_oracle.h"
#include "sample/isosurface.h"
#include "star/decomposition.h"
#include "star/shadow.h"
#include "star/two_pieces.h"
#include "starguard/solid.h"
#include "verify/claims.h"
#include "verify/everywhere.h"
#include "verify/measure.h"

enum { RAYS = 24, WORK = 500000, EFFORT = 60 };

static size_t at_least(size_t least, size_t count) {
    return count < least ? least : count;
}

/* A chain or a star of two to four round cones. */
static starg_solid *make_solid(starg_context *context, uint64_t seed, double spacing) {
    implicit_field field = {.count = 0};
    starg_rng rng = starg_rng_make(seed, 1, 1);
    mesh_builder builder = {.context = context};
    starg_mesh *mesh;
    starg_solid *solid;
    double at[3] = {0, 0, 0};
    for (size_t i = 0; i < 2 + seed % 3; i++) {
        implicit_part part = {.blend = 0.15};
        double way[3];
        starg_rng_direction(&rng, way);
        for (int k = 0; k < 3; k++) {
            part.a[k] = at[k];
            part.b[k] = at[k] + way[k] * (1.0 + 0.8 * starg_rng_unit(&rng));
        }
        part.ra = 0.2 + 0.25 * starg_rng_unit(&rng);
        part.rb = 0.2 + 0.2 * starg_rng_unit(&rng);
        if (seed % 2 == 1)
            memcpy(at, part.b, sizeof at);
        implicit_prepare(&part);
        field.parts[field.count++] = part;
    }
    test_ok(context, isosurface_extract(&field, spacing, &builder));
    test_ok(context, builder_finish(&builder, &mesh));
    test_ok(context, starg_solid_create(context, mesh, &solid));
    builder_free(&builder);
    starg_mesh_free(mesh);
    return solid;
}

/* ---- shadows ---- */

static void random_in(const bvh_box *box, starg_rng *rng, double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = box->lower[k] + starg_rng_unit(rng) * (box->upper[k] - box->lower[k]);
}

/* Does the ray from x in a direction meet a triangle, or nearly so? By the signs of three volumes.
 */
static bool ray_meets(const double x[3], const double way[3], const double *const t[3]) {
    double volume[3], sum = 0, size = 0;
    for (int i = 0; i < 3; i++) {
        double a[3], b[3];
        for (int k = 0; k < 3; k++) {
            a[k] = t[i][k] - x[k];
            b[k] = t[(i + 1) % 3][k] - x[k];
        }
        volume[i] = way[0] * (a[1] * b[2] - a[2] * b[1]) + way[1] * (a[2] * b[0] - a[0] * b[2]) +
                    way[2] * (a[0] * b[1] - a[1] * b[0]);
        sum += volume[i];
        size = fmax(size, fabs(volume[i]));
    }
    for (int i = 0; i < 3; i++)
        if (volume[i] < -1e-9 * size)
            return false;
    return sum > 0;
}

static void check_shadow(const shadow_tables *t, const shadow_place *place, const double x[3],
                         uint32_t patch, starg_rng *rng) {
    const uint32_t *ranks = t->patches.data + patch + 1;
    for (int r = 0; r < RAYS; r++) {
        double g[3], way[3];
        bool met = false;
        random_in(&place->box, rng, g);
        for (int k = 0; k < 3; k++)
            way[k] = x[k] - g[k];
        for (uint32_t i = 0; i < t->patches.data[patch]; i++) {
            const box_triangle *f = &t->scene->triangles[ranks[i]];
            const double *const corners[3] = {
                box_corner(t->scene, f, 0), box_corner(t->scene, f, 1), box_corner(t->scene, f, 2)};
            assert_int_equal(oracle_orient3d(corners[0], corners[1], corners[2], x), 1);
            met = met || ray_meets(x, way, corners);
        }
        assert_true(met);
    }
}

static void check_blind(const shadow_tables *t, const shadow_place *place, starg_rng *rng) {
    for (int r = 0; r < 4 && !place->outside; r++) {
        double g[3];
        random_in(&place->box, rng, g);
        for (size_t i = 0; i < t->scene->face_count; i++) {
            const box_triangle *f = &t->scene->triangles[i];
            if (starg_bit_test(place->blind, i))
                assert_true(oracle_orient3d(box_corner(t->scene, f, 0), box_corner(t->scene, f, 1),
                                            box_corner(t->scene, f, 2), g) <= 0);
        }
    }
}

static starg_status add_point(starg_context *context, shadow_tables *t, const double x[3]) {
    starg_status status = STARG_OK;
    for (int k = 0; k < 3; k++)
        STARG_PUSH(context, "test", &t->points, x[k]);
done:
    return status;
}

/* The checker, which finds the patch of a seed itself. */
typedef struct checker {
    verify_surface *surface;
    verify_tree *tree;
    verify_scene scene;
    verify_watch *watch;
} checker;

static void make_checker(starg_context *context, const starg_solid *solid, checker *c) {
    test_ok(context, verify_surface_create(context, starg_solid_mesh(solid), &c->surface));
    test_ok(context, verify_tree_create(c->surface, &c->tree));
    test_ok(context, verify_scene_create(c->surface, c->tree, false, &c->scene));
    test_ok(context, verify_watch_create(&c->scene, &c->watch));
}

static void free_checker(checker *c) {
    verify_watch_free(c->watch);
    verify_scene_free(&c->scene);
    verify_tree_free(c->tree);
    verify_surface_free(c->surface);
}

static verify_box box_of(const shadow_place *place) {
    verify_box out;
    memcpy(out.lower, place->box.lower, sizeof out.lower);
    memcpy(out.upper, place->box.upper, sizeof out.upper);
    return out;
}

/* It agrees about which places are blind for a shadow. Returns whether this one is. */
static bool compare_blind(const shadow_tables *t, const checker *c, uint32_t place, uint32_t other,
                          const double x[3], uint32_t patch) {
    const verify_box box = box_of(&t->places.data[place]), beyond = box_of(&t->places.data[other]);
    const uint32_t seed = t->scene->tree->order[t->patches.data[patch + 1]];
    const bool blind = shadow_is_blind(t, other, patch);
    assert_int_equal(verify_box_shades(c->watch, &box, x, seed, &beyond), blind);
    return blind;
}

/* Rays that enter the solid are no shadow, though x itself is behind all of the faces. */
static void check_entries(const shadow_tables *t, const checker *c, const shadow_place *place,
                          const double x[3]) {
    const verify_box box = box_of(place);
    verify_box only;
    memcpy(only.lower, x, sizeof only.lower);
    memcpy(only.upper, x, sizeof only.upper);
    for (uint32_t f = 0; f < t->scene->face_count; f++)
        assert_false(verify_box_shades(c->watch, &box, x, f, &only));
}

static void test_shadows(void **state) {
    (void)state;
    size_t found = 0, blind = 0;
    for (uint64_t seed = 0; seed < at_least(6, test_rounds(6, 60)); seed++) {
        starg_context *context = test_context(1);
        starg_solid *solid = make_solid(context, seed, 0.3);
        shadow_tables t;
        starg_rng rng = starg_rng_make(seed, 2, 2);
        checker c;
        make_checker(context, solid, &c);
        test_ok(context, shadow_tables_make(context, solid, &t));
        for (int round = 0; round < 60; round++) {
            uint32_t place = 0, halves[2], patch, point = (uint32_t)(t.points.count / 3);
            double x[3];
            for (uint64_t depth = starg_rng_below(&rng, 16); depth > 0; depth--) {
                test_ok(context, shadow_halve(&t, place, halves));
                place = halves[starg_rng_below(&rng, 2)];
            }
            check_blind(&t, &t.places.data[place], &rng);
            random_in(&t.scene->all, &rng, x);
            for (int k = 0; k < 3; k++)
                x[k] = rint(x[k] * 0x1p16) / 0x1p16;
            test_ok(context, add_point(context, &t, x));
            test_ok(context, shadow_of(&t, place, point, &patch));
            if (patch != SHADOW_NONE) {
                found++;
                check_shadow(&t, &t.places.data[place], x, patch, &rng);
                for (uint32_t other = 0; other < t.places.count; other++)
                    blind += !t.places.data[other].outside &&
                             compare_blind(&t, &c, place, other, x, patch);
            }
            check_entries(&t, &c, &t.places.data[place], x);
        }
        shadow_tables_free(&t);
        free_checker(&c);
        starg_solid_free(solid);
        test_context_free(context);
    }
    print_message("%zu shadows, %zu places blind for them\n", found, blind);
    assert_true(found >= 20 && blind >= 20);
}

/* ---- proofs ---- */

/* Does verify agree to a certificate, about the faces of a solid at these vertices? */
static bool is_agreed_to(starg_context *context, const starg_solid *solid, const char *text,
                         size_t size) {
    verify_surface *surface;
    verify_tree *tree;
    starg_certificate *read;
    starg_verdict *verdict;
    if (starg_certificate_read_memory(context, text, size, "test", &read) != STARG_OK)
        return false;
    test_ok(context, verify_surface_create(context, starg_solid_mesh(solid), &surface));
    test_ok(context, verify_tree_create(surface, &tree));
    test_ok(context, verify_verdict_create(context, &verdict));
    const verify_facts known = {.surface = surface, .tree = tree};
    test_ok(context, verify_claim_pairs(verdict, &known, read));
    bool agreed = verdict->passed;
    starg_verdict_free(context, verdict);
    verify_tree_free(tree);
    verify_surface_free(surface);
    starg_certificate_free(read);
    return agreed;
}

/* Changes a random digit of the certificate behind its head, and leaves lines as they are. */
static void change_digit(char *text, size_t size, starg_rng *rng) {
    const size_t head = (size_t)(strstr(text, "root") - text);
    size_t at;
    do
        at = head + (size_t)starg_rng_below(rng, size - head);
    while (text[at] < '2' || text[at] > '9');
    text[at] = (char)('0' + ((text[at] - '0') + 1 + (int)starg_rng_below(rng, 8)) % 10);
}

/* Most changes of one digit are noticed; a face may be replaced by another that does as well. */
static void check_changes(starg_context *context, const starg_solid *solid, const two_pieces *two,
                          starg_rng *rng, size_t noticed[2]) {
    char *text = starg_allocate(context, two->size + 1, 1);
    assert_non_null(text);
    for (int i = 0; i < 20; i++) {
        memcpy(text, two->certificate, two->size + 1);
        change_digit(text, two->size, rng);
        noticed[!is_agreed_to(context, solid, text, two->size)]++;
    }
    starg_release(context, text);
}

static size_t pieces_of(starg_context *context, const starg_solid *solid) {
    starg_decompose_options options;
    starg_decomposition *pieces;
    starg_decompose_options_default(&options);
    options.effort = EFFORT;
    test_ok(context, starg_decompose(context, solid, &options, &pieces));
    size_t count = pieces->piece_count;
    starg_decomposition_free(context, pieces);
    return count;
}

static void test_proofs(void **state) {
    (void)state;
    size_t proven = 0, cut = 0, noticed[2] = {0, 0};
    for (uint64_t seed = 95; seed < 95 + at_least(10, test_rounds(14, 140)); seed++) {
        starg_context *context = test_context(1);
        starg_solid *solid = make_solid(context, seed, 0.4);
        two_pieces two;
        test_ok(context, two_pieces_exclude(context, solid, WORK, true, &two));
        const size_t pieces = pieces_of(context, solid);
        cut += pieces == 2;
        assert_true(!two.excluded || pieces > 2);
        assert_true(two.excluded == (two.certificate != NULL));
        if (two.excluded) {
            proven++;
            starg_rng rng = starg_rng_make(seed, 3, 3);
            assert_true(is_agreed_to(context, solid, two.certificate, two.size));
            check_changes(context, solid, &two, &rng, noticed);
        }
        starg_release(context, two.certificate);
        starg_solid_free(solid);
        test_context_free(context);
    }
    print_message("%zu solids with a proof, %zu cut in two; %zu of %zu changes noticed\n", proven,
                  cut, noticed[1], noticed[0] + noticed[1]);
    assert_true(proven >= 1 && cut >= 2 && noticed[1] > 2 * noticed[0]);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_shadows),
                                       cmocka_unit_test(test_proofs)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
