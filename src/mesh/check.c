/* SPDX-License-Identifier: Apache-2.0 */
/* Checks a mesh as the boundary of a solid.
 *
 * Parts of it may share vertices and edges where they touch, if all faces there have partners
 * (mesh/wings.c): then it is examined with vertices of their own for all fans.
 *
 * Stages: corners, edges, vertices (fans), positions, duplicate faces, degenerate faces,
 * intersections of all pairs with overlapping boxes (by the tree), shells. All decisions are exact.
 * Cost: O(n log n) plus the number of box pairs. */

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "geometry/predicates.h"
#include "mesh/examine.h"

typedef struct checker {
    starg_context *context;
    const starg_mesh *mesh;
    starg_check *check;
    mesh_topology *topology;
    bvh *tree;
    mesh_shell *shells;
    uint8_t *touching; /* by face: meets another shell */
    size_t pairs;      /* of faces tested so far */
} checker;

/* Pairs between two checks of the clock. */
enum { PAIRS_PER_CLOCK = 4096 };

const char *starg_finding_name(starg_finding_kind kind) {
    static const char *const names[STARG_FINDING_KINDS] = {
        "open edges",         "non-manifold edges", "non-manifold vertices", "inconsistent edges",
        "repeated corners",   "inward shells",      "degenerate faces",      "duplicate faces",
        "duplicate vertices", "isolated vertices",  "self-intersections",    "self-contacts"};
    return kind < STARG_FINDING_KINDS ? names[kind] : "unknown findings";
}

static void mark_face(checker *c, starg_finding_kind kind, size_t face) {
    uint8_t *mark = &c->check->face_marks[face];
    if (*mark == 0 || *mark > kind + 1)
        *mark = (uint8_t)(kind + 1);
}

static void find_one(checker *c, starg_finding_kind kind, starg_element element, uint64_t index) {
    starg_finding *finding = &c->check->findings[kind];
    finding->count++;
    finding->element = element;
    if (finding->shown < STARG_ERROR_INDICES)
        finding->first[finding->shown++] = index;
}

static void find_pair(checker *c, starg_finding_kind kind, starg_element element, uint64_t a,
                      uint64_t b) {
    starg_finding *finding = &c->check->findings[kind];
    find_one(c, kind, element, a);
    if (finding->shown < STARG_ERROR_INDICES)
        finding->first[finding->shown++] = b;
}

static const double *position(const checker *c, uint32_t vertex) {
    return c->mesh->vertices + 3 * (size_t)vertex;
}

static void check_corners(checker *c) {
    const uint32_t *f = c->mesh->faces;
    for (size_t i = 0; i < c->mesh->face_count; i++, f += 3) {
        if (f[0] != f[1] && f[1] != f[2] && f[2] != f[0])
            continue;
        find_one(c, STARG_FINDING_REPEATED_CORNER, STARG_ELEMENT_FACE, i);
        mark_face(c, STARG_FINDING_REPEATED_CORNER, i);
    }
}

static void check_edge(checker *c, uint32_t halfedge) {
    const uint32_t *faces = c->mesh->faces;
    uint32_t a = faces[halfedge], b = faces[corner_next(halfedge)];
    size_t count = topology_edge_faces(c->topology, halfedge);
    starg_finding_kind kind;
    if (count == 1)
        kind = STARG_FINDING_OPEN_EDGE;
    else if (count > 2)
        kind = STARG_FINDING_NONMANIFOLD_EDGE;
    else if (faces[c->topology->ring[halfedge]] == a)
        kind = STARG_FINDING_INCONSISTENT_EDGE;
    else
        return;
    find_pair(c, kind, STARG_ELEMENT_EDGE, a < b ? a : b, a < b ? b : a);
    for (size_t i = 0; i < count; i++, halfedge = c->topology->ring[halfedge])
        mark_face(c, kind, halfedge / 3);
}

static void check_edges(checker *c) {
    for (uint32_t h = 0; h < 3 * c->mesh->face_count; h++) {
        bool lowest = true;
        for (uint32_t o = c->topology->ring[h]; o != h && lowest; o = c->topology->ring[o])
            lowest = h < o;
        if (lowest)
            check_edge(c, h);
    }
}

