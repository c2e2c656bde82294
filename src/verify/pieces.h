/* SPDX-License-Identifier: Apache-2.0 */
/* Pieces as they are checked: labelled tetrahedra, their facets, and the claims about them. */
#pragma once

#include "verify/facts.h"

/* ---- triangles of one tetrahedron, and those shared by two (facets.c) ---- */

#define VERIFY_NONE UINT32_MAX

/* Limit on tetrahedra, so that facet numbers are below VERIFY_NONE. */
#define VERIFY_TETRAHEDRA ((size_t)1 << 29)

/* An invalid use of a triangle: how often, and the first two conflicting facets. */
typedef struct verify_misuse {
    size_t count;
    uint32_t facet, other;
} verify_misuse;

/* Facet 4 t + i is the side of tetrahedron t opposite its corner i. */
typedef struct verify_facets {
    starg_context *context;
    const uint32_t *tetrahedra;
    size_t count;            /* of tetrahedra */
    uint32_t *mate;          /* per facet: the other one of its triangle, or VERIFY_NONE */
    verify_misuse third;     /* a triangle with more than two tetrahedra */
    verify_misuse same_side; /* a triangle with two facets of the same orientation */
} verify_facets;

/* `tetrahedra` (count x 4) must outlive the facets. Errors: MEMORY, CANCELLED. */
starg_status verify_facets_create(starg_context *context, const uint32_t *tetrahedra, size_t count,
                                  verify_facets **out);
void verify_facets_free(verify_facets *facets);
STARG_DROP(verify_facets, verify_facets)

