/* SPDX-License-Identifier: Apache-2.0 */
/* Merges vertices at equal positions or within a distance.
 *
 * Vertices are processed in order; each joins the nearest earlier representative within the
 * distance, so that nothing moves farther than the distance (chains of close vertices do not
 * collapse). Candidates lie in the same cell of a hashed grid or the 26 around it; for distance 0
 * the cell is the position itself. Cost O(n) as long as few vertices share a cell. */

#include "core/rng.h"
#include "geometry/vec3.h"
#include "mesh/union/union.h"

typedef struct weld_grid {
    const double *vertices;
    double distance;
    size_t mask;
    uint32_t *head, *next; /* vertex + 1, or 0; chained through next */
} weld_grid;

static void cell_of(const weld_grid *grid, const double p[3], double cell[3]) {
    for (int k = 0; k < 3; k++)
        cell[k] = grid->distance > 0 ? floor(p[k] / grid->distance) : p[k];
}

static uint32_t *bucket(const weld_grid *grid, const double cell[3]) {
    uint64_t hash = 0;
    for (int k = 0; k < 3; k++) {
        double value = cell[k] + 0.0; /* -0 becomes 0 */
        uint64_t bits;
        memcpy(&bits, &value, sizeof bits);
        hash = starg_hash64(hash + bits + UINT64_C(0x9e3779b97f4a7c15));
    }
    return &grid->head[(size_t)hash & grid->mask];
}

/* Looks in one cell for a vertex closer to p than *least. */
static void search_cell(const weld_grid *grid, const double cell[3], const double p[3],
                        double *least, uint32_t *found) {
    for (uint32_t slot = *bucket(grid, cell); slot != 0; slot = grid->next[slot - 1]) {
        const double *q = grid->vertices + 3 * (size_t)(slot - 1);
        bool equal = p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
        double d = equal ? 0 : vec3_distance(p, q);
        if (!equal && !(d > 0 && d <= grid->distance))
            continue;
        if (d < *least || (d == *least && slot - 1 < *found)) {
            *least = d;
            *found = slot - 1;
        }
    }
}

static uint32_t find_near(const weld_grid *grid, const double p[3]) {
    double cell[3], least = INFINITY;
    uint32_t found = UINT32_MAX;
    int reach = grid->distance > 0 ? 1 : 0;
    cell_of(grid, p, cell);
    for (int x = -reach; x <= reach; x++)
        for (int y = -reach; y <= reach; y++)
            for (int z = -reach; z <= reach; z++) {
                const double near[3] = {cell[0] + x, cell[1] + y, cell[2] + z};
                search_cell(grid, near, p, &least, &found);
            }
    return found;
}

starg_status near_weld(starg_context *context, const double *vertices, size_t count,
                       double distance, uint32_t *place) {
    starg_status status = STARG_OK;
    size_t size = 16;
    weld_grid grid = {.vertices = vertices, .distance = distance};
    while (size < 2 * count)
        size *= 2;
    grid.mask = size - 1;
    STARG_NEW_ZERO(context, UNION_STAGE, grid.head, size);
    STARG_NEW(context, UNION_STAGE, grid.next, count);
    for (uint32_t v = 0; v < count; v++) {
        const double *p = vertices + 3 * (size_t)v;
        double cell[3];
        place[v] = find_near(&grid, p);
        if (place[v] != UINT32_MAX)
            continue;
        cell_of(&grid, p, cell);
        uint32_t *slot = bucket(&grid, cell);
        place[v] = v;
        grid.next[v] = *slot;
        *slot = v + 1;
    }
done:
    RELEASE(grid.head, grid.next);
    return status;
}
