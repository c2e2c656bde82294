/* The verifier of star decompositions: decompositions made by hand pass, as text, binary and in
 * memory; with one thing wrong they fail by the right claim; files with anything wrong are refused;
 * and its search tree and facets agree with slow ones. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "adversarial.h"
#include "core/memory.h"
#include "exact_oracle.h"
#include "shapes.h"
#include "starguard/verify.h"
#include "support.h"
#include "verify/facets.h"
#include "verify/measure.h"
#include "verify/signs.h"
#include "verify/tree.h"
#include "visibility_oracle.h"

/* ---- decompositions made by hand ---- */

enum { PIECES = 16, CONTACTS = 64, VERTICES = 1200, TETRAHEDRA = 4000 };

/* A decomposition with room to spoil it. */
typedef struct cut {
    starg_pieces_mesh mesh;
    starg_pieces_report report;
    double vertices[3 * VERTICES];
    uint32_t tetrahedra[4 * TETRAHEDRA];
    int32_t labels[TETRAHEDRA];
    starg_piece pieces[PIECES];
    starg_piece_contact contacts[CONTACTS];
} cut;

static uint32_t add_vertex(cut *c, const double p[3]) {
    for (size_t i = 0; i < c->mesh.vertex_count; i++)
        if (memcmp(c->vertices + 3 * i, p, 3 * sizeof *p) == 0)
            return (uint32_t)i;
    assert_true(c->mesh.vertex_count < VERTICES);
    memcpy(c->vertices + 3 * c->mesh.vertex_count, p, 3 * sizeof *p);
    return (uint32_t)c->mesh.vertex_count++;
}

static void add_tetrahedron(cut *c, uint32_t a, uint32_t b, uint32_t d, uint32_t e, int32_t label) {
    assert_true(c->mesh.count < TETRAHEDRA);
    const uint32_t v[4] = {a, b, d, e};
    memcpy(c->tetrahedra + 4 * c->mesh.count, v, sizeof v);
    c->labels[c->mesh.count++] = label;
}

static const double *point(const cut *c, uint32_t vertex) {
    return c->vertices + 3 * (size_t)vertex;
}

/* A side of a cell, coned from the guard. The diagonal is that of shape_cells on the surface;
 * inside it is the one of upper sides. */
static void cone_side(cut *c, const int cell[3], int axis, bool upper, bool surface, int32_t label,
                      uint32_t guard) {
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    uint32_t corner[4];
    for (int i = 0; i < 4; i++) {
        double p[3] = {cell[0], cell[1], cell[2]};
        p[axis] += upper;
        p[u] += i == 1 || i == 2;
        p[v] += i >= 2;
        corner[i] = add_vertex(c, p);
    }
    if (upper) { /* outward triangles 0 1 2 and 0 2 3, turned towards the guard */
        add_tetrahedron(c, corner[0], corner[2], corner[1], guard, label);
        add_tetrahedron(c, corner[0], corner[3], corner[2], guard, label);
    } else if (surface) { /* 3 2 1 and 3 1 0 */
        add_tetrahedron(c, corner[3], corner[1], corner[2], guard, label);
        add_tetrahedron(c, corner[3], corner[0], corner[1], guard, label);
    } else { /* the triangles of the upper side of the cell below, seen from here */
        add_tetrahedron(c, corner[0], corner[1], corner[2], guard, label);
        add_tetrahedron(c, corner[0], corner[2], corner[3], guard, label);
    }
}

/* Cells of letters: each letter is a piece, coned from the centre of its capital cell. */
typedef struct grid {
    const char *cells;
    int size[3];
} grid;

