/* SPDX-License-Identifier: Apache-2.0 */
/* The search over every point of a solid: its guards see everything, no dense sample of points has
 * a cover below its bound, and its bytes do not depend on threads. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/bits.h"
#include "core/rng.h"
#include "geometry/vec3.h"
#include "guard/cells.h"
#include "guard/search_parts.h"
#include "guard/stages.h"
#include "models.h"
#include "shapes.h"
#include "starguard/sample.h"
#include "starguard/visibility.h"

enum { SAMPLE = 1500 };

static starg_guard_options proving(uint64_t work) {
    starg_guard_options options;
    starg_guard_options_default(&options);
    options.candidate_count = 60;
    options.refine_lines = 20000;
    options.prove = true;
    options.prove_work = work;
    return options;
}

/* Half of them anywhere in the box, half near a guard; from outside starg_visibility sees
 * nothing. */
static void sample_points(const starg_solid *solid, const starg_guards *guards, uint64_t item,
                          double *points) {
    const starg_mesh *mesh = starg_solid_mesh(solid);
    starg_rng rng = starg_rng_make(5, 9, item);
    double lower[3] = {INFINITY, INFINITY, INFINITY}, upper[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < 3 * starg_mesh_vertex_count(mesh); i++) {
        lower[i % 3] = fmin(lower[i % 3], starg_mesh_vertices(mesh)[i]);
        upper[i % 3] = fmax(upper[i % 3], starg_mesh_vertices(mesh)[i]);
    }
    for (size_t i = 0; i < SAMPLE; i++) {
        const double *near = guards->positions + 3 * (i % guards->count);
        double reach = i < guards->count ? 0 : pow(0.5, (double)(i % 7));
        for (size_t k = 0; k < 3; k++) {
            double at = starg_rng_unit(&rng), side = upper[k] - lower[k];
            points[3 * i + k] = i % 2 == 0 && i >= guards->count
                                    ? lower[k] + at * side
                                    : near[k] + reach * (at - 0.5) * side;
        }
    }
}

/* What the first rows hold together. The caller frees it. */
static uint64_t *union_of(const starg_bits *rows, size_t count) {
    uint64_t *all = calloc(rows->words, sizeof *all);
    assert_non_null(all);
    for (size_t i = 0; i < count; i++)
        for (size_t w = 0; w < rows->words; w++)
            all[w] |= starg_bits_row(rows, i)[w];
    return all;
}

/* Does no row that holds `column` hold one of `others` too? */
static bool is_apart(const starg_bits *rows, size_t column, const size_t *others, size_t count) {
    for (size_t i = 0; i < rows->rows; i++)
        for (size_t k = 0; k < count && starg_bits_test(rows, i, column); k++)
            if (starg_bits_test(rows, i, others[k]))
                return false;
    return true;
}

/* Are there more than `most` columns of which no row holds two? Then `most` rows cannot cover
 * them. */
static bool packs_more(const starg_bits *rows, const uint64_t *left, size_t most) {
    size_t *packed = calloc(most + 1, sizeof *packed), count = 0;
    assert_non_null(packed);
    for (size_t j = 0; j < rows->columns && count <= most; j++)
        if (starg_bit_test(left, j) && is_apart(rows, j, packed, count))
            packed[count++] = j;
    free(packed);
    return count > most;
}

/* Do `most` rows cover all remaining columns? Tries the rows of the rarest column. */
static bool covers(const starg_bits *rows, const uint64_t *left, size_t most) {
    size_t rarest = SIZE_MAX, fewest = SIZE_MAX;
    for (size_t j = 0; j < rows->columns; j++) {
        size_t held = 0;
        if (!starg_bit_test(left, j))
            continue;
        for (size_t i = 0; i < rows->rows && most > 0; i++)
            held += starg_bits_test(rows, i, j);
        if (held < fewest) {
            fewest = held;
            rarest = j;
        }
    }
    if (rarest == SIZE_MAX)
        return true;
    if (most == 0 || packs_more(rows, left, most))
        return false;
    uint64_t *rest = calloc(rows->words, sizeof *rest);
    assert_non_null(rest);
    bool found = false;
    for (size_t i = 0; i < rows->rows && most > 0 && !found; i++) {
        if (!starg_bits_test(rows, i, rarest))
            continue;
        for (size_t w = 0; w < rows->words; w++)
            rest[w] = left[w] & ~starg_bits_row(rows, i)[w];
        found = covers(rows, rest, most - 1);
    }
    free(rest);
    return found;
}

