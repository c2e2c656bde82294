/* SPDX-License-Identifier: Apache-2.0 */
#include "shapes.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"

static void *grow(void *block, size_t count, size_t size) {
    void *grown = realloc(block, (count ? count : 1) * size);
    if (grown == NULL)
        abort();
    return grown;
}

static uint32_t add_vertex(shape *s, const double p[3]) {
    for (size_t i = 0; i < s->vertex_count; i++)
        if (memcmp(s->vertices + 3 * i, p, 3 * sizeof *p) == 0)
            return (uint32_t)i;
    s->vertices = grow(s->vertices, 3 * (s->vertex_count + 1), sizeof *s->vertices);
    memcpy(s->vertices + 3 * s->vertex_count, p, 3 * sizeof *p);
    return (uint32_t)s->vertex_count++;
}

static void add_face(shape *s, uint32_t a, uint32_t b, uint32_t c) {
    s->faces = grow(s->faces, 3 * (s->face_count + 1), sizeof *s->faces);
    uint32_t *face = s->faces + 3 * s->face_count++;
    face[0] = a;
    face[1] = b;
    face[2] = c;
}

/* Adds the side of a cell across `axis`, at its upper or lower end. */
static void add_side(shape *s, const int cell[3], int axis, bool upper) {
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    uint32_t corner[4];
    for (int i = 0; i < 4; i++) {
        double p[3] = {cell[0], cell[1], cell[2]};
        p[axis] += upper;
        p[u] += i == 1 || i == 2;
        p[v] += i >= 2;
        corner[upper ? i : 3 - i] = add_vertex(s, p);
    }
    add_face(s, corner[0], corner[1], corner[2]);
    add_face(s, corner[0], corner[2], corner[3]);
}

shape shape_cells(const char *cells, int nx, int ny, int nz) {
    shape s = {0};
    const int size[3] = {nx, ny, nz}, stride[3] = {1, nx, nx * ny};
    for (int i = 0; i < nx * ny * nz; i++) {
        if (cells[i] != '#')
            continue;
        const int cell[3] = {i % nx, i / nx % ny, i / nx / ny};
        for (int axis = 0; axis < 3; axis++) {
            if (cell[axis] == 0 || cells[i - stride[axis]] != '#')
                add_side(&s, cell, axis, false);
            if (cell[axis] == size[axis] - 1 || cells[i + stride[axis]] != '#')
                add_side(&s, cell, axis, true);
        }
    }
    return s;
}

shape shape_tetrahedron(void) {
    static const double points[4][3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}};
    shape s = {0};
    for (int i = 0; i < 4; i++)
        add_vertex(&s, points[i]);
    add_face(&s, 0, 2, 1);
    add_face(&s, 0, 1, 3);
    add_face(&s, 0, 3, 2);
    add_face(&s, 1, 2, 3);
    return s;
}

shape shape_cube(int sides) {
    char cells[1000];
    memset(cells, '#', sizeof cells);
    return shape_cells(cells, sides, sides, sides);
}

shape shape_room(void) {
    return shape_cells("####"
                       "#..."
                       "#..."
                       "#...",
                       4, 4, 1);
}

shape shape_cavity(void) {
    return shape_cells("#########"
                       "####.####"
                       "#########",
                       3, 3, 3);
}

shape shape_columns(void) {
    return shape_cells("#####"
                       "#.#.#"
                       "#####"
                       "#.#.#"
                       "#####"
                       "#####"
                       "#.#.#"
                       "#####"
                       "#.#.#"
                       "#####",
                       5, 5, 2);
}

shape shape_heap(int width, uint64_t seed) {
    enum { WIDEST = 5 };
    starg_rng rng = starg_rng_make(8, 2, seed);
    char cells[2 * WIDEST * WIDEST];
    int at[3] = {0, 0, 0};
    const int size[3] = {width, width, 2};
    memset(cells, ' ', sizeof cells);
    for (int step = 0; step < 6 * width; step++) {
        size_t k = (size_t)starg_rng_below(&rng, 3);
        cells[at[0] + width * (at[1] + width * at[2])] = '#';
        at[k] = (int)starg_rng_below(&rng, 2) ? at[k] + 1 : at[k] - 1;
        at[k] = at[k] < 0 ? 0 : at[k] >= size[k] ? size[k] - 1 : at[k];
    }
    return shape_cells(cells, width, width, 2);
}

