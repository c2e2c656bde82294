/* SPDX-License-Identifier: Apache-2.0 */
/* Points and fields carried from one solid to the other.
 *
 * A point is located among the tetrahedra: those whose boxes meet its cell of a grid are tested, by
 * exact signs, and the first one that contains it, faces included, takes it along by its
 * barycentric coordinates. All tetrahedra that contain a point agree, up to rounding, because they
 * share the face on which it lies. Numbers and labels stay as they are; vectors are multiplied by
 * the Jacobian of the tetrahedron.
 *
 * Cost: O(1) for a point, if tetrahedra are about as large as cells. */

#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "starguard/solidmap.h"
#include "tetra/tetmesh.h"

static const char STAGE[] = "carry points";
enum { NOWHERE_SHOWN = 8, SIDE_MOST = 256 };
#define NOWHERE SIZE_MAX

typedef struct locator {
    const starg_solid_map *map;
    const double *from, *to; /* places of the vertices */
    double lower[3], width[3];
    size_t side[3];
    uint32_t *first, *items; /* tetrahedra of cell i: items[first[i]] and on */
} locator;

/* ---- grid ---- */

static size_t cell_of(const locator *l, double x, int k) {
    double at = (x - l->lower[k]) / l->width[k];
    return at > 0 ? (size_t)fmin(at, (double)(l->side[k] - 1)) : 0;
}

static const double *corner(const locator *l, const double *places, size_t t, size_t k) {
    return places + 3 * (size_t)l->map->tetrahedra[4 * t + k];
}

typedef struct cells {
    size_t lower[3], upper[3];
} cells;

static cells cells_of(const locator *l, size_t t) {
    cells c;
    for (int k = 0; k < 3; k++) {
        double least = INFINITY, most = -INFINITY;
        for (size_t i = 0; i < 4; i++) {
            least = fmin(least, corner(l, l->from, t, i)[k]);
            most = fmax(most, corner(l, l->from, t, i)[k]);
        }
        c.lower[k] = cell_of(l, least, k);
        c.upper[k] = cell_of(l, most, k);
    }
    return c;
}

/* Visits the cells of every tetrahedron: counts them, or fills them. */
static size_t visit(locator *l, bool fill) {
    size_t count = 0;
    for (size_t t = 0; t < l->map->count; t++) {
        cells c = cells_of(l, t);
        for (size_t x = c.lower[0]; x <= c.upper[0]; x++)
            for (size_t y = c.lower[1]; y <= c.upper[1]; y++)
                for (size_t z = c.lower[2]; z <= c.upper[2]; z++, count++) {
                    size_t cell = (x * l->side[1] + y) * l->side[2] + z;
                    if (fill)
                        l->items[l->first[cell + 1]++] = (uint32_t)t;
                    else
                        l->first[cell + 2]++;
                }
    }
    return count;
}

static starg_status make_grid(starg_context *context, locator *l) {
    const starg_solid_map *map = l->map;
    double per_axis = ceil(cbrt((double)map->count));
    size_t total = 1;
    for (int k = 0; k < 3; k++) {
        double upper = l->lower[k] = l->from[3 * (size_t)map->tetrahedra[0] + (size_t)k];
        for (size_t i = 0; i < 4 * map->count; i++) {
            double x = l->from[3 * (size_t)map->tetrahedra[i] + (size_t)k];
            l->lower[k] = fmin(l->lower[k], x);
            upper = fmax(upper, x);
        }
        l->side[k] = (size_t)fmin(per_axis, SIDE_MOST);
        l->width[k] = upper / (double)l->side[k] - l->lower[k] / (double)l->side[k];
        total *= l->side[k];
    }
    NEW_ZERO(context, STAGE, l->first, total + 2);
    size_t count = visit(l, false);
    NEW(context, STAGE, l->items, count);
    for (size_t i = 0; i < total; i++)
        l->first[i + 2] += l->first[i + 1];
    visit(l, true);
    return STARG_OK;
}

/* ---- points ---- */

static bool contains(const locator *l, size_t t, const double p[3]) {
    for (size_t k = 0; k < 4; k++)
        if (orient3d(corner(l, l->from, t, (size_t)TETMESH_FACE[k][0]),
                     corner(l, l->from, t, (size_t)TETMESH_FACE[k][1]),
                     corner(l, l->from, t, (size_t)TETMESH_FACE[k][2]), p) < 0)
            return false;
    return true;
}