static bool is_within(const starg_bits *rows, size_t a, size_t b) {
    uint64_t outside = 0;
    for (size_t w = 0; w < rows->words; w++)
        outside |= starg_bits_row(rows, a)[w] & ~starg_bits_row(rows, b)[w];
    return outside == 0;
}

/* Drops rows contained in others, which can replace them. */
static void keep_largest(starg_bits *rows) {
    size_t kept = 0;
    for (size_t i = 0; i < rows->rows; i++) {
        bool needless = false;
        for (size_t j = 0; j < rows->rows && !needless; j++)
            needless = (j < kept || j > i) && is_within(rows, i, j) &&
                       (j < kept || !is_within(rows, j, i));
        if (!needless)
            memmove(starg_bits_row_mutable(rows, kept++), starg_bits_row(rows, i),
                    rows->words * sizeof *rows->data);
    }
    rows->rows = kept;
}

/* The sample includes the guards, so that it sees everything that they see. */
static void check_bound(starg_context *context, const starg_solid *solid,
                        const starg_guards *guards, uint64_t item) {
    double *points = calloc(3 * SAMPLE, sizeof *points);
    starg_visibility_options view = guards->options.visibility;
    starg_bits *rows = NULL;
    assert_non_null(points);
    sample_points(solid, guards, item, points);
    view.engine = STARG_VISIBILITY_BVH;
    test_ok(context, starg_visibility(context, solid, points, SAMPLE, &view, &rows));
    uint64_t *seen = union_of(rows, guards->count);
    keep_largest(rows);
    assert_true(guards->lower_bound_everywhere >= 1);
    assert_true(guards->lower_bound_everywhere <= guards->count);
    assert_true(guards->optimal_everywhere == (guards->lower_bound_everywhere == guards->count));
    assert_true(guards->lower_bound >= guards->lower_bound_everywhere);
    assert_false(covers(rows, seen, guards->lower_bound_everywhere - 1));
    starg_bits_free(rows);
    free(seen);
    free(points);
}

/* Never more guards than without the search. */
static void check_solid(starg_context *context, const starg_solid *solid,
                        starg_guard_options options, uint64_t item) {
    starg_guards *best = test_guard(context, solid, &options);
    options.prove = false;
    starg_guards *first = test_guard(context, solid, &options);
    assert_true(best->count <= first->count);
    assert_true(best->coverage_faces >= first->coverage_faces);
    check_bound(context, solid, best, item);
    starg_guards_free(context, best);
    starg_guards_free(context, first);
}

static void test_random_solids(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    size_t solids = 0, rounds = test_rounds(6, 200);
    for (uint64_t item = 0; item < rounds; item++) {
        shape s = item % 3 == 0 ? shape_blob(2, item) : shape_heap(4, item);
        starg_mesh *mesh = test_mesh_of(context, &s);
        starg_solid *solid = NULL;
        if (starg_solid_create(context, mesh, &solid) == STARG_OK) {
            check_solid(context, solid, proving(300000), item);
            starg_solid_free(solid);
            solids++;
        }
        starg_mesh_free(mesh);
        shape_free(&s);
    }
    assert_true(solids > rounds / 2);
    test_context_free(context);
}

/* By default too, with the few cells that refinement cuts, bounds are no more than the guards, and
 * the one for any places no more than that for the candidates. */
static void check_default(starg_context *context, const starg_solid *solid, size_t *bounded) {
    starg_guard_options options;
    starg_guard_options_default(&options);
    starg_guards *first = test_guard(context, solid, &options);
    assert_true(first->lower_bound_everywhere <= first->lower_bound);
    assert_true(first->lower_bound <= first->count);
    assert_true(first->optimal == (first->lower_bound == first->count));
    *bounded += first->lower_bound_everywhere > 1;
    starg_guards_free(context, first);
}

static void test_default_bounds(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t bounded = 0;
    for (size_t vertices = 500; vertices <= 800; vertices += 300) {
        starg_solid *solid = test_sample(context, "torus", vertices);
        check_default(context, solid, &bounded);
        starg_solid_free(solid);
    }
    assert_true(bounded > 0);
    /* closed by a program over all faces, whose bound is remembered */
    starg_solid *solid = test_sample(context, "octopus", 1000);
    check_default(context, solid, &bounded);
    starg_solid_free(solid);
    test_context_free(context);
}

