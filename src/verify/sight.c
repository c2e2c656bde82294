/* SPDX-License-Identifier: Apache-2.0 */
/* Visibility by a map of directions.
 *
 * The directions from p are divided like the sides of a cube around it, each side into 2^levels
 * squares a row: a cell is the cone of all points q with u0 w <= u <= u1 w and v0 w <= v <= v1 w,
 * where (u, v, w) are the coordinates of q - p in the order of the side. Every triangle is listed
 * in every cell that it may meet: it is omitted only if its corners are certainly all beyond one of
 * the four planes, by more than rounding, which proves it to be outside the cone. Where all w are
 * positive, the ratios u / w and v / w give these cells at once; elsewhere halving does. A point on
 * the segment from p to a vertex q lies in the same cones as q; so q is seen exactly if no triangle
 * blocks [p, q) among those listed in the cells that may contain q. The same holds for a face, or a
 * part of one: whatever enters the tetrahedron (p, face) is listed in a cell that the face may
 * meet. Corners of parts lie near their rounded places: the cells are those that any point so near
 * meets.
 *
 * No triangle is omitted for facing away or being hidden. One that is certainly farther than the
 * view reaches is: what blocks [p, q) has a point nearer than q. Cost per point: a test of each
 * triangle, about O(k log k) to list the k in reach, then a short list for each vertex. */
#include "verify/sight.h"

#include <math.h>

enum { SIDES = 6, MAX_LEVELS = 12 };

/* How many times its blur an item is ahead before ratios are used. */
static const double AHEAD = 0x1p30;

typedef struct listing {
    uint32_t cell, face;
} listing;

/* Columns or rows of a side that an item may meet: those from `first` to before `end`. */
typedef struct strips {
    uint32_t first, end;
} strips;

struct verify_sight {
    const verify_surface *surface;
    uint32_t width;    /* cells in a row of a side */
    uint32_t *reached; /* faces in reach */
    size_t reached_count;
    STARG_ARRAY(listing) listings; /* in order of insertion */
    STARG_ARRAY(uint32_t) cells;   /* of the item placed last */
    size_t *start;                 /* of each cell's faces in `listed` */
    uint32_t *listed;              /* faces by cell */
    size_t listed_capacity;
    uint32_t blocker;            /* a face: that of the last view that one blocked */
    int8_t *sides;               /* of the planes of faces on which p is, as by verify_side */
    uint8_t *vertices, *patches; /* seen ones; points between vertices follow these */
    uint8_t *used;               /* those that are corners of patches */
};

static size_t count_cells(uint32_t width) {
    return (size_t)SIDES * width * width;
}

/* The width for so many faces: there are about as many cells, and no fewer for more faces. */
static uint32_t width_for(size_t face_count) {
    uint32_t width = 1;
    for (int level = 0; level < MAX_LEVELS && count_cells(width) <= face_count; level++)
        width *= 2;
    return width;
}

starg_status verify_sight_create(const verify_surface *surface, verify_sight **out) {
    starg_context *context = surface->context;
    verify_sight *sight = starg_allocate_zero(context, 1, sizeof *sight);
    *out = NULL;
    if (sight == NULL)
        return STARG_ERROR_MEMORY;
    sight->surface = surface;
    size_t most_cells = count_cells(width_for(surface->face_count));
    sight->start = starg_allocate(context, most_cells + 1, sizeof *sight->start);
    sight->reached = starg_allocate(context, surface->face_count, sizeof *sight->reached);
    sight->sides = starg_allocate(context, surface->face_count, 1);
    sight->vertices = starg_allocate(context, verify_spot_count(surface), 1);
    sight->patches = starg_allocate(context, verify_patch_count(surface), 1);
    sight->used = starg_allocate_zero(context, verify_spot_count(surface), 1);
    if (sight->start == NULL || sight->reached == NULL || sight->sides == NULL ||
        sight->vertices == NULL || sight->patches == NULL || sight->used == NULL) {
        verify_sight_free(sight);
        return STARG_ERROR_MEMORY;
    }
    for (size_t i = 0; i < 3 * verify_patch_count(surface); i++)
        sight->used[verify_patch_corners(surface, 0)[i]] = 1;
    *out = sight;
    return STARG_OK;
}

void verify_sight_free(verify_sight *sight) {
    if (sight == NULL)
        return;
    RELEASE(sight->listings.data, sight->cells.data, sight->start, sight->listed, sight->reached,
            sight->sides, sight->vertices, sight->patches, sight->used, sight);
}

/* ---- placing points and triangles in cells ---- */

/* One to three points relative to p, in the coordinates of one side of the cube. */
typedef struct item {
    double x[3][3]; /* u, v, w of each */
    double blur;    /* what they are off at most, but for the rounding of differences */
    int count;
} item;

