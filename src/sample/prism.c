/* SPDX-License-Identifier: Apache-2.0 */
/* Vertical prisms over a plan of rectangles: rooms (the solid is the air), halls with round
 * columns, plates with holes.
 *
 * The plan is a table of characters: '#' solid, ' ' empty, 'o' solid with a round hole through it.
 * Each strip of the plan and the height are divided into a whole number of steps, and every surface
 * consists of quads with corners on those steps, so that neighbours conform exactly and edges stay
 * sharp. Around a hole the quads go from the cell's border inward to the circle.
 *
 * The vertex count follows from the quads by Euler's formula (V = quads + 2 - 2 genus), so
 * bisection finds the step length for a wanted count without building a mesh. */
#include <math.h>

#include "sample/solids.h"

enum { MAX_STRIPS = 16 };

typedef struct plan {
    size_t columns, rows;
    double widths[MAX_STRIPS], depths[MAX_STRIPS]; /* of columns along x, of rows along z */
    double height;
    double hole; /* radius of a hole over half the shorter side of its cell */
    const char *cells[MAX_STRIPS];
} plan;

/* How a plan is divided into steps. */
typedef struct cutting {
    const plan *p;
    size_t x[MAX_STRIPS + 1], z[MAX_STRIPS + 1]; /* steps before each strip */
    double x_at[MAX_STRIPS + 1], z_at[MAX_STRIPS + 1];
    size_t levels;
    double step;
} cutting;

static char cell_at(const plan *p, size_t column, size_t row) {
    return column < p->columns && row < p->rows ? p->cells[row][column] : ' ';
}

static size_t steps_of(double length, double step) {
    double count = floor(length / step + 0.5);
    return count < 1 ? 1 : (size_t)count;
}

static void cut_strips(const double *lengths, size_t count, double step, size_t *before,
                       double *at) {
    before[0] = 0;
    at[0] = 0;
    for (size_t i = 0; i < count; i++) {
        before[i + 1] = before[i] + steps_of(lengths[i], step);
        at[i + 1] = at[i] + lengths[i];
    }
}

/* Vertical steps are `stretch` times as long as horizontal ones. */
static cutting cut_plan(const plan *p, double step, double stretch) {
    cutting c = {.p = p, .step = step, .levels = steps_of(p->height, stretch * step)};
    cut_strips(p->widths, p->columns, step, c.x, c.x_at);
    cut_strips(p->depths, p->rows, step, c.z, c.z_at);
    return c;
}

/* A cell with its place in the cutting. */
typedef struct cell {
    const cutting *c;
    size_t column, row, nx, nz;
    double center_x, center_z, radius; /* of its hole */
    size_t rings;                      /* of quads between border and hole */
} cell;

static cell make_cell(const cutting *c, size_t column, size_t row) {
    double width = c->p->widths[column], depth = c->p->depths[row];
    cell l = {.c = c, .column = column, .row = row};
    l.nx = c->x[column + 1] - c->x[column];
    l.nz = c->z[row + 1] - c->z[row];
    l.center_x = c->x_at[column] + 0.5 * width;
    l.center_z = c->z_at[row] + 0.5 * depth;
    l.radius = 0.5 * c->p->hole * fmin(width, depth);
    l.rings = steps_of(0.5 * fmin(width, depth) * 1.15 - l.radius, c->step);
    return l;
}

static size_t border_length(const cell *l) {
    return 2 * (l->nx + l->nz);
}

/* Point `a` of the walk around the border: along x, along z, back along x, back along z. */
static void border_point(const cell *l, size_t a, size_t *x, size_t *z) {
    size_t nx = l->nx, nz = l->nz;
    a %= border_length(l);
    if (a < nx) {
        *x = a;
        *z = 0;
    } else if (a < nx + nz) {
        *x = nx;
        *z = a - nx;
    } else if (a < 2 * nx + nz) {
        *x = 2 * nx + nz - a;
        *z = nz;
    } else {
        *x = 0;
        *z = 2 * (nx + nz) - a;
    }
}

/* ---- counting ---- */

static bool side_is_open(const cell *l, int side) {
    static const int across[4][2] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
    /* below 0 wraps to a huge index, which is outside as well */
    return cell_at(l->c->p, l->column + (size_t)across[side][0],
                   l->row + (size_t)across[side][1]) == ' ';
}

static size_t count_vertices(const cutting *c) {
    size_t quads = 0, holes = 0;
    for (size_t row = 0; row < c->p->rows; row++)
        for (size_t column = 0; column < c->p->columns; column++) {
            char kind = cell_at(c->p, column, row);
            if (kind == ' ')
                continue;
            cell l = make_cell(c, column, row);
            for (int side = 0; side < 4; side++)
                if (side_is_open(&l, side))
                    quads += (side % 2 ? l.nz : l.nx) * c->levels;
            if (kind == 'o') {
                quads += border_length(&l) * (2 * l.rings + c->levels);
                holes++;
            } else {
                quads += 2 * l.nx * l.nz;
            }
        }
    return quads + 2 - 2 * holes;
}