/* Vertices, a range, whole faces, and a distance from the walls. */
static void test_questions(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    shape s = shape_columns();
    starg_solid *solid = test_solid_of(context, &s);
    for (int question = 0; question < 4; question++) {
        starg_guard_options options = proving(100000);
        if (question == 0)
            options.visibility.target = STARG_TARGET_VERTICES;
        else if (question == 1)
            options.visibility.range = 3;
        else if (question == 2)
            options.visibility.face_rule = STARG_FACES_WHOLE;
        else
            options.clearance = 0.2;
        check_solid(context, solid, options, (uint64_t)question);
    }
    starg_solid_free(solid);
    shape_free(&s);
    test_context_free(context);
}

/* Witnesses from number `from` to `to`: faces at a fixed stride. */
static void add_faces(starg_context *context, search_scene *scene, search_cells *cells, size_t from,
                      size_t to) {
    size_t faces = starg_mesh_face_count(starg_solid_mesh(scene->solid));
    starg_status status = STARG_OK;
    uint64_t work = 0;
    for (size_t j = from; j < to; j++)
        STARG_PUSH(context, "test", &scene->witnesses, (uint32_t)(j * 7 % faces));
    test_ok(context, cells_look(scene, cells, from, &work));
done:
    test_ok(context, status);
}

/* The leaf that contains p. */
static const search_cell *leaf_of(const search_cells *cells, const double p[3]) {
    const search_cell *cell = cells->data;
    while (cell->children != 0) {
        const search_cell *part = &cells->data[cell->children];
        for (int k = 0; k < 3; k++)
            if (p[k] < part->box.lower[k] || p[k] > part->box.upper[k]) {
                part = &cells->data[cell->children + 1];
                break;
            }
        cell = part;
    }
    return cell;
}

/* No point sees a witness that is marked as hidden from its leaf, whichever came first, the witness
 * or the leaf; and a good part of what is hidden is found. */
static void test_cells_hold_their_points(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_solid *solid = test_sample(context, "gallery", 500);
    starg_visibility_options view;
    search_scene scene = {0};
    search_cells cells = {0};
    search_points points = {0};
    starg_bits *rows = NULL;
    uint64_t work = 0;
    starg_visibility_options_default(&view);
    view.engine = STARG_VISIBILITY_BVH;
    test_ok(context, search_scene_open(context, solid, &view, 0, &scene));
    test_ok(context, cells_begin(&scene, &cells));
    add_faces(context, &scene, &cells, 0, 60);
    for (size_t round = 0; round < 9; round++) {
        uint32_t leaves[600];
        size_t count = 0;
        for (size_t i = 0; i < cells.count && count < 600; i++)
            if (cells.data[i].children == 0)
                leaves[count++] = (uint32_t)i;
        test_ok(context, cells_split(&scene, &cells, leaves, count, 2, &points, &work));
        if (round == 5)
            add_faces(context, &scene, &cells, 60, 120);
    }
    assert_true(points.count > 200);
    double *places = calloc(3 * points.count, sizeof *places);
    assert_non_null(places);
    for (size_t i = 0; i < points.count; i++)
        memcpy(places + 3 * i, points.data[i].place, sizeof points.data[i].place);
    test_ok(context, starg_visibility(context, solid, places, points.count, &view, &rows));
    size_t hidden = 0, unseen = 0;
    for (size_t i = 0; i < points.count; i++) {
        const search_cell *leaf = leaf_of(&cells, places + 3 * i);
        for (size_t j = 0; j < scene.witnesses.count; j++) {
            bool sees = starg_bits_test(rows, i, scene.witnesses.data[j]);
            bool open = starg_bit_test(leaf->open.bits, j);
            assert_true(open || !sees);
            hidden += !open;
            unseen += !sees;
        }
    }
    assert_true(2 * hidden > unseen);
    starg_bits_free(rows);
    free(places);
    STARG_ARRAY_FREE(context, &points);
    STARG_ARRAY_FREE(context, &cells);
    search_scene_close(&scene);
    starg_solid_free(solid);
    test_context_free(context);
}