static starg_status check_vertices(checker *c) {
    size_t corners = 3 * c->mesh->face_count;
    SCOPED uint32_t *fan = NULL, *fans = NULL;
    NEW(c->context, "check", fan, corners);
    NEW_ZERO(c->context, "check", fans, c->mesh->vertex_count);
    wings_find_fans(c->topology, c->mesh, fan);
    for (uint32_t h = 0; h < corners; h++)
        if (sets_find(fan, h) == h)
            fans[c->mesh->faces[h]]++;
    for (size_t v = 0; v < c->mesh->vertex_count; v++) {
        if (fans[v] == 0)
            find_one(c, STARG_FINDING_ISOLATED_VERTEX, STARG_ELEMENT_VERTEX, v);
        else if (fans[v] > 1)
            find_one(c, STARG_FINDING_NONMANIFOLD_VERTEX, STARG_ELEMENT_VERTEX, v);
    }
    for (size_t h = 0; h < corners; h++)
        if (fans[c->mesh->faces[h]] > 1)
            mark_face(c, STARG_FINDING_NONMANIFOLD_VERTEX, h / 3);
    return STARG_OK;
}

typedef struct place {
    double p[3];
    uint32_t vertex;
} place;

static int compare_places(const void *left, const void *right) {
    const place *a = left, *b = right;
    for (int k = 0; k < 3; k++)
        if (a->p[k] != b->p[k])
            return a->p[k] < b->p[k] ? -1 : 1;
    return (a->vertex > b->vertex) - (a->vertex < b->vertex);
}

starg_status mesh_find_coincident(starg_context *context, const starg_mesh *mesh, uint32_t **first,
                                  size_t *count) {
    SCOPED place *places = NULL;
    *first = NULL;
    *count = 0;
    NEW(context, "check", places, mesh->vertex_count);
    NEW(context, "check", *first, mesh->vertex_count);
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        memcpy(places[v].p, mesh->vertices + 3 * v, sizeof places[v].p);
        places[v].vertex = (uint32_t)v;
    }
    qsort(places, mesh->vertex_count, sizeof *places, compare_places);
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        const double *p = places[i].p, *q = places[i > 0 ? i - 1 : 0].p;
        bool again = i > 0 && p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
        (*first)[places[i].vertex] = again ? (*first)[places[i - 1].vertex] : places[i].vertex;
        *count += again;
    }
    return STARG_OK;
}

static starg_status check_positions(checker *c) {
    uint32_t *first = NULL;
    size_t count;
    starg_status status = mesh_find_coincident(c->context, c->mesh, &first, &count);
    for (size_t v = 0; status == STARG_OK && v < c->mesh->vertex_count; v++)
        if (first[v] != v)
            find_one(c, STARG_FINDING_DUPLICATE_VERTEX, STARG_ELEMENT_VERTEX, v);
    starg_release(c->context, first);
    return status;
}

static bool same_corners(const uint32_t *a, const uint32_t *b) {
    int common = 0;
    for (int i = 0; i < 3; i++)
        common += a[i] == b[0] || a[i] == b[1] || a[i] == b[2];
    return common == 3;
}

/* Duplicates share all edges: the edge ring of the first one contains the others. */
static void check_duplicates(checker *c) {
    const uint32_t *faces = c->mesh->faces;
    for (uint32_t f = 0; f < c->mesh->face_count; f++) {
        bool doubled = false;
        for (uint32_t h = c->topology->ring[3 * f]; h != 3 * f && !doubled;
             h = c->topology->ring[h])
            doubled = h / 3 < f && same_corners(faces + 3 * (size_t)f, faces + h / 3 * (size_t)3);
        if (!doubled)
            continue;
        find_one(c, STARG_FINDING_DUPLICATE_FACE, STARG_ELEMENT_FACE, f);
        mark_face(c, STARG_FINDING_DUPLICATE_FACE, f);
    }
}

