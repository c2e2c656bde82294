/* SPDX-License-Identifier: Apache-2.0 */
/* Tests whether a mesh bounds a solid, and lists its defects. */
#ifndef STARGUARD_CHECK_H
#define STARGUARD_CHECK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "context.h"
#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Kinds of findings. The first five make a mesh unusable as a solid, unless edges of more faces and
 * vertices of several fans are where parts of it touch; the others are only reported. */
typedef enum starg_finding_kind {
    STARG_FINDING_OPEN_EDGE = 0,          /* an edge of one face                               */
    STARG_FINDING_NONMANIFOLD_EDGE = 1,   /* an edge of three or more faces                    */
    STARG_FINDING_NONMANIFOLD_VERTEX = 2, /* its faces form more than one fan                  */
    STARG_FINDING_INCONSISTENT_EDGE = 3,  /* its two faces traverse it in the same direction */
    STARG_FINDING_REPEATED_CORNER = 4,    /* a face with a repeated vertex */
    STARG_FINDING_INWARD_COMPONENT = 5,   /* a shell to be reversed; listed by its first face */
    STARG_FINDING_DEGENERATE_FACE = 6,    /* three different corners on one line: no area      */
    STARG_FINDING_DUPLICATE_FACE = 7,     /* the same three corners as an earlier face         */
    STARG_FINDING_DUPLICATE_VERTEX = 8,   /* at the position of an earlier vertex              */
    STARG_FINDING_ISOLATED_VERTEX = 9,    /* a vertex without faces */
    STARG_FINDING_SELF_INTERSECTION = 10, /* a pair of intersecting faces */
    STARG_FINDING_SELF_CONTACT = 11,      /* a pair that touches away from shared vertices */
    STARG_FINDING_KINDS = 12
} starg_finding_kind;

typedef struct starg_finding {
    size_t count;          /* elements (or pairs) found                                        */
    starg_element element; /* what `first` counts; edges and pairs take two entries each       */
    size_t shown;          /* used entries of `first`                                          */
    uint64_t first[STARG_ERROR_INDICES];
} starg_finding;

/* The result of a check. */
typedef struct starg_check {
    size_t vertices, faces, edges;
    size_t components;      /* connected by edges                                           */
    size_t cavities;        /* shells that bound a void inside the solid */
    bool closed;            /* every edge has two faces                                     */
    bool manifold;          /* every edge at most two faces, every vertex one fan           */
    bool oriented;          /* neighbours agree; inward shells are allowed */
    bool embedded;          /* no degenerate face, intersection or contact                  */
    bool usable;            /* closed, oriented, with positive volume; manifold but for contacts;
                               not so small that its area or volume underflows */
    int64_t genus;          /* sum over components; -1 unless closed and manifold           */
    double area, volume;    /* volume after turning inward shells; 0 unless usable          */
    double diagonal;        /* of the bounding box                                          */
    double shortest_edge;   /* of those with a length; 0 if there are none                  */
    double grid[3];         /* by axis: the step of which all coordinates are multiples     */
    bool coarse;            /* edges are hardly longer than these steps, far from the origin */
    bool underflows;        /* it encloses a volume, but doubles do not hold it or the area */
    size_t one_sided_faces; /* faces of one-sided surfaces such as a Moebius strip */
    starg_finding findings[STARG_FINDING_KINDS];
    uint8_t *face_marks; /* per face: 0, or 1 + the first kind (in enum order) that marks it */
} starg_check;

/* Checks a mesh. Errors: MEMORY, CANCELLED; a defective mesh is a result, not an error. */
STARG_API starg_status starg_mesh_check(starg_context *context, const starg_mesh *mesh,
                                        starg_check **out);
/* What helps a mesh that is not usable, as the end of a sentence; static. */
STARG_API const char *starg_check_advice(const starg_check *check);

/* What rounding has done, if the grid is coarse ("coordinates have steps of 0.5, ..."); otherwise
 * empty. Truncated to `size` bytes. */
STARG_API void starg_check_describe_grid(const starg_check *check, char *text, size_t size);

STARG_API void starg_check_free(starg_context *context, starg_check *check);

/* The plural name of a kind, for example "open edges"; static. */
STARG_API const char *starg_finding_name(starg_finding_kind kind);

#ifdef __cplusplus
}
#endif

#endif