/* Points proposed at the wall are inside but for few (where other walls are nearer than they are
 * high), no higher than 0.002 diagonals, at heights of all three orders of magnitude below that,
 * and rather near the witness than anywhere, of faces as of vertices. */
static void test_places_at_walls(void **state) {
    (void)state;
    enum { PROPOSALS = 2000 };
    static const starg_target TARGETS[] = {STARG_TARGET_FACES, STARG_TARGET_VERTICES};
    starg_context *context = test_context(1);
    starg_solid *solid = test_sample(context, "horse", 1000);
    for (size_t t = 0; t < 2; t++) {
        starg_visibility_options view;
        search_scene scene = {0};
        search_point best = {.place = {0}}, point;
        starg_rng rng = starg_rng_make(5, 6, t);
        size_t inside = 0, near = 0, decade[3] = {0};
        double centre[3];
        starg_visibility_options_default(&view);
        view.target = TARGETS[t];
        test_ok(context, search_scene_open(context, solid, &view, 0, &scene));
        starg_status status = STARG_OK;
        STARG_PUSH(context, "test", &scene.witnesses, 321);
        search_scene_centre(&scene, 0, centre);
        const bvh_box *all = &scene.points->all;
        double diagonal = vec3_distance(all->lower, all->upper);
        for (size_t k = 0; k < PROPOSALS; k++) {
            search_propose(&scene, &best, 0, NULL, STAND_AT_WALL, 1, &rng, &point);
            double height = starg_solid_distance(solid, point.place) / diagonal;
            assert_true(height < 2.001e-3);
            inside += starg_solid_contains(solid, point.place);
            near += vec3_distance(point.place, centre) < diagonal / 8;
            decade[height > 2e-4 ? 0 : height > 2e-5 ? 1 : 2]++;
        }
        assert_true(inside > PROPOSALS * 9 / 10);
        assert_true(near > PROPOSALS / 3 && near < PROPOSALS);
        for (int k = 0; k < 3; k++)
            assert_true(decade[k] > PROPOSALS / 5);
    done:
        test_ok(context, status);
        search_scene_close(&scene);
    }
    starg_solid_free(solid);
    test_context_free(context);
}

static char *bytes_with(int threads, size_t *size) {
    starg_context *context = test_context(threads);
    starg_solid *solid = test_sample(context, "gallery", 500);
    starg_guard_options options = proving(300000);
    starg_guards *guards = NULL;
    char *text = NULL, *copy;
    test_ok(context, starg_guard(context, solid, &options, &guards));
    test_ok(context, starg_guards_write_memory(context, guards, "gallery.off", &text, size));
    copy = malloc(*size);
    assert_non_null(copy);
    memcpy(copy, text, *size);
    starg_text_free(context, text);
    starg_guards_free(context, guards);
    starg_solid_free(solid);
    test_context_free(context);
    return copy;
}

static void test_same_bytes(void **state) {
    (void)state;
    size_t size, other;
    char *first = bytes_with(1, &size);
    for (int threads = (int)test_size(7, 2); threads <= 7; threads += 5) {
        char *again = bytes_with(threads, &other);
        assert_int_equal(size, other);
        assert_memory_equal(first, again, size);
        free(again);
    }
    free(first);
}

/* More work never proves less, nor does it end with more guards. */
static void test_more_work(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_solid *solid = test_sample(context, "horse", 500);
    size_t bound = 0, count = SIZE_MAX;
    for (uint64_t work = 20000; work < 400000; work *= 2) {
        starg_guard_options options = proving(work);
        starg_guards *guards = test_guard(context, solid, &options);
        assert_true(guards->lower_bound_everywhere >= bound);
        assert_true(guards->count <= count);
        bound = guards->lower_bound_everywhere;
        count = guards->count;
        starg_guards_free(context, guards);
    }
    starg_solid_free(solid);
    test_context_free(context);
}

/* About reflex edges boxes see more than any point, however small they are. If boxes never counted
 * as points in the prices, neither small ones nor in the end all, they would be split there until
 * the work is used up, and one guard less would be proven. */
