/* SPDX-License-Identifier: Apache-2.0 */
/* Common models of the tests, and common assertions about results. Any failure fails the test. */
#ifndef TESTS_MODELS_H
#define TESTS_MODELS_H

#include <stdbool.h>
#include <stdio.h>

#include "shapes.h"
#include "starguard/guard.h"
#include "starguard/mesh.h"
#include "starguard/morph.h"
#include "starguard/solid.h"
#include "support.h"

starg_mesh *test_mesh_of(starg_context *context, const shape *s);
starg_solid *test_solid_of(starg_context *context, const shape *s);

/* A procedural solid in a pose, and in its first pose. */
starg_mesh *test_pose(starg_context *context, const char *name, int pose, size_t vertices);
starg_mesh *test_sample_mesh(starg_context *context, const char *name, size_t vertices);
starg_solid *test_sample(starg_context *context, const char *name, size_t vertices);

/* The same bytes. */
bool test_same_mesh(const starg_mesh *a, const starg_mesh *b);

/* Asserts that the independent verifier confirms every claim of a result; prints those that fail,
 * with the model's name. */
void test_verified(starg_context *context, const char *name, const starg_mesh *mesh,
                   const starg_guards *guards);

/* Guards that test_verified has confirmed. */
starg_guards *test_guard(starg_context *context, const starg_solid *solid,
                         const starg_guard_options *options);

/* A morph with few candidates for its guards. */
starg_morph *test_morph(starg_context *context, const starg_mesh *a, const double *images,
                        starg_morph_method method);

/* A row about a surface file in the tables of the shared data. */
typedef struct test_row {
    char folder[64], file[128];
    char cells[7][32]; /* cells after the file; empty where the row is shorter */
    char path[4400];
} test_row;

/* The README with the tables; the caller closes it. */
FILE *test_tables(const char *data);

/* The next row about a surface file; false at the end. The row must initially be zero. */
bool test_next_row(FILE *readme, const char *data, test_row *row);

#endif