static size_t locate(const locator *l, const double p[3]) {
    size_t at[3];
    for (int k = 0; k < 3; k++)
        at[k] = cell_of(l, p[k], k);
    size_t cell = (at[0] * l->side[1] + at[1]) * l->side[2] + at[2];
    for (uint32_t i = l->first[cell]; i < l->first[cell + 1]; i++)
        if (contains(l, l->items[i], p))
            return l->items[i];
    return NOWHERE;
}

/* The three coordinates of a vector in the edges from the first corner. */
static void coordinates_of(const locator *l, size_t t, const double vector[3], double out[3]) {
    double e[3][3], normal[3];
    for (size_t k = 0; k < 3; k++)
        vec3_subtract(corner(l, l->from, t, k + 1), corner(l, l->from, t, 0), e[k]);
    double volume = vec3_triple(e[0], e[1], e[2]);
    for (int k = 0; k < 3; k++) {
        vec3_cross(e[(k + 1) % 3], e[(k + 2) % 3], normal);
        out[k] = vec3_dot(normal, vector) / volume;
    }
}

/* `start` plus the image of a vector. */
static void carry(const locator *l, size_t t, const double vector[3], const double start[3],
                  double out[3]) {
    double u[3], edge[3], sum[3] = {0, 0, 0};
    coordinates_of(l, t, vector, u);
    for (size_t k = 0; k < 3; k++) {
        vec3_subtract(corner(l, l->to, t, k + 1), corner(l, l->to, t, 0), edge);
        vec3_along(sum, u[k], edge, sum);
    }
    vec3_along(start, 1, sum, out);
}

/* A vertex goes to its image without rounding. */
static void carry_point(const locator *l, size_t t, const double p[3], double out[3]) {
    double vector[3];
    for (size_t k = 0; k < 4; k++)
        if (vec3_equal(p, corner(l, l->from, t, k))) {
            vec3_copy(corner(l, l->to, t, k), out);
            return;
        }
    vec3_subtract(p, corner(l, l->from, t, 0), vector);
    carry(l, t, vector, corner(l, l->to, t, 0), out);
}

static starg_status carry_all(starg_context *context, const locator *l,
                              const starg_samples *samples, bool back, starg_samples *out) {
    static const double zero[3];
    uint64_t nowhere[NOWHERE_SHOWN];
    size_t missing = 0;
    for (size_t i = 0; i < samples->count; i++) {
        if (i % 1024 == 0)
            TRY(starg_check_cancel(context, STAGE));
        size_t t = locate(l, samples->points + 3 * i);
        if (t == NOWHERE) {
            if (missing < NOWHERE_SHOWN)
                nowhere[missing] = i;
            missing++;
            continue;
        }
        carry_point(l, t, samples->points + 3 * i, out->points + 3 * i);
        if (samples->width == 3)
            carry(l, t, samples->values + 3 * i, zero, out->values + 3 * i);
    }
    if (missing > 0)
        return starg_fail_at(
            context, STARG_ERROR_MESH, STAGE, STARG_ELEMENT_VERTEX, nowhere,
            missing < NOWHERE_SHOWN ? missing : NOWHERE_SHOWN,
            "%zu of %zu points are outside of %s, first point %llu (from 0); give points inside or "
            "on its surface",
            missing, samples->count, back ? "B" : "A", (unsigned long long)nowhere[0]);
    return STARG_OK;
}

starg_status starg_solid_map_carry(starg_context *context, const starg_solid_map *map,
                                   const starg_samples *samples, bool back, starg_samples **out) {
    starg_status status = STARG_OK;
    locator l = {.map = map,
                 .from = back ? map->images : map->vertices,
                 .to = back ? map->vertices : map->images};
    starg_samples *carried = NULL;
    size_t values = samples->width * samples->count;
    *out = NULL;
    STARG_NEW_ZERO(context, STAGE, carried, 1);
    carried->count = samples->count;
    carried->width = samples->width;
    STARG_NEW(context, STAGE, carried->points, 3 * samples->count);
    STARG_NEW(context, STAGE, carried->values, values);
    if (values > 0)
        memcpy(carried->values, samples->values, values * sizeof *carried->values);
    STARG_TRY(make_grid(context, &l));
    STARG_TRY(carry_all(context, &l, samples, back, carried));
    *out = carried;
    carried = NULL;
done:
    starg_samples_free(context, carried);
    RELEASE(l.first, l.items);
    return status;
}