static void test_limits_of_sight(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    static const char *const names[] = {"labyrinth", "gallery"};
    for (size_t i = 0; i < 2; i++) {
        starg_solid *solid = test_sample(context, names[i], 500);
        starg_guard_options options = proving(300000);
        starg_guards *guards = test_guard(context, solid, &options);
        assert_true(guards->lower_bound_everywhere >= 3 + i);
        starg_guards_free(context, guards);
        starg_solid_free(solid);
    }
    test_context_free(context);
}

/* One guard in the kernel is enough, with or without the search, and is reported as such. */
static void test_star_shaped(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape s = shape_blob(2, 7);
    starg_solid *solid = test_solid_of(context, &s);
    starg_guard_options options;
    starg_guard_options_default(&options);
    starg_guards *guards = test_guard(context, solid, &options);
    assert_int_equal(guards->count, 1);
    assert_int_equal(guards->lower_bound_everywhere, 1);
    assert_true(guards->optimal_everywhere && guards->optimal);
    starg_guards_free(context, guards);
    starg_solid_free(solid);
    shape_free(&s);
    test_context_free(context);
}

/* ---- other kinds of question ---- */

/* A dense sample near and far from the guards, and what its points see in all directions; only
 * points with a maximal view. */
static starg_bits *sample_rows(starg_context *context, const starg_solid *solid,
                               const starg_guards *guards, uint64_t item) {
    double *points = calloc(3 * SAMPLE, sizeof *points);
    starg_visibility_options view = guards->options.visibility;
    starg_bits *rows = NULL;
    assert_non_null(points);
    sample_points(solid, guards, item, points);
    view.engine = STARG_VISIBILITY_BVH;
    view.cone = 360;
    test_ok(context, starg_visibility(context, solid, points, SAMPLE, &view, &rows));
    free(points);
    keep_largest(rows);
    return rows;
}

/* Can `most` rows, some of them possibly repeated, cover each column as often as still needed? */
static bool holds_often(const starg_bits *rows, const uint8_t *left, size_t most) {
    size_t rarest = SIZE_MAX, fewest = SIZE_MAX;
    for (size_t j = 0; j < rows->columns; j++) {
        size_t held = 0;
        if (left[j] == 0)
            continue;
        for (size_t i = 0; i < rows->rows && most > 0; i++)
            held += starg_bits_test(rows, i, j);
        if (held < fewest) {
            fewest = held;
            rarest = j;
        }
    }
    if (rarest == SIZE_MAX)
        return true;
    uint8_t *rest = calloc(rows->columns, 1);
    assert_non_null(rest);
    bool found = false;
    for (size_t i = 0; i < rows->rows && most > 0 && !found; i++) {
        if (!starg_bits_test(rows, i, rarest))
            continue;
        for (size_t j = 0; j < rows->columns; j++)
            rest[j] = (uint8_t)(left[j] - (left[j] > 0 && starg_bits_test(rows, i, j)));
        found = holds_often(rows, rest, most - 1);
    }
    free(rest);
    return found;
}

/* The largest fraction of the area that one or two of the rows cover. */
static double largest_area(const starg_solid *solid, const starg_bits *rows, size_t count) {
    const starg_mesh *mesh = starg_solid_mesh(solid);
    double *areas = calloc(rows->columns, sizeof *areas), total = 0, most = 0;
    assert_non_null(areas);
    for (size_t f = 0; f < rows->columns; f++) {
        const uint32_t *c = starg_mesh_faces(mesh) + 3 * f;
        const double *v = starg_mesh_vertices(mesh);
        areas[f] =
            vec3_triangle_area(v + 3 * (size_t)c[0], v + 3 * (size_t)c[1], v + 3 * (size_t)c[2]);
        total += areas[f];
    }
    assert_in_range(count, 1, 2);
    for (size_t i = 0; i < rows->rows; i++)
        for (size_t k = count == 1 ? i : 0; k <= i; k++) {
            double area = 0;
            for (size_t w = 0; w < rows->words; w++)
                STARG_FOR_BITS (bit, starg_bits_row(rows, i)[w] | starg_bits_row(rows, k)[w])
                    area += areas[64 * w + bit];
            most = fmax(most, area);
        }
    free(areas);
    return most / total;
}

static starg_solid *columns_solid(starg_context *context) {
    shape s = shape_columns();
    starg_solid *solid = test_solid_of(context, &s);
    shape_free(&s);
    return solid;
}

