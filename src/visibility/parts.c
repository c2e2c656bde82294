/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of a solid, and what they need at least.
 *
 * Problem: which faces bound the same connected component of the interior?
 *
 * Method: a shell that lies in an even number of others bounds a part from outside; one in an odd
 * number is a cavity of the part whose outer shell is the innermost around it (mesh/examine.h).
 *
 * Why no point sees faces of two parts: nothing lies between a point and what it sees, so it lies
 * in the same shells as the inner side of the face does. These are, for an outer shell, itself and
 * all around it; for a cavity, all around it. The innermost of them is the outer shell of the part.
 *
 * Cost: O(n log n), and a linear program for each part. */
#include "visibility/kernel.h"

#include "core/memory.h"
#include "geometry/predicates.h"
#include "mesh/examine.h"
#include "mesh/topology.h"

static const char STAGE[] = "kernel";

typedef struct joining {
    const starg_mesh *mesh;
    const mesh_topology *topology;
    uint32_t *parent;  /* by shell: those of one part */
    uint8_t *touching; /* by face: meets another shell */
    uint32_t *welded;  /* faces with one vertex at each position */
} joining;

/* What shells have in common beside vertices and edges may let one be seen from within another. */
static bool join_touching(void *user, uint32_t a, uint32_t b) {
    joining *j = user;
    uint32_t first = j->topology->component[a], second = j->topology->component[b];
    if (first == second)
        return true;
    triangle_contact contact =
        faces_contact(j->mesh->vertices, j->welded + 3 * (size_t)a, j->welded + 3 * (size_t)b);
    if (contact == TRIANGLES_APART)
        return true;
    j->touching[a] = j->touching[b] = 1;
    if (contact != TRIANGLES_SHARE)
        sets_join(j->parent, first, second);
    return true;
}

static starg_status join_contacts(starg_context *context, const starg_solid *solid, joining *j) {
    SCOPED uint32_t *first = NULL;
    size_t moved;
    TRY(mesh_find_coincident(context, solid->mesh, &first, &moved));
    NEW(context, STAGE, j->welded, 3 * solid->mesh->face_count);
    for (size_t i = 0; i < 3 * solid->mesh->face_count; i++)
        j->welded[i] = first[solid->mesh->faces[i]];
    return face_pairs_visit(context, solid->mesh, solid->tree, NULL, join_touching, j);
}

static starg_status join_shells(starg_context *context, const starg_solid *solid, joining *j) {
    starg_status status = STARG_OK;
    mesh_shell *shells = NULL;
    uint32_t crossed = UINT32_MAX;
    size_t count = j->topology->component_count;
    const starg_finding *found = solid->check->findings;
    STARG_NEW_ZERO(context, STAGE, shells, count);
    STARG_NEW_ZERO(context, STAGE, j->touching, solid->mesh->face_count);
    if (found[STARG_FINDING_SELF_INTERSECTION].count + found[STARG_FINDING_SELF_CONTACT].count > 0)
        STARG_TRY(join_contacts(context, solid, j));
    STARG_TRY(shells_classify(context, solid->mesh, j->topology, solid->tree, j->touching, shells));
    for (uint32_t c = 0; c < count; c++) {
        if (shells[c].within != UINT32_MAX)
            sets_join(j->parent, c, shells[c].within);
        if (shells[c].crossed && crossed == UINT32_MAX)
            crossed = c;
        if (shells[c].crossed)
            sets_join(j->parent, c, crossed);
    }
done:
    RELEASE(j->touching, j->welded, shells);
    return status;
}

/* Gives parts numbers in the order of their lowest faces. */
static starg_status number_parts(starg_context *context, const joining *j, solid_parts *out) {
    SCOPED uint32_t *number = NULL;
    NEW(context, STAGE, number, j->topology->component_count);
    for (size_t c = 0; c < j->topology->component_count; c++)
        number[c] = UINT32_MAX;
    for (size_t f = 0; f < j->topology->face_count; f++) {
        uint32_t root = sets_find(j->parent, j->topology->component[f]);
        if (number[root] == UINT32_MAX)
            number[root] = (uint32_t)out->count++;
        out->of[f] = number[root];
    }
    return STARG_OK;
}

