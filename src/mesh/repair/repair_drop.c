/* SPDX-License-Identifier: Apache-2.0 */
/* Drops what the boundary of a solid cannot contain: faces with repeated corners, duplicate faces,
 * fins, and components without volume. */
#include <stdlib.h>

#include "geometry/vec3.h"
#include "mesh/repair/repair.h"

void repair_drop_repeated(repair_state *state) {
    for (size_t f = 0; f < repair_face_count(state); f++) {
        const uint32_t *corner = repair_face(state, f);
        if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0])
            state->flags.data[f] |= REPAIR_GONE;
    }
    repair_compact(state);
}

/* ---- duplicates ---- */

typedef struct face_key {
    uint32_t corner[3]; /* ascending */
    uint32_t face;
    bool odd; /* ascending order reverses the face's orientation */
} face_key;

static void sort_two(face_key *key, int i, int j) {
    uint32_t swap = key->corner[i];
    if (swap <= key->corner[j])
        return;
    key->corner[i] = key->corner[j];
    key->corner[j] = swap;
    key->odd = !key->odd;
}

static face_key make_key(const repair_state *state, uint32_t face) {
    face_key key = {.face = face};
    memcpy(key.corner, repair_face(state, face), sizeof key.corner);
    sort_two(&key, 0, 1);
    sort_two(&key, 1, 2);
    sort_two(&key, 0, 1);
    return key;
}

static int compare_keys(const void *left, const void *right) {
    const face_key *a = left, *b = right;
    for (int k = 0; k < 3; k++)
        if (a->corner[k] != b->corner[k])
            return a->corner[k] < b->corner[k] ? -1 : 1;
    return (a->face > b->face) - (a->face < b->face);
}

/* Keeps the first face of each set with equal corners. Marks it in `sheet` if both orientations
 * occurred: such a layer bounds nothing by itself. */
static starg_status keep_first(repair_state *state, uint8_t *sheet) {
    size_t count = repair_face_count(state), kept = 0;
    SCOPED face_key *keys = NULL;
    NEW(state->context, REPAIR_STAGE, keys, count);
    for (uint32_t f = 0; f < count; f++)
        keys[f] = make_key(state, f);
    qsort(keys, count, sizeof *keys, compare_keys);
    for (size_t i = 0, first = 0; i < count; i++) {
        if (memcmp(keys[i].corner, keys[first].corner, sizeof keys[i].corner) != 0)
            first = i;
        if (i == first)
            continue;
        state->flags.data[keys[i].face] |= REPAIR_GONE;
        if (keys[i].odd != keys[first].odd)
            sheet[keys[first].face] = 1;
    }
    for (size_t f = 0; f < count; f++)
        if (!(state->flags.data[f] & REPAIR_GONE))
            sheet[kept++] = sheet[f];
    repair_compact(state);
    return STARG_OK;
}

/* Joins adjacent sheet faces into patches and lets the edges on a patch's border vote: for dropping
 * it if the number of other faces there is even, against it if odd. */
static void vote_on_sheets(const mesh_topology *topology, const uint8_t *sheet, uint32_t *patch,
                           int64_t *votes) {
    for (uint32_t h = 0; h < 3 * topology->face_count; h++) {
        uint32_t next = topology->ring[h];
        if (sheet[h / 3] && sheet[next / 3])
            sets_join(patch, h / 3, next / 3);
    }
    for (uint32_t h = 0; h < 3 * topology->face_count; h++) {
        size_t others = 0;
        for (uint32_t o = topology->ring[h]; o != h; o = topology->ring[o])
            others += !sheet[o / 3];
        if (sheet[h / 3] && others > 0)
            votes[sets_find(patch, h / 3)] += others % 2 == 0 ? 1 : -1;
    }
}

starg_status repair_drop_duplicates(repair_state *state) {
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    SCOPED uint8_t *sheet = NULL;
    SCOPED uint32_t *patch = NULL;
    SCOPED int64_t *votes = NULL;
    NEW_ZERO(state->context, REPAIR_STAGE, sheet, repair_face_count(state));
    TRY(keep_first(state, sheet));
    size_t count = repair_face_count(state);
    NEW(state->context, REPAIR_STAGE, patch, count);
    NEW_ZERO(state->context, REPAIR_STAGE, votes, count);
    starg_mesh view = repair_view(state);
    TRY(topology_create(state->context, &view, &topology));
    sets_make(patch, count);
    vote_on_sheets(topology, sheet, patch, votes);
    for (uint32_t f = 0; f < count; f++)
        if (sheet[f] && votes[sets_find(patch, f)] > 0)
            state->flags.data[f] |= REPAIR_GONE;
    repair_compact(state);
    return STARG_OK;
}

