/* SPDX-License-Identifier: Apache-2.0 */
/* A solid divided into pieces, each given by its closed surface: triangles in space, each with the
 * pieces on its two sides. */
#ifndef STARG_STAR_STRICT_PARTITION_PARTITION_H
#define STARG_STAR_STRICT_PARTITION_PARTITION_H

#include "core/context.h"
#include "core/memory.h"
#include "tetra/tetmesh.h"
#include "visibility/kernel.h"

#define PARTITION_STAGE "decompose"

/* So many vertices, facets and rows are looked at in about a microsecond. */
enum { PARTITION_WORK = 250 };

/* A plane {x : normal . x = offset} in unit coordinates; the normal has length one. */
typedef struct partition_plane {
    double normal[3], offset;
} partition_plane;

enum { FACET_INNER = 0, FACET_OUTER = 1 };

/* The end of a list of corners. */
#define PARTITION_NO_CORNER UINT32_MAX

/* The exterior of the solid. */
#define PARTITION_OUTSIDE UINT32_MAX

/* A triangle, counter-clockwise seen from side[FACET_OUTER]. Facets split by a cut keep the plane
 * of their parent. */
typedef struct facet {
    uint32_t corners[3];
    uint32_t side[2]; /* pieces, or OUTSIDE for the outer one */
    uint32_t plane;
} facet;

typedef struct piece {
    double guard[3];  /* in the coordinates of the solid; certified */
    double radius;    /* of the ball around it in the kernel, in unit coordinates; rounded */
    double volume;    /* in unit coordinates */
    uint64_t stamp;   /* changes whenever the piece does */
    uint64_t checked; /* partition's stamps when its union with each neighbour was last tried */
} piece;

/* Invariants between operations: every piece's surface is closed, its guard is strictly on the
 * inner side of each of its facets, and the surface winds around it once, exactly. No piece number
 * is unused. */
typedef struct partition {
    starg_context *context;
    /* Unit coordinates are (p - origin) / 2^exponent, axis by axis: the solid roughly fills
     * [-1/2, 1/2]^3. Where it is much thinner along one axis than along another, that is stretched:
     * star-shaped pieces stay so, and what is rounded or looked for in space gets room. They
     * serve the search; signs are decided on the points. */
    double origin[3];
    int exponents[3];
    STARG_ARRAY(double) points; /* x 3, in the coordinates of the solid */
    STARG_ARRAY(double) unit;   /* x 3, the same in unit coordinates */
    size_t first_points;        /* those that precede any cut */
    STARG_ARRAY(partition_plane) planes;
    size_t first_planes; /* likewise */
    STARG_ARRAY(facet) facets;
    STARG_ARRAY(piece) pieces;
    uint64_t stamps; /* handed out so far */

    /* facets of piece i: index[start[i]] to index[start[i + 1] - 1], ascending, each as
     * 2 * facet + side */
    STARG_ARRAY(uint32_t) start;
    STARG_ARRAY(uint32_t) index;

    /* Corner k of facet f is 3 * f + k. Those at point i form a list: first_at[i], then next_at of
     * each, to the end. */
    STARG_ARRAY(uint32_t) first_at;
    STARG_ARRAY(uint32_t) next_at;
} partition;

static inline const double *partition_point(const partition *p, uint32_t vertex) {
    return p->points.data + 3 * (size_t)vertex;
}

static inline const double *partition_unit(const partition *p, uint32_t vertex) {
    return p->unit.data + 3 * (size_t)vertex;
}

/* Exchanges what they hold. */
void partition_swap(partition *a, partition *b);

/* The largest of the exponents. */
int partition_exponent(const partition *p);
void partition_to_unit(const partition *p, const double point[3], double out[3]);
void partition_from_unit(const partition *p, const double unit[3], double out[3]);

/* A closed surface as one piece, without a guard. Errors: MEMORY. */
starg_status partition_create_from_surface(starg_context *context, const kernel_faces *surface,
                                           partition *out);

/* The partition of a tetrahedral mesh by labels 0 to count - 1, whose guards (count x 3, in the
 * mesh's coordinates) see their pieces as the invariants say. Errors: MEMORY. */
starg_status partition_create(starg_context *context, const starg_tetmesh *mesh,
                              const uint32_t *labels, const double *guards, size_t count,
                              partition *out);
void partition_free(partition *p);

/* A copy without an index, on which operations can be tried. Errors: MEMORY. */
starg_status partition_copy(const partition *from, partition *to);

/* Fills start and index, and the lists of corners. Errors: MEMORY. */
starg_status partition_build_index(partition *p);

/* Appends a point in the solid's coordinates; returns its number. Errors: MEMORY. */
starg_status partition_add_point(partition *p, const double point[3], uint32_t *vertex);

/* Order of edges by their ends, in either direction: 0 for the same edge. */
static inline int partition_compare_edges(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    uint32_t low[2] = {a < b ? a : b, c < d ? c : d}, high[2] = {a < b ? b : a, c < d ? d : c};
    if (low[0] != low[1])
        return low[0] < low[1] ? -1 : 1;
    return (high[0] > high[1]) - (high[0] < high[1]);
}

/* The plane of three vertices, which are counter-clockwise seen from where the normal points. */
void partition_plane_of(const partition *p, const uint32_t corners[3], partition_plane *plane);

/* Corners of a facet of piece side s, counter-clockwise from outside that piece. */
static inline void facet_outward(const facet *f, int side, uint32_t corners[3]) {
    corners[0] = f->corners[0];
    corners[1] = f->corners[side == FACET_INNER ? 1 : 2];
    corners[2] = f->corners[side == FACET_INNER ? 2 : 1];
}

/* All facets of a piece, outward, appended to `triangles`. Errors: MEMORY. */
typedef STARG_ARRAY(uint32_t) partition_triangles;
starg_status partition_gather(const partition *p, uint32_t number, partition_triangles *triangles);

/* The volume enclosed by closed triangles, in unit coordinates. */
double partition_volume(const partition *p, const uint32_t *triangles, size_t count);

/* Appends the pieces of which there may be fewer, ascending: those of connected components, over
 * common facets, of three pieces and more. A component of two is as good as it gets, unless they
 * can be joined. Errors: MEMORY. */
typedef STARG_ARRAY(uint32_t) partition_numbers;
starg_status partition_find_open(const partition *p, partition_numbers *open);

/* Gives the last piece, `from`, the number `to`, whose piece no longer has facets. */
void partition_renumber(partition *p, uint32_t from, uint32_t to);

/* Is the guard strictly inside each of the `count` triangles, and do they wind around it once?
 * Exact. */
bool partition_certify(const partition *p, const uint32_t *triangles, size_t count,
                       const double guard[3]);

/* The same for every piece of a partition with an index. Errors: MEMORY. */
starg_status partition_certify_all(const partition *p, bool *done);

#endif