starg_status solid_parts_find(starg_context *context, const starg_solid *solid, solid_parts *out) {
    starg_status status = STARG_OK;
    mesh_topology *topology = NULL;
    joining j = {.mesh = solid->mesh};
    *out = (solid_parts){.count = solid->scene || solid->check->components < 2};
    STARG_NEW_ZERO(context, STAGE, out->of, solid->mesh->face_count);
    if (out->count == 1)
        goto done;
    STARG_TRY(topology_create(context, solid->mesh, &topology));
    j.topology = topology;
    STARG_NEW(context, STAGE, j.parent, topology->component_count);
    sets_make(j.parent, topology->component_count);
    STARG_TRY(join_shells(context, solid, &j));
    STARG_TRY(number_parts(context, &j, out));
done:
    topology_free(topology);
    starg_release(context, j.parent);
    return status;
}

void solid_parts_free(solid_parts *parts) {
    RELEASE(parts->of);
    *parts = (solid_parts){0};
}

/* Faces by part: those of part i are list[first[i]] to list[first[i + 1] - 1]. */
static starg_status list_faces(starg_context *context, const solid_parts *parts, size_t faces,
                               uint32_t **list, size_t **first) {
    NEW(context, STAGE, *list, faces);
    NEW_ZERO(context, STAGE, *first, parts->count + 2);
    for (size_t f = 0; f < faces; f++)
        (*first)[parts->of[f] + 2]++;
    for (size_t i = 2; i < parts->count + 2; i++)
        (*first)[i] += (*first)[i - 1];
    for (size_t f = 0; f < faces; f++)
        (*list)[(*first)[parts->of[f] + 1]++] = (uint32_t)f;
    return STARG_OK;
}

static bool is_flat(const starg_mesh *mesh, const uint32_t *c) {
    return collinear(mesh->vertices + 3 * (size_t)c[0], mesh->vertices + 3 * (size_t)c[1],
                     mesh->vertices + 3 * (size_t)c[2]);
}

/* Is it proven that no point is strictly inside all of the faces? Those without area are left out:
 * nothing sees them. */
static starg_status is_without_kernel(starg_context *context, const starg_mesh *mesh,
                                      const uint32_t *list, size_t count, bool *empty) {
    SCOPED uint32_t *faces = NULL;
    kernel_faces surface = {.vertices = mesh->vertices};
    starg_kernel_result result;
    NEW(context, STAGE, faces, 3 * count);
    surface.faces = faces;
    for (size_t i = 0; i < count; i++) {
        const uint32_t *c = mesh->faces + 3 * (size_t)list[i];
        if (!is_flat(mesh, c))
            memcpy(faces + 3 * surface.count++, c, 3 * sizeof *c);
    }
    TRY(kernel_find(context, &surface, &result));
    *empty = result.verdict == STARG_KERNEL_EMPTY && result.witness_count > 0;
    return STARG_OK;
}

starg_status solid_parts_bound(starg_context *context, const starg_solid *solid,
                               const solid_parts *parts, const uint64_t *targets, size_t times,
                               bool inner, size_t *bound) {
    const starg_mesh *mesh = solid->mesh;
    SCOPED uint32_t *list = NULL;
    SCOPED size_t *first = NULL;
    *bound = 0;
    TRY(list_faces(context, parts, mesh->face_count, &list, &first));
    for (size_t i = 0; i < parts->count; i++) {
        bool any = false, all = inner, empty = false;
        for (size_t k = first[i]; k < first[i + 1]; k++) {
            bool target = targets == NULL || starg_bit_test(targets, list[k]);
            any = any || target;
            all = all && (target || is_flat(mesh, mesh->faces + 3 * (size_t)list[k]));
        }
        if (any && all)
            TRY(is_without_kernel(context, mesh, list + first[i], first[i + 1] - first[i], &empty));
        *bound += any ? times + empty : 0;
    }
    return STARG_OK;
}