/* ---- fins ---- */

typedef struct fin {
    uint32_t patch; /* its lowest face */
    uint32_t faces;
    bool open;
} fin;

static int compare_fins(const void *left, const void *right) {
    const fin *a = left, *b = right;
    if (a->faces != b->faces)
        return a->faces < b->faces ? -1 : 1;
    return (a->patch > b->patch) - (a->patch < b->patch);
}

/* Number of remaining faces on the edge of h. */
static size_t faces_left(const repair_state *state, const mesh_topology *topology, uint32_t h) {
    size_t left = 0;
    uint32_t o = h;
    do {
        left += !(state->flags.data[o / 3] & REPAIR_GONE);
        o = topology->ring[o];
    } while (o != h);
    return left;
}

/* Would every edge between the patch and the rest have an even number of faces without it? */
static bool hangs_loose(const repair_state *state, const mesh_topology *topology,
                        const uint32_t *members, size_t count) {
    bool attached = false;
    for (size_t i = 0; i < 3 * count; i++) {
        uint32_t h = 3 * members[i / 3] + (uint32_t)(i % 3);
        if (topology_edge_faces(topology, h) <= 2)
            continue;
        size_t left = faces_left(state, topology, h);
        if (left < 3 || left % 2 == 0)
            return false;
        attached = true;
    }
    return attached;
}

/* Joins faces across manifold edges into patches; sorts them by size, small ones first. */
static size_t list_fins(const mesh_topology *topology, uint32_t *patch, fin *fins) {
    size_t count = 0;
    sets_make(patch, topology->face_count);
    for (uint32_t h = 0; h < 3 * topology->face_count; h++)
        if (topology->twin[h] != TOPOLOGY_NONE)
            sets_join(patch, h / 3, topology->twin[h] / 3);
    for (uint32_t f = 0; f < topology->face_count; f++)
        fins[f] = (fin){.patch = f};
    for (uint32_t f = 0; f < topology->face_count; f++) {
        fin *own = &fins[sets_find(patch, f)];
        own->faces++;
        for (uint32_t h = 3 * f; h < 3 * f + 3; h++)
            own->open = own->open || topology->ring[h] == h;
    }
    for (uint32_t f = 0; f < topology->face_count; f++)
        if (fins[f].open)
            fins[count++] = fins[f];
    qsort(fins, count, sizeof *fins, compare_fins);
    return count;
}

/* Groups faces by patch: members[start[p]] to members[start[p] + size - 1] for root p. */
static void file_members(uint32_t *patch, size_t count, size_t *start, uint32_t *members) {
    for (uint32_t f = 0; f < count; f++)
        start[sets_find(patch, f)]++;
    for (size_t f = 0, sum = 0; f < count; f++) {
        sum += start[f];
        start[f] = sum;
    }
    for (size_t f = count; f-- > 0;)
        members[--start[sets_find(patch, (uint32_t)f)]] = (uint32_t)f;
}

starg_status repair_drop_fins(repair_state *state) {
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    size_t count = repair_face_count(state);
    SCOPED size_t *start = NULL;
    SCOPED uint32_t *patch = NULL, *members = NULL;
    SCOPED fin *fins = NULL;
    NEW(state->context, REPAIR_STAGE, patch, count);
    NEW(state->context, REPAIR_STAGE, members, count);
    NEW(state->context, REPAIR_STAGE, fins, count);
    NEW_ZERO(state->context, REPAIR_STAGE, start, count);
    starg_mesh view = repair_view(state);
    TRY(topology_create(state->context, &view, &topology));
    size_t fin_count = list_fins(topology, patch, fins);
    file_members(patch, count, start, members);
    for (size_t i = 0; i < fin_count; i++) {
        const uint32_t *own = members + start[fins[i].patch];
        if (!hangs_loose(state, topology, own, fins[i].faces))
            continue;
        for (size_t k = 0; k < fins[i].faces; k++)
            state->flags.data[own[k]] |= REPAIR_GONE;
    }
    repair_compact(state);
    return STARG_OK;
}

