/* SPDX-License-Identifier: Apache-2.0 */
/* Operations on partitions: built, joined, sliced, merged, cut by a plan. After every step brute
 * force checks everything (partition_oracle.h). */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "exact_oracle.h"
#include "models.h"
#include "partition_oracle.h"
#include "star/certified/search.h"
#include "starguard/sample.h"
#include "tetrahedra.h"

enum { CUTS_MOST = 8 };

static double volume_of_all(const partition *p) {
    double sum = 0;
    for (uint32_t i = 0; i < p->pieces.count; i++)
        sum += partition_oracle_volume(p, i);
    return sum;
}

static double height_at(const partition_plane *plane, const double q[3]) {
    return plane->normal[0] * q[0] + plane->normal[1] * q[1] + plane->normal[2] * q[2] -
           plane->offset;
}

static double height_of(const partition *p, const partition_plane *plane, uint32_t vertex) {
    return height_at(plane, partition_unit(p, vertex));
}

static void replace(partition *p, partition *by) {
    partition_free(p);
    *p = *by;
}

/* ---- building ---- */

/* Facets are exactly the faces between labels and at the boundary. */
static void check_facets(const partition *p, const starg_tetmesh *mesh, const uint32_t *labels) {
    size_t expected = 0;
    for (size_t slot = 0; slot < 4 * mesh->count; slot++) {
        uint32_t beyond = mesh->neighbours[slot];
        if (beyond == STARG_TETMESH_NONE)
            expected += 2;
        else
            expected += labels[slot / 4] != labels[beyond];
    }
    assert_int_equal(2 * p->facets.count, expected);
    assert_int_equal(p->first_points, p->points.count / 3);
    for (size_t i = 0; i < p->unit.count; i++)
        assert_true(fabs(p->unit.data[i]) <= 0.5);
}

static void test_create(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (uint64_t seed = 0; seed < 40; seed++) {
        starg_rng rng = starg_rng_make(seed, 72, 0);
        starg_tetmesh *mesh = random_tetmesh(context, seed, 8 + seed, seed % 4 == 1, 1);
        size_t count = seed % 3 == 0 ? mesh->count : 1 + (size_t)starg_rng_below(&rng, mesh->count);
        uint32_t *labels = calloc(mesh->count, sizeof *labels);
        double *guards = calloc(3 * count, sizeof *guards);
        partition p;
        for (size_t t = 0; t < mesh->count; t++)
            labels[t] = (uint32_t)(t < count ? t : starg_rng_below(&rng, count));
        for (size_t i = 0; i < 3 * count; i++)
            guards[i] = starg_rng_unit(&rng);
        test_ok(context, partition_create(context, mesh, labels, guards, count, &p));
        partition_oracle_check(&p);
        check_facets(&p, mesh, labels);
        assert_int_equal(p.pieces.count, count);
        for (uint32_t i = 0; i < count; i++) {
            assert_memory_equal(p.pieces.data[i].guard, guards + 3 * i, 3 * sizeof *guards);
            assert_true(fabs(p.pieces.data[i].volume - partition_oracle_volume(&p, i)) < 1e-13);
        }
        double scale = ldexp(1, p.exponents[0] + p.exponents[1] + p.exponents[2]);
        assert_true(fabs(volume_of_all(&p) * scale - starg_tetmesh_volume(mesh)) < 1e-12 * scale);
        partition_free(&p);
        free(labels);
        free(guards);
        starg_tetmesh_free(mesh);
    }
    test_context_free(context);
}

/* A surface is one piece with its faces as facets, each in its own plane. */
static void test_create_from_surface(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (size_t i = 0; i < starg_sample_count(); i += test_step()) {
        if (starg_sample_at(i)->scene)
            continue;
        starg_solid *solid = test_sample(context, starg_sample_at(i)->name, 500);
        const starg_mesh *mesh = starg_solid_mesh(solid);
        const kernel_faces surface = {starg_mesh_vertices(mesh), starg_mesh_faces(mesh),
                                      starg_mesh_face_count(mesh)};
        partition p;
        test_ok(context, partition_create_from_surface(context, &surface, NULL, &p));
        partition_oracle_check(&p);
        assert_int_equal(p.pieces.count, 1);
        assert_int_equal(p.facets.count, surface.count);
        assert_int_equal(p.first_planes, surface.count);
        assert_int_equal(p.first_points, starg_mesh_vertex_count(mesh));
        assert_memory_equal(p.points.data, surface.vertices, 24 * p.first_points);
        for (size_t f = 0; f < surface.count; f++)
            assert_memory_equal(p.facets.data[f].corners, surface.faces + 3 * f, 12);
        double scale = ldexp(1, p.exponents[0] + p.exponents[1] + p.exponents[2]);
        assert_true(fabs(volume_of_all(&p) * scale - starg_mesh_volume(mesh)) < 1e-12 * scale);
        partition_free(&p);
        starg_solid_free(solid);
    }
    test_context_free(context);
}

static void test_gather(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    partition p = grown_sample(context, "torus", 1500);
    partition_oracle_check_guards(&p);
    for (uint32_t i = 0; i < p.pieces.count; i++) {
        partition_triangles triangles = {0};
        test_ok(context, partition_gather(&p, i, &triangles));
        assert_int_equal(triangles.count, 3 * (p.start.data[i + 1] - p.start.data[i]));
        double volume = partition_volume(&p, triangles.data, triangles.count / 3);
        assert_true(volume > 0);
        assert_true(fabs(volume - partition_oracle_volume(&p, i)) < 1e-13);
        const double *guard = p.pieces.data[i].guard;
        assert_true(partition_certify(&p, triangles.data, triangles.count / 3, guard));
        /* not with a guard behind one of the facets, nor without one of them */
        double behind[3];
        for (int k = 0; k < 3; k++)
            behind[k] = 3 * partition_point(&p, triangles.data[0])[k] - 2 * guard[k];
        assert_false(partition_certify(&p, triangles.data, triangles.count / 3, behind));
        STARG_ARRAY_FREE(context, &triangles);
    }
    partition_free(&p);
    test_context_free(context);
}

