/* SPDX-License-Identifier: Apache-2.0 */
/* Minimal inputs of every type, for the tests of failing memory. */
#ifndef TESTS_FAILING_INPUTS_H
#define TESTS_FAILING_INPUTS_H

#include "starguard/decompose.h"
#include "starguard/descriptor.h"
#include "starguard/guard.h"
#include "starguard/morph.h"
#include "starguard/skeleton.h"
#include "starguard/tetra.h"
#include "starguard/verify.h"
#include "starguard/visibility.h"

/* A file in memory. */
typedef struct input_bytes {
    char *data;
    size_t size;
} input_bytes;

typedef struct failing_inputs {
    starg_context *context;               /* owns the memory */
    starg_mesh *cube, *box;               /* with the same faces */
    starg_mesh *room, *blob, *other_blob; /* an L; two spheres with different faces */
    starg_mesh *fine_blob;                /* a sphere of 258 vertices */
    starg_mesh *open, *crossed;           /* a cube without a face; two that intersect */
    starg_solid *solid, *simple;          /* of the room, of the cube */
    starg_tetmesh *tetmesh;
    starg_guards *guards;
    starg_bits *seen;
    starg_skeleton *skeleton;
    starg_decomposition *decomposition; /* of the room */
    starg_pieces_mesh *pieces;
    starg_pieces_report *report;
    starg_descriptor *descriptor;
    starg_signature *stars[2], *papers[2];
    starg_map *map; /* of the blobs */
} failing_inputs;

/* Makes the inputs; fails the test if that fails. */
void failing_inputs_make(failing_inputs *in);
void failing_inputs_free(failing_inputs *in);

/* Path of an input file: room.off, .obj, .ply, .stl; guards.json; skeleton.obj, .cg, .vtk;
 * pieces.vtk, .json; descriptor.json; map.json; tets.vtk; points.txt; landmarks.txt; classes.txt;
 * shapes.db. Valid for the next three calls. */
const char *failing_input(const char *name);
input_bytes failing_input_bytes(const char *name);

#endif
