/* SPDX-License-Identifier: Apache-2.0 */
/* The arrangement of the faces of a surface: exact, and only where faces meet.
 *
 * 1. Vertices of the faces concerned and the ends of what each pair shares become points; equal
 *    points are one, which joins what touches.
 * 2. Faces with a common area, and what hangs together by such, form a sheet; any other face that
 *    meets something is a sheet of its own.
 * 3. Each sheet is triangulated with the borders of its faces and its shares with other sheets as
 *    segments. Three faces that meet in a point give it to each of their sheets, because every two
 *    of the three segments cross there; so triangles of different sheets meet in common corners
 *    and edges only.
 * 4. A triangle of a sheet lies on the faces that hold its corners. Where as many turn one way as
 *    the other they cancel out.
 *
 * Cost: that of the triangulations, and faces x triangles for sheets of many faces. */
#include "mesh/union/arrangement.h"

#include <stdlib.h>

#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "mesh/topology.h"

typedef struct job {
    starg_context *context;
    const union_surface *surface;
    union_contacts *contacts;
    union_complex *out;
    uint32_t *point; /* per vertex: its point, or NONE                     */
    uint32_t *sheet; /* per face, parents of a forest: the root names the sheet */
    uint8_t *busy;   /* per face: it meets another                         */
    uint32_t *order; /* faces that meet others, sheet by sheet             */
    size_t busy_count;
    size_t *first;            /* per face: where its contacts begin in `list`       */
    uint32_t *list;           /* contacts                                           */
    uint32_t enclosing[3][3]; /* per axis: points around all in the plane across it */
    triangulation plane;
} job;

enum { ENCLOSING = 9 }; /* the first points */

static uint32_t point_of(const job *j, uint32_t face, uint32_t k) {
    return j->point[j->surface->faces.data[3 * (size_t)face + k]];
}

/* ---- points ---- */

static starg_status set_scale(job *j) {
    int bits;
    const union_surface *surface = j->surface;
    j->out->points.scale = exact_scale(surface->vertices.data, surface->vertices.count, &bits);
    if (bits <= EXACT_POINT_BITS)
        return STARG_OK;
    return starg_fail(j->context, STARG_ERROR_RANGE, UNION_STAGE,
                      "the coordinates span %d bits from the largest to the smallest, and at most "
                      "%d where faces intersect; round the smallest coordinates",
                      bits, EXACT_POINT_BITS);
}

/* Triangles around [-m, m] x [-m, m] in the planes across the axes. */
static starg_status add_enclosing(job *j) {
    double largest = 0;
    for (size_t i = 0; i < j->surface->vertices.count; i++)
        largest = fmax(largest, fabs(j->surface->vertices.data[i]));
    double m = ldexp(1, ilogb(largest) + 2);
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < 3; i++) {
            exact_point corner;
            double p[3] = {0};
            p[(axis + 1) % 3] = i == 1 ? 3 * m : -m;
            p[(axis + 2) % 3] = i == 2 ? 3 * m : -m;
            exact_point_set(&corner, p, j->out->points.scale);
            TRY(exact_points_add(&j->out->points, &corner, &j->enclosing[axis][i]));
        }
    return STARG_OK;
}

/* Equal positions get the number of the first vertex there. */
static starg_status add_vertices(job *j) {
    union_complex *out = j->out;
    size_t count = j->surface->vertices.count / 3;
    NEW_ZERO(j->context, UNION_STAGE, j->point, count);
    for (uint32_t f = 0; f < union_face_count(j->surface); f++)
        for (size_t k = 0; k < 3 && j->busy[f]; k++)
            j->point[j->surface->faces.data[3 * (size_t)f + k]] = 1;
    for (uint32_t v = 0; v < count; v++) {
        exact_point own;
        bool used = j->point[v];
        j->point[v] = UINT32_MAX;
        if (!used)
            continue;
        exact_point_set(&own, j->surface->vertices.data + 3 * (size_t)v, out->points.scale);
        TRY(exact_points_add(&out->points, &own, &j->point[v]));
        while (out->name.count < out->points.points.count)
            PUSH(j->context, UNION_STAGE, &out->name, v);
    }
    return STARG_OK;
}