/* That many guards see no more than the bound, and neither do any two of a dense sample. */
static void test_number_given(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_solid *solid = columns_solid(context);
    for (size_t most = 1; most <= 2; most++) {
        starg_guard_options options = proving(800000);
        options.max_guards = most;
        starg_guards *guards = test_guard(context, solid, &options);
        starg_bits *rows = sample_rows(context, solid, guards, most);
        assert_int_equal(guards->lower_bound_everywhere, 0);
        assert_false(guards->optimal_everywhere);
        assert_true(guards->area_bound_everywhere < 1);
        assert_true(guards->coverage_area <= guards->area_bound_everywhere * (1 + 1e-9));
        assert_true(largest_area(solid, rows, most) <= guards->area_bound_everywhere * (1 + 1e-9));
        starg_bits_free(rows);
        starg_guards_free(context, guards);
    }
    starg_solid_free(solid);
    test_context_free(context);
}

/* Fewer guards than the bound do not see the requested part. */
static void test_part_of_the_area(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_solid *solid = columns_solid(context);
    size_t told = 0;
    for (int part = 6; part <= 9; part++) {
        starg_guard_options options = proving(600000);
        options.coverage = part / 10.0;
        starg_guards *guards = test_guard(context, solid, &options);
        starg_bits *rows = sample_rows(context, solid, guards, (uint64_t)part);
        size_t fewer = guards->lower_bound_everywhere - 1;
        assert_int_equal(guards->coverable_faces, guards->face_count);
        assert_in_range(guards->lower_bound_everywhere, 1, guards->count);
        assert_true(guards->lower_bound >= guards->lower_bound_everywhere);
        if (fewer > 0)
            assert_true(largest_area(solid, rows, fewer < 2 ? fewer : 2) < options.coverage);
        told += fewer;
        starg_bits_free(rows);
        starg_guards_free(context, guards);
    }
    assert_true(told > 0);
    starg_solid_free(solid);
    test_context_free(context);
}

/* Fewer guards than the bound do not see twice everything that the guards see twice. */
static void test_several_guards_a_face(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_solid *solid = columns_solid(context);
    starg_guard_options options = proving(500000);
    options.redundancy = 2;
    starg_guards *guards = test_guard(context, solid, &options);
    starg_bits *rows = sample_rows(context, solid, guards, 3);
    starg_bits *own = NULL;
    uint8_t *wanted = calloc(rows->columns, 1);
    assert_non_null(wanted);
    test_ok(context, starg_visibility(context, solid, guards->positions, guards->count,
                                      &options.visibility, &own));
    for (size_t j = 0; j < rows->columns; j++) {
        for (size_t i = 0; i < guards->count && wanted[j] < 2; i++)
            wanted[j] = (uint8_t)(wanted[j] + starg_bits_test(own, i, j));
        assert_int_equal(wanted[j], 2);
    }
    assert_in_range(guards->lower_bound_everywhere, 3, guards->count);
    assert_false(holds_often(rows, wanted, guards->lower_bound_everywhere - 1));
    free(wanted);
    starg_bits_free(own);
    starg_bits_free(rows);
    starg_guards_free(context, guards);
    starg_solid_free(solid);
    test_context_free(context);
}

/* The fewest of the given candidates, the only places allowed, compared with a bound for guards
 * anywhere; the method does not matter. */
static void test_given_candidates(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_solid *solid = columns_solid(context);
    double points[3 * 40];
    const starg_mesh *mesh = starg_solid_mesh(solid);
    double lower[3], upper[3];
    starg_rng rng = starg_rng_make(4, 4, 4);
    size_t count = 0;
    starg_mesh_bounds(mesh, lower, upper);
    while (count < 40) {
        for (size_t k = 0; k < 3; k++)
            points[3 * count + k] = lower[k] + starg_rng_unit(&rng) * (upper[k] - lower[k]);
        count += starg_solid_contains(solid, points + 3 * count);
    }
    for (int method = 0; method < 3; method++) {
        starg_guard_options options = proving(400000);
        starg_bits *rows = NULL;
        options.method = (starg_guard_method)method;
        options.candidates = STARG_CANDIDATES_GIVEN;
        options.points = points;
        options.point_count = count;
        starg_guards *guards = test_guard(context, solid, &options);
        test_ok(context,
                starg_visibility(context, solid, points, count, &options.visibility, &rows));
        uint64_t *all = union_of(rows, count);
        assert_int_equal(guards->candidate_count, count);
        assert_true(guards->optimal);
        assert_true(covers(rows, all, guards->count) && !covers(rows, all, guards->count - 1));
        for (size_t g = 0; g < guards->count; g++) {
            bool given = false;
            for (size_t i = 0; i < count; i++)
                given = given ||
                        memcmp(points + 3 * i, guards->positions + 3 * g, 3 * sizeof *points) == 0;
            assert_true(given);
        }
        check_bound(context, solid, guards, (uint64_t)method);
        free(all);
        starg_bits_free(rows);
        starg_guards_free(context, guards);
    }
    starg_solid_free(solid);
    test_context_free(context);
}