/* Being inside is not enough, nor is seeing all of a doubled surface. */
static void test_certify(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t certified = 0, others = 0;
    for (uint64_t seed = 0; seed < 8; seed++) {
        partition p = random_cells(context, seed, 5 + (size_t)seed);
        partition_triangles triangles = {0};
        uint32_t all[200];
        for (uint32_t i = 0; i < p.pieces.count; i++)
            all[i] = i;
        partition_join(&p, all, p.pieces.count);
        test_ok(context, partition_build_index(&p));
        test_ok(context, partition_gather(&p, 0, &triangles));
        size_t count = triangles.count / 3;
        test_ok(context, partition_gather(&p, 0, &triangles));
        for (size_t i = 0; i < p.pieces.count; i++) {
            const double *guard = p.pieces.data[i].guard;
            bool sees = true;
            for (size_t t = 0; t < count; t++)
                sees = sees &&
                       oracle_orient3d(partition_point(&p, triangles.data[3 * t]),
                                       partition_point(&p, triangles.data[3 * t + 1]),
                                       partition_point(&p, triangles.data[3 * t + 2]), guard) == 1;
            assert_int_equal(partition_certify(&p, triangles.data, count, guard), sees);
            assert_false(partition_certify(&p, triangles.data, 2 * count, guard));
            certified += sees;
            others += !sees;
        }
        STARG_ARRAY_FREE(context, &triangles);
        partition_free(&p);
    }
    assert_true(certified > 5 && others > 5);
    test_context_free(context);
}

/* ---- slicing ---- */

/* Slices a copy; returns whether that was possible. */
static bool slice(const partition *p, uint32_t low, const partition_plane *plane, partition *out) {
    bool done = false;
    piece fresh = {.volume = 0};
    starg_status status = STARG_OK;
    *out = partition_oracle_copy(p);
    STARG_PUSH(p->context, PARTITION_STAGE, &out->pieces, fresh);
    STARG_TRY(partition_slice(out, low, (uint32_t)out->pieces.count - 1, plane, &done));
done:
    test_ok(p->context, status);
    if (done)
        test_ok(p->context, partition_build_index(out));
    else
        partition_free(out);
    return done;
}

/* Both parts of a slice are on their sides, and the facets between them lie in the plane. */
static void check_slice(const partition *before, const partition *p, uint32_t low,
                        const partition_plane *plane) {
    uint32_t high = (uint32_t)p->pieces.count - 1;
    double whole = partition_oracle_volume(before, low), parts[2];
    size_t cap = 0;
    for (size_t i = 0; i < 2 * p->facets.count; i++) {
        const facet *f = &p->facets.data[i / 2];
        uint32_t owner = f->side[i % 2];
        bool between = f->side[FACET_INNER] == low && f->side[FACET_OUTER] == high;
        if (owner != low && owner != high)
            continue;
        for (int k = 0; k < 3; k++) {
            double height = height_of(p, plane, f->corners[k]);
            assert_true(owner == low ? height < SLICE_ON : height > -SLICE_ON);
            if (between)
                assert_true(fabs(height) < SLICE_ON);
        }
        if (between)
            assert_memory_equal(&p->planes.data[f->plane], plane, sizeof *plane);
        cap += between;
    }
    /* disconnected parts of the piece may be separated without a cut */
    assert_true(cap > 0 || p->facets.count == before->facets.count);
    parts[0] = partition_oracle_volume(p, low);
    parts[1] = partition_oracle_volume(p, high);
    assert_true(parts[0] > -1e-15 && parts[1] > -1e-15);
    assert_true(fabs(parts[0] + parts[1] - whole) < 1e-12);
    for (uint32_t i = 0; i < before->pieces.count; i++)
        if (i != low)
            assert_true(fabs(partition_oracle_volume(before, i) - partition_oracle_volume(p, i)) <
                        1e-13);
}

/* A plane through an edge of a piece, at a random angle. */
static partition_plane random_plane_through(const partition *p, uint32_t number, starg_rng *rng) {
    partition_plane plane = random_plane_across(p, number, rng);
    uint32_t facets = p->start.data[number + 1] - p->start.data[number];
    uint32_t entry = p->index.data[p->start.data[number] + starg_rng_below(rng, facets)];
    const uint32_t *corners = p->facets.data[entry / 2].corners;
    const double *a = partition_unit(p, corners[0]), *b = partition_unit(p, corners[1]);
    double edge[3], along = 0, squared = 0, length = 0;
    for (int k = 0; k < 3; k++) {
        edge[k] = b[k] - a[k];
        squared += edge[k] * edge[k];
        along += edge[k] * plane.normal[k];
    }
    for (int k = 0; k < 3; k++) {
        plane.normal[k] -= along / squared * edge[k];
        length += plane.normal[k] * plane.normal[k];
    }
    for (int k = 0; k < 3; k++)
        plane.normal[k] /= sqrt(length);
    plane.offset = 0;
    plane.offset = height_at(&plane, a);
    return plane;
}