/* The division closest to the wanted number. The count falls as the step grows, in jumps if many
 * strips are equally wide; several stretches provide more values to choose from. */
static cutting find_cutting(const plan *p, size_t vertex_count) {
    static const double stretches[] = {1, 0.9, 1.1, 0.8, 1.25, 0.7, 1.4};
    cutting best = {0};
    size_t best_error = SIZE_MAX;
    for (size_t s = 0; s < sizeof stretches / sizeof *stretches; s++) {
        double low = 1e-4, high = 10;
        for (int i = 0; i < 50 && best_error > vertex_count / 100; i++) {
            double step = sqrt(low * high);
            cutting c = cut_plan(p, step, stretches[s]);
            size_t count = count_vertices(&c);
            size_t error = count > vertex_count ? count - vertex_count : vertex_count - count;
            if (error < best_error) {
                best_error = error;
                best = c;
            }
            if (count > vertex_count)
                low = step;
            else
                high = step;
        }
    }
    return best;
}

/* ---- building ---- */

/* The vertex at step (x, z) of the cell and at a level. */
static starg_status grid_vertex(mesh_builder *b, const cell *l, size_t x, size_t z, size_t level,
                                uint32_t *vertex) {
    const cutting *c = l->c;
    double p[3] = {c->x_at[l->column] + c->p->widths[l->column] * (double)x / (double)l->nx,
                   c->p->height * (double)level / (double)c->levels,
                   c->z_at[l->row] + c->p->depths[l->row] * (double)z / (double)l->nz};
    uint64_t name = (uint64_t)(c->x[l->column] + x) << 40 | (uint64_t)(c->z[l->row] + z) << 20 |
                    (uint64_t)level;
    return builder_vertex(b, name, p, vertex);
}

/* The vertex on ring 0 (the cell's border) to `rings` (the hole) below border point `a`. */
static starg_status ring_vertex(mesh_builder *b, const cell *l, size_t ring, size_t a, size_t level,
                                uint32_t *vertex) {
    const cutting *c = l->c;
    size_t x, z;
    border_point(l, a, &x, &z);
    if (ring == 0)
        return grid_vertex(b, l, x, z, level, vertex);
    double dx = c->p->widths[l->column] * ((double)x / (double)l->nx - 0.5);
    double dz = c->p->depths[l->row] * ((double)z / (double)l->nz - 0.5);
    double share = (double)ring / (double)l->rings;
    double scale = 1 - share + share * l->radius / hypot(dx, dz);
    double p[3] = {l->center_x + scale * dx, c->p->height * (double)level / (double)c->levels,
                   l->center_z + scale * dz};
    uint64_t place = (uint64_t)(l->row * MAX_STRIPS + l->column);
    uint64_t name = (uint64_t)1 << 62 | place << 48 | (uint64_t)ring << 32 |
                    (uint64_t)(a % border_length(l)) << 16 | (uint64_t)level;
    return builder_vertex(b, name, p, vertex);
}

/* A wall below ring `ring` from border point a to a + 1, seen from inside the cell or not. */
static starg_status add_wall(mesh_builder *b, const cell *l, size_t ring, size_t a) {
    for (size_t level = 0; level < l->c->levels; level++) {
        uint32_t p, q, r, s;
        TRY(ring_vertex(b, l, ring, a, level, &p));
        TRY(ring_vertex(b, l, ring, a, level + 1, &q));
        TRY(ring_vertex(b, l, ring, a + 1, level + 1, &r));
        TRY(ring_vertex(b, l, ring, a + 1, level, &s));
        if (ring == 0)
            TRY(builder_quad(b, p, q, r, s));
        else
            TRY(builder_quad(b, p, s, r, q));
    }
    return STARG_OK;
}

static starg_status add_floor_quad(mesh_builder *b, const uint32_t q[4], bool top) {
    return top ? builder_quad(b, q[0], q[1], q[2], q[3]) : builder_quad(b, q[3], q[2], q[1], q[0]);
}

static starg_status add_full_floor(mesh_builder *b, const cell *l, size_t level) {
    for (size_t x = 0; x < l->nx; x++)
        for (size_t z = 0; z < l->nz; z++) {
            uint32_t q[4];
            TRY(grid_vertex(b, l, x, z, level, &q[0]));
            TRY(grid_vertex(b, l, x, z + 1, level, &q[1]));
            TRY(grid_vertex(b, l, x + 1, z + 1, level, &q[2]));
            TRY(grid_vertex(b, l, x + 1, z, level, &q[3]));
            TRY(add_floor_quad(b, q, level > 0));
        }
    return STARG_OK;
}