/* A comb: a corridor with a chamber at each end of each tooth, behind a corner. */
static starg_solid *comb_solid(starg_context *context, uint64_t seed) {
    enum { TEETH = 7, WIDTH = 3 * TEETH, HEIGHT = 9 };
    char cells[WIDTH * HEIGHT];
    starg_rng rng = starg_rng_make(6, 2, seed);
    memset(cells, ' ', sizeof cells);
    memset(cells + WIDTH * (HEIGHT / 2), '#', WIDTH);
    for (int tooth = 0; tooth < TEETH; tooth++) {
        int down = (int)starg_rng_below(&rng, 3) + 1, up = (int)starg_rng_below(&rng, 3) + 1;
        for (int y = HEIGHT / 2 - down; y <= HEIGHT / 2 + up; y++)
            cells[3 * tooth + WIDTH * y] = '#';
        cells[3 * tooth + 1 + WIDTH * (HEIGHT / 2 - down)] = '#';
        cells[3 * tooth + 1 + WIDTH * (HEIGHT / 2 + up)] = '#';
    }
    shape s = shape_cells(cells, WIDTH, HEIGHT, 1);
    starg_mesh *mesh = test_mesh_of(context, &s);
    starg_solid *solid = NULL;
    test_ok(context, starg_solid_create(context, mesh, &solid));
    starg_mesh_free(mesh);
    shape_free(&s);
    return solid;
}

/* A pool of random candidates, augmented, and the greedy choice of them. */
static void choose_poorly(const guard_problem *problem, uint64_t seed, guard_pool *pool,
                          guard_selection *selection) {
    const choice how = {.method = STARG_COVER_GREEDY};
    starg_context *context = problem->context;
    candidate_points points = {0};
    double lower[3], upper[3];
    starg_rng rng = starg_rng_make(4, 4, seed);
    starg_cover *cover = NULL;
    starg_mesh_bounds(starg_solid_mesh(problem->solid), lower, upper);
    while (candidates_count(&points) < 60) {
        double p[3];
        for (size_t k = 0; k < 3; k++)
            p[k] = lower[k] + starg_rng_unit(&rng) * (upper[k] - lower[k]);
        if (starg_solid_contains(problem->solid, p))
            test_ok(context, candidates_push(context, &points, p, NULL));
    }
    test_ok(context, pool_create(context, problem->solid, problem->options, pool));
    test_ok(context, pool_add(pool, &points));
    test_ok(context, pool_augment(pool, &problem->weights));
    test_ok(context, choose_candidates(pool, &problem->weights, &how, &cover));
    test_ok(context, selection_of_cover(context, cover, &(guard_selection){0}, 0, selection));
    starg_cover_free(cover);
    candidates_free(&points);
}

/* The bound for candidates is one for those of the end, of which the search closes its rounds three
 * times with so many guards. */
static void test_last_candidates(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    size_t fewer = 0;
    for (uint64_t seed = 0; seed < test_rounds(2, 4); seed++) {
        starg_solid *solid = comb_solid(context, seed);
        starg_guard_options options = proving(0);
        guard_problem problem = {.context = context, .solid = solid, .options = &options};
        guard_pool pool = {0};
        guard_selection selection = {0};
        search_record record = {0};
        options.prove = false;
        options.refine_lines = 3000000;
        test_ok(context,
                column_weights_create(context, solid, options.visibility.target, &problem.weights));
        choose_poorly(&problem, seed, &pool, &selection);
        size_t before = selection.chosen.count;
        assert_true(before >= 12);
        test_ok(context,
                search_guards(&problem, &(guard_detail){0}, true, &pool, &selection, &record));
        fewer += selection.chosen.count < before;
        assert_in_range(selection.lower_bound, 1, selection.chosen.count);
        keep_largest(pool.rows);
        uint64_t *seen = union_of(pool.rows, pool.rows->rows);
        assert_false(covers(pool.rows, seen, selection.lower_bound - 1));
        free(seen);
        starg_release(context, record.steps);
        selection_free(&selection);
        pool_free(&pool);
        column_weights_free(&problem.weights);
        starg_solid_free(solid);
    }
    assert_true(fewer > 0);
    test_context_free(context);
}