/* Many planes one after the other, through pieces and through their parts. */
static void slice_often(const partition *first, uint64_t seed, size_t planes, size_t least) {
    starg_rng rng = starg_rng_make(seed, 73, 0);
    partition p = partition_oracle_copy(first), next;
    double whole = volume_of_all(first);
    size_t done = 0;
    for (size_t i = 0; i < planes; i++) {
        uint32_t low = (uint32_t)starg_rng_below(&rng, p.pieces.count);
        partition_plane plane = random_plane_across(&p, low, &rng);
        if (!slice(&p, low, &plane, &next))
            continue;
        partition_oracle_check(&next);
        check_slice(&p, &next, low, &plane);
        replace(&p, &next);
        done++;
    }
    assert_true(done >= least);
    assert_true(fabs(volume_of_all(&p) - whole) < 1e-12);
    partition_oracle_check_surface(first, &p);
    partition_free(&p);
}

static void test_slices_of_samples(void **state) {
    (void)state;
    static const char *const names[] = {"horse", "knot", "plate", "shell", "gallery"};
    starg_context *context = test_context(1);
    for (uint64_t i = 0; i < sizeof names / sizeof *names; i++) {
        partition p = grown_sample(context, names[i], 1500);
        slice_often(&p, i, 30, 22);
        /* as one piece, where a plane cuts many loops at once */
        uint32_t *all = calloc(p.pieces.count, sizeof *all);
        for (uint32_t k = 0; k < p.pieces.count; k++)
            all[k] = k;
        partition_join(&p, all, p.pieces.count);
        p.pieces.count = 1;
        test_ok(context, partition_build_index(&p));
        partition_oracle_check(&p);
        slice_often(&p, i, 30, 26);
        free(all);
        partition_free(&p);
    }
    test_context_free(context);
}

static void test_slices_of_hulls(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (uint64_t seed = 0; seed < 12; seed++) {
        partition p = random_hull(context, seed, 5 + 3 * (size_t)seed);
        slice_often(&p, seed, 40, 38);
        partition_free(&p);
    }
    test_context_free(context);
}

/* Planes through edges, which enter the piece there or touch it. No vertex is duplicated. */
static void test_slices_through_edges(void **state) {
    (void)state;
    static const char *const names[] = {"horse", "knot", "gallery"};
    starg_context *context = test_context(1);
    size_t done = 0, through = 0;
    for (uint64_t i = 0; i < 9; i++) {
        starg_rng rng = starg_rng_make(i, 75, 0);
        partition first = i < 3 ? grown_sample(context, names[i], 1500)
                                : random_hull(context, i, 8 + 4 * (size_t)i);
        partition p = partition_oracle_copy(&first), next;
        for (int turn = 0; turn < 40; turn++) {
            uint32_t low = (uint32_t)starg_rng_below(&rng, p.pieces.count);
            partition_plane plane = random_plane_through(&p, low, &rng);
            if (!slice(&p, low, &plane, &next))
                continue;
            partition_oracle_check(&next);
            check_slice(&p, &next, low, &plane);
            for (size_t f = 0; f < next.facets.count; f++) {
                const facet *cap = &next.facets.data[f];
                for (int k = 0; k < 3 && cap->plane == next.planes.count - 1; k++)
                    through += cap->corners[k] < p.points.count / 3;
            }
            replace(&p, &next);
            done++;
        }
        partition_oracle_check_surface(&first, &p);
        partition_free(&p);
        partition_free(&first);
    }
    assert_true(done > 120 && through > done / 2);
    test_context_free(context);
}

/* Planes through or nearly through a vertex, and planes that miss the piece, which are rejected. */
static void test_planes_at_vertices(void **state) {
    (void)state;
    static const double near[] = {0, 2e-12, -2e-12, 9e-10, -9e-10, 1e-8};
    starg_context *context = test_context(1);
    partition p = random_hull(context, 4, 20), next;
    starg_rng rng = starg_rng_make(1, 74, 0);
    size_t cut = 0;
    for (uint32_t v = 0; v < p.points.count / 3; v++) {
        partition_plane plane = random_plane_across(&p, 0, &rng);
        plane.offset = 0;
        double at = height_of(&p, &plane, v), lowest = INFINITY, highest = -INFINITY;
        for (uint32_t w = 0; w < p.points.count / 3; w++) {
            double height = height_of(&p, &plane, w);
            lowest = fmin(lowest, height);
            highest = fmax(highest, height);
        }
        plane.offset = lowest - 0.01;
        assert_false(slice(&p, 0, &plane, &next));
        plane.offset = highest + 0.01;
        assert_false(slice(&p, 0, &plane, &next));
        for (size_t i = 0; i < sizeof near / sizeof *near; i++) {
            plane.offset = at + near[i];
            if (plane.offset <= lowest || plane.offset >= highest)
                continue;
            assert_true(slice(&p, 0, &plane, &next));
            partition_oracle_check(&next);
            check_slice(&p, &next, 0, &plane);
            partition_free(&next);
            cut++;
        }
    }
    assert_true(cut > 30);
    partition_free(&p);
    test_context_free(context);
}

