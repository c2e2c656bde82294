/* SPDX-License-Identifier: Apache-2.0 */
/* What guards see of the vertices of tetrahedra, and what follows from it for growth. */
#ifndef STARG_STAR_PAPER_VIEW_H
#define STARG_STAR_PAPER_VIEW_H

#include "star/paper/state.h"

/* A part of the mesh: tetrahedra and their vertices, none twice. */
typedef struct paper_domain {
    uint32_t *tetrahedra, *vertices;
    size_t count, vertex_count;
} paper_domain;

/* Memory for the mesh as a whole, with `waiting` zero. Errors: MEMORY. */
typedef struct view_scratch {
    uint32_t *waiting, *stack;
} view_scratch;
starg_status view_scratch_create(const paper_state *s, view_scratch *out);
void view_scratch_free(const paper_state *s, view_scratch *scratch);

/* An empty view: nothing is seen. Errors: MEMORY. */
starg_status view_create(const paper_state *s, paper_guard *g);
void view_free(const paper_state *s, paper_guard *g);

/* Fills `toward` and `cost` within a domain; the position is known. */
void view_fill(const paper_state *s, paper_guard *g, const paper_domain *domain,
               view_scratch *scratch);
/* Takes away what was filled. */
void view_clear(paper_guard *g, const paper_domain *domain);

/* Views of the whole mesh, with homes, for `count` guards strictly inside; `guards` is zero. In
 * parallel. Errors: MEMORY, CANCELLED. */
starg_status views_create(paper_state *s, const paper_domain *all, const double *positions,
                          size_t count, paper_guard *guards);

#endif
