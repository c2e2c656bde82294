/* SPDX-License-Identifier: Apache-2.0 */
/* A solid divided into pieces, each given by its closed surface: triangles in space, each with the
 * pieces on its two sides. */
#pragma once

#include "geometry/constrained.h"
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

/* A closed surface as a piece for each of the parts (NULL: one), without guards. Errors: MEMORY. */
starg_status partition_create_from_surface(starg_context *context, const kernel_faces *surface,
                                           const solid_parts *parts, partition *out);

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

/* Appends a facet in a plane of its own. Errors: MEMORY. */
starg_status partition_add_facet(partition *p, const uint32_t corners[3], uint32_t inner,
                                 uint32_t outer);

/* Order of edges by their ends, in either direction: 0 for the same edge. */
static inline int partition_compare_edges(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    uint32_t low[2] = {a < b ? a : b, c < d ? c : d}, high[2] = {a < b ? b : a, c < d ? d : c};
    if (low[0] != low[1])
        return low[0] < low[1] ? -1 : 1;
    return (high[0] > high[1]) - (high[0] < high[1]);
}

/* Edge from a to b of a facet, whatever numbers these have. */
typedef struct partition_edge {
    uint32_t a, b, facet;
} partition_edge;

static inline bool partition_same_edge(const partition_edge *x, const partition_edge *y) {
    return partition_compare_edges(x->a, x->b, y->a, y->b) == 0;
}

/* Sorts edges between vertices below `vertices` by their ends, in either direction, then by their
 * facets. Errors: MEMORY. */
starg_status partition_sort_edges(starg_context *context, partition_edge *edges, size_t count,
                                  size_t vertices);

/* Is a number in a list? */
static inline bool partition_lists(const uint32_t *numbers, size_t count, uint32_t number) {
    for (size_t i = 0; i < count; i++)
        if (numbers[i] == number)
            return true;
    return false;
}

/* The order of numbers, for qsort and bsearch. */
int partition_ascending(const void *x, const void *y);
int partition_ascending_real(const void *x, const void *y);

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

/* ---- regions (region.c) ---- */

/* The input of a search for cuts: the surface of a union of pieces and the half-spaces that a guard
 * must be in. */

/* Half-spaces {normal . x <= offset} are kept in blocks of SCAN_BLOCK: first coordinates of all
 * normals, then second, third, then all offsets. */
enum { SCAN_BLOCK = 64, SCAN_SIZE = 4 * SCAN_BLOCK };

/* Of those in a block whose `lowest` is below the bound: the one whose plane the point is least
 * inside of, if that is less than `room`; SCAN_BLOCK if there is none. */
size_t scan_block(const double *block, const double *lowest, double bound, const double point[3],
                  double room);

/* A triangle, counter-clockwise seen from outside, or a segment along an earlier cut (then two
 * corners are the same). */
typedef struct region_triangle {
    uint32_t corners[3], row;
} region_triangle;

/* All in unit coordinates. A guard of the whole region is strictly inside every row. */
typedef struct region {
    STARG_ARRAY(double) vertices; /* x 3 */
    STARG_ARRAY(region_triangle) triangles;
    STARG_ARRAY(double) rows;   /* x 4: outward normal of length one, offset; one for each plane */
    STARG_ARRAY(double) blocks; /* the same for scan_block */
    size_t first_rows;          /* number of rows of the first piece, which come first */
} region;

/* How far a star-shaped part of a region reaches: below a plane with this `normal` at any height up
 * to `height`, the guard is inside every row by the margin (at least where it may stay). */
typedef struct region_reach {
    double height; /* -INFINITY: nowhere; INFINITY: all of the region has a kernel */
    double guard[3];
} region_reach;

typedef STARG_ARRAY(double) region_values;