static char cell_at(const grid *g, int x, int y, int z) {
    if (x < 0 || y < 0 || z < 0 || x >= g->size[0] || y >= g->size[1] || z >= g->size[2])
        return '.';
    char c = g->cells[x + g->size[0] * (y + g->size[1] * z)];
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

static size_t cell_count(const grid *g) {
    return (size_t)(g->size[0] * g->size[1] * g->size[2]);
}

static void place_guards(cut *c, const grid *g, uint32_t guards[PIECES]) {
    for (int i = 0; i < (int)cell_count(g); i++) {
        int label = g->cells[i] - 'A';
        if (label < 0 || label >= PIECES)
            continue;
        const double p[3] = {i % g->size[0] + 0.5, i / g->size[0] % g->size[1] + 0.5,
                             i / g->size[0] / g->size[1] + 0.5};
        guards[label] = add_vertex(c, p);
        memcpy(c->pieces[label].guard, p, sizeof p);
        c->pieces[label].star = true;
        c->report.piece_count =
            c->report.piece_count > (size_t)label + 1 ? c->report.piece_count : (size_t)label + 1;
    }
}

static void cone_cells(cut *c, const grid *g) {
    uint32_t guards[PIECES];
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

/* The surface of the cells as the model. */
static shape model_of(const grid *g) {
    char *solid = calloc(cell_count(g) + 1, 1);
    for (size_t i = 0; i < cell_count(g); i++)
        solid[i] = g->cells[i] == '.' ? '.' : '#';
    shape s = shape_cells(solid, g->size[0], g->size[1], g->size[2]);
    free(solid);
    return s;
}

/* ---- honest reports, found slowly ---- */

static const uint8_t SIDES[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

static void side_of(const cut *c, size_t tetrahedron, int side, uint32_t v[3]) {
    for (int i = 0; i < 3; i++)
        v[i] = c->tetrahedra[4 * tetrahedron + SIDES[side][i]];
}

/* Is the second triangle the first one, run the other way? */
static bool opposite(const uint32_t a[3], const uint32_t b[3]) {
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
            e[i][k] = (long double)point(c, v[i + 1])[k] - point(c, v[0])[k];
    return (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
            e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
            e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
           6;
}

static double area_of(const cut *c, const uint32_t v[3]) {
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        int u = (k + 1) % 3, w = (k + 2) % 3;
        const double *a = point(c, v[0]), *b = point(c, v[1]), *d = point(c, v[2]);
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
    assert_true(c->report.contact_count < CONTACTS);
    c->contacts[c->report.contact_count++] = (starg_piece_contact){first, second, area};
}

/* Counts, volumes and contacts of what the labels say. */
static void recount(cut *c) {
    c->report.tetrahedra = c->mesh.count;
    c->report.contact_count = 0;
    for (size_t p = 0; p < c->report.piece_count; p++)
        c->pieces[p].tetrahedra = 0, c->pieces[p].volume = 0;
    for (size_t t = 0; t < c->mesh.count; t++) {
        c->pieces[c->labels[t]].tetrahedra++;
        c->pieces[c->labels[t]].volume += (double)volume_of(c, t);
    }
    for (size_t s = 0; s < c->mesh.count; s++)
        for (size_t t = s + 1; t < c->mesh.count; t++)
            for (int i = 0; i < 16 && c->labels[s] != c->labels[t]; i++) {
                uint32_t a[3], b[3];
                side_of(c, s, i / 4, a);
                side_of(c, t, i % 4, b);
                if (opposite(a, b))
                    add_contact(c, c->labels[s], c->labels[t], area_of(c, a));
            }
}

static void make_cut(cut *c, const grid *g) {
    memset(c, 0, sizeof *c);
    c->mesh.vertices = c->vertices;
    c->mesh.tetrahedra = c->tetrahedra;
    c->mesh.labels = c->labels;
    c->report.pieces = c->pieces;
    c->report.contacts = c->contacts;
    cone_cells(c, g);
    c->report.strictly_star = c->report.piece_count;
    c->report.visible_vertices = 1;
    recount(c);
}

static cut *new_cut(const grid *g) {
    cut *c = malloc(sizeof *c);
    assert_non_null(c);
    make_cut(c, g);
    return c;
}

static cut *copy_cut(const cut *from) {
    cut *c = malloc(sizeof *c);
    assert_non_null(c);
    memcpy(c, from, sizeof *c);
    c->mesh.vertices = c->vertices;
    c->mesh.tetrahedra = c->tetrahedra;
    c->mesh.labels = c->labels;
    c->report.pieces = c->pieces;
    c->report.contacts = c->contacts;
    return c;
}

enum { ALL = -1, FIRST = -2 };

/* Splits the edge a b at a point: in ALL tetrahedra that have it, in the FIRST one only, or in
 * those of one piece. */
static void split_edge(cut *c, uint32_t a, uint32_t b, const double p[3], int32_t where) {
    uint32_t middle = add_vertex(c, p);
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
        add_tetrahedron(c, half[0], half[1], half[2], half[3], c->labels[t]);
        if (where == FIRST)
            return;
    }
}

static void split_middle(cut *c, const double a[3], const double b[3], int32_t where) {
    size_t before = c->mesh.count;
    const double p[3] = {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
    split_edge(c, add_vertex(c, a), add_vertex(c, b), p, where);
    assert_true(c->mesh.count > before);
    recount(c);
}

static const grid HALVES = {"AaBb"
                            "aabb"
                            "aabb"
                            "aabb",
                            {4, 2, 2}};
static const grid CORNER = {"Aaa"
                            "B.."
                            "b..",
                            {3, 3, 1}};
static const grid BEND = {"Aaa"
                          "a.."
                          "a..",
                          {3, 3, 1}};
static const grid RING = {"Aaa"
                          "D.B"
                          "Ccc",
                          {3, 3, 1}};
static const grid CAVITY = {"Aaaaaaaaa"
                            "BbbC.DEee"
                            "Fffffffff",
                            {3, 3, 3}};

/* ---- claims ---- */

static starg_mesh *make_mesh(starg_context *context, const shape *s) {
    starg_mesh *mesh = NULL;
    test_ok(context, starg_mesh_create(context, s->vertices, s->vertex_count, s->faces,
                                       s->face_count, &mesh));
    return mesh;
}

static void expect_consistent(const starg_verdict *verdict) {
    bool all = true;
    for (size_t i = 0; i < verdict->count; i++) {
        assert_true(strlen(verdict->claims[i].text) > 10);
        all = all && verdict->claims[i].holds;
    }
    assert_int_equal(verdict->passed, all);
}

static starg_verdict *verify(starg_context *context, const shape *model, const cut *c) {
    starg_verdict *verdict = NULL;
    starg_mesh *mesh = make_mesh(context, model);
    test_ok(context, starg_verify_pieces(context, mesh, &c->mesh, &c->report, &verdict));
    starg_mesh_free(mesh);
    expect_consistent(verdict);
    return verdict;
}

static void expect_pass(starg_context *context, const shape *model, const cut *c) {
    starg_verdict *verdict = verify(context, model, c);
    for (size_t i = 0; i < verdict->count; i++)
        if (!verdict->claims[i].holds)
            fail_msg("%s", verdict->claims[i].text);
    assert_true(verdict->count >= 14);
    starg_verdict_free(context, verdict);
}

/* A claim with this text fails, and with `alone` no other one. */
static void expect_failure(starg_context *context, const shape *model, const cut *c,
                           const char *text, bool alone) {
    starg_verdict *verdict = verify(context, model, c);
    bool found = false;
    for (size_t i = 0; i < verdict->count; i++) {
        const starg_claim *claim = &verdict->claims[i];
        bool meant = strstr(claim->text, text) != NULL;
        found = found || (meant && !claim->holds);
        if (alone && !meant && !claim->holds)
            fail_msg("wrong is \"%s\", but what fails is \"%s\"", text, claim->text);
    }
    for (size_t i = 0; i < verdict->count && !found; i++)
        print_error("%d %s\n", verdict->claims[i].holds, verdict->claims[i].text);
    if (!found)
        fail_msg("\"%s\" does not fail", text);
    assert_false(verdict->passed);
    starg_verdict_free(context, verdict);
}

static const grid *const GRIDS[] = {&HALVES, &CORNER, &BEND, &RING, &CAVITY};
enum { GRID_COUNT = sizeof GRIDS / sizeof *GRIDS };

static void test_true_decompositions_pass(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (int i = 0; i < GRID_COUNT; i++) {
        shape model = model_of(GRIDS[i]);
        cut *c = new_cut(GRIDS[i]);
        expect_pass(context, &model, c);
        c->report.mode = STARG_DECOMPOSE_PAPER;
        expect_pass(context, &model, c);
        shape_free(&model);
        free(c);
    }
    test_context_free(context);
}

/* Far from the origin, huge, tiny and stretched: all that has no tolerance stays exact. */
static void test_scales(void **state) {
    (void)state;
    static const struct {
        double scale, offset;
    } places[] = {{1e90, 0}, {1e-90, 0}, {1, 1048576}, {0.1, 1000.1}, {3e-7, -0.3}};
    starg_context *context = test_context(1);
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        shape model = model_of(&CAVITY);
        cut *c = new_cut(&CAVITY);
        shape_place(&model, places[i].scale, places[i].offset);
        for (size_t k = 0; k < 3 * c->mesh.vertex_count; k++)
            c->vertices[k] = places[i].scale * c->vertices[k] + places[i].offset;
        for (size_t p = 0; p < c->report.piece_count; p++)
            for (int k = 0; k < 3; k++)
                c->pieces[p].guard[k] = places[i].scale * c->pieces[p].guard[k] + places[i].offset;
        recount(c);
        expect_pass(context, &model, c);
        shape_free(&model);
        free(c);
    }
    test_context_free(context);
}

/* ---- falsified decompositions ---- */

static void swap_label(cut *c) { /* the tetrahedron of a towards b becomes one of b */
    for (size_t t = 0; t < c->mesh.count; t++)
        if (c->labels[t] == 0) {
            c->labels[t] = 1;
            break;
        }
}

static void swap_label_and_recount(cut *c) {
    swap_label(c);
    recount(c);
}

static void move_guard_out(cut *c) {
    c->pieces[0].guard[1] = nextafter(1, 2); /* the walls of a end at y = 1 */
}

static void move_guard_to_plane(cut *c) {
    c->pieces[0].guard[1] = 1;
}

static void move_guard_to_corner(cut *c) {
    memset(c->pieces[2].guard, 0, sizeof c->pieces[2].guard);
}

static void remove_tetrahedron(cut *c) {
    c->mesh.count--;
    recount(c);
}

static void double_tetrahedron(cut *c) {
    const uint32_t *v = c->tetrahedra + 4;
    add_tetrahedron(c, v[0], v[1], v[2], v[3], c->labels[1]);
    recount(c);
}

static void add_third(cut *c) { /* on the outer side of an inner face: a third one there */
    const double far[3] = {-1, -1, -1};
    const uint32_t *v = c->tetrahedra;
    add_tetrahedron(c, v[0], v[2], v[3], add_vertex(c, far), c->labels[0]);
    recount(c);
}

static void invert_tetrahedron(cut *c) {
    uint32_t *v = c->tetrahedra + 8, first = v[0];
    v[0] = v[1];
    v[1] = first;
}

static void flatten_tetrahedron(cut *c) {
    uint32_t *v = c->tetrahedra + 8;
    memcpy(c->vertices + 3 * (size_t)v[3], point(c, v[0]), 3 * sizeof(double));
}

static void repeat_corner(cut *c) {
    c->tetrahedra[9] = c->tetrahedra[8];
}

static void move_outer_vertex(cut *c) {
    const double corner[3] = {0, 0, 0};
    c->vertices[3 * (size_t)add_vertex(c, corner)] -= 1e-7;
    recount(c);
}

static void push_inner_vertex_out(cut *c) {
    const double guard[3] = {0.5, 0.5, 0.5};
    c->vertices[3 * (size_t)add_vertex(c, guard) + 2] = 7;
}

static void hang_vertex(cut *c) { /* on an inner edge, split in one tetrahedron only */
    static const double a[3] = {0, 1, 0}, b[3] = {1, 1, 1};
    split_middle(c, a, b, FIRST);
}

static void hang_face_vertex(cut *c) { /* split on one side of the contact of a and b only */
    static const double a[3] = {2, 1, 0}, b[3] = {3, 1, 1};
    split_middle(c, a, b, 0);
}

static void part_piece(cut *c) { /* b and d, on opposite sides of the ring, become one */
    for (size_t t = 0; t < c->mesh.count; t++)
        c->labels[t] = c->labels[t] == 3 ? 1 : c->labels[t];
    c->report.piece_count = c->report.strictly_star = 3;
    recount(c);
}

static void add_empty_piece(cut *c) {
    c->pieces[c->report.piece_count++] = c->pieces[0];
}

static void skip_label(cut *c) {
    for (size_t t = 0; t < c->mesh.count; t++)
        c->labels[t] += c->labels[t] == 3;
    c->report.piece_count++;
    recount(c);
}

static void exceed_labels(cut *c) {
    c->labels[5] = 4;
}

static void lower_label(cut *c) {
    c->labels[5] = -1;
}

static void raise_label(cut *c) {
    c->labels[5] = INT32_MAX;
}

static void raise_volume(cut *c) {
    c->pieces[1].volume *= 1 + 1e-8;
}

static void lose_volume(cut *c) {
    c->pieces[1].volume = NAN;
}

static void raise_area(cut *c) {
    c->contacts[2].area *= 1 + 1e-8;
}

static void lose_contact(cut *c) {
    c->report.contact_count--;
}

static void repeat_contact(cut *c) {
    c->contacts[c->report.contact_count++] = c->contacts[0];
}

static void invent_contact(cut *c) {
    c->contacts[c->report.contact_count++] = (starg_piece_contact){0, 2, 0};
}

static void turn_contact(cut *c) {
    c->contacts[0] = (starg_piece_contact){1, 0, c->contacts[0].area};
}

static void miscall_contact(cut *c) {
    c->contacts[0].second = 77;
}

static void miscount(cut *c) {
    c->pieces[1].tetrahedra++;
    c->pieces[2].tetrahedra--;
}

static void miscount_all(cut *c) {
    c->report.tetrahedra++;
}

static void lower_star(cut *c) {
    c->report.strictly_star--;
}

static void deny_star(cut *c) {
    c->pieces[1].star = false;
    c->report.strictly_star--;
}

static void lower_seen(cut *c) {
    c->report.visible_vertices = 1 - 1e-6;
}

static void lose_seen(cut *c) {
    c->report.visible_vertices = NAN;
}

static void admit_failure(cut *c) { /* honest, but not what strict mode promises */
    move_guard_to_plane(c);
    c->pieces[0].star = false;
    c->report.strictly_star--;
}

static void fill_hole(cut *c) {
    static const grid filled = {"Aaa"
                                "DEB"
                                "Ccc",
                                {3, 3, 1}};
    cut *whole = new_cut(&filled);
    whole->report.mode = c->report.mode;
    cut *copy = copy_cut(whole);
    memcpy(c, copy, sizeof *c);
    c->mesh.vertices = c->vertices;
    c->mesh.tetrahedra = c->tetrahedra;
    c->mesh.labels = c->labels;
    c->report.pieces = c->pieces;
    c->report.contacts = c->contacts;
    free(whole);
    free(copy);
}

static void drop_piece(cut *c) { /* the last tetrahedra are those of c */
    size_t left = 0;
    for (size_t t = 0; t < c->mesh.count; t++)
        if (c->labels[t] != 3) {
            memcpy(c->tetrahedra + 4 * left, c->tetrahedra + 4 * t, 4 * sizeof(uint32_t));
            c->labels[left++] = c->labels[t];
        }
    c->mesh.count = left;
    c->report.piece_count = c->report.strictly_star = 3;
    recount(c);
}

typedef struct falsification {
    void (*apply)(cut *c);
    const char *claim; /* part of the text of the claim that must fail */
    bool alone;        /* and no other one */
} falsification;

static const falsification FALSIFICATIONS[] = {
    {swap_label, "star-shaped", false},
    {swap_label, "as many tetrahedra as claimed: 2 have not, first piece 0", false},
    {swap_label, "the volume that is claimed: 2 have not, first piece 0", false},
    {swap_label_and_recount, "each piece is connected through faces: piece 1 falls apart", false},
    {move_guard_out, "first piece 0, whose guard is not strictly on the inner side of face", false},
    {move_guard_out, "4 pieces are strictly star-shaped (called so: 4, found: 3)", false},
    {move_guard_to_plane, "first piece 0, whose guard is not strictly on the inner side", false},
    {move_guard_to_corner, "first piece 2, whose guard is not strictly on the inner side", false},
    {remove_tetrahedron, "on the model's surface and looks its way: 3 of", false},
    {remove_tetrahedron, "the volume of the model", false},
    {double_tetrahedron, "each triangle has one tetrahedron, or two on opposite sides", false},
    {double_tetrahedron, "of tetrahedron", false},
    {add_third, "1 have more, first face", false},
    {invert_tetrahedron, "1 are inverted or flat, first tetrahedron 2 of piece 0", false},
    {invert_tetrahedron, "have two on one side, first face", false},
    {flatten_tetrahedron, "inverted or flat", false},
    {repeat_corner, "1 are inverted or flat, first tetrahedron 2", false},
    {move_outer_vertex, "the boundary lies on the model's surface", false},
    {push_inner_vertex_out, "inverted or flat", false},
    {hang_vertex, "faces lie elsewhere", false},
    {hang_face_vertex, "faces lie elsewhere", false},
    {part_piece, "piece 1 falls apart, tetrahedra", false},
    {add_empty_piece, "1 are empty, first piece 4", true},
    {skip_label, "1 are empty, first piece 3", true},
    {exceed_labels, "tetrahedron 5 has label 4", true},
    {lower_label, "tetrahedron 5 has label -1", true},
    {raise_label, "tetrahedron 5 has label 2147483647", true},
    {raise_volume, "the volume that is claimed: 1 have not, first piece 1", true},
    {lose_volume, "the volume that is claimed: 1 have not, first piece 1", true},
    {raise_area, "contacts of pieces and their areas are right: 1", true},
    {lose_contact, "contacts of pieces and their areas are right: 1", true},
    {repeat_contact, "contacts of pieces and their areas are right: 1", true},
    {invent_contact, "missing, first 0-2", true},
    {turn_contact, "contacts of pieces and their areas are right: 2", true},
    {miscall_contact, "missing, first 0-77", true},
    {miscount, "as many tetrahedra as claimed: 2 have not, first piece 1", true},
    {miscount_all, "tetrahedra (the file holds", true},
    {lower_star, "3 pieces are strictly star-shaped (called so: 4, found: 4)", true},
    {deny_star, "3 pieces are strictly star-shaped (called so: 3, found: 4)", true},
    {lower_seen, "of their pieces' vertices (found: 1; 0 of", true},
    {lose_seen, "of their pieces' vertices", true},
    {admit_failure, "in strict mode all 4 pieces are star-shaped (found: 3)", false},
    {fill_hole, "faces lie elsewhere", false},
    {fill_hole, "shells once: not so for 1", false},
    {drop_piece, "faces lie elsewhere", false},
    {drop_piece, "shells once: not so for 1", false},
};

static void test_each_falsification_fails(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape model = model_of(&RING);
    cut *truth = new_cut(&RING);
    expect_pass(context, &model, truth);
    for (size_t i = 0; i < sizeof FALSIFICATIONS / sizeof *FALSIFICATIONS; i++) {
        cut *c = copy_cut(truth);
        FALSIFICATIONS[i].apply(c);
        expect_failure(context, &model, c, FALSIFICATIONS[i].claim, FALSIFICATIONS[i].alone);
        free(c);
    }
    free(truth);
    shape_free(&model);
    test_context_free(context);
}

/* The plane of a wall is x = 2: the last double before it passes, it and the next one do not. */
static void test_guard_at_a_plane(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape model = model_of(&HALVES);
    cut *c = new_cut(&HALVES);
    c->pieces[0].guard[0] = nextafter(2, 0);
    expect_pass(context, &model, c);
    c->pieces[0].guard[0] = 2;
    expect_failure(context, &model, c, "first piece 0, whose guard is not", false);
    c->pieces[0].guard[0] = nextafter(2, 3);
    expect_failure(context, &model, c, "first piece 0, whose guard is not", false);
    free(c);
    shape_free(&model);
    test_context_free(context);
}

/* ---- boundaries ---- */

/* Edges of the surface and of contacts split, where rounding leaves the plane and where not. */
static void test_subdivided(void **state) {
    (void)state;
    static const double a[3] = {0, 1, 0}, b[3] = {1, 1, 1}, o[3] = {0, 0, 0}, x[3] = {1, 0, 0};
    starg_context *context = test_context(1);
    shape model = model_of(&RING);
    cut *c = new_cut(&RING);
    split_middle(c, o, x, ALL);
    split_middle(c, a, b, ALL);
    expect_pass(context, &model, c);
    starg_verdict *verdict = verify(context, &model, c);
    bool told = false;
    for (size_t i = 0; i < verdict->count; i++)
        told = told || strstr(verdict->claims[i].text, "faces of the model, 4 parts") != NULL;
    assert_true(told);
    starg_verdict_free(context, verdict);

    static const double near[3] = {0.5, 1e-11, -1e-11}, away[3] = {0.5, 1e-7, 0};
    const double middle[3] = {0.5, 0, 0};
    double *moved = c->vertices + 3 * (size_t)add_vertex(c, middle);
    memcpy(moved, near, sizeof near);
    recount(c);
    expect_pass(context, &model, c);
    memcpy(moved, away, sizeof away);
    recount(c);
    expect_failure(context, &model, c, "faces lie elsewhere", false);
    free(c);
    shape_free(&model);
    test_context_free(context);
}

/* A ring around an axis, run through twice: all tetrahedra positive, all faces on the model with
 * the right side, and the guard behind none; but everything is covered twice. */
static void test_double_winding(void **state) {
    (void)state;
    static const double ring[4][3] = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
    static const double top[3] = {0, 0, 1}, bottom[3] = {0, 0, -1}, middle[3] = {0, 0, 0};
    static const grid none = {"", {0, 0, 0}};
    starg_context *context = test_context(1);
    shape model = shape_blob(0, 1);
    cut *c = new_cut(&none);
    uint32_t t = add_vertex(c, top), s = add_vertex(c, bottom), g = add_vertex(c, middle), r[8];
    for (int i = 0; i < 8; i++) { /* equal points stay apart */
        r[i] = (uint32_t)c->mesh.vertex_count++;
        memcpy(c->vertices + 3 * (size_t)r[i], ring[i % 4], 3 * sizeof(double));
    }
    for (int i = 0; i < 8; i++) {
        add_tetrahedron(c, t, r[(i + 1) % 8], r[i], g, 0);
        add_tetrahedron(c, s, r[i], r[(i + 1) % 8], g, 0);
    }
    for (size_t i = 0; i < model.vertex_count; i++) /* the octahedron again */
        for (int k = 0; k < 3; k++) {
            double x = model.vertices[3 * i + (size_t)k];
            model.vertices[3 * i + (size_t)k] = (x > 0) - (x < 0);
        }
    c->report.piece_count = c->report.strictly_star = 1;
    c->pieces[0].star = true;
    const double guard[3] = {0.1, 0.2, 0.05};
    memcpy(c->pieces[0].guard, guard, sizeof guard);
    c->report.visible_vertices = 1;
    recount(c);
    expect_failure(context, &model, c, "whose boundary winds 2 times around its guard", false);
    expect_failure(context, &model, c, "shells once: not so for 1", false);
    expect_failure(context, &model, c, "the volume of the model", false);
    c->report.approximated = true;
    c->report.distance = 1e-9;
    expect_failure(context, &model, c,
                   "no two faces of the boundary pass through one another: ", false);
    free(c);
    shape_free(&model);
    test_context_free(context);
}

static void test_model_turned_inside_out(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape model = model_of(&CAVITY), turned = {0};
    const double nowhere[3] = {0, 0, 0};
    shape_append(&turned, &model, nowhere, 1);
    cut *c = new_cut(&CAVITY);
    expect_pass(context, &turned, c); /* shells are turned */
    shape_free(&model);
    model = shape_cube(3); /* without the cavity */
    expect_failure(context, &model, c, "faces lie elsewhere", false);
    shape_free(&model);
    shape_free(&turned);
    free(c);
    test_context_free(context);
}

static void test_approximated(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape model = model_of(&RING);
    cut *c = new_cut(&RING);
    shape_place(&model, 1, 0.0625);
    c->report.approximated = true;
    c->report.distance = 0.0625 * sqrt(3);
    expect_pass(context, &model, c);
    model.face_count -= 2; /* an open model has no inside, but a surface */
    expect_failure(context, &model, c, "the boundary is at most", true);
    c->report.distance = 0.3;
    expect_pass(context, &model, c);
    c->report.distance = 0.0624;
    expect_failure(context, &model, c, "the boundary is at most", true);
    c->report.distance = NAN;
    expect_failure(context, &model, c, "the boundary is at most", true);
    free(c);
    shape_free(&model);
    test_context_free(context);
}

/* Two pieces that lie one in the other, each fine by itself. */
static void test_overlap_of_shells(void **state) {
    (void)state;
    static const grid small = {"A", {1, 1, 1}};
    starg_context *context = test_context(1);
    cut *c = new_cut(&HALVES), *inner = new_cut(&small);
    shape model = model_of(&HALVES);
    uint32_t base = (uint32_t)c->mesh.vertex_count;
    for (size_t v = 0; v < inner->mesh.vertex_count; v++)
        for (int k = 0; k < 3; k++)
            c->vertices[3 * c->mesh.vertex_count + 3 * v + (size_t)k] =
                0.5 * inner->vertices[3 * v + (size_t)k] + 0.25;
    c->mesh.vertex_count += inner->mesh.vertex_count;
    for (size_t t = 0; t < inner->mesh.count; t++) {
        const uint32_t *v = inner->tetrahedra + 4 * t;
        add_tetrahedron(c, base + v[0], base + v[1], base + v[2], base + v[3], 2);
    }
    c->report.piece_count = c->report.strictly_star = 3;
    c->pieces[2] = inner->pieces[0];
    recount(c);
    c->report.approximated = true;
    c->report.distance = 1;
    expect_failure(context, &model, c, "winds once around the inside of its 2 shells: not so for 1",
                   true);
    free(c);
    free(inner);
    shape_free(&model);
    test_context_free(context);
}

static void test_tetmesh_model(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    cut *c = new_cut(&CAVITY);
    starg_tetmesh *tetmesh = NULL;
    starg_verdict *verdict = NULL;
    test_ok(context, starg_tetmesh_create(context, c->vertices, c->mesh.vertex_count, c->tetrahedra,
                                          c->mesh.count, NULL, &tetmesh));
    test_ok(context,
            starg_verify_pieces_of_tetmesh(context, tetmesh, &c->mesh, &c->report, &verdict));
    expect_consistent(verdict);
    assert_true(verdict->passed);
    starg_verdict_free(context, verdict);
    move_outer_vertex(c);
    test_ok(context,
            starg_verify_pieces_of_tetmesh(context, tetmesh, &c->mesh, &c->report, &verdict));
    assert_false(verdict->passed);
    starg_verdict_free(context, verdict);
    starg_tetmesh_free(tetmesh);
    free(c);
    test_context_free(context);
}

/* ---- vertices seen ---- */

/* The fraction by the definition: every line against every outer face. */
static double fraction_seen(const cut *c) {
    size_t outer = 0, pairs = 0, seen = 0;
    uint32_t *faces = calloc(12 * c->mesh.count, sizeof *faces);
    bool *visible = calloc(c->mesh.vertex_count, sizeof *visible);
    for (size_t s = 0; s < c->mesh.count; s++)
        for (int i = 0; i < 4; i++) {
            bool alone = true;
            uint32_t a[3], b[3];
            side_of(c, s, i, a);
            for (size_t t = 0; t < 4 * c->mesh.count && alone; t++) {
                side_of(c, t / 4, (int)(t % 4), b);
                alone = !opposite(a, b);
            }
            if (alone)
                memcpy(faces + 3 * outer++, a, sizeof a);
        }
    for (size_t p = 0; p < c->report.piece_count; p++) {
        visibility_oracle_vertices(c->vertices, c->mesh.vertex_count, faces, outer,
                                   c->pieces[p].guard, visible);
        for (uint32_t v = 0; v < c->mesh.vertex_count; v++) {
            bool own = false;
            for (size_t t = 0; t < 4 * c->mesh.count && !own; t++)
                own = c->labels[t / 4] == (int32_t)p && c->tetrahedra[t] == v;
            pairs += own;
            seen += own && visible[v];
        }
    }
    free(faces);
    free(visible);
    return (double)seen / (double)pairs;
}

/* Guards anywhere, in the mode that allows it; also outside and on the surface. */
static void test_visible_vertices(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape model = model_of(&CAVITY);
    size_t partial = 0;
    for (uint64_t round = 0; round < 12; round++) {
        cut *c = new_cut(&CAVITY);
        starg_rng rng = starg_rng_make(23, round, 0);
        c->report.mode = STARG_DECOMPOSE_PAPER;
        for (size_t p = 0; p < 3; p++) {
            for (int k = 0; k < 3; k++)
                c->pieces[p].guard[k] = round % 2 ? 3 * starg_rng_unit(&rng)
                                                  : (double)starg_rng_below(&rng, 9) / 2 - 0.5;
            c->pieces[p].star = false;
        }
        c->report.strictly_star -= 3;
        for (size_t p = 0; p < 3; p++) { /* by chance it may be in the kernel, a box */
            const double *g = c->pieces[p].guard;
            static const double box[3][6] = {
                {0, 0, 0, 3, 3, 1}, {0, 0, 1, 3, 1, 2}, {0, 1, 1, 1, 2, 2}};
            c->pieces[p].star = g[0] > box[p][0] && g[1] > box[p][1] && g[2] > box[p][2] &&
                                g[0] < box[p][3] && g[1] < box[p][4] && g[2] < box[p][5];
            c->report.strictly_star += c->pieces[p].star;
        }
        c->report.visible_vertices = fraction_seen(c);
        partial += c->report.visible_vertices < 1;
        expect_pass(context, &model, c);
        c->report.visible_vertices += 1e-4;
        expect_failure(context, &model, c, "of their pieces' vertices", true);
        free(c);
    }
    assert_true(partial > 6);
    shape_free(&model);
    test_context_free(context);
}

/* ---- files ---- */

typedef struct text {
    char *bytes;
    size_t size;
} text;

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

/* PIECES.vtk as text, as doubles or as floats. */
typedef enum coding { TEXT, DOUBLES, FLOATS, CODINGS } coding;

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

static text write_vtk(const starg_pieces_mesh *mesh, coding code) {
    text out = {0};
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

static text write_report(const starg_pieces_report *report) {
    text out = {0};
    FILE *file = open_memstream(&out.bytes, &out.size);
    fprintf(file, "{\"format\": \"starguard-pieces\", \"version\": 1, \"mode\": \"%s\",\n",
            report->mode == STARG_DECOMPOSE_PAPER ? "paper" : "strict");
    fprintf(file, "\"tetrahedra\": %zu, \"pieces\": [", report->tetrahedra);
    for (size_t p = 0; p < report->piece_count; p++) {
        const starg_piece *piece = &report->pieces[p];
        fprintf(file,
                "%s{\"guard\": [%.17g, %.17g, %.17g], \"tetrahedra\": %zu, \"volume\": %.17g, "
                "\"star\": %s}",
                p > 0 ? ",\n" : "\n", piece->guard[0], piece->guard[1], piece->guard[2],
                piece->tetrahedra, piece->volume, piece->star ? "true" : "false");
    }
    fprintf(file, "],\n\"strictly_star\": %zu, \"visible_vertices\": %.17g, \"adjacency\": [",
            report->strictly_star, report->visible_vertices);
    for (size_t i = 0; i < report->contact_count; i++)
        fprintf(file, "%s[%u, %u, %.17g]", i > 0 ? ", " : "", report->contacts[i].first,
                report->contacts[i].second, report->contacts[i].area);
    fprintf(file, "]%s}\n",
            report->approximated ? ", \"surface\": \"approximated\", \"distance\": 0.25" : "");
    fclose(file);
    return out;
}

static void expect_same_mesh(const starg_pieces_mesh *a, const starg_pieces_mesh *b) {
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->count, b->count);
    assert_memory_equal(a->vertices, b->vertices, 3 * a->vertex_count * sizeof(double));
    assert_memory_equal(a->tetrahedra, b->tetrahedra, 4 * a->count * sizeof(uint32_t));
    assert_memory_equal(a->labels, b->labels, a->count * sizeof(int32_t));
}

static void test_files_give_back_what_was_written(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    cut *c = new_cut(&CAVITY);
    for (coding code = TEXT; code < CODINGS; code++) {
        text vtk = write_vtk(&c->mesh, code);
        starg_pieces_mesh *mesh = NULL;
        test_ok(context, starg_pieces_mesh_read_memory(context, vtk.bytes, vtk.size, "p", &mesh));
        expect_same_mesh(mesh, &c->mesh);
        starg_pieces_mesh_free(context, mesh);
        free(vtk.bytes);
    }
    c->report.mode = STARG_DECOMPOSE_PAPER;
    c->report.approximated = true;
    text json = write_report(&c->report);
    starg_pieces_report *report = NULL;
    test_ok(context, starg_pieces_report_read_memory(context, json.bytes, json.size, "r", &report));
    assert_int_equal(report->mode, STARG_DECOMPOSE_PAPER);
    assert_int_equal(report->tetrahedra, c->report.tetrahedra);
    assert_int_equal(report->piece_count, c->report.piece_count);
    assert_int_equal(report->contact_count, c->report.contact_count);
    assert_int_equal(report->strictly_star, c->report.strictly_star);
    assert_true(report->visible_vertices == 1 && report->approximated && report->distance == 0.25);
    for (size_t p = 0; p < report->piece_count; p++) {
        assert_memory_equal(report->pieces[p].guard, c->pieces[p].guard, 3 * sizeof(double));
        assert_true(report->pieces[p].volume == c->pieces[p].volume && report->pieces[p].star);
        assert_int_equal(report->pieces[p].tetrahedra, c->pieces[p].tetrahedra);
    }
    assert_memory_equal(report->contacts, c->contacts, report->contact_count * sizeof *c->contacts);
    starg_pieces_report_free(context, report);
    free(json.bytes);
    free(c);
    test_context_free(context);
}

/* Reads bytes that are of either kind; what cannot be read is refused with a message. */
static starg_status read_any(starg_context *context, bool json, const char *bytes, size_t size) {
    starg_pieces_mesh *mesh = NULL;
    starg_pieces_report *report = NULL;
    char *exact = malloc(size + 1); /* so that reading beyond the end is found */
    memcpy(exact, bytes, size);
    exact = realloc(exact, size > 0 ? size : 1);
    starg_status status =
        json ? starg_pieces_report_read_memory(context, exact, size, "file", &report)
             : starg_pieces_mesh_read_memory(context, exact, size, "file", &mesh);
    free(exact);
    if (status == STARG_OK) {
        starg_pieces_mesh_free(context, mesh);
        starg_pieces_report_free(context, report);
    } else {
        assert_null(mesh);
        assert_null(report);
        assert_true(status == STARG_ERROR_FORMAT || status == STARG_ERROR_RANGE);
        assert_non_null(strstr(starg_context_error(context)->message, "file"));
    }
    return status;
}

static void test_truncated_files(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    cut *c = new_cut(&HALVES);
    for (int kind = 0; kind < 3; kind++) {
        text whole = kind < 2 ? write_vtk(&c->mesh, (coding)kind) : write_report(&c->report);
        for (size_t size = 0; size <= whole.size; size++) {
            bool good = size >= whole.size - (kind != DOUBLES); /* a line end may be missing */
            assert_int_equal(read_any(context, kind == 2, whole.bytes, size) == STARG_OK, good);
        }
        free(whole.bytes);
    }
    free(c);
    test_context_free(context);
}

/* Bytes changed at random: read or refused, nothing lost. */
static void test_mutilated_files(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    cut *c = new_cut(&BEND);
    size_t read = 0, refused = 0;
    for (int kind = 0; kind < 3; kind++) {
        text whole = kind < 2 ? write_vtk(&c->mesh, (coding)kind) : write_report(&c->report);
        for (uint64_t round = 0; round < 3000; round++) {
            starg_rng rng = starg_rng_make(29, (uint64_t)kind, round);
            char *bytes = malloc(whole.size);
            memcpy(bytes, whole.bytes, whole.size);
            for (uint64_t i = starg_rng_below(&rng, 3) + 1; i > 0; i--)
                bytes[starg_rng_below(&rng, whole.size)] =
                    starg_rng_below(&rng, 2) ? (char)starg_rng_below(&rng, 256)
                                             : " 0123456789-.e\n"[starg_rng_below(&rng, 15)];
            if (read_any(context, kind == 2, bytes, whole.size) == STARG_OK)
                read++;
            else
                refused++;
            free(bytes);
        }
        free(whole.bytes);
    }
    assert_true(read > 300 && refused > 300);
    free(c);
    test_context_free(context);
}

/* Puts `new` in the place of the first `old`, and reads. */
static void expect_refusal(starg_context *context, bool json, text whole, const char *old,
                           const char *new, const char *says) {
    char *at = strstr(whole.bytes, old);
    if (at == NULL)
        fail_msg("there is no '%s' in %s", old, whole.bytes);
    size_t head = (size_t)(at - whole.bytes), tail = whole.size - head - strlen(old);
    char *bytes = malloc(head + strlen(new) + tail);
    memcpy(bytes, whole.bytes, head);
    memcpy(bytes + head, new, strlen(new));
    memcpy(bytes + head + strlen(new), at + strlen(old), tail);
    if (read_any(context, json, bytes, head + strlen(new) + tail) == STARG_OK)
        fail_msg("'%s' for '%s' is read", new, old);
    if (strstr(starg_context_error(context)->message, says) == NULL)
        fail_msg("'%s' for '%s': %s", new, old, starg_context_error(context)->message);
    free(bytes);
}

typedef struct refusal {
    const char *old, *new, *says;
} refusal;

static void test_bad_files(void **state) {
    (void)state;
    static const refusal texts[] = {
        {"# vtk", "# vtx", "line 1: this is no legacy VTK file"},
        {"Version 3", "Version 5", "only versions below 5"},
        {"ASCII", "ASCIL", "ASCII or BINARY"},
        {"UNSTRUCTURED_GRID", "POLYDATA", "\"UNSTRUCTURED_GRID\" is expected"},
        {"double", "int", "type float or double"},
        {"POINTS 45", "POINTS 44", "\"CELLS\" is expected"},
        {"POINTS 45", "POINTS 100000000000", "more is declared than the file holds"},
        {"POINTS 45", "POINTS -1", "the count is negative"},
        {"POINTS 45", "POINTS 9999999999999999999", "whole number is expected"},
        {"\n0.5\n", "\nnan\n", "point 0 is not finite"},
        {"\n0.5\n", "\n-inf\n", "point 0 is not finite"},
        {"\n0.5\n", "\n1e100\n", "point 0 is not finite"},
        {"\n0.5\n", "\n0x1p1\n", "line 6: a number is expected"},
        {"\n0.5\n", "\n0.5.5\n", "line 6: a number is expected"},
        {"CELLS 96", "CELLS 100000000", "more is declared than the file holds"},
        {"CELLS 96", "CELLS 0", "there are no cells"},
        {"CELLS 96 480", "CELLS 96 481", "five numbers for each"},
        {"480\n4 ", "480\n5 ", "cell 0 is no tetrahedron: its number of corners is 5"},
        {"\n4 5 3 4 0", "\n4 5 3 4 45", "cell 0 names a point that does not exist: 45"},
        {"\n4 5 3 4 0", "\n4 5 -3 4 0", "cell 0 names a point that does not exist: -3"},
        {"\n4 5 3 4 0", "\n4 5 3 4 0.5", "whole number is expected"},
        {"CELL_TYPES 96", "CELL_TYPES 95", "as many types as cells"},
        {"CELL_TYPES 96\n10", "CELL_TYPES 96\n12", "it is of type 12"},
        {"CELL_DATA 96", "CELL_DATA 97", "as many labels as cells"},
        {"CELL_DATA", "POINT_DATA", "\"CELL_DATA\" is expected"},
        {"SCALARS piece", "SCALARS label", "\"piece\" is expected"},
        {"piece int", "piece float", "\"int\" is expected"},
        {"default\n0", "default\nx", "whole number is expected"},
        {"default\n0", "default\n4294967296", "label beyond 32 bits"},
        {"default\n0", "default\n0\n0", "more follows behind the last label"},
    };
    static const refusal reports[] = {
        {"starguard-pieces", "starguard-guards", "\"format\" must be"},
        {"\"version\": 1", "\"version\": 2", "\"version\" must be 1"},
        {"strict", "strange", "\"mode\" must be \"strict\" or \"paper\""},
        {"\"tetrahedra\": 96", "\"tetrahedra\": -1", "\"tetrahedra\" must be"},
        {"\"tetrahedra\": 48", "\"tetrahedra\": 48.5", "\"tetrahedra\" must be"},
        {"\"guard\": [", "\"guard\": [1,", "\"guard\" must be an array of three"},
        {"\"guard\": [0.5", "\"guard\": [1e100", "\"guard\" must be an array of three"},
        {"\"guard\"", "\"guards\"", "\"guard\" must be an array of three"},
        {"\"star\": true", "\"star\": 1", "\"star\" must be true or false"},
        {"\"volume\": ", "\"volume\": null, \"v\": ", "\"volume\" must be a number"},
        {"\"pieces\": [", "\"pieces\": {}, \"p\": [", "\"pieces\" must be an array"},
        {"\"adjacency\": [[0", "\"adjacency\": [[-1", "\"adjacency\" must be"},
        {"\"adjacency\": [[0,", "\"adjacency\": [[", "\"adjacency\" must be"},
        {"\"adjacency\"", "\"contacts\"", "\"adjacency\" must be an array"},
        {"]}", "], \"surface\": \"near\"}", "\"surface\" must be"},
        {"]}", "], \"surface\": \"approximated\"}", "\"distance\" must be a number"},
        {"]}", "]", "line"},
    };
    starg_context *context = test_context(1);
    cut *c = new_cut(&HALVES);
    text vtk = write_vtk(&c->mesh, TEXT), json = write_report(&c->report);
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        expect_refusal(context, false, vtk, texts[i].old, texts[i].new, texts[i].says);
    for (size_t i = 0; i < sizeof reports / sizeof *reports; i++)
        expect_refusal(context, true, json, reports[i].old, reports[i].new, reports[i].says);
    free(vtk.bytes);
    free(json.bytes);
    free(c);
    test_context_free(context);
}

static void test_bad_arrays(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape model = model_of(&HALVES);
    starg_mesh *mesh = make_mesh(context, &model);
    cut *c = new_cut(&HALVES);
    starg_verdict *verdict;
    c->tetrahedra[7] = (uint32_t)c->mesh.vertex_count;
    assert_int_equal(starg_verify_pieces(context, mesh, &c->mesh, &c->report, &verdict),
                     STARG_ERROR_ARGUMENT);
    c->tetrahedra[7] = 0;
    c->vertices[4] = INFINITY;
    assert_int_equal(starg_verify_pieces(context, mesh, &c->mesh, &c->report, &verdict),
                     STARG_ERROR_RANGE);
    c->mesh.count = 0;
    assert_int_equal(starg_verify_pieces(context, mesh, &c->mesh, &c->report, &verdict),
                     STARG_ERROR_ARGUMENT);
    assert_null(verdict);
    starg_mesh_free(mesh);
    shape_free(&model);
    free(c);
    test_context_free(context);
}

/* ---- without a report, without memory ---- */

static void test_without_report(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape model = model_of(&RING);
    starg_mesh *mesh = make_mesh(context, &model);
    cut *c = new_cut(&RING);
    starg_verdict *verdict;
    test_ok(context, starg_verify_pieces(context, mesh, &c->mesh, NULL, &verdict));
    expect_consistent(verdict);
    assert_true(verdict->passed);
    starg_verdict_free(context, verdict);
    c->labels[0] = 9;
    test_ok(context, starg_verify_pieces(context, mesh, &c->mesh, NULL, &verdict));
    assert_false(verdict->passed);
    starg_verdict_free(context, verdict);
    for (size_t t = 0; t < c->mesh.count; t++)
        c->labels[t] = -2;
    test_ok(context, starg_verify_pieces(context, mesh, &c->mesh, NULL, &verdict));
    assert_false(verdict->passed);
    starg_verdict_free(context, verdict);
    starg_mesh_free(mesh);
    shape_free(&model);
    free(c);
    test_context_free(context);
}

/* Memory that runs out after a number of blocks. */
typedef struct purse {
    long left;
} purse;

static void *spend(void *user, size_t size) {
    purse *own = user;
    return own->left-- > 0 ? malloc(size) : NULL;
}

static void give_back(void *user, void *block) {
    (void)user;
    free(block);
}

/* Reading both files and verifying, in paper mode with lines of sight, or near the model. */
static starg_status read_and_verify(starg_context *context, const starg_mesh *mesh, text vtk,
                                    text json) {
    starg_pieces_mesh *pieces = NULL;
    starg_pieces_report *report = NULL;
    starg_verdict *verdict = NULL;
    starg_status status = starg_pieces_mesh_read_memory(context, vtk.bytes, vtk.size, "p", &pieces);
    if (status == STARG_OK)
        status = starg_pieces_report_read_memory(context, json.bytes, json.size, "r", &report);
    if (status == STARG_OK)
        status = starg_verify_pieces(context, mesh, pieces, report, &verdict);
    starg_pieces_mesh_free(context, pieces);
    starg_pieces_report_free(context, report);
    starg_verdict_free(context, verdict);
    return status;
}

static void test_out_of_memory(void **state) {
    (void)state;
    shape model = model_of(&RING);
    cut *c = new_cut(&RING);
    purse own = {1000000};
    starg_context_options options;
    starg_context_options_default(&options);
    options.threads = 1;
    options.allocator = (starg_allocator){spend, give_back, &own};
    starg_context *context;
    assert_int_equal(starg_context_create(&options, &context), STARG_OK);
    starg_mesh *mesh = make_mesh(context, &model);
    size_t before = starg_context_live_blocks(context);
    c->report.mode = STARG_DECOMPOSE_PAPER;
    c->pieces[0].guard[1] = 1;
    for (int near = 0; near < 2; near++) {
        c->report.approximated = near;
        text vtk = write_vtk(&c->mesh, TEXT), json = write_report(&c->report);
        starg_status status = STARG_ERROR_MEMORY;
        long blocks = 0;
        for (; status != STARG_OK; blocks++) {
            own.left = blocks;
            status = read_and_verify(context, mesh, vtk, json);
            assert_true(status == STARG_OK || status == STARG_ERROR_MEMORY);
            assert_int_equal(starg_context_live_blocks(context), before);
        }
        assert_true(blocks > 30);
        own.left = 1000000;
        free(vtk.bytes);
        free(json.bytes);
    }
    starg_mesh_free(mesh);
    test_context_free(context);
    shape_free(&model);
    free(c);
}

/* ---- the search tree ---- */

typedef struct tally {
    uint8_t *visited;
    size_t count;
} tally;

static bool visit(void *data, uint32_t face) {
    tally *own = data;
    own->count++;
    assert_int_equal(own->visited[face]++, 0);
    return true;
}

static bool box_meets(const double lower[3], const double upper[3], const double *const t[3]) {
    for (int k = 0; k < 3; k++)
        if (fmax(fmax(t[0][k], t[1][k]), t[2][k]) < lower[k] ||
            fmin(fmin(t[0][k], t[1][k]), t[2][k]) > upper[k])
            return false;
    return true;
}

static void compare_boxes(const verify_surface *surface, const verify_tree *tree, const double p[3],
                          const double q[3]) {
    double lower[3], upper[3];
    for (int k = 0; k < 3; k++) {
        lower[k] = fmin(p[k], q[k]);
        upper[k] = fmax(p[k], q[k]);
    }
    tally own = {calloc(surface->face_count, 1), 0};
    verify_tree_visit(tree, lower, upper, visit, &own);
    for (size_t f = 0; f < surface->face_count; f++) {
        const double *t[3];
        verify_corners(surface, f, t);
        assert_int_equal(own.visited[f], box_meets(lower, upper, t));
    }
    free(own.visited);
}

/* Random triangles on random points of every family. */
static void test_tree(void **state) {
    (void)state;
    enum { FACES = 60, POINTS = 24, ROUNDS = 25 };
    starg_context *context = test_context(1);
    size_t blocked = 0, free_lines = 0;
    for (int family = 0; family < POINT_FAMILIES; family++)
        for (uint64_t round = 0; round < ROUNDS; round++) {
            starg_rng rng = starg_rng_make(31, (uint64_t)family, round);
            double x[POINTS][3];
            uint32_t *faces = starg_allocate(context, 3 * (size_t)FACES, sizeof *faces);
            size_t count = round == 0 ? 0 : (size_t)starg_rng_below(&rng, FACES) + 1;
            adversarial_points(&rng, (point_family)family, x, POINTS);
            for (size_t i = 0; i < 3 * count; i++)
                faces[i] = (uint32_t)starg_rng_below(&rng, POINTS);
            verify_surface *surface = NULL;
            verify_tree *tree = NULL;
            test_ok(context, verify_surface_wrap(context, x[0], POINTS, faces, count, &surface));
            test_ok(context, verify_tree_create(surface, &tree));
            for (int i = 0; i < POINTS; i++) {
                const double *p = x[i], *q = x[starg_rng_below(&rng, POINTS)];
                int scale = verify_scale(surface);
                bool on = false, blocks = false;
                for (size_t f = 0; f < count; f++) {
                    const double *t[3];
                    verify_corners(surface, f, t);
                    on = on || verify_on_triangle(p, t);
                    blocks = blocks || verify_blocks(p, q, t);
                }
                if (!on) {
                    assert_int_equal(verify_tree_blocks(tree, p, q), blocks);
                    blocked += blocks;
                    free_lines += !blocks;
                }
                compare_boxes(surface, tree, p, q);
                double near = verify_distance(surface, p, scale);
                double found = verify_tree_distance(tree, p, scale);
                assert_true(near == found || fabs(near - found) <= ldexp(1e-12, -scale));
            }
            verify_tree_free(tree);
            verify_surface_free(surface);
        }
    assert_true(blocked > 100 && free_lines > 100);
    test_context_free(context);
}

/* ---- facets ---- */

/* Random tetrahedra on few vertices: mates are unique, mutual and opposite; every triangle without
 * misuse is mated exactly if it occurs twice. */
static void test_facets(void **state) {
    (void)state;
    enum { MOST = 40 };
    starg_context *context = test_context(1);
    size_t mated = 0, misused = 0;
    for (uint64_t round = 0; round < 300; round++) {
        starg_rng rng = starg_rng_make(37, round, 0);
        static cut c;
        memset(&c, 0, sizeof c);
        size_t vertices = 4 + (size_t)starg_rng_below(&rng, 12);
        size_t count = 1 + (size_t)starg_rng_below(&rng, MOST);
        while (c.mesh.count < count) {
            uint32_t v[4];
            for (int i = 0; i < 4; i++)
                v[i] = (uint32_t)starg_rng_below(&rng, vertices);
            if (v[0] != v[1] && v[0] != v[2] && v[0] != v[3] && v[1] != v[2] && v[1] != v[3] &&
                v[2] != v[3])
                add_tetrahedron(&c, v[0], v[1], v[2], v[3], 0);
        }
        verify_facets *facets = NULL;
        test_ok(context, verify_facets_create(context, c.tetrahedra, count, &facets));
        size_t wrong = 0;
        for (uint32_t f = 0; f < 4 * count; f++) {
            uint32_t a[3], b[3], same = 0, other = 0, mate = facets->mate[f];
            side_of(&c, f / 4, (int)(f % 4), a);
            for (uint32_t g = 0; g < 4 * count; g++) {
                side_of(&c, g / 4, (int)(g % 4), b);
                const uint32_t turned[3] = {b[0], b[2], b[1]};
                other += opposite(a, b);
                same += opposite(a, turned);
            }
            wrong += same > 1 || other > 1;
            if (same == 1 && other <= 1)
                assert_int_equal(mate != VERIFY_NONE, other == 1);
            if (mate == VERIFY_NONE)
                continue;
            mated++;
            side_of(&c, mate / 4, (int)(mate % 4), b);
            assert_true(opposite(a, b) && facets->mate[mate] == f);
        }
        assert_int_equal(facets->third.count + facets->same_side.count > 0, wrong > 0);
        misused += wrong > 0;
        verify_facets_free(facets);
    }
    assert_true(mated > 100 && misused > 20 && misused < 290);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_true_decompositions_pass),
        cmocka_unit_test(test_scales),
        cmocka_unit_test(test_each_falsification_fails),
        cmocka_unit_test(test_guard_at_a_plane),
        cmocka_unit_test(test_subdivided),
        cmocka_unit_test(test_double_winding),
        cmocka_unit_test(test_model_turned_inside_out),
        cmocka_unit_test(test_approximated),
        cmocka_unit_test(test_overlap_of_shells),
        cmocka_unit_test(test_tetmesh_model),
        cmocka_unit_test(test_visible_vertices),
        cmocka_unit_test(test_files_give_back_what_was_written),
        cmocka_unit_test(test_truncated_files),
        cmocka_unit_test(test_mutilated_files),
        cmocka_unit_test(test_bad_files),
        cmocka_unit_test(test_bad_arrays),
        cmocka_unit_test(test_without_report),
        cmocka_unit_test(test_out_of_memory),
        cmocka_unit_test(test_tree),
        cmocka_unit_test(test_facets),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
