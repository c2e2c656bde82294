/* SPDX-License-Identifier: Apache-2.0 */
/* What hangs together by faces and has no colour yet. */
#ifndef STARG_STAR_PAPER_COMPONENT_H
#define STARG_STAR_PAPER_COMPONENT_H

#include "star/paper/view.h"

typedef struct component_search {
    paper_domain found;
    uint32_t *number;                 /* of a found vertex in `found` */
    uint32_t *tet_mark, *vertex_mark; /* the search in which it was found last */
    uint32_t search;
} component_search;

/* Memory for all searches; free it also after a failure. Errors: MEMORY. */
starg_status component_create(const paper_state *s, component_search *out);
void component_free(const paper_state *s, component_search *c);

/* Finds the uncoloured component of a tetrahedron, breadth first. */
void component_find(const paper_state *s, component_search *c, uint32_t tetrahedron);

#endif