/* Working memory of one thread. */
typedef struct region_scratch {
    starg_context *context;
    STARG_ARRAY(uint32_t) vertex_of; /* by the partition's vertex: 1 + the region's, or 0 */
    STARG_ARRAY(uint32_t) row_of;    /* by 2 * plane + side: likewise */
    STARG_ARRAY(uint32_t) piece_of;  /* by piece: likewise */
    region_values heights;           /* of vertices along a direction */
    region_values lowest;            /* of rows likewise: their lowest vertex */
    region_values lowest_back;       /* the same along the opposite direction */
    uint64_t work;                   /* vertices, facets and rows visited so far */
} region_scratch;

void region_scratch_free(region_scratch *scratch);

/* Makes room in the tables, which are all zero between calls, for the partition. Errors: MEMORY. */
starg_status region_scratch_fit(region_scratch *scratch, const partition *p);

/* For the threads of a parallel loop (core/parallel.h); nothing is shared. Errors: MEMORY. */
starg_status region_make_scratch(starg_context *context, void *shared, void **out);
void region_free_scratch(starg_context *context, void *scratch);

/* The union of `count` pieces of a partition with an index. Replaces the contents of `region`.
 * Errors: MEMORY. */
starg_status region_gather(const partition *p, const uint32_t *pieces, size_t count,
                           region_scratch *scratch, region *out);

/* The same from about `most` facets of each piece, evenly spaced in its list (fewer than twice as
 * many): if these leave no room for a guard, all facets leave none. */
starg_status region_gather_some(const partition *p, const uint32_t *pieces, size_t count,
                                uint32_t most, region_scratch *scratch, region *out);
void region_free(region *r);

/* Of the box around all vertices. */
double region_diagonal(const region *r);

/* The blocks of the rows, after these were made. Errors: MEMORY. */
starg_status region_make_blocks(starg_context *context, region *r);

/* The part of a region above a plane, closed by it. Errors: MEMORY. */
starg_status region_clip(starg_context *context, const region *from, const double normal[3],
                         double height, region *out);

/* Volume of a part that region_clip has cut off by this plane. */
double region_volume_above(const region *part, const double normal[3], double height);

/* The highest plane along `normal` whose lower part has a kernel, with a guard inside by about
 * `margin` (at least half of it); and, unless `down` is NULL, the same for the upper part along the
 * opposite direction (its height is minus the lowest position of the plane), if the lower part
 * exists. Errors: MEMORY. */
starg_status region_find_reach(const region *r, const double normal[3], double margin,
                               region_scratch *scratch, region_reach *up, region_reach *down);

/* A place inside all rows whose distance to `center` is below the height of `out`, a squared
 * distance; the height is as large as possible. Errors: MEMORY. */
starg_status region_find_reach_about(const region *r, const double center[3], double margin,
                                     region_scratch *scratch, region_reach *out);

/* The same, but always inside all rows of the region's first piece. Errors: MEMORY. */
starg_status region_find_reach_beyond(const region *r, const double center[3], double margin,
                                      region_scratch *scratch, region_reach *out);

/* The same, but always inside all rows that `other` is not inside of by the margin. Errors: MEMORY.
 */
starg_status region_find_reach_for(const region *r, const double center[3], const double other[3],
                                   double margin, region_scratch *scratch, region_reach *out);

/* Centre and radius of the largest ball inside all rows or, if `normal` is not NULL, inside those
 * with a vertex below a plane and the plane itself. The radius is negative if there is none.
 * Errors: MEMORY. */
starg_status region_find_center(const region *r, const double *normal, double height,
                                region_scratch *scratch, double center[3], double *radius);

/* ---- cuts (cut.c) ---- */

typedef STARG_ARRAY(uint32_t) cap_indices;
typedef STARG_ARRAY(constrained_edge) cap_edges;

/* Takes vertices near a plane with the given normal, and distinct edges between them; viewed
 * against the normal, the winding number on the left of an edge exceeds that on the right by its
 * turns. Appends triangles (counter-clockwise in the same view) that fill the regions of winding
 * number 1; all edges and vertices there belong to triangles. *done is false if edges cross, or if
 * some region has a winding number other than 0 and 1. Errors: MEMORY. */
