/* Independent checks of results: arithmetic and algorithms of their own, slow and simple. */
#ifndef STARGUARD_VERIFY_H
#define STARGUARD_VERIFY_H

#include <stdbool.h>
#include <stddef.h>

#include "context.h"
#include "guard.h"
#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One claim that was checked. */
typedef struct starg_claim {
    char text[256]; /* what was checked, and what was found where it does not hold */
    bool holds;
} starg_claim;

typedef struct starg_verdict {
    bool passed; /* every claim holds */
    size_t count;
    starg_claim *claims;
} starg_verdict;

/* Checks everything that a guards result claims about a mesh and that can be checked without its
 * candidates: counts, every guard strictly inside with its clearance, what each guard sees, the
 * coverage, the uncovered faces, and that bounds and counts are consistent. The mesh is the model
 * as read (inward shells are turned here as well).
 * Errors: MESH (not closed and oriented), MEMORY, CANCELLED; a claim that fails is no error. */
STARG_API starg_status starg_verify_guards(starg_context *context, const starg_mesh *mesh,
                                           const starg_guards *guards, starg_verdict **out);
STARG_API void starg_verdict_free(starg_context *context, starg_verdict *verdict);

#ifdef __cplusplus
}
#endif

#endif
