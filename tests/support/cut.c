/* SPDX-License-Identifier: Apache-2.0 */
#include "cut.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support.h"

const grid GRID_HALVES = {"AaBb"
                          "aabb"
                          "aabb"
                          "aabb",
                          {4, 2, 2}};
const grid GRID_CORNER = {"Aaa"
                          "B.."
                          "b..",
                          {3, 3, 1}};
const grid GRID_BEND = {"Aaa"
                        "a.."
                        "a..",
                        {3, 3, 1}};
const grid GRID_RING = {"Aaa"
                        "D.B"
                        "Ccc",
                        {3, 3, 1}};
const grid GRID_CAVITY = {"Aaaaaaaaa"
                          "BbbC.DEee"
                          "Fffffffff",
                          {3, 3, 3}};

/* ---- coning cells ---- */

uint32_t cut_add_vertex(cut *c, const double p[3]) {
    for (size_t i = 0; i < c->mesh.vertex_count; i++)
        if (memcmp(c->vertices + 3 * i, p, 3 * sizeof *p) == 0)
            return (uint32_t)i;
    assert_true(c->mesh.vertex_count < CUT_VERTICES);
    memcpy(c->vertices + 3 * c->mesh.vertex_count, p, 3 * sizeof *p);
    return (uint32_t)c->mesh.vertex_count++;
}

void cut_add_tetrahedron(cut *c, uint32_t a, uint32_t b, uint32_t d, uint32_t e, int32_t label) {
    assert_true(c->mesh.count < CUT_TETRAHEDRA);
    const uint32_t v[4] = {a, b, d, e};
    memcpy(c->tetrahedra + 4 * c->mesh.count, v, sizeof v);
    c->labels[c->mesh.count++] = label;
}

/* Cones a side of a cell from the guard. Diagonals on the surface are those of shape_cells, inside
 * those of upper sides. */
static void cone_side(cut *c, const int cell[3], int axis, bool upper, bool surface, int32_t label,
                      uint32_t guard) {
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    uint32_t corner[4];
    for (int i = 0; i < 4; i++) {
        double p[3] = {cell[0], cell[1], cell[2]};
        p[axis] += upper;
        p[u] += i == 1 || i == 2;
        p[v] += i >= 2;
        corner[i] = cut_add_vertex(c, p);
    }
    if (upper) { /* outward triangles 0 1 2 and 0 2 3, turned towards the guard */
        cut_add_tetrahedron(c, corner[0], corner[2], corner[1], guard, label);
        cut_add_tetrahedron(c, corner[0], corner[3], corner[2], guard, label);
    } else if (surface) { /* 3 2 1 and 3 1 0 */
        cut_add_tetrahedron(c, corner[3], corner[1], corner[2], guard, label);
        cut_add_tetrahedron(c, corner[3], corner[0], corner[1], guard, label);
    } else { /* the triangles of the upper side of the cell below, reversed */
        cut_add_tetrahedron(c, corner[0], corner[1], corner[2], guard, label);
        cut_add_tetrahedron(c, corner[0], corner[2], corner[3], guard, label);
    }
}