static void check_areas(checker *c) {
    const uint32_t *f = c->mesh->faces;
    for (size_t i = 0; i < c->mesh->face_count; i++, f += 3) {
        if (f[0] == f[1] || f[1] == f[2] || f[2] == f[0])
            continue;
        if (!collinear(position(c, f[0]), position(c, f[1]), position(c, f[2])))
            continue;
        find_one(c, STARG_FINDING_DEGENERATE_FACE, STARG_ELEMENT_FACE, i);
        mark_face(c, STARG_FINDING_DEGENERATE_FACE, i);
    }
}

/* Does an edge of face a pass through the inside of face b? */
static bool passes_through(const checker *c, uint32_t a, uint32_t b) {
    const double *s[3], *t[3];
    bool passes = false;
    for (size_t k = 0; k < 3; k++) {
        s[k] = position(c, c->mesh->faces[3 * (size_t)a + k]);
        t[k] = position(c, c->mesh->faces[3 * (size_t)b + k]);
    }
    for (int i = 0; i < 3 && !passes; i++) {
        const double *p = s[i], *q = s[(i + 1) % 3];
        int turn = orient3d(p, q, t[0], t[1]);
        passes = orient3d(t[0], t[1], t[2], p) * orient3d(t[0], t[1], t[2], q) < 0 && turn != 0 &&
                 turn == orient3d(p, q, t[1], t[2]) && turn == orient3d(p, q, t[2], t[0]);
    }
    return passes;
}

/* Shells that touch, or overlap in faces, need not cross. */
static void note_shells(checker *c, uint32_t a, uint32_t b, triangle_contact contact) {
    uint32_t first = c->topology->component[a], second = c->topology->component[b];
    if (contact == TRIANGLES_APART || first == second)
        return;
    c->touching[a] = c->touching[b] = 1;
    if (contact == TRIANGLES_CROSS && (passes_through(c, a, b) || passes_through(c, b, a)))
        c->shells[first].crossed = c->shells[second].crossed = true;
}

static triangle_contact contact_of(const checker *c, uint32_t a, uint32_t b) {
    const uint32_t *faces = c->mesh->faces;
    return faces_contact(c->mesh->vertices, faces + 3 * (size_t)a, faces + 3 * (size_t)b);
}

/* Is the contact more than that of neighbours? */
static bool is_contact(void *user, uint32_t a, uint32_t b) {
    const checker *c = user;
    triangle_contact contact = contact_of(c, a, b);
    return contact == TRIANGLES_TOUCH || contact == TRIANGLES_CROSS ||
           (contact == TRIANGLES_SHARE && c->topology->component[a] != c->topology->component[b]);
}

static bool check_pair(void *user, uint32_t a, uint32_t b) {
    checker *c = user;
    triangle_contact contact = contact_of(c, a, b);
    note_shells(c, a, b, contact);
    if (contact == TRIANGLES_TOUCH || contact == TRIANGLES_CROSS) {
        starg_finding_kind kind = contact == TRIANGLES_CROSS ? STARG_FINDING_SELF_INTERSECTION
                                                             : STARG_FINDING_SELF_CONTACT;
        find_pair(c, kind, STARG_ELEMENT_FACE, a, b);
        mark_face(c, kind, a);
        mark_face(c, kind, b);
    }
    bool look_up = ++c->pairs % PAIRS_PER_CLOCK == 0;
    return !(look_up && starg_time_has_failed(c->context)) &&
           !atomic_load_explicit(&c->context->cancelled, memory_order_relaxed);
}

static starg_status check_intersections(checker *c) {
    starg_status status = face_pairs_visit(c->context, c->mesh, c->tree, is_contact, check_pair, c);
    return status != STARG_OK ? status : starg_check_cancel(c->context, "check");
}

static size_t count_of(const checker *c, starg_finding_kind kind) {
    return c->check->findings[kind].count;
}

/* Then areas or volumes underflow, and commands refuse it. */
static bool is_too_small(const checker *c) {
    return !mesh_is_wide(c->mesh) || c->check->area < DBL_MIN || c->check->volume < DBL_MIN;
}