/* Are all points certainly beyond the plane x[k] = limit x w, where limit is in [-1, 1]? The terms
 * have at most four roundings; the constant covers those of subnormal products. */
static bool beyond(const item *it, int k, double limit, int direction) {
    for (int i = 0; i < it->count; i++) {
        double x = it->x[i][k], along = limit * it->x[i][2];
        double bound = 0x1p-50 * (fabs(x) + fabs(it->x[i][2])) + 2 * it->blur + 0x1p-1072;
        if (!(direction * (x - along) > bound))
            return false;
    }
    return true;
}

/* Extends `out` by those of the `size` columns (k = 0) or rows (k = 1) from `first` on, by halving.
 */
static void halve(const item *it, int k, uint32_t width, uint32_t first, uint32_t size,
                  strips *out) {
    double step = 2.0 / width;
    if (beyond(it, k, first * step - 1, -1) || beyond(it, k, (first + size) * step - 1, 1))
        return;
    if (size == 1) {
        out->first = out->end == 0 ? first : out->first;
        out->end = first + 1;
        return;
    }
    halve(it, k, width, first, size / 2, out);
    halve(it, k, width, first + size / 2, size / 2, out);
}

/* The strip of a ratio x / w; ratios off the side count as on its border. */
static uint32_t strip_of(double ratio, uint32_t width, double margin) {
    double on_side = ratio < -1 ? -1 : ratio > 1 ? 1 : ratio;
    double at = (on_side + 1) * (0.5 * width) + margin;
    return at < 0 ? 0 : at < width ? (uint32_t)at : width - 1;
}

/* The columns or rows of an item, all of it at w > AHEAD x blur: the ratios of what is between
 * points are between theirs. Ratios have an error below 2^-50 of themselves; the margin is 2^-30 of
 * a cell, of which a side has at most 2^MAX_LEVELS in a row. What blur adds to a ratio is below
 * 2 / AHEAD times it and 1. */
static strips spanned(const item *it, int k, uint32_t width) {
    double low = it->x[0][k] / it->x[0][2], high = low;
    double slack = it->blur > 0 ? 4 / AHEAD : 0, margin = 0x1p-30 + slack * width;
    for (int i = 1; i < it->count; i++) {
        double ratio = it->x[i][k] / it->x[i][2];
        low = ratio < low ? ratio : low;
        high = ratio > high ? ratio : high;
    }
    if (low > 1 + 0x1p-40 + slack || high < -1 - 0x1p-40 - slack)
        return (strips){0, 0};
    return (strips){strip_of(low, width, -margin), strip_of(high, width, margin) + 1};
}

static strips find_strips(const item *it, int k, uint32_t width, bool ahead) {
    strips out = {0, 0};
    if (ahead)
        return spanned(it, k, width);
    halve(it, k, width, 0, width, &out);
    return out;
}

static starg_status reserve_cells(verify_sight *sight, size_t more) {
    size_t count = sight->cells.count + more;
    if (count <= sight->cells.capacity)
        return STARG_OK;
    uint32_t *grown = starg_reallocate(sight->surface->context, sight->cells.data,
                                       sight->cells.count, 2 * count, sizeof *grown);
    if (grown == NULL)
        return STARG_ERROR_MEMORY;
    sight->cells.data = grown;
    sight->cells.capacity = 2 * count;
    return STARG_OK;
}

/* Appends the cells of a side that the item may meet: all in such a column and such a row. Nothing
 * of it, as p is not on it, is in a cell if no point of it is at w > 0. */
static starg_status place(verify_sight *sight, const item *it, uint32_t side) {
    int ahead = 0, far_ahead = 0;
    for (int i = 0; i < it->count; i++) {
        ahead += it->x[i][2] > -2 * it->blur;
        far_ahead += it->x[i][2] > AHEAD * it->blur;
    }
    if (ahead == 0)
        return STARG_OK;
    strips columns = find_strips(it, 0, sight->width, far_ahead == it->count);
    if (columns.end == 0)
        return STARG_OK;
    strips rows = find_strips(it, 1, sight->width, far_ahead == it->count);
    starg_status status =
        reserve_cells(sight, (size_t)(columns.end - columns.first) * (rows.end - rows.first));
    for (uint32_t r = rows.first; r < rows.end && status == STARG_OK; r++)
        for (uint32_t c = columns.first; c < columns.end; c++)
            sight->cells.data[sight->cells.count++] = (side * sight->width + r) * sight->width + c;
    return status;
}

