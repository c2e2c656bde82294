/* SPDX-License-Identifier: Apache-2.0 */
/* Breadth-first search through uncoloured tetrahedra. Marks are numbers of searches, so that
 * nothing has to be cleared in between: the cost of a search is the size of what it finds. */
#include "star/paper/state.h"

starg_status component_create(const paper_state *s, component_search *out) {
    starg_status status = STARG_OK;
    *out = (component_search){0};
    STARG_NEW(s->context, PAPER_STAGE, out->found.tetrahedra, s->mesh->count);
    STARG_NEW(s->context, PAPER_STAGE, out->found.vertices, s->mesh->vertex_count);
    STARG_NEW(s->context, PAPER_STAGE, out->number, s->mesh->vertex_count);
    STARG_NEW_ZERO(s->context, PAPER_STAGE, out->tet_mark, s->mesh->count);
    STARG_NEW_ZERO(s->context, PAPER_STAGE, out->vertex_mark, s->mesh->vertex_count);
done:
    return status;
}

void component_free(const paper_state *s, component_search *c) {
    starg_release(s->context, c->found.tetrahedra);
    starg_release(s->context, c->found.vertices);
    starg_release(s->context, c->number);
    starg_release(s->context, c->tet_mark);
    starg_release(s->context, c->vertex_mark);
    *c = (component_search){0};
}

static void add_vertices(const paper_state *s, component_search *c, uint32_t tetrahedron) {
    for (size_t k = 0; k < 4; k++) {
        uint32_t v = s->mesh->tetrahedra[4 * (size_t)tetrahedron + k];
        if (c->vertex_mark[v] == c->search)
            continue;
        c->vertex_mark[v] = c->search;
        c->number[v] = (uint32_t)c->found.vertex_count;
        c->found.vertices[c->found.vertex_count++] = v;
    }
}

static void add_tetrahedron(const paper_state *s, component_search *c, uint32_t tetrahedron) {
    if (tetrahedron == PAPER_NONE || s->labels[tetrahedron] >= 0 ||
        c->tet_mark[tetrahedron] == c->search)
        return;
    c->tet_mark[tetrahedron] = c->search;
    c->found.tetrahedra[c->found.count++] = tetrahedron;
    add_vertices(s, c, tetrahedron);
}

void component_find(const paper_state *s, component_search *c, uint32_t tetrahedron) {
    c->search++;
    c->found.count = 0;
    c->found.vertex_count = 0;
    add_tetrahedron(s, c, tetrahedron);
    for (size_t i = 0; i < c->found.count; i++)
        for (size_t k = 0; k < 4; k++)
            add_tetrahedron(s, c, s->mesh->neighbours[4 * (size_t)c->found.tetrahedra[i] + k]);
}