static starg_status add_ring_floor(mesh_builder *b, const cell *l, size_t level) {
    for (size_t ring = 0; ring < l->rings; ring++)
        for (size_t a = 0; a < border_length(l); a++) {
            uint32_t q[4];
            TRY(ring_vertex(b, l, ring, a, level, &q[0]));
            TRY(ring_vertex(b, l, ring + 1, a, level, &q[1]));
            TRY(ring_vertex(b, l, ring + 1, a + 1, level, &q[2]));
            TRY(ring_vertex(b, l, ring, a + 1, level, &q[3]));
            TRY(add_floor_quad(b, q, level > 0));
        }
    return STARG_OK;
}

static starg_status add_cell(mesh_builder *b, const cell *l, bool pierced) {
    size_t levels[2] = {0, l->c->levels};
    for (int i = 0; i < 2; i++)
        if (pierced)
            TRY(add_ring_floor(b, l, levels[i]));
        else
            TRY(add_full_floor(b, l, levels[i]));
    const size_t start[5] = {0, l->nx, l->nx + l->nz, 2 * l->nx + l->nz, border_length(l)};
    for (int side = 0; side < 4; side++)
        for (size_t a = start[side]; side_is_open(l, side) && a < start[side + 1]; a++)
            TRY(add_wall(b, l, 0, a));
    for (size_t a = 0; pierced && a < border_length(l); a++)
        TRY(add_wall(b, l, l->rings, a));
    return starg_check_cancel(b->context, "sample");
}

static starg_status make_prism(starg_context *context, const plan *p, size_t vertex_count,
                               starg_mesh **out) {
    SCOPED_BY(builder_free) mesh_builder builder = {.context = context};
    cutting c = find_cutting(p, vertex_count);
    for (size_t row = 0; row < p->rows; row++)
        for (size_t column = 0; column < p->columns; column++) {
            char kind = cell_at(p, column, row);
            if (kind == ' ')
                continue;
            cell l = make_cell(&c, column, row);
            TRY(add_cell(&builder, &l, kind == 'o'));
        }
    return builder_finish(&builder, out);
}

/* ---- plans ---- */

starg_status solid_l_room(starg_context *context, size_t vertex_count, starg_mesh **out) {
    static const plan room = {.columns = 2,
                              .rows = 2,
                              .widths = {1.5, 2.5},
                              .depths = {1.5, 2.0},
                              .height = 1.1,
                              .cells = {"##", /**/
                                        "# "}};
    return make_prism(context, &room, vertex_count, out);
}

starg_status solid_gallery(starg_context *context, size_t vertex_count, starg_mesh **out) {
    static const plan gallery = {.columns = 9,
                                 .rows = 7,
                                 .widths = {0.8, 1, 0.8, 1, 0.8, 1, 0.8, 1, 0.8},
                                 .depths = {0.6, 0.5, 1, 1.4, 1, 0.5, 0.6},
                                 .height = 1.6,
                                 .hole = 0.52,
                                 .cells = {" # # # # ", /**/
                                           "#########", /**/
                                           "#o#o#o#o#", /**/
                                           "#########", /**/
                                           "#o#o#o#o#", /**/
                                           "#########", /**/
                                           " # # # # "}};
    return make_prism(context, &gallery, vertex_count, out);
}

starg_status solid_labyrinth(starg_context *context, size_t vertex_count, starg_mesh **out) {
    static const plan spiral = {.columns = 9,
                                .rows = 9,
                                .widths = {1, 0.4, 1, 0.4, 1, 0.4, 1, 0.4, 1},
                                .depths = {1, 0.4, 1, 0.4, 1, 0.4, 1, 0.4, 1},
                                .height = 1,
                                .cells = {"#########", /**/
                                          "#        ", /**/
                                          "# #######", /**/
                                          "# #     #", /**/
                                          "# # ### #", /**/
                                          "# #   # #", /**/
                                          "# ##### #", /**/
                                          "#       #", /**/
                                          "#########"}};
    return make_prism(context, &spiral, vertex_count, out);
}

starg_status solid_plate(starg_context *context, size_t vertex_count, starg_mesh **out) {
    static const plan plate = {.columns = 7,
                               .rows = 5,
                               .widths = {0.3, 1, 0.3, 1, 0.3, 1, 0.3},
                               .depths = {0.3, 1, 0.3, 1, 0.3},
                               .height = 0.35,
                               .hole = 0.72,
                               .cells = {"#######", /**/
                                         "#o#o#o#", /**/
                                         "#######", /**/
                                         "#o#o#o#", /**/
                                         "#######"}};
    return make_prism(context, &plate, vertex_count, out);
}

starg_status solid_eight(starg_context *context, size_t vertex_count, starg_mesh **out) {
    static const plan eight = {.columns = 5,
                               .rows = 3,
                               .widths = {0.3, 1, 0.3, 1, 0.3},
                               .depths = {0.3, 1, 0.3},
                               .height = 0.35,
                               .hole = 0.72,
                               .cells = {"#####", /**/
                                         "#o#o#", /**/
                                         "#####"}};
    return make_prism(context, &eight, vertex_count, out);
}
