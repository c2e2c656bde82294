/* SPDX-License-Identifier: Apache-2.0 */
/* Bounding volume hierarchy under edge collapses: when a face leaves the box of its leaf, that box
 * and its ancestors grow; dead faces leave it. Boxes never shrink, so no face is missed.
 * Rebuilding when half of the faces are dead keeps boxes tight and costs at most twice the first
 * construction in total. */
#include "mesh/levels/levels.h"

#include <math.h>

enum { STACK_SIZE = 128 };

/* The box of a leaf whose faces are all dead: meets none. */
static const bvh_box NOWHERE = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

static void clear(dynamic_bvh *n) {
    bvh_free(n->tree);
    RELEASE(n->corners, n->face, n->parent);
    n->tree = NULL;
    n->corners = n->face = n->parent = NULL;
}

/* Lists the living faces. */
static starg_status list_faces(dynamic_bvh *n, uint32_t **listed) {
    const mesh_surface *surface = n->surface;
    size_t count = 0;
    for (uint32_t f = 0; f < surface->face_count; f++)
        count += halfedges_face_lives(&surface->mesh, f);
    NEW(n->context, "simplify", n->corners, 3 * count);
    NEW(n->context, "simplify", *listed, count);
    n->listed = 0;
    for (uint32_t f = 0; f < surface->face_count; f++) {
        if (!halfedges_face_lives(&surface->mesh, f))
            continue;
        for (size_t k = 0; k < 3; k++)
            n->corners[3 * n->listed + k] = surface_face(surface, f)[k];
        (*listed)[n->listed++] = f;
    }
    return STARG_OK;
}

static bool is_leaf(const dynamic_bvh *n, const bvh_node *node) {
    return node->count > 0 || n->tree->node_count == 1;
}

static void link_nodes(dynamic_bvh *n) {
    n->parent[0] = 0;
    for (uint32_t i = 0; i < n->tree->node_count; i++) {
        const bvh_node *node = &n->tree->nodes[i];
        if (!is_leaf(n, node))
            n->parent[node->first] = n->parent[node->first + 1] = i;
        else
            for (uint32_t j = node->first; j < node->first + node->count; j++)
                n->leaf[n->face[j]] = i;
    }
}

static starg_status build(dynamic_bvh *n) {
    SCOPED uint32_t *listed = NULL;
    TRY(list_faces(n, &listed));
    TRY(bvh_create(n->context, n->surface->vertices, n->corners, n->listed, &n->tree));
    NEW(n->context, "simplify", n->face, n->listed);
    NEW(n->context, "simplify", n->parent, n->tree->node_count);
    for (size_t rank = 0; rank < n->listed; rank++)
        n->face[rank] = listed[n->tree->order[rank]];
    link_nodes(n);
    return STARG_OK;
}

starg_status dynamic_bvh_create(starg_context *context, const mesh_surface *surface,
                                dynamic_bvh **out) {
    SCOPED_BY(dynamic_bvh_drop) dynamic_bvh *tree = NULL;
    *out = NULL;
    NEW_ZERO(context, "simplify", tree, 1);
    tree->context = context;
    tree->surface = surface;
    NEW(context, "simplify", tree->leaf, surface->face_count);
    TRY(build(tree));
    *out = tree;
    tree = NULL;
    return STARG_OK;
}

void dynamic_bvh_free(dynamic_bvh *tree) {
    if (tree == NULL)
        return;
    clear(tree);
    RELEASE(tree->leaf, tree);
}

/* Extends a box to contain another; false if it already did. */
static bool enclose(bvh_box *box, const bvh_box *other) {
    bool grown = false;
    for (int k = 0; k < 3; k++) {
        if (other->lower[k] < box->lower[k]) {
            box->lower[k] = other->lower[k];
            grown = true;
        }
        if (other->upper[k] > box->upper[k]) {
            box->upper[k] = other->upper[k];
            grown = true;
        }
    }
    return grown;
}

void dynamic_bvh_update(dynamic_bvh *n, uint32_t face) {
    bvh_box box = dynamic_bvh_face_box(n->surface, surface_face(n->surface, face));
    uint32_t node = n->leaf[face];
    while (enclose(&n->tree->nodes[node].box, &box) && node != 0)
        node = n->parent[node];
}

void dynamic_bvh_remove(dynamic_bvh *n, uint32_t face) {
    bvh_node *leaf = &n->tree->nodes[n->leaf[face]];
    uint32_t rank = leaf->first;
    while (n->face[rank] != face)
        rank++;
    if (leaf->count > 1)
        n->face[rank] = n->face[leaf->first + --leaf->count];
    else
        leaf->box = NOWHERE;
}

starg_status dynamic_bvh_renew(dynamic_bvh *n) {
    if (2 * n->surface->faces_left > n->listed)
        return STARG_OK;
    clear(n);
    return build(n);
}

/* Visits the faces of a leaf. */
static bool visit_leaf(const dynamic_bvh *n, const bvh_node *leaf, const bvh_box *box,
                       bvh_visit *visit, void *user) {
    for (uint32_t rank = leaf->first; rank < leaf->first + leaf->count; rank++) {
        uint32_t face = n->face[rank];
        bvh_box own = dynamic_bvh_face_box(n->surface, surface_face(n->surface, face));
        if (bvh_boxes_meet(&own, box) && !visit(user, face))
            return false;
    }
    return true;
}

bool dynamic_bvh_query(const dynamic_bvh *tree, const bvh_box *box, bvh_visit *visit, void *user) {
    uint32_t stack[STACK_SIZE];
    size_t depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const bvh_node *node = &tree->tree->nodes[stack[--depth]];
        if (is_leaf(tree, node)) {
            if (!visit_leaf(tree, node, box, visit, user))
                return false;
            continue;
        }
        for (uint32_t child = 2; child-- > 0;)
            if (bvh_boxes_meet(&tree->tree->nodes[node->first + child].box, box))
                stack[depth++] = node->first + child;
    }
    return true;
}