/* The corners of a facet, counter-clockwise seen from outside of a positive tetrahedron. */
static inline void verify_facet_corners(const uint32_t *tetrahedra, uint32_t facet,
                                        uint32_t corners[3]) {
    static const uint8_t opposite[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    for (int i = 0; i < 3; i++)
        corners[i] = tetrahedra[(size_t)(facet & ~UINT32_C(3)) + opposite[facet % 4][i]];
}

/* The facets without a mate, ascending, and their triangles (count x 3). Errors: MEMORY. */
starg_status verify_facets_outer(const verify_facets *facets, uint32_t **outer, uint32_t **faces,
                                 size_t *count);

/* ---- a decomposition taken apart, and what is found out about it (pieces.c) ---- */

/* Labels that are not 0 to pieces - 1, each in use. */
typedef struct verify_labels {
    bool good;
    size_t tetrahedron;  /* the first one with a wrong label, or VERIFY_NONE */
    size_t empty, first; /* labels of no tetrahedron                         */
} verify_labels;

typedef struct verify_pieces {
    starg_context *context;
    const starg_pieces_mesh *mesh;
    int scale; /* of the model (verify/surface.h)  */
    verify_facets *facets;
    verify_surface *outer;  /* the boundary of all tetrahedra   */
    uint32_t *outer_facets; /* of each face of it               */

    verify_labels labels;
    size_t piece_count; /* of the report or, without one, as many as there are labels */
    /* The rest only with good labels. A wall is a face of a piece's boundary; those of piece p are
     * wall_start[p] to wall_start[p + 1] - 1. */
    size_t *sizes; /* tetrahedra of each piece */
    verify_surface *walls;
    uint32_t *wall_facets;
    size_t *wall_start;
} verify_pieces;

/* Are indices in range and coordinates finite? `report` may be NULL. Errors: ARGUMENT, RANGE. */
starg_status verify_check_arrays(starg_context *context, const starg_pieces_mesh *mesh,
                                 const starg_pieces_report *report);

/* `report` may be NULL. Errors: MEMORY, CANCELLED. */
starg_status verify_pieces_create(starg_context *context, const starg_pieces_mesh *mesh,
                                  const starg_pieces_report *report, verify_pieces **out);
void verify_pieces_free(verify_pieces *pieces);
STARG_DROP(verify_pieces, verify_pieces)

static inline const double *verify_point(const starg_pieces_mesh *mesh, uint32_t vertex) {
    return mesh->vertices + 3 * (size_t)vertex;
}

/* Adds the volume of a tetrahedron. */
static inline void verify_add_tetrahedron(verify_volume *volume, const starg_pieces_mesh *mesh,
                                          size_t tetrahedron, int scale) {
    const double *t[4];
    for (size_t i = 0; i < 4; i++)
        t[i] = verify_point(mesh, mesh->tetrahedra[4 * tetrahedron + i]);
    verify_add_volume(volume, t, scale);
}

/* ---- the boundary and the model (boundary.c, nearness.c, enclosed.c) ---- */

typedef struct verify_match {
    size_t equal;                     /* outer faces that are faces of the model as they are */
    size_t off, first_off;            /* that do not lie on the model                        */
    size_t turned, first_turned;      /* that lie on it the wrong way round                */
    size_t shells, uneven;            /* of the model; not covered once                      */
    size_t shell;                     /* a face of the first of these                        */
    double shell_area, shell_covered; /* of it, in scaled units                       */
    double area, model_area;          /* of all, in scaled units                      */
} verify_match;

/* Lays the faces of a closed surface on those of the model. Errors: MEMORY, CANCELLED. */
starg_status verify_match_surfaces(const verify_surface *outer, const verify_surface *model,
                                   verify_match *match);

/* From one surface to another. */
typedef struct verify_reach {
    double farthest; /* distance found          */
    size_t face;     /* where it starts         */
    size_t points;   /* that were looked at     */
} verify_reach;

typedef struct verify_nearness {
    verify_reach to, from;   /* from the boundary to the model, and back      */
    size_t crossings;        /* pairs of outer faces that cross               */
    size_t pair[2];          /* the first pair                                */
    size_t shells, multiple; /* shells; those about whose inside the boundary does not wind
                                once                                          */
    size_t shell;            /* an outer face of the first of these           */
} verify_nearness;

/* How far is the boundary from the model, and does it bound its tetrahedra once? Errors: MEMORY,
 * CANCELLED. */
starg_status verify_measure_boundary(const verify_pieces *pieces, const verify_surface *model,
                                     verify_nearness *nearness);

/* How many pairs of faces cross, and the first of them? Errors: MEMORY, CANCELLED. */
starg_status verify_find_crossings(const verify_surface *surface, const verify_tree *tree,
                                   size_t *count, size_t pair[2]);

/* Points that were drawn, off the surface. */
typedef struct verify_enclosed {
    size_t points, inside; /* those in the model                                  */
    size_t missing;        /* that the model encloses and the pieces do not       */
    size_t excess;         /* the other way round, or that pieces enclose twice   */
    size_t overlapping;    /* about which the model winds more than once          */
    double place[3];       /* the first of either                                 */
} verify_enclosed;

/* Do the pieces fill what the model encloses, but for what is as near to its surface as said?
 * Errors: MEMORY, CANCELLED. */
starg_status verify_compare_enclosed(const verify_pieces *pieces, const verify_surface *model,
                                     double near, verify_enclosed *found);

/* ---- star-shapedness (claim_stars.c) ---- */

typedef enum verify_proof {
    VERIFY_PROVEN = 0, /* the piece is star-shaped about its guard               */
    VERIFY_BEHIND = 1, /* the guard is not strictly on the inner side of a wall  */
    VERIFY_WOUND = 2   /* the walls do not wind once around the guard            */
} verify_proof;

typedef struct verify_certificate {
    verify_proof proof;
    size_t wall; /* BEHIND: the first such wall */
    int winding; /* WOUND                       */
} verify_certificate;

/* The certificate of each piece (piece_count of them). Errors: CANCELLED. */
starg_status verify_certify(const verify_pieces *pieces, const starg_pieces_report *report,
                            verify_certificate *certificates);

/* ---- contacts (contacts.c) ---- */

typedef struct verify_contacts {
    size_t wrong;           /* contacts listed wrongly, twice or not at all        */
    uint32_t first, second; /* the first of them                                   */
    double listed, found;   /* its areas; 0: not listed, or no contact             */
} verify_contacts;

/* Holds the listed contacts against the walls. Errors: MEMORY. */
starg_status verify_compare_contacts(const verify_pieces *pieces, const starg_pieces_report *report,
                                     verify_contacts *contacts);

/* ---- vertices seen (seen.c) ---- */

typedef struct verify_seen {
    size_t pairs;  /* of a piece and a vertex of it                            */
    size_t proven; /* of them in star-shaped pieces, where all are seen        */
    size_t looked; /* lines of sight that were tested among the other pairs    */
    size_t seen;   /* of them free                                             */
} verify_seen;

/* Which vertices of its piece does each guard see past the boundary? Errors: MEMORY, CANCELLED. */
starg_status verify_find_seen(const verify_pieces *pieces, const starg_pieces_report *report,
                              const verify_certificate *certificates, verify_seen *seen);

/* ---- distortion of a linear map, found in another way than by the solver (distortion.c) ---- */

/* Sums over tetrahedra, initially zero. */
typedef struct verify_distortion {
    double worst, sum, above, all;
    double worst_room, sum_room, above_room; /* how far rounding may move them */
} verify_distortion;

/* Adds a tetrahedron and its image; coordinates are multiplied by 2^scale first. */
void verify_add_distortion(verify_distortion *own, const double *const from[4], int from_scale,
                           const double *const to[4], int to_scale);

/* Do two values agree, up to rounding, which grows as tetrahedra get flatter (`room`)? */
int verify_near_distortion(double claimed, double found, double room);

/* ---- the model, the report, and the claims to check (result.c and a file for each claim) ---- */

typedef struct verify_context {
    starg_context *context;
    const starg_pieces_mesh *mesh;
    const starg_pieces_report *report; /* or NULL */
    const verify_surface *model;
    size_t model_tetrahedra;     /* of a tetrahedral model, or 0 */
    const verify_surface *solid; /* the same, closed and oriented; NULL: it is not closed */
    const starg_certificate *certificate; /* of the report's lower bound, or NULL */
    verify_pieces *pieces;
    starg_verdict *verdict;
} verify_context;

/* Claims about the tetrahedra: positive, conforming, labelled, connected by piece. Errors: MEMORY,
 * CANCELLED. */
starg_status verify_claim_tetrahedra(const verify_context *own);

/* The boundary and the volume are those of the model. Errors: MEMORY, CANCELLED. */
starg_status verify_claim_boundary(const verify_context *own);

/* The boundary does not cross itself and winds around its inside once, so that positive tetrahedra
 * do not overlap. Errors: MEMORY, CANCELLED. */
starg_status verify_claim_once(const verify_context *own);

/* The report's numbers. Requires valid labels. Errors: MEMORY, CANCELLED. */
starg_status verify_claim_numbers(const verify_context *own);

/* Star-shapedness, and what guards see. Requires valid labels. Errors: MEMORY, CANCELLED. */
starg_status verify_claim_stars(const verify_context *own);

/* Dihedral angles. Errors: MEMORY. */
starg_status verify_claim_angles(const verify_context *own);

/* No fewer star-shaped pieces are possible. Errors: MEMORY, CANCELLED. */
starg_status verify_claim_fewest(const verify_context *own);
/* Maps of pieces to balls, if there are any. Errors: MEMORY. */
starg_status verify_claim_balls(const verify_context *own);

/* Between the keys of a map no tetrahedron is ever inverted. Errors: CANCELLED. */
starg_status verify_claim_path(starg_context *context, const starg_solid_map *map,
                               starg_verdict *verdict);

/* ---- names of elements (claim_tetrahedra.c) ---- */

typedef struct verify_words {
    char text[96];
} verify_words;

verify_words verify_facet_words(const verify_context *own, uint32_t facet);
verify_words verify_outer_words(const verify_context *own, size_t face);