/* Points found since get a name: all are on faces. */
static starg_status name_points(job *j) {
    union_complex *out = j->out;
    size_t vertices = j->surface->vertices.count / 3;
    for (uint32_t p = (uint32_t)out->name.count; p < out->points.points.count; p++) {
        PUSH(j->context, UNION_STAGE, &out->name, (uint32_t)(vertices + out->added.count));
        PUSH(j->context, UNION_STAGE, &out->added, p);
    }
    return STARG_OK;
}

/* ---- sheets ---- */

static void join_sheets(job *j) {
    for (size_t i = 0; i < j->contacts->count; i++) {
        const union_contact *contact = &j->contacts->data[i];
        j->busy[contact->face[0]] = j->busy[contact->face[1]] = 1;
        if (contact->overlap)
            sets_join(j->sheet, contact->face[0], contact->face[1]);
    }
}

/* Files each contact under both its faces. */
static starg_status file_contacts(job *j) {
    size_t faces = union_face_count(j->surface), count = j->contacts->count;
    NEW_ZERO(j->context, UNION_STAGE, j->first, faces + 1);
    NEW(j->context, UNION_STAGE, j->list, 2 * count);
    for (size_t i = 0; i < 2 * count; i++)
        j->first[j->contacts->data[i / 2].face[i % 2] + 1]++;
    for (size_t f = 0; f < faces; f++)
        j->first[f + 1] += j->first[f];
    for (size_t i = 2 * count; i-- > 0;)
        j->list[--j->first[j->contacts->data[i / 2].face[i % 2] + 1]] = (uint32_t)(i / 2);
    /* each count has gone down to its begin: first[f + 1] is where f begins */
    memmove(j->first, j->first + 1, faces * sizeof *j->first);
    j->first[faces] = 2 * count;
    return STARG_OK;
}

/* Lists the faces concerned by sheet: counting sort by the root. */
static starg_status order_faces(job *j) {
    size_t faces = union_face_count(j->surface);
    SCOPED size_t *start = NULL;
    NEW_ZERO(j->context, UNION_STAGE, start, faces + 1);
    NEW(j->context, UNION_STAGE, j->order, faces);
    for (uint32_t f = 0; f < faces; f++)
        start[sets_find(j->sheet, f) + 1] += j->busy[f];
    for (size_t f = 0; f < faces; f++)
        start[f + 1] += start[f];
    j->busy_count = start[faces];
    for (uint32_t f = 0; f < faces; f++)
        if (j->busy[f])
            j->order[start[sets_find(j->sheet, f)]++] = f;
    return STARG_OK;
}

/* The projection of a face in which it is largest, with coordinates in the order in which it turns
 * left. */
static int choose_projection(const job *j, uint32_t face, int *u, int *v) {
    const double *a = union_corner(j->surface, face, 0), *b = union_corner(j->surface, face, 1);
    const double *c = union_corner(j->surface, face, 2);
    double normal[3];
    vec3_triangle_normal(a, b, c, normal);
    int axis = 0, turn = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(normal[k]) > fabs(normal[axis]))
            axis = k;
    while ((turn = orient2d(a, b, c, (axis + 1) % 3, (axis + 2) % 3)) == 0)
        axis = (axis + 1) % 3;
    *u = (axis + (turn > 0 ? 1 : 2)) % 3;
    *v = (axis + (turn > 0 ? 2 : 1)) % 3;
    return axis;
}

static starg_status begin_plane(job *j, uint32_t face) {
    int u, v, axis = choose_projection(j, face, &u, &v);
    const uint32_t *around = j->enclosing[axis];
    const double *const corner[3] = {union_corner(j->surface, face, 0),
                                     union_corner(j->surface, face, 1),
                                     union_corner(j->surface, face, 2)};
    bool swapped = u != (axis + 1) % 3;
    return triangulation_begin(
        &j->plane, corner, u, v,
        (const uint32_t[]){around[0], around[swapped ? 2 : 1], around[swapped ? 1 : 2]});
}