/* Two cubes of six tetrahedra each that share only an edge. */
static starg_tetmesh *touching_cubes(starg_context *context) {
    static const int steps[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                    {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    static const uint32_t stride[3] = {1, 3, 9};
    double vertices[54];
    uint32_t tetrahedra[48];
    starg_tetmesh *mesh = NULL;
    for (size_t v = 0; v < 18; v++) {
        vertices[3 * v] = (double)(v % 3);
        vertices[3 * v + 1] = (double)(v / 3 % 3);
        vertices[3 * v + 2] = (double)(v / 9);
    }
    for (size_t t = 0; t < 12; t++) {
        uint32_t at = t < 6 ? 0 : stride[0] + stride[1];
        for (size_t k = 0; k < 4; k++) {
            tetrahedra[4 * t + k] = at;
            at += k < 3 ? stride[steps[t % 6][k]] : 0;
        }
    }
    test_ok(context, starg_tetmesh_create(context, vertices, 18, tetrahedra, 12, NULL, &mesh));
    return mesh;
}

/* Cutting one piece splits facets of the other at a shared edge; a piece that touches itself in an
 * edge is cut there. */
static void test_edge_contact(void **state) {
    (void)state;
    static const double guards[] = {0.5, 0.5, 0.5, 1.5, 1.5, 0.5};
    static const uint32_t labels[] = {0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1}, one[12] = {0};
    const partition_plane plane = {{0.6, 0, 0.8}, 0.01};
    starg_context *context = test_context(1);
    starg_tetmesh *mesh = touching_cubes(context);
    partition p, next;
    test_ok(context, partition_create(context, mesh, labels, guards, 2, &p));
    assert_int_equal(p.facets.count, 24);
    for (uint32_t i = 0; i < 2; i++) {
        assert_true(slice(&p, i, &plane, &next));
        partition_oracle_check(&next);
        check_slice(&p, &next, i, &plane);
        assert_int_equal(next.start.data[2 - i] - next.start.data[1 - i], 14); /* two more */
        partition_free(&next);
    }
    partition_free(&p);
    test_ok(context, partition_create(context, mesh, one, guards, 1, &p));
    starg_rng rng = starg_rng_make(1, 87, 0);
    size_t across = 0;
    for (int trial = 0; trial < 60; trial++) {
        static const double ends[2][3] = {{1, 1, 0}, {1, 1, 1}};
        const partition_plane other = random_plane_across(&p, 0, &rng);
        double heights[2];
        for (int i = 0; i < 2; i++) {
            double unit[3];
            partition_to_unit(&p, ends[i], unit);
            heights[i] = height_at(&other, unit);
        }
        if (heights[0] * heights[1] >= 0)
            continue;
        assert_true(slice(&p, 0, &other, &next));
        partition_oracle_check(&next);
        check_slice(&p, &next, 0, &other);
        partition_free(&next);
        across++;
    }
    assert_true(across > 10);
    partition_free(&p);
    starg_tetmesh_free(mesh);
    test_context_free(context);
}

/* ---- extracts ---- */

static size_t choose_pieces(const partition *p, starg_rng *rng, uint32_t pieces[3]) {
    size_t wanted = 1 + starg_rng_below(rng, 3), count = 0;
    for (int i = 0; i < 20 && count < wanted; i++) {
        uint32_t next = (uint32_t)starg_rng_below(rng, p->pieces.count);
        bool known = false;
        for (size_t k = 0; k < count; k++)
            known = known || pieces[k] == next;
        if (!known)
            pieces[count++] = next;
    }
    return count;
}

static bool is_one_of(const uint32_t *numbers, size_t count, uint32_t number) {
    for (size_t i = 0; i < count; i++)
        if (numbers[i] == number)
            return true;
    return false;
}

static bool belongs_to(const facet *f, const uint32_t *pieces, size_t count) {
    return is_one_of(pieces, count, f->side[0]) || is_one_of(pieces, count, f->side[1]);
}

/* All facets of the pieces, all others with an edge of these, none that has no vertex of them; and
 * the same facets in the part. */
static void check_extract(const partition *p, const partition_extract *e, const uint32_t *pieces,
                          size_t count) {
    size_t points = p->points.count / 3;
    bool *known = calloc(points, sizeof *known);
    assert_non_null(known);
    assert_memory_equal(e->pieces.data, pieces, count * sizeof *pieces);
    for (size_t i = 0; i < p->facets.count; i++)
        for (int k = 0; k < 3; k++)
            known[p->facets.data[i].corners[k]] |= belongs_to(&p->facets.data[i], pieces, count);
    size_t next = 0;
    for (uint32_t i = 0; i < p->facets.count; i++) {
        const facet *f = &p->facets.data[i];
        int shared = known[f->corners[0]] + known[f->corners[1]] + known[f->corners[2]];
        bool taken = next < e->facets.count && e->facets.data[next] == i;
        assert_int_equal(taken, shared >= 2);
        if (!taken)
            continue;
        const facet *own = &e->part.facets.data[next++];
        for (int k = 0; k < 3; k++) {
            assert_int_equal(e->points.data[own->corners[k]], f->corners[k]);
            assert_memory_equal(partition_point(&e->part, own->corners[k]),
                                partition_point(p, f->corners[k]), 3 * sizeof(double));
        }
        for (int side = 0; side < 2; side++)
            assert_int_equal(own->side[side] == PARTITION_OUTSIDE ? PARTITION_OUTSIDE
                                                                  : e->pieces.data[own->side[side]],
                             f->side[side]);
        assert_memory_equal(&e->part.planes.data[own->plane], &p->planes.data[f->plane],
                            sizeof(partition_plane));
    }
    assert_int_equal(next, e->part.facets.count);
    free(known);
}

/* Returned as it is, an extract changes nothing; cut, what a cut of the whole does. */
static void test_extracts(void **state) {
    starg_status status = STARG_OK;
    (void)state;
    starg_context *context = test_context(1);
    region_scratch scratch = {.context = context};
    size_t cuts = 0;
    for (uint64_t seed = 1; seed <= 30; seed++) {
        starg_rng rng = starg_rng_make(seed, 78, 0);
        partition p = random_cells(context, seed, 12 + (size_t)seed), whole;
        partition before = partition_oracle_copy(&p);
        partition_extract e;
        uint32_t pieces[3];
        size_t count = choose_pieces(&p, &rng, pieces);
        test_ok(context, extract_make(&p, pieces, count, &scratch, &e));
        check_extract(&p, &e, pieces, count);
        test_ok(context, extract_return(&e, &p));
        test_ok(context, partition_build_index(&p));
        assert_true(partition_oracle_same(&p, &before));
        extract_free(&e);

        const partition_plane plane = random_plane_across(&p, pieces[0], &rng);
        bool done = false;
        test_ok(context, extract_make(&p, pieces, count, &scratch, &e));
        uint32_t high = (uint32_t)e.part.pieces.count;
        const piece fresh = {.stamp = 1};
        STARG_PUSH(context, "test", &e.part.pieces, fresh);
        test_ok(context, partition_slice(&e.part, 0, high, &plane, &done));
        if (done && slice(&before, pieces[0], &plane, &whole)) {
            test_ok(context, extract_return(&e, &p));
            test_ok(context, partition_build_index(&p));
            partition_oracle_check(&p);
            check_slice(&before, &p, pieces[0], &plane);
            assert_int_equal(p.facets.count, whole.facets.count);
            for (uint32_t i = 0; i < p.pieces.count; i++)
                assert_true(fabs(partition_oracle_volume(&p, i) -
                                 partition_oracle_volume(&whole, i)) < 1e-13);
            partition_free(&whole);
            cuts++;
        }
        extract_free(&e);
        partition_free(&before);
        partition_free(&p);
    }
    assert_true(cuts > 20);
done:
    assert_int_equal(status, STARG_OK);
    region_scratch_free(&scratch);
    test_context_free(context);
}

/* ---- joining ---- */

static void test_join(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    partition p = random_cells(context, 9, 20);
    starg_rng rng = starg_rng_make(1, 75, 0);
    double whole = volume_of_all(&p);
    while (p.pieces.count > 1) {
        uint32_t last = (uint32_t)p.pieces.count - 1;
        uint32_t pair[2] = {(uint32_t)starg_rng_below(&rng, last),
                            (uint32_t)starg_rng_below(&rng, p.pieces.count)};
        if (pair[0] == pair[1])
            continue;
        double joint = partition_oracle_volume(&p, pair[0]) + partition_oracle_volume(&p, pair[1]);
        double moved = partition_oracle_volume(&p, last);
        partition_join(&p, pair, 2);
        partition_renumber(&p, last, pair[1]);
        test_ok(context, partition_build_index(&p));
        partition_oracle_check(&p);
        assert_true(fabs(partition_oracle_volume(&p, pair[0]) - joint) < 1e-13);
        if (pair[1] != last)
            assert_true(partition_oracle_volume(&p, pair[1]) == moved);
    }
    assert_true(fabs(volume_of_all(&p) - whole) < 1e-12);
    for (size_t i = 0; i < p.facets.count; i++)
        assert_int_equal(p.facets.data[i].side[FACET_OUTER], PARTITION_OUTSIDE);
    partition_free(&p);
    test_context_free(context);
}

/* ---- coplanar merge ---- */

/* Every piece of a convex solid is convex: the mean of its corners is in its kernel. */
static void place_guards(partition *p) {
    for (uint32_t i = 0; i < p->pieces.count; i++) {
        piece *own = &p->pieces.data[i];
        double n = 0;
        *own = (piece){.volume = partition_oracle_volume(p, i), .stamp = ++p->stamps};
        for (uint32_t k = p->start.data[i]; k < p->start.data[i + 1]; k++, n += 3)
            for (int c = 0; c < 9; c++)
                own->guard[c % 3] +=
                    partition_point(p, p->facets.data[p->index.data[k] / 2].corners[c / 3])[c % 3];
        for (int k = 0; k < 3; k++)
            own->guard[k] /= n;
    }
}

/* Cut i has split piece i + 1 off piece lows[i]. */
static partition sliced_hull(starg_context *context, uint64_t seed, size_t cuts, uint32_t *lows) {
    starg_rng rng = starg_rng_make(seed, 76, 0);
    partition p = random_hull(context, seed, 6 + 2 * (size_t)(seed % 10)), next;
    while (p.pieces.count <= cuts) {
        uint32_t low = (uint32_t)starg_rng_below(&rng, p.pieces.count);
        partition_plane plane = random_plane_across(&p, low, &rng);
        if (!slice(&p, low, &plane, &next))
            continue;
        lows[p.pieces.count - 1] = low;
        replace(&p, &next);
    }
    place_guards(&p);
    return p;
}

/* Undoes the last cut. */
static void undo_cut(partition *p, const uint32_t *lows) {
    uint32_t last = (uint32_t)p->pieces.count - 1;
    const uint32_t pair[2] = {lows[last - 1], last};
    partition_join(p, pair, 2);
    partition_renumber(p, last, last);
    test_ok(p->context, partition_build_index(p));
    place_guards(p);
}

/* Random points, off all facets with probability one, lie in the same pieces as before. */
static void check_same_pieces(const partition *a, const partition *b, starg_rng *rng, int points) {
    assert_int_equal(a->pieces.count, b->pieces.count);
    for (uint32_t i = 0; i < a->pieces.count; i++)
        assert_true(fabs(partition_oracle_volume(a, i) - partition_oracle_volume(b, i)) < 1e-13);
    for (int i = 0; i < points; i++) {
        double q[3];
        for (int k = 0; k < 3; k++)
            q[k] = starg_rng_unit(rng) - 0.5;
        assert_int_equal(partition_oracle_locate(a, q), partition_oracle_locate(b, q));
    }
}

/* Undoing and merging cut after cut leaves no more than if there had never been a cut. */
static void undo_all(starg_context *context, uint64_t seed, size_t cuts) {
    starg_rng rng = starg_rng_make(seed, 77, 0);
    uint32_t lows[CUTS_MOST];
    partition first = random_hull(context, seed, 6 + 2 * (size_t)(seed % 10));
    partition p = sliced_hull(context, seed, cuts, lows);
    partition_oracle_check_guards(&p);
    for (size_t left = cuts + 1; left-- > 0;) {
        partition fresh = sliced_hull(context, seed, left, lows);
        partition before = partition_oracle_copy(&p);
        test_ok(context, merge_coplanar(&p));
        partition_oracle_check_guards(&p);
        partition_oracle_check_surface(&first, &p);
        check_same_pieces(&before, &p, &rng, 20);
        check_same_pieces(&fresh, &p, &rng, 20);
        test_ok(context, merge_coplanar(&fresh));
        assert_int_equal(p.facets.count, fresh.facets.count);
        assert_int_equal(p.points.count, fresh.points.count);
        partition_free(&before);
        partition_free(&fresh);
        if (left > 0)
            undo_cut(&p, lows);
    }
    assert_int_equal(p.facets.count, first.facets.count);
    assert_int_equal(p.points.count, first.points.count);
    assert_memory_equal(p.points.data, first.points.data, p.points.count * sizeof(double));
    partition_free(&first);
    partition_free(&p);
}

static void test_merge_undoes_cuts(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (uint64_t seed = 0; seed < 30; seed++)
        undo_all(context, seed, 1 + (size_t)(seed % CUTS_MOST));
    test_context_free(context);
}

/* Merging again changes nothing. */
static void test_merge_twice(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (uint64_t seed = 0; seed < 20; seed++) {
        uint32_t lows[CUTS_MOST];
        partition p = sliced_hull(context, seed, CUTS_MOST, lows), once;
        test_ok(context, merge_coplanar(&p));
        once = partition_oracle_copy(&p);
        test_ok(context, merge_coplanar(&p));
        assert_int_equal(p.facets.count, once.facets.count);
        assert_int_equal(p.points.count, once.points.count);
        partition_free(&once);
        partition_free(&p);
    }
    test_context_free(context);
}

/* A guard that does not see its piece: nothing is changed. */
static void test_merge_refuses(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    uint32_t lows[CUTS_MOST];
    partition p = sliced_hull(context, 3, 3, lows);
    undo_cut(&p, lows);
    p.pieces.data[0].guard[0] += 100;
    partition before = partition_oracle_copy(&p);
    test_ok(context, merge_coplanar(&p));
    assert_true(partition_oracle_same(&before, &p));
    partition_free(&before);
    /* with its own guard there would be changes */
    place_guards(&p);
    size_t facets = p.facets.count;
    test_ok(context, merge_coplanar(&p));
    assert_true(p.facets.count < facets);
    partition_free(&p);
    test_context_free(context);
}

/* Partitions produced by the search. */
static void test_merge_after_search(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    uint64_t joins = 0, saved = 0, moves = 0;
    for (uint64_t seed = 0; seed < 8; seed++) {
        starg_rng rng = starg_rng_make(seed, 78, 0);
        partition first = random_cells(context, seed, 30);
        partition p = partition_oracle_copy(&first);
        improve_tallies tallies = {0};
        const improve_options options = {.trials = 320,
                                         .work = UINT64_MAX,
                                         .patience = UINT64_MAX,
                                         .enough = 1,
                                         .tallies = &tallies};
        improve_report report;
        test_ok(context, improve(&p, &options, &report));
        assert_int_equal(p.pieces.count, first.pieces.count - report.joins - report.saved);
        joins += report.joins, saved += report.saved, moves += report.moves;
        partition_oracle_check_guards(&p);
        partition before = partition_oracle_copy(&p);
        test_ok(context, merge_coplanar(&p));
        partition_oracle_check_guards(&p);
        partition_oracle_check_surface(&first, &p);
        check_same_pieces(&before, &p, &rng, 20);
        assert_true(p.facets.count <= before.facets.count);
        partition_free(&before);
        partition_free(&first);
        partition_free(&p);
    }
    assert_true(joins > 100 && saved > 0 && moves > 0);
    test_context_free(context);
}

static improve_options search_with(uint64_t work, improve_tallies *tallies) {
    return (improve_options){.trials = UINT64_MAX,
                             .work = work,
                             .patience = UINT64_MAX,
                             .enough = 1,
                             .tallies = tallies};
}

/* The search ends by its work count, which is the same for any number of threads. */
static void test_search_ends_by_work(void **state) {
    (void)state;
    improve_report report[2];
    partition done[2];
    starg_context *contexts[2];
    for (int i = 0; i < 2; i++) {
        contexts[i] = test_context(1 + i);
        done[i] = random_cells(contexts[i], 3, 30);
        improve_tallies tallies = {0};
        const improve_options options = search_with(2000000, &tallies);
        test_ok(contexts[i], improve(&done[i], &options, &report[i]));
        assert_true(report[i].work >= options.work && report[i].trials > 0);
        assert_false(report[i].time_limited);
    }
    assert_int_equal(report[0].work, report[1].work);
    assert_int_equal(report[0].trials, report[1].trials);
    assert_true(partition_oracle_same(&done[0], &done[1]));
    improve_tallies tallies = {0};
    const improve_options twice = search_with(20000000, &tallies);
    partition more = random_cells(contexts[0], 3, 30);
    test_ok(contexts[0], improve(&more, &twice, &report[1]));
    assert_true(report[1].trials > report[0].trials);
    partition_free(&more);
    for (int i = 0; i < 2; i++) {
        partition_free(&done[i]);
        test_context_free(contexts[i]);
    }
}

/* ---- plans ---- */

/* A random piece and adjacent pieces. */
static size_t choose(const partition *p, starg_rng *rng, uint32_t pieces[APPLY_MOST]) {
    size_t count = 1, wanted = 2 + (size_t)starg_rng_below(rng, APPLY_MOST - 1);
    pieces[0] = (uint32_t)starg_rng_below(rng, p->pieces.count);
    for (int attempt = 0; attempt < 200 && count < wanted; attempt++) {
        const facet *f = &p->facets.data[starg_rng_below(rng, p->facets.count)];
        for (size_t i = 0; i < count; i++)
            for (int side = 0; side < 2; side++) {
                uint32_t other = f->side[1 - side];
                bool known = other == PARTITION_OUTSIDE;
                for (size_t k = 0; k < count; k++)
                    known = known || pieces[k] == other;
                if (f->side[side] == pieces[i] && !known && count < wanted)
                    pieces[count++] = other;
            }
    }
    return count;
}

/* Pieces that the plan does not mention are unchanged, up to their numbers. */
static void check_others(const partition *before, const partition *p, const uint32_t *pieces,
                         size_t count, const apply_effect *effect) {
    for (uint32_t i = 0; i < before->pieces.count; i++) {
        uint32_t at = i;
        bool named = false;
        for (size_t k = 0; k < count; k++)
            named = named || pieces[k] == i;
        if (named)
            continue;
        for (size_t k = 0; k < effect->move_count; k++)
            if (effect->moves[k].from == at)
                at = effect->moves[k].to;
        assert_memory_equal(&p->pieces.data[at], &before->pieces.data[i], sizeof(piece));
        assert_true(fabs(partition_oracle_volume(p, at) - partition_oracle_volume(before, i)) <
                    1e-13);
    }
}

static void check_applied(const partition *before, const partition *p, const uint32_t *pieces,
                          size_t count, int parts, const apply_effect *effect) {
    partition_oracle_check_guards(p);
    assert_int_equal(p->pieces.count, before->pieces.count - count + (size_t)parts);
    check_others(before, p, pieces, count, effect);
    size_t fresh = 0;
    for (size_t i = 0; i < p->pieces.count; i++)
        if (p->pieces.data[i].stamp > before->stamps) {
            assert_true(p->pieces.data[i].radius >= 4e-6);
            fresh++;
        }
    assert_int_equal(fresh, parts);
    assert_true(fabs(volume_of_all(p) - volume_of_all(before)) < 1e-12);
}

static double never_more(const partition *part, size_t count) {
    assert_true(part->pieces.count >= count);
    return 0;
}

/* Random plans of planes, which rarely apply, and those found by the search. */
static void test_plans(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    region_scratch scratch = {.context = context};
    region r = {.vertices = {0}};
    size_t done[2] = {0}, refused = 0, uneven = 0;
    for (uint64_t n = 0; n < 8; n++) {
        starg_rng rng = starg_rng_make(n, 79, 0);
        partition first = random_cells(context, n, 25);
        partition p = partition_oracle_copy(&first);
        for (int trial = 0; trial < 60 && p.pieces.count > 2; trial++) {
            uint32_t pieces[APPLY_MOST];
            cut_plan plan = {.count = 0};
            apply_effect effect;
            size_t count = choose(&p, &rng, pieces);
            if (count < 2)
                continue;
            bool found = trial % 3 == 0, same = starg_rng_below(&rng, 4) == 0;
            int parts = count == 2 || same ? 2 : (int)count - 1;
            if (found) {
                plan.count = parts - 1;
                for (int i = 0; i < plan.count; i++)
                    plan.planes[i] = random_plane_across(&p, pieces[i], &rng),
                    plan.ends[i] = CUT_ENDS_PART;
            } else {
                const repartition_options options = {1e-5, 24, 16, same};
                test_ok(context, region_gather(&p, pieces, count, &scratch, &r));
                test_ok(context,
                        repartition_find(&r, parts, &options, &rng, &scratch, &plan, &found));
            }
            if (!found)
                continue;
            assert_int_equal(plan.count, parts - 1);
            partition before = partition_oracle_copy(&p);
            /* first with a worth that does not grow */
            test_ok(context,
                    apply_cuts(&p, pieces, count, &plan, 4e-6, never_more, &scratch, &effect));
            assert_false(effect.done);
            assert_true(partition_oracle_same(&before, &p));
            uneven++;
            /* then with more room than possible */
            test_ok(context, apply_cuts(&p, pieces, count, &plan, 1, NULL, &scratch, &effect));
            assert_false(effect.done);
            assert_true(partition_oracle_same(&before, &p));
            test_ok(context, apply_cuts(&p, pieces, count, &plan, 4e-6, NULL, &scratch, &effect));
            if (effect.done)
                check_applied(&before, &p, pieces, count, parts, &effect);
            else
                assert_true(partition_oracle_same(&before, &p));
            done[trial % 3 != 0] += effect.done;
            refused += !effect.done;
            partition_free(&before);
        }
        partition_oracle_check_surface(&first, &p);
        partition_free(&first);
        partition_free(&p);
    }
    assert_true(done[0] > 20 && done[1] > 60 && refused > 30 && uneven > 100);
    region_free(&r);
    region_scratch_free(&scratch);
    test_context_free(context);
}

/* Is the guard strictly on the inner side of all of its piece's facets? */
static bool sees_all(const partition *p, uint32_t number, const double guard[3]) {
    bool sees = true;
    for (uint32_t i = p->start.data[number]; i < p->start.data[number + 1]; i++) {
        uint32_t k[3];
        facet_outward(&p->facets.data[p->index.data[i] / 2], (int)(p->index.data[i] % 2), k);
        sees = sees && oracle_orient3d(partition_point(p, k[0]), partition_point(p, k[1]),
                                       partition_point(p, k[2]), guard) == 1;
    }
    return sees;
}

/* Moves a guard within rounding of the midpoint of a facet's edge. */
static void move_guard(partition *p, uint32_t number, starg_rng *rng) {
    uint32_t first = p->start.data[number], count = p->start.data[number + 1] - first;
    const facet *f = &p->facets.data[p->index.data[first + starg_rng_below(rng, count)] / 2];
    const double *a = partition_point(p, f->corners[0]), *b = partition_point(p, f->corners[1]);
    for (double share = 0.5; share > 1e-17; share /= 2) {
        double *guard = p->pieces.data[number].guard, next[3];
        for (int k = 0; k < 3; k++)
            next[k] = guard[k] + 0.5 * (0.5 * a[k] + 0.5 * b[k] - guard[k]);
        if (!sees_all(p, number, next))
            return;
        memcpy(guard, next, sizeof next);
    }
}

/* Splitting a facet rotates its parts by a rounding error: another piece's guard that is too close
 * no longer sees them, and the plan is rejected. */
static void test_near_guards(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    region_scratch scratch = {.context = context};
    size_t done = 0;
    for (uint64_t seed = 0; seed < 12; seed++) {
        starg_rng rng = starg_rng_make(seed, 86, 0);
        partition p = random_cells(context, seed, 10);
        for (int trial = 0; trial < 20; trial++) {
            uint32_t pieces[APPLY_MOST];
            apply_effect effect;
            choose(&p, &rng, pieces);
            const cut_plan plan = {.count = 1,
                                   .ends = {CUT_ENDS_PART},
                                   .planes = {random_plane_across(&p, pieces[0], &rng)}};
            for (uint32_t i = 0; i < p.pieces.count; i++)
                move_guard(&p, i, &rng);
            test_ok(context, apply_cuts(&p, pieces, 2, &plan, 4e-6, NULL, &scratch, &effect));
            for (uint32_t i = 0; i < p.pieces.count; i++)
                assert_true(sees_all(&p, i, p.pieces.data[i].guard));
            done += effect.done;
        }
        partition_free(&p);
    }
    assert_true(done > 10);
    region_scratch_free(&scratch);
    test_context_free(context);
}

/* Any two neighbours can be joined exactly if they have a common kernel. */
static void test_joins(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    region_scratch scratch = {.context = context};
    size_t joined = 0, refused = 0;
    for (uint64_t n = 0; n < 6; n++) {
        partition p = random_cells(context, n, 20 + 4 * (size_t)n);
        for (size_t i = 0; i < p.facets.count; i++) {
            uint32_t a = p.facets.data[i].side[i % 2], b = p.facets.data[i].side[1 - i % 2];
            bool done = true;
            if (a == PARTITION_OUTSIDE || b == PARTITION_OUTSIDE)
                continue;
            partition before = partition_oracle_copy(&p);
            test_ok(context, apply_join(&p, a, b, 4e-6, &scratch, &done));
            if (done) {
                uint32_t last = (uint32_t)before.pieces.count - 1;
                const apply_effect effect = {true, 1, {{last, b}}};
                const uint32_t pair[2] = {a, b};
                check_applied(&before, &p, pair, 2, 1, &effect);
                joined++;
            } else {
                assert_true(partition_oracle_same(&before, &p));
                refused++;
            }
            partition_free(&before);
        }
        partition_free(&p);
    }
    assert_true(joined > 100 && refused > 50);
    region_scratch_free(&scratch);
    test_context_free(context);
}

/* ---- memory ---- */

/* Everything in one go on a small hull; true if the ration was enough. */
static bool run_rationed(size_t ration) {
    size_t left = SIZE_MAX;
    starg_context *context = test_scarce_context(1, &left);
    uint32_t lows[CUTS_MOST];
    partition p = sliced_hull(context, 2, 3, lows);
    region_scratch scratch = {.context = context};
    starg_rng rng = starg_rng_make(1, 80, 0);
    uint32_t pieces[APPLY_MOST];
    size_t count = choose(&p, &rng, pieces);
    const cut_plan plan = {
        .count = 1, .ends = {CUT_ENDS_PART}, .planes = {random_plane_across(&p, pieces[0], &rng)}};
    apply_effect effect = {.done = false};
    bool done = false;
    left = ration;
    starg_status status = apply_cuts(&p, pieces, count, &plan, 4e-6, NULL, &scratch, &effect);
    if (status == STARG_OK)
        status = merge_coplanar(&p);
    if (status == STARG_OK)
        status = apply_join(&p, 0, 1, 4e-6, &scratch, &done);
    left = SIZE_MAX;
    if (status != STARG_OK)
        assert_int_equal(status, STARG_ERROR_MEMORY);
    region_scratch_free(&scratch);
    partition_free(&p);
    test_context_free(context);
    return status == STARG_OK && effect.done;
}

static void test_memory(void **state) {
    (void)state;
    size_t ration = 0;
    while (ration < 1000 && !run_rationed(ration))
        ration++;
    assert_in_range(ration, 30, 999);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_create),
        cmocka_unit_test(test_create_from_surface),
        cmocka_unit_test(test_gather),
        cmocka_unit_test(test_certify),
        cmocka_unit_test(test_slices_of_samples),
        cmocka_unit_test(test_slices_of_hulls),
        cmocka_unit_test(test_slices_through_edges),
        cmocka_unit_test(test_planes_at_vertices),
        cmocka_unit_test(test_edge_contact),
        cmocka_unit_test(test_extracts),
        cmocka_unit_test(test_join),
        cmocka_unit_test(test_merge_undoes_cuts),
        cmocka_unit_test(test_merge_twice),
        cmocka_unit_test(test_merge_refuses),
        cmocka_unit_test(test_merge_after_search),
        cmocka_unit_test(test_search_ends_by_work),
        cmocka_unit_test(test_plans),
        cmocka_unit_test(test_near_guards),
        cmocka_unit_test(test_joins),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