/* ---- components without volume ---- */

typedef struct extent {
    double lower[3], upper[3], volume, area;
} extent;

/* Volume and area of a shell scaled to a box diagonal of 1, to avoid overflow and underflow. */
static void measure_faces(const starg_mesh *view, const mesh_topology *topology, extent *extents) {
    for (size_t f = 0; f < view->face_count; f++) {
        extent *own = &extents[topology->component[f]];
        double p[3][3], normal[3], size = 0;
        for (int k = 0; k < 3; k++)
            size = hypot(size, own->upper[k] - own->lower[k]);
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++) {
                double x = view->vertices[3 * (size_t)view->faces[3 * f + (size_t)i] + (size_t)k];
                p[i][k] = size > 0 ? (x - own->lower[k]) / size : 0;
            }
        vec3_triangle_normal(p[0], p[1], p[2], normal);
        own->area += vec3_length(normal) / 2;
        own->volume += vec3_triple(p[0], p[1], p[2]) / 6;
    }
}

static void measure_boxes(const starg_mesh *view, const mesh_topology *topology, extent *extents) {
    for (size_t c = 0; c < topology->component_count; c++)
        for (int k = 0; k < 3; k++) {
            extents[c].lower[k] = INFINITY;
            extents[c].upper[k] = -INFINITY;
        }
    for (size_t i = 0; i < 3 * view->face_count; i++) {
        extent *own = &extents[topology->component[i / 3]];
        const double *p = view->vertices + 3 * (size_t)view->faces[i];
        for (int k = 0; k < 3; k++) {
            own->lower[k] = fmin(own->lower[k], p[k]);
            own->upper[k] = fmax(own->upper[k], p[k]);
        }
    }
}

/* Flat up to the rounding of coordinates; thin solids are kept. */
static bool is_flat(const extent *own) {
    return !(fabs(own->volume) > 0x1p-44 * own->area);
}

starg_status repair_drop_flat(repair_state *state) {
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    SCOPED extent *extents = NULL;
    starg_mesh view = repair_view(state);
    TRY(topology_create(state->context, &view, &topology));
    NEW_ZERO(state->context, REPAIR_STAGE, extents, topology->component_count);
    measure_boxes(&view, topology, extents);
    measure_faces(&view, topology, extents);
    for (size_t c = 0; c < topology->component_count; c++)
        state->report.components_dropped += is_flat(&extents[c]);
    for (size_t f = 0; f < view.face_count; f++)
        if (is_flat(&extents[topology->component[f]]))
            state->flags.data[f] |= REPAIR_GONE;
    repair_compact(state);
    return STARG_OK;
}

/* ---- enclosed volume ---- */

/* Does each edge bound as many faces of one direction as of the other? */
static bool is_balanced(const mesh_topology *topology, const starg_mesh *view) {
    for (uint32_t h = 0; h < 3 * view->face_count; h++) {
        long sum = 0;
        uint32_t o = h;
        do {
            sum += view->faces[o] == view->faces[h] ? 1 : -1;
            o = topology->ring[o];
        } while (o != h);
        if (sum != 0)
            return false;
    }
    return true;
}

starg_status repair_measure(const repair_state *state, bool *closed, double *enclosed) {
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    SCOPED double *volume = NULL;
    double sum = 0;
    starg_mesh view = repair_view(state);
    *enclosed = 0;
    TRY(topology_create(state->context, &view, &topology));
    *closed = view.face_count > 0 && is_balanced(topology, &view);
    NEW_ZERO(state->context, REPAIR_STAGE, volume, topology->component_count);
    int exponent = starg_mesh_exponent(&view);
    for (size_t f = 0; f < view.face_count && *closed; f++) {
        double p[3][3];
        for (size_t k = 0; k < 3; k++)
            starg_mesh_scaled_corner(&view, f, k, exponent, p[k]);
        volume[topology->component[f]] += vec3_triple(p[0], p[1], p[2]) / 6;
    }
    for (size_t c = 0; c < topology->component_count; c++)
        sum += fabs(volume[c]);
    *enclosed = ldexp(sum, 3 * exponent);
    return STARG_OK;
}