static starg_status add_border(job *j, uint32_t face) {
    for (uint32_t k = 0; k < 3; k++)
        TRY(triangulation_insert(&j->plane, point_of(j, face, k)));
    for (uint32_t k = 0; k < 3; k++) {
        triangulation_carrier line = {{union_corner(j->surface, face, (int)k),
                                       union_corner(j->surface, face, (int)(k + 1) % 3), NULL}};
        TRY(triangulation_constrain(&j->plane, point_of(j, face, k), point_of(j, face, (k + 1) % 3),
                                    line));
    }
    return STARG_OK;
}

/* What a face shares with others; in the same plane that runs along its border. */
static starg_status add_shares(job *j, uint32_t face) {
    for (size_t i = j->first[face]; i < j->first[face + 1]; i++) {
        const union_contact *contact = &j->contacts->data[j->list[i]];
        uint32_t other = contact->face[contact->face[0] == face];
        if (contact->overlap)
            continue;
        TRY(triangulation_insert(&j->plane, contact->end[0]));
        TRY(triangulation_insert(&j->plane, contact->end[1]));
        if (contact->coplanar)
            continue;
        triangulation_carrier plane = {{union_corner(j->surface, other, 0),
                                        union_corner(j->surface, other, 1),
                                        union_corner(j->surface, other, 2)}};
        TRY(triangulation_constrain(&j->plane, contact->end[0], contact->end[1], plane));
    }
    return STARG_OK;
}

/* ---- triangles ---- */

static starg_status emit(job *j, const union_triangle *triangle) {
    PUSH(j->context, UNION_STAGE, &j->out->triangles, *triangle);
    return STARG_OK;
}

static starg_status emit_whole(job *j, uint32_t face) {
    union_triangle own = {.face = face, .layers = 1, .whole = true};
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t vertex = j->surface->faces.data[3 * (size_t)face + k];
        own.corner[k] = j->busy[face] ? j->out->name.data[j->point[vertex]] : vertex;
    }
    return emit(j, &own);
}

/* 1 or -1 for a face on which the triangle lies, by the way the face turns in the projection. */
static int layer_of(const job *j, uint32_t face, const uint32_t corner[3]) {
    const triangulation *t = &j->plane;
    const uint32_t own[3] = {point_of(j, face, 0), point_of(j, face, 1), point_of(j, face, 2)};
    int turn = exact_points_turn(t->points, own[0], own[1], own[2], t->u, t->v);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            if (exact_points_turn(t->points, own[k], own[(k + 1) % 3], corner[i], t->u, t->v) *
                    turn <
                0)
                return 0;
    return turn;
}

/* A face that is alone holds all triangles of the hull. */
static void count_layers(const job *j, const uint32_t *faces, size_t count,
                         union_triangle *triangle) {
    triangle->face = faces[0];
    triangle->layers = count == 1;
    for (size_t i = 0; i < count && count > 1; i++) {
        int layer = layer_of(j, faces[i], triangle->corner);
        triangle->layers += layer;
        if (layer != 0)
            triangle->face = faces[i];
    }
    if (triangle->layers >= 0)
        return;
    uint32_t swap = triangle->corner[1];
    triangle->corner[1] = triangle->corner[2];
    triangle->corner[2] = swap;
    triangle->layers = -triangle->layers;
}

static starg_status emit_parts(job *j, const uint32_t *faces, size_t count) {
    const planar *t = &j->plane.mesh;
    for (size_t h = 0; h < t->corner.count; h += 3) {
        union_triangle own = {
            .corner = {t->corner.data[h], t->corner.data[h + 1], t->corner.data[h + 2]}};
        bool outside = false;
        for (int k = 0; k < 3; k++)
            outside = outside || own.corner[k] < ENCLOSING;
        if (outside)
            continue;
        count_layers(j, faces, count, &own);
        if (own.layers == 0)
            continue;
        for (int k = 0; k < 3; k++)
            own.corner[k] = j->out->name.data[own.corner[k]];
        TRY(emit(j, &own));
    }
    return STARG_OK;
}