static starg_status check_shells(checker *c) {
    starg_check *check = c->check;
    starg_status status =
        shells_classify(c->context, c->mesh, c->topology, c->tree, c->touching, c->shells);
    if (status != STARG_OK)
        return status;
    double volume = 0; /* scaled: the true volume may underflow */
    for (size_t i = 0; i < c->topology->component_count; i++) {
        const mesh_shell *own = &c->shells[i];
        check->cavities += own->cavity;
        volume += own->turn ? -own->volume : own->volume;
        if (own->turn)
            find_one(c, STARG_FINDING_INWARD_COMPONENT, STARG_ELEMENT_FACE, own->first_face);
    }
    check->volume = ldexp(volume, 3 * starg_mesh_exponent(c->mesh));
    check->underflows = volume > 0 && is_too_small(c);
    check->usable = volume > 0 && !check->underflows;
    return STARG_OK;
}

bool mesh_is_rounded(const starg_check *check) {
    return check->coarse && !check->embedded;
}

void starg_check_describe_grid(const starg_check *check, char *text, size_t size) {
    const double *g = check->grid;
    text[0] = '\0';
    if (check->coarse)
        snprintf(
            text, size,
            "coordinates have steps of %.3g, %.3g and %.3g (x, y, z), and the shortest edge is "
            "%.3g: finer parts, if there were any, are lost in the file; take one in double "
            "precision, or about an origin near the model",
            g[0], g[1], g[2], check->shortest_edge);
}

bool mesh_only_touches(const starg_check *check) {
    return check->findings[STARG_FINDING_SELF_INTERSECTION].count == 0 &&
           check->findings[STARG_FINDING_DEGENERATE_FACE].count == 0;
}

/* Does every face have one neighbour across each edge, facing the same way, and every vertex one
 * fan? Then the Euler characteristic tells the genus. */
static bool is_sound(const checker *c) {
    bool sound = c->check->closed && c->check->oriented &&
                 count_of(c, STARG_FINDING_NONMANIFOLD_VERTEX) == 0 &&
                 count_of(c, STARG_FINDING_REPEATED_CORNER) == 0;
    for (size_t h = 0; h < 3 * c->mesh->face_count && sound; h++)
        sound = c->topology->twin[h] != TOPOLOGY_NONE;
    return sound;
}

static void summarise(checker *c) {
    starg_check *check = c->check;
    check->vertices = c->mesh->vertex_count;
    check->faces = c->mesh->face_count;
    check->edges = c->topology->edge_count;
    check->components = c->topology->component_count;
    check->area = starg_mesh_area(c->mesh);
    check->diagonal = mesh_diagonal(c->mesh);
    check_steps(c->mesh, check);
    check->manifold = count_of(c, STARG_FINDING_NONMANIFOLD_EDGE) == 0 &&
                      count_of(c, STARG_FINDING_NONMANIFOLD_VERTEX) == 0 &&
                      count_of(c, STARG_FINDING_REPEATED_CORNER) == 0;
    check->closed = count_of(c, STARG_FINDING_OPEN_EDGE) == 0 && check->faces > 0;
    check->oriented = count_of(c, STARG_FINDING_INCONSISTENT_EDGE) == 0;
    check->embedded = count_of(c, STARG_FINDING_DEGENERATE_FACE) == 0 &&
                      count_of(c, STARG_FINDING_SELF_INTERSECTION) == 0 &&
                      count_of(c, STARG_FINDING_SELF_CONTACT) == 0 && check->manifold;
    check->genus = -1;
    if (is_sound(c) || (check->closed && check->manifold)) {
        int64_t used = (int64_t)(check->vertices - count_of(c, STARG_FINDING_ISOLATED_VERTEX));
        int64_t euler = used - (int64_t)check->faces / 2;
        check->genus = (int64_t)check->components - euler / 2;
    }
}