/* Sets sight->cells to all cells that the points, relative to p, may meet. */
static starg_status find_cells(verify_sight *sight, const double p[3], const double *const *points,
                               int count, double blur) {
    sight->cells.count = 0;
    for (uint32_t side = 0; side < SIDES; side++) {
        uint32_t axis = side / 2;
        double sign = side % 2 ? -1 : 1;
        item it = {.blur = blur, .count = count};
        for (int i = 0; i < count; i++) {
            it.x[i][0] = points[i][(axis + 1) % 3] - p[(axis + 1) % 3];
            it.x[i][1] = points[i][(axis + 2) % 3] - p[(axis + 2) % 3];
            it.x[i][2] = sign * (points[i][axis] - p[axis]);
        }
        TRY(place(sight, &it, side));
    }
    return STARG_OK;
}

/* ---- the map ---- */

/* Is the box of the triangle, and so all of it, certainly farther from p than `range`? The margins
 * are far above what roundings lose, and products that are too small for a double. */
static bool out_of_reach(const double p[3], const double *const t[3], double range) {
    double squared = 0;
    for (int k = 0; k < 3; k++) {
        double low = fmin(t[0][k], fmin(t[1][k], t[2][k])),
               high = fmax(t[0][k], fmax(t[1][k], t[2][k]));
        double apart = fmax(0, fmax(low - p[k], p[k] - high));
        squared += apart * apart;
    }
    return squared * (1 - 0x1p-40) > range * range + 0x1p-1000;
}

/* Does the face block no view? */
static bool verify_is_clear(const verify_surface *surface, size_t face) {
    return surface->clear != NULL && surface->clear[face];
}

/* Sets the sides of all faces, the faces in reach, and the width for these. */
static void survey(verify_sight *sight, const double p[3], double range) {
    sight->reached_count = 0;
    for (uint32_t f = 0; f < sight->surface->face_count; f++) {
        const double *t[3];
        verify_corners(sight->surface, f, t);
        sight->sides[f] = (int8_t)verify_side(t[0], t[1], t[2], p);
        if (!verify_is_clear(sight->surface, f) && !out_of_reach(p, t, range))
            sight->reached[sight->reached_count++] = f;
    }
    sight->width = width_for(sight->reached_count);
}

static starg_status list_faces(verify_sight *sight, const double p[3]) {
    starg_context *context = sight->surface->context;
    sight->listings.count = 0;
    for (size_t n = 0; n < sight->reached_count; n++) {
        const double *t[3];
        verify_corners(sight->surface, sight->reached[n], t);
        TRY(find_cells(sight, p, t, 3, 0));
        size_t count = sight->listings.count + sight->cells.count;
        if (count > sight->listings.capacity) {
            listing *grown = starg_reallocate(context, sight->listings.data, sight->listings.count,
                                              2 * count, sizeof *grown);
            if (grown == NULL)
                return STARG_ERROR_MEMORY;
            sight->listings.data = grown;
            sight->listings.capacity = 2 * count;
        }
        for (size_t i = 0; i < sight->cells.count; i++)
            sight->listings.data[sight->listings.count++] =
                (listing){sight->cells.data[i], sight->reached[n]};
    }
    return STARG_OK;
}

/* Counting sort of the listings by cell. */
static starg_status sort_listings(verify_sight *sight) {
    starg_context *context = sight->surface->context;
    size_t cell_count = count_cells(sight->width);
    if (sight->listed_capacity < sight->listings.capacity) {
        starg_release(context, sight->listed);
        sight->listed_capacity = 0;
        sight->listed = starg_allocate(context, sight->listings.capacity, sizeof *sight->listed);
        if (sight->listed == NULL)
            return STARG_ERROR_MEMORY;
        sight->listed_capacity = sight->listings.capacity;
    }
    memset(sight->start, 0, (cell_count + 1) * sizeof *sight->start);
    for (size_t i = 0; i < sight->listings.count; i++)
        sight->start[sight->listings.data[i].cell]++;
    for (size_t c = 1; c <= cell_count; c++)
        sight->start[c] += sight->start[c - 1];
    for (size_t i = sight->listings.count; i-- > 0;) {
        listing entry = sight->listings.data[i];
        sight->listed[--sight->start[entry.cell]] = entry.face;
    }
    return STARG_OK;
}

/* ---- looking ---- */

/* Does no face listed in sight->cells block the view to q? The one that blocked the last view is
 * tried first: points follow one another in the file mostly where they do on the surface. */