static char cell_at(const grid *g, int x, int y, int z) {
    if (x < 0 || y < 0 || z < 0 || x >= g->size[0] || y >= g->size[1] || z >= g->size[2])
        return '.';
    char c = g->cells[x + g->size[0] * (y + g->size[1] * z)];
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

static size_t cell_count(const grid *g) {
    return (size_t)(g->size[0] * g->size[1] * g->size[2]);
}

static void place_guards(cut *c, const grid *g, uint32_t guards[CUT_PIECES]) {
    for (int i = 0; i < (int)cell_count(g); i++) {
        int label = g->cells[i] - 'A';
        if (label < 0 || label >= CUT_PIECES)
            continue;
        const double p[3] = {i % g->size[0] + 0.5, i / g->size[0] % g->size[1] + 0.5,
                             i / g->size[0] / g->size[1] + 0.5};
        guards[label] = cut_add_vertex(c, p);
        memcpy(c->pieces[label].guard, p, sizeof p);
        c->pieces[label].star = true;
        c->report.piece_count =
            c->report.piece_count > (size_t)label + 1 ? c->report.piece_count : (size_t)label + 1;
    }
}

static void cone_cells(cut *c, const grid *g) {
    uint32_t guards[CUT_PIECES];
    place_guards(c, g, guards);
    for (int i = 0; i < (int)cell_count(g); i++) {
        const int cell[3] = {i % g->size[0], i / g->size[0] % g->size[1],
                             i / g->size[0] / g->size[1]};
        char own = cell_at(g, cell[0], cell[1], cell[2]);
        for (int side = 0; side < 6 && own != '.'; side++) {
            int axis = side / 2, step[3] = {cell[0], cell[1], cell[2]};
            step[axis] += side % 2 ? 1 : -1;
            char other = cell_at(g, step[0], step[1], step[2]);
            if (other != own)
                cone_side(c, cell, axis, side % 2, other == '.', own - 'a', guards[own - 'a']);
        }
    }
}

shape grid_model(const grid *g) {
    char *solid = calloc(cell_count(g) + 1, 1);
    for (size_t i = 0; i < cell_count(g); i++)
        solid[i] = g->cells[i] == '.' ? '.' : '#';
    shape s = shape_cells(solid, g->size[0], g->size[1], g->size[2]);
    free(solid);
    return s;
}

/* ---- true reports, computed slowly ---- */

static const uint8_t SIDES[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

void cut_side(const cut *c, size_t tetrahedron, int side, uint32_t v[3]) {
    for (int i = 0; i < 3; i++)
        v[i] = c->tetrahedra[4 * tetrahedron + SIDES[side][i]];
}

bool cut_opposite(const uint32_t a[3], const uint32_t b[3]) {
    for (int i = 0; i < 3; i++)
        if (a[0] == b[i] && a[1] == b[(i + 2) % 3] && a[2] == b[(i + 1) % 3])
            return true;
    return false;
}

static long double volume_of(const cut *c, size_t tetrahedron) {
    long double e[3][3];
    const uint32_t *v = c->tetrahedra + 4 * tetrahedron;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            e[i][k] = (long double)cut_point(c, v[i + 1])[k] - cut_point(c, v[0])[k];
    return (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
            e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
            e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
           6;
}

static double area_of(const cut *c, const uint32_t v[3]) {
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        int u = (k + 1) % 3, w = (k + 2) % 3;
        const double *a = cut_point(c, v[0]), *b = cut_point(c, v[1]), *d = cut_point(c, v[2]);
        double n = (b[u] - a[u]) * (d[w] - a[w]) - (b[w] - a[w]) * (d[u] - a[u]);
        sum = hypot(sum, n);
    }
    return sum / 2;
}

static void add_contact(cut *c, int32_t a, int32_t b, double area) {
    uint32_t first = (uint32_t)(a < b ? a : b), second = (uint32_t)(a < b ? b : a);
    for (size_t i = 0; i < c->report.contact_count; i++)
        if (c->contacts[i].first == first && c->contacts[i].second == second) {
            c->contacts[i].area += area;
            return;
        }
    assert_true(c->report.contact_count < CUT_CONTACTS);
    c->contacts[c->report.contact_count++] = (starg_piece_contact){first, second, area};
}

void cut_recount(cut *c) {
    c->report.tetrahedra = c->mesh.count;
    c->report.contact_count = 0;
    for (size_t p = 0; p < c->report.piece_count; p++)
        c->pieces[p].tetrahedra = 0, c->pieces[p].volume = 0, c->pieces[p].radius = NAN;
    for (size_t t = 0; t < c->mesh.count; t++) {
        c->pieces[c->labels[t]].tetrahedra++;
        c->pieces[c->labels[t]].volume += (double)volume_of(c, t);
    }
    for (size_t s = 0; s < c->mesh.count; s++)
        for (size_t t = s + 1; t < c->mesh.count; t++)
            for (int i = 0; i < 16 && c->labels[s] != c->labels[t]; i++) {
                uint32_t a[3], b[3];
                cut_side(c, s, i / 4, a);
                cut_side(c, t, i % 4, b);
                if (cut_opposite(a, b))
                    add_contact(c, c->labels[s], c->labels[t], area_of(c, a));
            }
}

/* Points the arrays of mesh and report to the cut's own. */
static void adopt(cut *c) {
    c->mesh.vertices = c->vertices;
    c->mesh.tetrahedra = c->tetrahedra;
    c->mesh.labels = c->labels;
    c->report.pieces = c->pieces;
    c->report.contacts = c->contacts;
}

cut *cut_new(const grid *g) {
    cut *c = calloc(1, sizeof *c);
    assert_non_null(c);
    adopt(c);
    cone_cells(c, g);
    c->report.strictly_star = c->report.piece_count;
    c->report.visible_vertices = 1;
    cut_recount(c);
    return c;
}

void cut_assign(cut *to, const cut *from) {
    memcpy(to, from, sizeof *to);
    adopt(to);
}

cut *cut_copy(const cut *from) {
    cut *c = malloc(sizeof *c);
    assert_non_null(c);
    cut_assign(c, from);
    return c;
}

/* Splits the edge a b at a point: in all of its tetrahedra (CUT_ALL), in one only (CUT_FIRST), or
 * in those of one piece. */
static void split_edge(cut *c, uint32_t a, uint32_t b, const double p[3], int32_t where) {
    uint32_t middle = cut_add_vertex(c, p);
    size_t count = c->mesh.count;
    for (size_t t = 0; t < count; t++) {
        uint32_t *v = c->tetrahedra + 4 * t, half[4];
        int at_a = -1, at_b = -1;
        for (int i = 0; i < 4; i++) {
            at_a = v[i] == a ? i : at_a;
            at_b = v[i] == b ? i : at_b;
        }
        if (at_a < 0 || at_b < 0 || (where >= 0 && c->labels[t] != where))
            continue;
        memcpy(half, v, sizeof half);
        half[at_a] = middle;
        v[at_b] = middle;
        cut_add_tetrahedron(c, half[0], half[1], half[2], half[3], c->labels[t]);
        if (where == CUT_FIRST)
            return;
    }
}

void cut_split_middle(cut *c, const double a[3], const double b[3], int32_t where) {
    size_t before = c->mesh.count;
    const double p[3] = {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
    split_edge(c, cut_add_vertex(c, a), cut_add_vertex(c, b), p, where);
    assert_true(c->mesh.count > before);
    cut_recount(c);
}

/* ---- files ---- */

static void put_binary(FILE *file, uint64_t bits, int bytes) {
    while (bytes-- > 0)
        fputc((int)(bits >> 8 * bytes & 255), file);
}

static void put_integer(FILE *file, bool binary, int64_t value, const char *after) {
    if (binary)
        put_binary(file, (uint64_t)value & UINT32_MAX, 4);
    else
        fprintf(file, "%" PRId64 "%s", value, after);
}

static void put_real(FILE *file, coding code, double value) {
    uint64_t bits;
    uint32_t short_bits;
    float number = (float)value;
    memcpy(&bits, &value, sizeof bits);
    memcpy(&short_bits, &number, sizeof short_bits);
    if (code == TEXT)
        fprintf(file, "%.17g\n", value);
    else
        put_binary(file, code == DOUBLES ? bits : short_bits, code == DOUBLES ? 8 : 4);
}

cut_file cut_write_vtk(const starg_pieces_mesh *mesh, coding code) {
    cut_file out = {0};
    FILE *file = open_memstream(&out.bytes, &out.size);
    bool binary = code != TEXT;
    fprintf(file, "# vtk DataFile Version 3.0\npieces\n%s\nDATASET UNSTRUCTURED_GRID\n",
            binary ? "BINARY" : "ASCII");
    fprintf(file, "POINTS %zu %s\n", mesh->vertex_count, code == FLOATS ? "float" : "double");
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        put_real(file, code, mesh->vertices[i]);
    fprintf(file, "\nCELLS %zu %zu\n", mesh->count, 5 * mesh->count);
    for (size_t i = 0; i < 5 * mesh->count; i++)
        put_integer(file, binary, i % 5 ? mesh->tetrahedra[i - i / 5 - 1] : 4,
                    i % 5 < 4 ? " " : "\n");
    fprintf(file, "\nCELL_TYPES %zu\n", mesh->count);
    for (size_t t = 0; t < mesh->count; t++)
        put_integer(file, binary, 10, "\n");
    fprintf(file, "\nCELL_DATA %zu\nSCALARS piece int 1\nLOOKUP_TABLE default\n", mesh->count);
    for (size_t t = 0; t < mesh->count; t++)
        put_integer(file, binary, mesh->labels[t], "\n");
    fclose(file);
    return out;
}

cut_file cut_write_report(const starg_pieces_report *report) {
    cut_file out = {0};
    FILE *file = open_memstream(&out.bytes, &out.size);
    fprintf(file, "{\"format\": \"starguard-pieces\", \"version\": 1, \"mode\": \"%s\",\n",
            report->mode == STARG_DECOMPOSE_PAPER ? "paper" : "strict");
    fprintf(file, "\"model\": {\"vertices\": %zu, \"faces\": %zu},\n", report->model_vertices,
            report->model_faces > 0 ? report->model_faces : 1);
    fprintf(file, "\"tetrahedra\": %zu, \"pieces\": [", report->tetrahedra);
    for (size_t p = 0; p < report->piece_count; p++) {
        const starg_piece *piece = &report->pieces[p];
        fprintf(file,
                "%s{\"guard\": [%.17g, %.17g, %.17g], \"tetrahedra\": %zu, \"volume\": %.17g, "
                "\"star\": %s, \"radius\": %.17g, \"margin\": 0}",
                p > 0 ? ",\n" : "\n", piece->guard[0], piece->guard[1], piece->guard[2],
                piece->tetrahedra, piece->volume, piece->star ? "true" : "false",
                isnan(piece->radius) ? 0 : piece->radius);
    }
    fprintf(file, "],\n\"strictly_star\": %zu, \"visible_vertices\": %.17g, \"flattest\": %.17g,\n",
            report->strictly_star, report->visible_vertices, report->flattest);
    fprintf(file,
            "\"smallest_angle\": %.17g, \"median_angle\": %.17g, \"smallest_angle_made\": %.17g, "
            "\"adjacency\": [",
            report->smallest_angle, report->median_angle, report->smallest_angle_made);
    for (size_t i = 0; i < report->contact_count; i++)
        fprintf(file, "%s[%u, %u, %.17g]", i > 0 ? ", " : "", report->contacts[i].first,
                report->contacts[i].second, report->contacts[i].area);
    fprintf(file, "]%s}\n",
            report->approximated ? ", \"surface\": \"approximated\", \"distance\": 0.25, "
                                   "\"distance_back\": 0.5"
                                 : "");
    fclose(file);
    return out;
}
