/* SPDX-License-Identifier: Apache-2.0 */
/* Compatible planes: cuts through tetrahedra in two places until every part is star-shaped in both.
 *
 * Problem: that of compatible.c. Sets grown from tetrahedra have ragged sides, which cost guards;
 * planes are flat in the one place, and nearly so in the other if it is bent a little.
 *
 * Method: as in bsp_start.c. A part that has a kernel in both places is done. Any other is cut
 * where it has none by the plane after which two guards miss the least of its surface there
 * (star/certified/split_plane.c), through the tetrahedra (through.c), into connected parts. A
 * part that resists, because no plane is found or tetrahedra would lose their sign, is tried again
 * with fewer demands, and at last given up: its tetrahedra are grown into regions.
 *
 * Invariants: the tetrahedra stay positive in both places, and at the end every part is proven by
 * exact signs: what rounding of later cuts has spoilt is given up, too.
 *
 * Cost: for each part that of the split plane search, and a pass over all tetrahedra. */
#include "core/streams.h"
#include "star/compatible/cone_builder.h"
#include "star/compatible/twin_pieces.h"

#include <stdlib.h>

#include "geometry/vec3.h"
#include "star/certified/search.h"

static const char STAGE[] = "planes";

enum { FAIR_FROM = 1, HALVE_FROM = 3, ATTEMPTS_MOST = 6, EFFORT = 3, GROWTH_MOST = 4 };

static const double MARGIN = 2e-5; /* of the extent, for guards of the plane search */

#define NOWHERE UINT32_MAX

typedef struct part {
    int attempts;
    bool done;
    double guards[2][3];
} part;

typedef struct plane_builder {
    starg_context *context;
    const starg_tetmesh *meshes[2];
    starg_tetmesh *own[2]; /* the same, once they are divided */
    uint32_t *labels;      /* per tetrahedron: its part */
    STARG_ARRAY(part) parts;
    face_corners faces; /* of the part that is looked at */
    region_scratch scratch;
    starg_rng rng;
} plane_builder;

static void builder_free(plane_builder *b) {
    for (int i = 0; i < 2; i++)
        starg_tetmesh_free(b->own[i]);
    RELEASE(b->labels, b->parts.data, b->faces.data);
    region_scratch_free(&b->scratch);
}

/* ---- a part ---- */

/* The faces around a part. */
static starg_status list_faces(plane_builder *b, uint32_t number) {
    const starg_tetmesh *mesh = b->meshes[0];
    b->faces.count = 0;
    for (size_t face = 0; face < 4 * mesh->count; face++)
        if (b->labels[face / 4] == number)
            TRY(piece_faces_add(b->context, mesh, b->labels, face, number, number, &b->faces));
    return STARG_OK;
}

static kernel_faces surface_in(const plane_builder *b, int place) {
    return (kernel_faces){b->meshes[place]->vertices, b->faces.data, b->faces.count / 3};
}

starg_status twin_kernels(starg_context *context, const kernel_faces surfaces[2], starg_rng *rng,
                          double guards[2][3], int *blind) {
    int first = (int)starg_rng_below(rng, 2);
    *blind = -1;
    for (int i = 0; i < 2 && *blind < 0; i++) {
        int place = first ^ i;
        starg_kernel_result kernel;
        TRY(kernel_find(context, &surfaces[place], &kernel));
        vec3_copy(kernel.guard, guards[place]);
        if (kernel.verdict != STARG_KERNEL_INTERIOR)
            *blind = place;
    }
    return STARG_OK;
}

/* ---- the plane ---- */

twin_frame twin_frame_of(const double *places, const uint32_t *corners, size_t count) {
    double lower[3] = {INFINITY, INFINITY, INFINITY}, upper[3] = {-INFINITY, -INFINITY, -INFINITY};
    twin_frame out = {.scale = 0};
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < 3; k++) {
            double x = places[3 * (size_t)corners[i] + k];
            lower[k] = fmin(lower[k], x);
            upper[k] = fmax(upper[k], x);
        }
    for (int k = 0; k < 3; k++) {
        out.origin[k] = 0.5 * lower[k] + 0.5 * upper[k];
        out.scale = fmax(out.scale, upper[k] - lower[k]);
    }
    out.scale = 1 / out.scale;
    return out;
}

