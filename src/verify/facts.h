/* SPDX-License-Identifier: Apache-2.0 */
/* The verdict on guards: claims, and the facts that they are held against. */
#pragma once

#include "core/bits.h"
#include "verify/sight.h"

/* ---- a verdict under construction: a list of claims (claims.c) ---- */

/* Limits on the claims of a verdict, and on those left unchecked. */
enum { VERIFY_CLAIMS = 64, VERIFY_UNCHECKED = 32 };

starg_status verify_verdict_create(starg_context *context, starg_verdict **out);
STARG_DROP_RESULT(starg_verdict)

/* Adds a claim: what was checked, and, if it does not hold, what was found. */
void verify_claim(starg_verdict *verdict, bool holds, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Adds a claim that holds of all but `bad` elements, the first of which is named if there are any:
 * "text (not: 3, the first is 17)". */
void verify_claim_all(starg_verdict *verdict, size_t bad, size_t first, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Adds a statement of the result that is not checked; the second one, that the verdict is about. */
void verify_leave(starg_verdict *verdict, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void verify_leave_asked(starg_verdict *verdict, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* ---- what the guards of a result see, recomputed, and conclusions from it (facts.c) ---- */

/* The zones of a result (verify/zones.c); NULL: there are none. `meshes` has one for each zone that
 * is one. Errors: MESH (also: other meshes than those of the result), MEMORY, CANCELLED. */
typedef struct verify_zones verify_zones;
starg_status verify_zones_create(starg_context *context, const starg_guards *guards,
                                 const starg_mesh *const *meshes, verify_zones **out);
void verify_zones_free(verify_zones *zones);
STARG_DROP(verify_zones, verify_zones)
bool verify_zones_admit(const verify_zones *zones, const double p[3]);

typedef struct verify_facts {
    const verify_surface *surface;
    const starg_guards *guards;
    const verify_zones *zones;
    int scale;
    bool *inside;         /* per guard */
    double *distance;     /* per guard its distance to the surface; only with a clearance */
    double *standoff;     /* per guard its distance to the model; if needed */
    size_t *seen_faces;   /* per guard */
    starg_bits *patches;  /* per guard a row: the patches of targets that it sees */
    starg_bits *vertices; /* likewise; only if vertices are the target */
    uint8_t *vertex;      /* 1: some guard sees the vertex; likewise */
    uint8_t *patch;       /* 1: some guard sees the patch, or it is no target */
    uint8_t *face;        /* 1: of all its patches */
    uint8_t *wanted;      /* 1: the patch is a target; others have area 0 */
    uint8_t *used;        /* vertices of target faces */
    double *area;         /* per patch, in scaled units */
    verify_tree *tree;    /* of the surface */

    size_t wanted_faces, covered_faces, used_vertices, covered_vertices;
    double covered_area, total_area;
} verify_facts;

/* Was a guard given to stay? Then it may stand and look where others may not. */
static inline bool verify_is_kept(const starg_guards *guards, size_t guard) {
    return guards->kept != NULL && guards->kept[guard];
}

/* The number of guards that were given to stay. */
static inline size_t verify_count_kept(const starg_guards *guards) {
    size_t count = 0;
    for (size_t g = 0; g < guards->count; g++)
        count += verify_is_kept(guards, g);
    return count;
}

/* How many guards must see a column: a patch, or a vertex. */
uint32_t verify_times(const verify_facts *known, size_t column);

static inline bool verify_targets_vertices(const verify_facts *known) {
    return known->guards->options.visibility.target == STARG_TARGET_VERTICES;
}

static inline bool verify_targets_points(const verify_facts *known) {
    return known->guards->options.visibility.target == STARG_TARGET_POINTS;
}

/* Halves faces until what guards see of them whole is known: these are its patches, and counts
 * the faces that each guard sees (verify/points.c). Errors: ARGUMENT (too many parts), MEMORY,
 * CANCELLED. */
starg_status verify_divide_by_points(verify_facts *known, verify_surface *surface);

/* Relative; for lengths, areas and fractions. */
#define VERIFY_TOLERANCE 1e-9

/* `known` has guards, the rest is 0; the surface, which must outlive it, gets patches. Errors:
 * ARGUMENT (too many parts), MEMORY, CANCELLED, TIME. */
starg_status verify_facts_find(verify_surface *surface, verify_facts *known);
void verify_facts_free(verify_facts *known);

static inline double verify_fraction(double part, double all) {
    return all > 0 ? part / all : 0;
}

/* Elements that were to be seen. */
typedef struct verify_target {
    const char *name;
    size_t all, covered, coverable; /* the last as claimed */
} verify_target;
verify_target verify_target_of(const verify_facts *known);

/* Does the space restrict guards to a part of the free space? */
bool verify_space_is_narrow(const starg_space_options *space);

/* Counts the guards that cannot be reached from where the space says, through cubes of half the
 * size (verify/reach.c); *known_cubes: false if there are too many of them to tell. Errors: MEMORY,
 * CANCELLED. */
starg_status verify_find_unreached(const verify_facts *known, bool *known_cubes, size_t *count,
                                   size_t *first);

/* Rows of the target elements: patches, or vertices. */
static inline const starg_bits *verify_rows(const verify_facts *known) {
    return verify_targets_vertices(known) ? known->vertices : known->patches;
}

/* How many target faces have all their patches in a row? */
size_t verify_count_faces(const verify_facts *known, const uint64_t *row);

/* Number of rows that contain each column; the caller releases `held`. Errors: MEMORY. */
starg_status verify_count_held(const verify_facts *known, const starg_bits *rows, uint32_t **held);

/* The view of a guard that looks all around, and that of one of the result. */
verify_view verify_view_around(const starg_guards *guards);
verify_view verify_view_of(const starg_guards *guards, size_t guard);

/* May a guard stand at p, with its clearance and in the space? But for what can be reached. */
bool verify_admits(const verify_facts *known, const double p[3]);

/* Number of unseen elements that could be seen (verify/coverable.c). The search ends when it
 * exceeds `enough`. */
typedef struct verify_coverable {
    size_t proven; /* elements that a guard at some place would see */
    size_t first;  /* the first of them */
    double place[3];
} verify_coverable;
starg_status verify_find_coverable(const verify_facts *known, size_t enough,
                                   verify_coverable *found);

/* Number of guards of the result, chosen among them, that are as good as all (verify/needed.c). */
starg_status verify_find_needed(const verify_facts *known, size_t *needed);

/* Of how many faces is each patch seen by two guards that are the baseline apart (verify/facts.c)?
 */
size_t verify_count_paired(const verify_facts *known);

/* Columns seen by fewer guards than redundancy requires (verify/redundancy.c). */
#define VERIFY_NO_COLUMN SIZE_MAX
typedef struct verify_lack {
    size_t lacking;  /* seen by some guard, but by too few */
    size_t shown;    /* one of them that another guard could have seen, or VERIFY_NO_COLUMN */
    double place[3]; /* where it could have stood */
} verify_lack;
starg_status verify_find_lack(const verify_facts *known, verify_lack *found);

/* Of how many faces with needs of their own is each patch seen as often as they need? Errors:
 * MEMORY. */
starg_status verify_count_met(const verify_facts *known, size_t *met);

/* The numbers of faces that at least 1, 2, ... and `most` guards see. Errors: MEMORY. */
starg_status verify_count_often(const verify_facts *known, size_t most, size_t *often);

/* Consistency of levels and guards (verify/guards.c). */
typedef struct verify_levels {
    bool grow;   /* each has more vertices than the one before; the last has those of the model */
    bool kept;   /* guards that are kept were guards of the level before */
    bool inside; /* all their guards are strictly inside the model */
    bool named;  /* a guard is listed in its level and in all later ones */
} verify_levels;
verify_levels verify_check_levels(const verify_facts *known);

/* Claims of files beside the result (verify/tables.c). Errors: READ, MEMORY. */
starg_status verify_claim_tables(starg_verdict *verdict, const verify_facts *known,
                                 const starg_guards_evidence *evidence);

/* The claims of a result, in their order (verify/guards_*.c). Errors: MEMORY, CANCELLED, TIME. */
starg_status verify_claim_places(starg_verdict *verdict, const verify_facts *known);
void verify_claim_tour(starg_verdict *verdict, const verify_facts *known);
starg_status verify_claim_coverage(starg_verdict *verdict, const verify_facts *known);