/* What cameras cannot do in all directions, they cannot do in one. */
static void test_cone(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_solid *solid = columns_solid(context);
    starg_guard_options options = proving(400000);
    options.candidate_count = 20;
    options.visibility.cone = 120;
    starg_guards *guards = test_guard(context, solid, &options);
    starg_bits *rows = sample_rows(context, solid, guards, 5);
    starg_bits *seen_rows = NULL;
    starg_visibility_options view = guards->options.visibility;
    view.directions = guards->directions;
    test_ok(context,
            starg_visibility(context, solid, guards->positions, guards->count, &view, &seen_rows));
    uint64_t *seen = union_of(seen_rows, guards->count);
    assert_in_range(guards->lower_bound_everywhere, 2, guards->count);
    assert_false(covers(rows, seen, guards->lower_bound_everywhere - 1));
    free(seen);
    starg_bits_free(rows);
    starg_bits_free(seen_rows);
    starg_guards_free(context, guards);
    starg_solid_free(solid);
    test_context_free(context);
}

/* A list of rows of few witnesses says of each random row whether one of the list holds all of it
 * among some witnesses, as comparing them one by one does. */
static void test_rows_held(void **state) {
    (void)state;
    enum { ROWS = 150, WITNESSES = 90, LISTS = 20 };
    starg_context *context = test_context(1);
    starg_rng rng = starg_rng_make(6, 1, 0);
    size_t answers[2] = {0, 0};
    for (size_t n = 0; n < test_rounds(LISTS, 10 * LISTS); n++) {
        static witness_row rows[ROWS];
        const witness_row *places[ROWS];
        uint32_t names[ROWS];
        row_list list = {.context = context, .rows = places, .names = names};
        const uint64_t sparse = 2 + starg_rng_below(&rng, 8);
        memset(rows, 0, sizeof rows);
        for (size_t i = 0; i < ROWS; i++) {
            witness_row among = {{0}};
            bool held = false;
            for (size_t j = 0; j < WITNESSES; j++) {
                if (starg_rng_below(&rng, sparse) == 0)
                    starg_bit_set(rows[i].bits, j);
                if (starg_rng_below(&rng, 12) == 0)
                    starg_bit_set(among.bits, j);
            }
            for (size_t k = 0; k < list.count && !held; k++) {
                held = true;
                for (size_t j = 0; j < WITNESSES; j++)
                    held = held &&
                           (!starg_bit_test(rows[i].bits, j) || !starg_bit_test(among.bits, j) ||
                            starg_bit_test(places[k]->bits, j));
            }
            assert_int_equal(row_list_holds(&list, &rows[i], &among), held);
            test_ok(context, row_list_add(&list, &rows[i], i));
            answers[held]++;
            if (i == ROWS / 3 && n % 2 == 0)
                list.count = 0; /* from the beginning, in blocks that were used */
        }
        RELEASE(list.blocks.data);
    }
    assert_true(answers[0] > 100 && answers[1] > 100);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rows_held),
        cmocka_unit_test(test_random_solids),
        cmocka_unit_test(test_default_bounds),
        cmocka_unit_test(test_questions),
        cmocka_unit_test(test_cells_hold_their_points),
        cmocka_unit_test(test_places_at_walls),
        cmocka_unit_test(test_same_bytes),
        cmocka_unit_test(test_more_work),
        cmocka_unit_test(test_limits_of_sight),
        cmocka_unit_test(test_star_shaped),
        cmocka_unit_test(test_number_given),
        cmocka_unit_test(test_part_of_the_area),
        cmocka_unit_test(test_several_guards_a_face),
        cmocka_unit_test(test_given_candidates),
        cmocka_unit_test(test_last_candidates),
        cmocka_unit_test(test_cone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