/* Is a face met in its corners only? */
static bool stays_whole(const job *j, uint32_t face) {
    for (size_t i = j->first[face]; i < j->first[face + 1]; i++)
        for (int e = 0; e < 2; e++) {
            uint32_t end = j->contacts->data[j->list[i]].end[e];
            if (end != point_of(j, face, 0) && end != point_of(j, face, 1) &&
                end != point_of(j, face, 2))
                return false;
        }
    return true;
}

static starg_status cut_sheet(job *j, const uint32_t *faces, size_t count) {
    if (count == 1 && stays_whole(j, faces[0]))
        return emit_whole(j, faces[0]);
    TRY(begin_plane(j, faces[0]));
    for (size_t i = 0; i < count; i++)
        TRY(add_border(j, faces[i]));
    for (size_t i = 0; i < count; i++)
        TRY(add_shares(j, faces[i]));
    TRY(triangulation_improve(&j->plane));
    TRY(name_points(j));
    TRY(emit_parts(j, faces, count));
    return starg_check_cancel(j->context, UNION_STAGE);
}

static starg_status cut_sheets(job *j) {
    for (uint32_t f = 0; f < union_face_count(j->surface); f++)
        if (!j->busy[f])
            TRY(emit_whole(j, f));
    for (size_t i = 0, end; i < j->busy_count; i = end) {
        uint32_t root = sets_find(j->sheet, j->order[i]);
        for (end = i; end < j->busy_count && sets_find(j->sheet, j->order[end]) == root;)
            end++;
        TRY(cut_sheet(j, j->order + i, end - i));
        starg_progress_step(j->context, end, j->busy_count);
    }
    return STARG_OK;
}

/* ---- all ---- */

static starg_status find_points(job *j) {
    TRY(set_scale(j));
    TRY(add_enclosing(j));
    TRY(add_vertices(j));
    for (size_t i = 0; i < j->contacts->count; i++)
        if (!j->contacts->data[i].overlap)
            TRY(union_find_ends(j->surface, j->point, &j->out->points, &j->contacts->data[i]));
    return name_points(j);
}

starg_status union_arrange(const union_surface *surface, union_contacts *contacts,
                           union_complex *out) {
    starg_status status = STARG_OK;
    starg_context *context = surface->context;
    size_t faces = union_face_count(surface);
    job j = {.context = context, .surface = surface, .contacts = contacts, .out = out};
    *out = (union_complex){.context = context, .surface = surface, .points.context = context};
    j.plane = triangulation_make(&out->points);
    STARG_NEW_ZERO(context, UNION_STAGE, j.busy, faces);
    STARG_NEW(context, UNION_STAGE, j.sheet, faces);
    sets_make(j.sheet, faces);
    join_sheets(&j);
    STARG_TRY(find_points(&j));
    STARG_TRY(file_contacts(&j));
    STARG_TRY(order_faces(&j));
    STARG_TRY(cut_sheets(&j));
done:
    RELEASE(j.busy, j.sheet, j.point, j.order, j.first, j.list);
    triangulation_free(&j.plane);
    return status;
}

void union_complex_free(union_complex *complex) {
    exact_points_free(&complex->points);
    RELEASE(complex->triangles.data, complex->added.data, complex->name.data);
}

void union_complex_place(const union_complex *complex, uint32_t corner, exact_point *out) {
    const union_surface *surface = complex->surface;
    size_t vertices = surface->vertices.count / 3;
    if (corner < vertices)
        exact_point_set(out, surface->vertices.data + 3 * (size_t)corner, complex->points.scale);
    else
        exact_points_get(&complex->points, complex->added.data[corner - vertices], out);
}

const double *union_complex_rounded(const union_complex *complex, uint32_t corner) {
    const union_surface *surface = complex->surface;
    size_t vertices = surface->vertices.count / 3;
    return corner < vertices
               ? surface->vertices.data + 3 * (size_t)corner
               : exact_points_rounded(&complex->points, complex->added.data[corner - vertices]);
}