starg_status mesh_examine(starg_context *context, const starg_mesh *mesh, mesh_examination *out) {
    starg_status status = STARG_OK;
    checker c = {.context = context, .mesh = mesh};
    starg_progress_begin(context, "check");
    STARG_NEW_ZERO(context, "check", c.check, 1);
    STARG_NEW_ZERO(context, "check", c.check->face_marks, mesh->face_count);
    STARG_TRY(wings_create(context, mesh, &c.topology));
    STARG_TRY(starg_check_cancel(context, "check"));
    STARG_TRY(bvh_create(context, mesh->vertices, mesh->faces, mesh->face_count, &c.tree));
    STARG_TRY(starg_check_cancel(context, "check"));
    STARG_NEW_ZERO(context, "check", c.shells, c.topology->component_count);
    STARG_NEW_ZERO(context, "check", c.touching, mesh->face_count);
    check_corners(&c);
    check_edges(&c);
    STARG_TRY(check_vertices(&c));
    STARG_TRY(check_positions(&c));
    STARG_TRY(starg_check_cancel(context, "check"));
    check_duplicates(&c);
    check_areas(&c);
    STARG_TRY(check_intersections(&c));
    summarise(&c);
    if (is_sound(&c) && (c.check->manifold || mesh_only_touches(c.check)))
        STARG_TRY(check_shells(&c));
    if (!c.check->oriented)
        STARG_TRY(topology_count_one_sided(c.topology, mesh, &c.check->one_sided_faces));
done:
    starg_release(context, c.touching);
    starg_progress_end(context);
    *out = (mesh_examination){c.check, c.topology, c.tree, c.shells};
    return status;
}

void mesh_examination_free(mesh_examination *examination) {
    starg_check_free(NULL, examination->check);
    topology_free(examination->topology);
    bvh_free(examination->tree);
    RELEASE(examination->shells);
}

/* What the shells enclose where they share vertices. */
static starg_status check_parted(starg_context *context, const starg_mesh *mesh,
                                 starg_check *check) {
    SCOPED_BY(mesh_examination_free) mesh_examination all = {0};
    SCOPED_BY(starg_mesh_drop) starg_mesh *parted = NULL;
    if (check->usable || !check->closed || !check->oriented)
        return STARG_OK;
    TRY(wings_part(context, mesh, &parted));
    if (parted == NULL)
        return STARG_OK;
    TRY(mesh_examine(context, parted, &all));
    if (!all.check->usable || !mesh_only_touches(all.check))
        return STARG_OK;
    check->usable = true;
    check->volume = all.check->volume;
    check->components = all.check->components;
    check->cavities = all.check->cavities;
    check->genus = all.check->genus;
    check->findings[STARG_FINDING_INWARD_COMPONENT] =
        all.check->findings[STARG_FINDING_INWARD_COMPONENT];
    return STARG_OK;
}

/* Components are connected by edges, also by those of more than two faces. */
static starg_status count_components(starg_context *context, const starg_mesh *mesh,
                                     starg_check *check) {
    mesh_topology *topology = NULL;
    if (check->findings[STARG_FINDING_NONMANIFOLD_EDGE].count == 0)
        return STARG_OK;
    starg_status status = topology_create(context, mesh, &topology);
    if (status == STARG_OK)
        check->components = topology->component_count;
    topology_free(topology);
    return status;
}

starg_status starg_mesh_check(starg_context *context, const starg_mesh *mesh, starg_check **out) {
    mesh_examination all;
    *out = NULL;
    starg_time_rule former = starg_time_begin(context, STARG_TIME_FAILS);
    starg_status status = mesh_examine(context, mesh, &all);
    if (status == STARG_OK)
        status = check_parted(context, mesh, all.check);
    if (status == STARG_OK)
        status = count_components(context, mesh, all.check);
    starg_time_end(context, former);
    if (status == STARG_OK) {
        *out = all.check;
        all.check = NULL;
    }
    mesh_examination_free(&all);
    return status;
}

void starg_check_free(starg_context *context, starg_check *check) {
    (void)context;
    if (check == NULL)
        return;
    RELEASE(check->face_marks, check);
}