static void twin_to_unit(const twin_frame *frame, const double p[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = (p[k] - frame->origin[k]) * frame->scale;
}

static starg_status add_triangle(starg_context *context, const uint32_t numbers[3], region *out) {
    const double *a = out->vertices.data + 3 * (size_t)numbers[0];
    const double *b = out->vertices.data + 3 * (size_t)numbers[1];
    const double *c = out->vertices.data + 3 * (size_t)numbers[2];
    const region_triangle fresh = {{numbers[0], numbers[1], numbers[2]},
                                   (uint32_t)(out->rows.count / 4)};
    double normal[3], offset;
    vec3_triangle_normal(a, b, c, normal);
    double length = vec3_length(normal);
    if (!(length > 0))
        return STARG_OK; /* too thin for doubles: any guard will do */
    for (int k = 0; k < 3; k++)
        normal[k] /= length;
    offset = vec3_dot(normal, a);
    for (int k = 0; k < 3; k++)
        PUSH(context, STAGE, &out->rows, normal[k]);
    PUSH(context, STAGE, &out->rows, offset);
    PUSH(context, STAGE, &out->triangles, fresh);
    return STARG_OK;
}

starg_status twin_region(starg_context *context, const double *places, size_t vertices,
                         const uint32_t *corners, size_t count, const twin_frame *frame,
                         region *out) {
    SCOPED uint32_t *numbers = NULL;
    NEW(context, STAGE, numbers, vertices);
    memset(numbers, 0xff, vertices * sizeof *numbers);
    for (size_t i = 0; i < count; i += 3) {
        uint32_t own[3];
        for (size_t k = 0; k < 3; k++) {
            uint32_t v = corners[i + k];
            double p[3];
            if (numbers[v] == NOWHERE) {
                numbers[v] = (uint32_t)(out->vertices.count / 3);
                twin_to_unit(frame, places + 3 * (size_t)v, p);
                for (int c = 0; c < 3; c++)
                    PUSH(context, STAGE, &out->vertices, p[c]);
            }
            own[k] = numbers[v];
        }
        TRY(add_triangle(context, own, out));
    }
    return region_make_blocks(context, out);
}

/* Heights above the plane of the part's vertices; 0 for all others. */
static void find_levels(const plane_builder *b, uint32_t number, int place, const twin_frame *frame,
                        const partition_plane *plane, double *levels) {
    const starg_tetmesh *mesh = b->meshes[place];
    memset(levels, 0, mesh->vertex_count * sizeof *levels);
    for (size_t i = 0; i < 4 * mesh->count; i++) {
        double p[3];
        if (b->labels[i / 4] != number)
            continue;
        twin_to_unit(frame, mesh->vertices + 3 * (size_t)mesh->tetrahedra[i], p);
        levels[mesh->tetrahedra[i]] = vec3_dot(plane->normal, p) - plane->offset;
    }
}

static starg_status choose_plane(plane_builder *b, uint32_t number, int place, double *levels,
                                 bool *found) {
    int attempts = b->parts.data[number].attempts;
    const starg_tetmesh *mesh = b->meshes[place];
    const twin_frame frame = twin_frame_of(mesh->vertices, b->faces.data, b->faces.count);
    const split_plane_options options = {.margin = MARGIN,
                                         .effort = EFFORT,
                                         .demand = attempts < FAIR_FROM    ? SPLIT_PLANE_GAIN
                                                   : attempts < HALVE_FROM ? SPLIT_PLANE_FAIR
                                                                           : SPLIT_PLANE_HALVE};
    SCOPED_BY(region_free) region r = {.vertices = {0}};
    partition_plane plane;
    TRY(twin_region(b->context, mesh->vertices, mesh->vertex_count, b->faces.data, b->faces.count,
                    &frame, &r));
    TRY(split_plane_find(&r, &options, &b->rng, &b->scratch, &plane, found));
    if (*found)
        find_levels(b, number, place, &frame, &plane, levels);
    return STARG_OK;
}

/* ---- the cut ---- */

static starg_status open_part(plane_builder *b, int attempts, uint32_t *number) {
    *number = (uint32_t)b->parts.count;
    PUSH(b->context, STAGE, &b->parts, ((part){.attempts = attempts}));
    return STARG_OK;
}

/* What hangs together with a tetrahedron of label `from` becomes `to`. */
static starg_status relabel(plane_builder *b, size_t seed, uint32_t from, uint32_t to) {
    const starg_tetmesh *mesh = b->meshes[0];
    SCOPED STARG_ARRAY(uint32_t) stack = {0};
    b->labels[seed] = to;
    PUSH(b->context, STAGE, &stack, (uint32_t)seed);
    while (stack.count > 0) {
        size_t t = stack.data[--stack.count];
        for (size_t face = 4 * t; face < 4 * t + 4; face++) {
            uint32_t u = mesh->neighbours[face];
            if (u == STARG_TETMESH_NONE || b->labels[u] != from)
                continue;
            b->labels[u] = to;
            PUSH(b->context, STAGE, &stack, u);
        }
    }
    return STARG_OK;
}

/* Each connected set with a label becomes a part; the first is `number`, if that is one. */
static starg_status separate(plane_builder *b, uint32_t label, uint32_t number, int attempts) {
    for (size_t t = 0; t < b->meshes[0]->count; t++) {
        uint32_t to = number;
        if (b->labels[t] != label)
            continue;
        if (to == NOWHERE)
            TRY(open_part(b, attempts, &to));
        TRY(relabel(b, t, label, to));
        number = NOWHERE;
    }
    return STARG_OK;
}

static void adopt(plane_builder *b, starg_tetmesh *const meshes[2], uint32_t *labels) {
    for (int i = 0; i < 2; i++) {
        starg_tetmesh_free(b->own[i]);
        b->meshes[i] = b->own[i] = meshes[i];
    }
    starg_release(b->context, b->labels);
    b->labels = labels;
}

static starg_status divide(plane_builder *b, uint32_t number, through_cut *cut, bool *done) {
    starg_tetmesh *meshes[2];
    uint32_t *labels;
    *done = false;
    TRY(through_place(cut, done));
    if (*done)
        TRY(through_divide(cut, b->labels, meshes, &labels, done));
    if (!*done)
        return STARG_OK;
    adopt(b, meshes, labels);
    int attempts = b->parts.data[number].attempts / 2;
    b->parts.data[number].attempts = attempts;
    TRY(separate(b, THROUGH_PART, number, attempts));
    return separate(b, THROUGH_PART + 1, NOWHERE, attempts);
}

static starg_status cut_part(plane_builder *b, uint32_t number, int place) {
    starg_status status = STARG_OK;
    through_cut cut = {.context = b->context, .meshes = {b->meshes[0], b->meshes[1]}};
    uint8_t *inside = NULL;
    bool done = false;
    STARG_NEW(b->context, STAGE, cut.levels, b->meshes[0]->vertex_count);
    STARG_NEW(b->context, STAGE, inside, b->meshes[0]->count);
    for (size_t t = 0; t < b->meshes[0]->count; t++)
        inside[t] = b->labels[t] == number;
    cut.inside = inside;
    STARG_TRY(choose_plane(b, number, place, cut.levels, &done));
    if (done)
        STARG_TRY(divide(b, number, &cut, &done));
    if (!done)
        b->parts.data[number].attempts++;
done:
    RELEASE(cut.levels, inside);
    through_free(&cut);
    return status;
}

static starg_status look_at(plane_builder *b, uint32_t number) {
    int blind;
    TRY(list_faces(b, number));
    const kernel_faces surfaces[2] = {surface_in(b, 0), surface_in(b, 1)};
    TRY(twin_kernels(b->context, surfaces, &b->rng, b->parts.data[number].guards, &blind));
    if (blind < 0)
        b->parts.data[number].done = true;
    else
        TRY(cut_part(b, number, blind));
    return STARG_OK;
}

/* ---- the result ---- */

/* Later cuts may have divided what was proven before, with rounded points. */
static starg_status prove(plane_builder *b, uint32_t number) {
    part *it = &b->parts.data[number];
    TRY(list_faces(b, number));
    for (int place = 0; place < 2 && it->done; place++) {
        const kernel_faces surface = surface_in(b, place);
        it->done = kernel_sees_all(&surface, it->guards[place]);
    }
    return STARG_OK;
}

/* What is not done is grown. */
static starg_status finish(plane_builder *b, grown_regions *out) {
    starg_status status = STARG_OK;
    grown_regions parts = {.labels = b->labels, .count = b->parts.count};
    uint8_t *dropped = NULL;
    STARG_NEW(b->context, STAGE, dropped, b->parts.count);
    for (uint32_t i = 0; i < b->parts.count; i++) {
        const part *it = &b->parts.data[i];
        STARG_TRY(prove(b, i));
        dropped[i] = !it->done;
        for (int k = 0; k < 3; k++) {
            STARG_PUSH(b->context, STAGE, &parts.guards, it->guards[0][k]);
            STARG_PUSH(b->context, STAGE, &parts.counterparts, it->guards[1][k]);
        }
    }
    STARG_TRY(
        grow_compatible_again(b->context, b->meshes[0], b->meshes[1], &parts, dropped, 0, out));
done:
    RELEASE(dropped, parts.guards.data, parts.counterparts.data);
    return status;
}

starg_status compatible_planes(starg_context *context, const starg_tetmesh *const meshes[2],
                               uint64_t round, starg_tetmesh *own[2], grown_regions *pieces) {
    SCOPED_BY(builder_free)
    plane_builder b = {.context = context,
                       .meshes = {meshes[0], meshes[1]},
                       .scratch = {.context = context},
                       .rng = starg_rng_make(context->seed, STREAM_TWIN_PLANES, round)};
    own[0] = own[1] = NULL;
    NEW(context, STAGE, b.labels, meshes[0]->count);
    for (size_t t = 0; t < meshes[0]->count; t++)
        b.labels[t] = THROUGH_PART;
    TRY(separate(&b, THROUGH_PART, NOWHERE, 0));
    for (uint32_t i = 0; i < b.parts.count; i++)
        while (!b.parts.data[i].done && b.parts.data[i].attempts < ATTEMPTS_MOST &&
               b.meshes[0]->count < GROWTH_MOST * meshes[0]->count) {
            TRY(starg_check_cancel(context, STAGE));
            TRY(look_at(&b, i));
        }
    TRY(finish(&b, pieces));
    for (int i = 0; i < 2; i++) {
        own[i] = b.own[i];
        b.own[i] = NULL;
    }
    return STARG_OK;
}
