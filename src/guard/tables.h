/* SPDX-License-Identifier: Apache-2.0 */
/* What guards see of their scene, as numbers for tables (guard/tables.c). */
#ifndef STARG_GUARD_TABLES_H
#define STARG_GUARD_TABLES_H

#include "guard/patched.h"
#include "starguard/guard.h"

enum { SEEN_TIMES = 3 };

/* A scene, in the patches in which the guards see it, and a row of patches for each guard. */
typedef struct seen_table {
    const starg_guards *guards;
    const starg_face_groups *groups; /* NULL: the faces have none */
    patched_solid patched;
    starg_bits *rows;
} seen_table;

/* Errors: those of starg_visibility. */
starg_status seen_table_open(starg_context *context, const starg_solid *scene,
                             const starg_guards *guards, const starg_face_groups *groups,
                             seen_table *out);
void seen_table_close(seen_table *table);

typedef struct seen_face {
    double area, share; /* the latter: of the area, that any guard sees */
    size_t cameras;     /* that see some of it */
    size_t least;       /* that see every part of it, at least */
} seen_face;

/* `sees`: by guard, whether it sees some of the face. */
seen_face seen_table_face(const seen_table *table, size_t face, uint8_t *sees);

typedef struct seen_area {
    double all, alone; /* areas: seen, and seen by no other guard */
    double density;    /* mean by area, of pixels for each unit of length; 0: not known */
} seen_area;

typedef struct group_area {
    double all, by[SEEN_TIMES]; /* areas, by[k] of what k + 1 guards see */
} group_area;

/* An area for each guard, and for each group; the last of these, one more than there are groups, is
 * that of all targets. */
void seen_table_measure(const seen_table *table, seen_area *guards, group_area *groups);

/* A part of an area, at most 1. */
double seen_ratio(double part, double all);

#endif