static bool sees_point(verify_sight *sight, const double p[3], const verify_spot *q) {
    const double *last[3];
    verify_corners(sight->surface, sight->blocker, last);
    if (!verify_is_clear(sight->surface, sight->blocker) &&
        verify_blocks_from(sight->sides[sight->blocker], p, q, last))
        return false;
    for (size_t c = 0; c < sight->cells.count; c++) {
        uint32_t cell = sight->cells.data[c];
        for (size_t i = sight->start[cell]; i < sight->start[cell + 1]; i++) {
            uint32_t face = sight->listed[i];
            const double *t[3];
            verify_corners(sight->surface, face, t);
            if (verify_blocks_from(sight->sides[face], p, q, t)) {
                sight->blocker = face;
                return false;
            }
        }
    }
    return true;
}

/* Does nothing listed in sight->cells enter the tetrahedron (p, patch)? */
static bool sees_whole(const verify_sight *sight, const double p[3], size_t face,
                       const verify_spot patch[3]) {
    const double *f[3];
    verify_corners(sight->surface, face, f);
    for (size_t c = 0; c < sight->cells.count; c++) {
        uint32_t cell = sight->cells.data[c];
        for (size_t i = sight->start[cell]; i < sight->start[cell + 1]; i++) {
            const double *t[3];
            verify_corners(sight->surface, sight->listed[i], t);
            if (sight->listed[i] != face && verify_enters(p, f, patch, t))
                return false;
        }
    }
    return true;
}

static starg_status look_at_vertices(verify_sight *sight, const double p[3],
                                     const verify_view *view) {
    const verify_surface *surface = sight->surface;
    for (uint32_t v = 0; v < verify_spot_count(surface); v++) {
        const verify_spot q = verify_spot_of(surface, v);
        sight->vertices[v] = 0;
        if (!sight->used[v] || !verify_in_view(view, p, q.at))
            continue;
        TRY(find_cells(sight, p, &q.at, 1, q.blur));
        sight->vertices[v] = sees_point(sight, p, &q);
    }
    return STARG_OK;
}

/* Has the view the density that the face needs? A back needs what its front does. */
static bool is_resolved(const verify_surface *surface, const verify_view *view, const double p[3],
                        size_t face, const double *const at[3]) {
    if (view->needs == NULL || !view->framed)
        return true;
    if (surface->backs > 0 && face >= surface->backs)
        face -= surface->backs;
    const starg_face_need *need = verify_need_of(view->needs, face);
    double depth =
        starg_density_depth(&view->needs->options.visibility, need != NULL ? need->density : 0);
    return verify_is_near(view, p, depth, at[0]) && verify_is_near(view, p, depth, at[1]) &&
           verify_is_near(view, p, depth, at[2]);
}

static starg_status look_at_patches(verify_sight *sight, const double p[3],
                                    const verify_view *view) {
    const verify_surface *surface = sight->surface;
    for (size_t j = 0; j < verify_patch_count(surface); j++) {
        const uint32_t *corner = verify_patch_corners(surface, j);
        size_t f = verify_patch_face(surface, j);
        const double *t[3];
        verify_spot spots[3];
        sight->patches[j] = sight->vertices[corner[0]] && sight->vertices[corner[1]] &&
                            sight->vertices[corner[2]] && sight->sides[f] > 0;
        if (!sight->patches[j] ||
            (view->steepest == 0 && view->rule != STARG_FACES_WHOLE && view->needs == NULL))
            continue;
        verify_corners(surface, f, t);
        verify_patch_spots(surface, j, spots);
        const double *at[3] = {spots[0].at, spots[1].at, spots[2].at};
        sight->patches[j] = verify_faces(view, p, t, at) && is_resolved(surface, view, p, f, at);
        if (!sight->patches[j] || view->rule != STARG_FACES_WHOLE)
            continue;
        double blur = fmax(spots[0].blur, fmax(spots[1].blur, spots[2].blur));
        TRY(find_cells(sight, p, at, 3, blur));
        sight->patches[j] = sees_whole(sight, p, f, spots);
    }
    return STARG_OK;
}

/* Patches that count from either side are seen where their backs are. */
static void add_backs(verify_sight *sight) {
    const verify_surface *surface = sight->surface;
    if (surface->backs == 0)
        return;
    size_t backs = verify_first_patch(surface, surface->backs);
    for (size_t j = 0; j < verify_first_patch(surface, surface->model_faces); j++)
        sight->patches[j] |= sight->patches[backs + j];
}

starg_status verify_look(verify_sight *sight, const double p[3], const verify_view *view,
                         const uint8_t **vertices, const uint8_t **patches) {
    const verify_patches *parts = sight->surface->patches;
    survey(sight, p, view->range + (parts != NULL ? 4 * parts->blur : 0));
    TRY(list_faces(sight, p));
    TRY(sort_listings(sight));
    TRY(look_at_vertices(sight, p, view));
    TRY(look_at_patches(sight, p, view));
    add_backs(sight);
    *vertices = sight->vertices;
    *patches = sight->patches;
    return STARG_OK;
}