starg_status cap_fill(starg_context *context, const double *points, const double normal[3],
                      const cap_edges *edges, const cap_indices *loose, cap_indices *triangles,
                      bool *done);

/* Joins all of `pieces` into the first of them; facets between them are removed. The other numbers
 * keep no facets. */
void partition_join(partition *p, const uint32_t *pieces, size_t count);

/* Moves the part of piece `low` above the plane to piece `high`, which must be empty; adds facets
 * along the plane between them, and splits facets that the plane cuts, also those that meet the
 * piece only in an edge. *done is false, and the partition unusable, if all of the piece is on one
 * side or rounding makes edges of the section cross. Proves nothing about either part. Errors:
 * MEMORY. */
starg_status partition_slice(partition *p, uint32_t low, uint32_t high,
                             const partition_plane *plane, bool *done);

/* On which sides of a plane a piece has vertices; both bits if the plane cuts it. */
enum { PARTITION_BELOW = 1, PARTITION_ABOVE = 2 };
int partition_sides(const partition *p, uint32_t number, const partition_plane *plane);

/* Vertices this close to the plane of a slice count as on it, in unit coordinates (far from the
 * origin, the rounding of coordinates instead). */
#define SLICE_ON 1e-12

/* Turns parts of piece `number` that share no edge into pieces: the first keeps the number, the
 * others come last. A piece with a cavity stays whole, because the cavity's surface belongs to a
 * part that it does not touch. Needs the index and rebuilds it. The caller sets the guards. Errors:
 * MEMORY. */
starg_status partition_separate(partition *p, uint32_t number);

/* ---- extracts: some pieces as a partition of their own, to try a change (partition.c) ---- */

/* The part contains the requested pieces, in their order, with all of their facets, then other
 * pieces that have facets at an edge of these, with only those facets. The lists map numbers in the
 * part to numbers in the whole, for everything that the part started with. */
typedef struct partition_extract {
    partition part;               /* without an index */
    STARG_ARRAY(uint32_t) facets; /* ascending */
    STARG_ARRAY(uint32_t) points;
    STARG_ARRAY(uint32_t) planes;
    STARG_ARRAY(uint32_t) pieces;
} partition_extract;

/* Extracts `count` pieces of a partition with an index. `out` must be freed in any case. Errors:
 * MEMORY. */
starg_status extract_make(const partition *p, const uint32_t *pieces, size_t count,
                          region_scratch *scratch, partition_extract *out);

/* Puts the part, in its current state, back into the partition, which must not have changed. New
 * points, planes and pieces come last. The index becomes stale. Errors: MEMORY; the partition is
 * then unusable. */
starg_status extract_return(partition_extract *e, partition *p);

void extract_free(partition_extract *e);

/* ---- splits of facets that no cut needs any longer (merge_coplanar.c) ---- */

/* Retriangulates facets in one plane between the same two pieces with only the vertices that their
 * borders need; removes unused points. The pieces stay the same up to rounding; they are certified
 * again, and if that fails, nothing changes. Rebuilds the index. Errors: MEMORY. */
starg_status merge_coplanar(partition *p);

/* The same for pieces whose guards do not see them yet: certifies nothing. Errors: MEMORY. */
starg_status merge_coplanar_unproven(partition *p);

/* ---- changes with proof (apply.c) ---- */

enum { APPLY_MOST = 5, CUT_PLANES_MOST = 64 };

typedef enum cut_end { CUT_GOES_ON, CUT_ENDS_TERM, CUT_ENDS_PART } cut_end;

/* Part after part, each cut from what the former ones leave, which is the last part in the end. A
 * part is the union of terms, a term what is below all of its planes. */