/* Splits every face into four, with the midpoints projected to the unit sphere. */
static shape subdivide(const shape *s) {
    shape fine = {0};
    for (size_t f = 0; f < s->face_count; f++) {
        uint32_t corner[3], middle[3];
        for (int i = 0; i < 3; i++) {
            const double *a = s->vertices + 3 * (size_t)s->faces[3 * f + (size_t)i];
            const double *b = s->vertices + 3 * (size_t)s->faces[3 * f + (size_t)(i + 1) % 3];
            double m[3] = {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
            double length = sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);
            for (int k = 0; k < 3; k++)
                m[k] /= length;
            corner[i] = add_vertex(&fine, a);
            middle[i] = add_vertex(&fine, m);
        }
        for (int i = 0; i < 3; i++)
            add_face(&fine, corner[i], middle[i], middle[(i + 2) % 3]);
        add_face(&fine, middle[0], middle[1], middle[2]);
    }
    return fine;
}

shape shape_blob(int levels, uint64_t seed) {
    shape s = {0};
    for (int i = 0; i < 6; i++) {
        double p[3] = {0, 0, 0};
        p[i / 2] = i % 2 ? -1 : 1;
        add_vertex(&s, p);
    }
    for (uint32_t i = 0; i < 8; i++) {
        uint32_t x = i & 1, y = 2 + (i >> 1 & 1), z = 4 + (i >> 2);
        bool turned = (i & 1) ^ (i >> 1 & 1) ^ (i >> 2);
        add_face(&s, x, turned ? z : y, turned ? y : z);
    }
    for (int i = 0; i < levels; i++) {
        shape fine = subdivide(&s);
        shape_free(&s);
        s = fine;
    }
    starg_rng rng = starg_rng_make(seed, 0, 0);
    for (size_t i = 0; i < s.vertex_count; i++) {
        double radius = 1 + 2 * starg_rng_unit(&rng);
        for (size_t k = 0; k < 3; k++)
            s.vertices[3 * i + k] *= radius;
    }
    return s;
}

void shape_append(shape *out, const shape *other, const double offset[3], int turned) {
    uint32_t base = (uint32_t)out->vertex_count;
    size_t vertices = out->vertex_count + other->vertex_count;
    out->vertices = grow(out->vertices, 3 * vertices, sizeof *out->vertices);
    for (size_t i = 0; i < 3 * other->vertex_count; i++)
        out->vertices[3 * (size_t)base + i] = other->vertices[i] + offset[i % 3];
    out->vertex_count = vertices;
    for (size_t f = 0; f < other->face_count; f++) {
        const uint32_t *v = other->faces + 3 * f;
        add_face(out, base + v[0], base + v[turned ? 2 : 1], base + v[turned ? 1 : 2]);
    }
}

shape shape_overlap(int number) {
    static const double places[OVERLAPS / 2][3] = {
        {0.5, 0.25, -0.5}, {0.3, 0.2, 0.1}, {1.5, -1.25, 0.25}, {-1.5, 0.4, 0.35}};
    bool flat = number < OVERLAPS / 2;
    shape both = flat ? shape_room() : shape_blob(2, 5);
    shape other = flat ? shape_cube(2) : shape_blob(2, 9);
    shape_append(&both, &other, places[number % (OVERLAPS / 2)], 0);
    shape_free(&other);
    return both;
}

void shape_place(shape *out, double scale, double offset) {
    for (size_t i = 0; i < 3 * out->vertex_count; i++)
        out->vertices[i] = scale * out->vertices[i] + offset;
}

void shape_free(shape *s) {
    free(s->vertices);
    free(s->faces);
    *s = (shape){0};
}