typedef struct cut_plan {
    int count;
    partition_plane planes[CUT_PLANES_MOST];
    cut_end ends[CUT_PLANES_MOST]; /* is it the last one of its term, or part? */
} cut_plan;

enum { FAN_PIECES_MOST = 4, FAN_TAKERS_MOST = 24 };

/* Every facet of the pieces' union goes to a taker, together with the tetrahedron between it and
 * the apex. Takers are neighbours, or the first `kept` pieces, which are thereby replaced. */
typedef struct fan_plan {
    uint32_t pieces[FAN_PIECES_MOST];
    size_t piece_count, kept;
    uint32_t takers[FAN_TAKERS_MOST]; /* each receives something */
    size_t taker_count;
    double apex[3];                /* in unit coordinates */
    STARG_ARRAY(uint32_t) entries; /* of the union's surface: 2 * facet + side */
    STARG_ARRAY(uint8_t) takes;    /* for each: the index of its taker */
    STARG_ARRAY(uint32_t) corners; /* for each, x 3: by which it is found again */
} fan_plan;

void fan_plan_free(fan_plan *plan);

/* Notes the corners of all entries. Errors: MEMORY. */
starg_status fan_plan_mark(const partition *p, fan_plan *plan);

/* The entries of a marked plan by the numbers of a partition with an index that has changed since;
 * the plan's own numbers of pieces are those of now. *found is false if some facet is gone. Errors:
 * MEMORY. */
starg_status fan_plan_find(const partition *p, fan_plan *plan, bool *found);

/* Applies the plan to the partition for which it was made, without proof. Pieces that are not kept
 * end up without facets, and the index becomes stale. Errors: MEMORY. */
starg_status partition_fan(partition *p, const fan_plan *plan);

/* A piece that was renumbered. */
typedef struct apply_move {
    uint32_t from, to;
} apply_move;

typedef struct apply_effect {
    bool done;
    size_t move_count;
    apply_move moves[APPLY_MOST]; /* one after the other */
} apply_effect;

/* What a change is to increase: of an extract with all facets that it may concern, and the first
 * `count` pieces complete. */
typedef double (*apply_worth)(const partition *part, size_t count);

/* Joins `count` pieces (at most APPLY_MOST) and cuts their union into at most as many parts, as
 * planned. Certifies every new
 * piece, and every other piece whose facets were split; if one fails, or if `worth`, unless NULL,
 * does not grow, the partition is unchanged. Guards of the new pieces are the centres of their
 * kernels, at least `margin` (unit coordinates) inside. Rebuilds the index. Errors: MEMORY. */
starg_status apply_cuts(partition *p, const uint32_t *pieces, size_t count, const cut_plan *plan,
                        double margin, apply_worth worth, region_scratch *scratch,
                        apply_effect *effect);

/* Distributes pieces as planned; proofs, `margin` and index as above. Errors: MEMORY. */
starg_status apply_fan(partition *p, const fan_plan *plan, double margin, region_scratch *scratch,
                       apply_effect *effect);

/* Joins pieces a and b if the union has a kernel with this margin (certified); it gets number a (or
 * b, if a is the last piece), and the last piece gets number b. Errors: MEMORY. */
starg_status apply_join(partition *p, uint32_t a, uint32_t b, double margin,
                        region_scratch *scratch, bool *done);

/* Moves each guard to the centre of its kernel if that is certified and better. Errors: MEMORY. */
starg_status apply_centers(partition *p, region_scratch *scratch);

/* ---- tetrahedra (partition.c) ---- */

/* One tetrahedron for each facet of each piece, with the piece's guard as its fourth vertex; all
 * are positive because the guard is strictly inside the facet's plane. Points come first, in their
 * order, then the guards. `labels` (a block of the context) holds the piece of each tetrahedron.
 * Errors: MEMORY. */
starg_status cone_all(const partition *p, starg_tetmesh **mesh, int32_t **labels);
