/* SPDX-License-Identifier: Apache-2.0 */
/* Morphs of surfaces: paths of faces, systems that join them, consistent guards. */
#pragma once

#include "mesh/mesh.h"
#include "shape/spectrum.h"
#include "starguard/morph.h"

/* ---- 3 x 3 matrices, row-major, and rotations (rotation.c) ---- */

/* Eigenvalues of a symmetric matrix in descending order, unit eigenvectors in the columns of
 * `vectors`, a right-handed frame. By Jacobi rotations. */
void symmetric_eigen(const double matrix[9], double values[3], double vectors[9]);

/* The rotation nearest to m: the R of the polar decomposition m = R S, with S symmetric, of
 * positive trace if possible; proper also if m is singular or mirrors. */
void polar_rotation(const double m[9], double rotation[9]);

/* The axis times the angle in [0, pi], and back. */
void rotation_to_vector(const double rotation[9], double vector[3]);
void rotation_from_vector(const double vector[3], double rotation[9]);

/* The vector of the same rotation nearest to `near`: its angle may exceed pi. */
void rotation_vector_near(const double near[3], double vector[3]);

/* out = a b, out = a^T b; out must not alias. */
void matrix_multiply(const double a[9], const double b[9], double out[9]);
void matrix_multiply_transposed(const double a[9], const double b[9], double out[9]);

/* out = m v; out may be v. */
void matrix_apply(const double m[9], const double v[3], double out[3]);

/* ---- sparse systems assembled from triplets (triplets.c) ---- */

/* A matrix entry; duplicates are summed, both triangles are given. */
typedef struct triplet {
    uint32_t row, column;
    double value;
} triplet;

/* Writes the quadratic form of w (x_a - x_b)^2 as EDGE_TRIPLETS triplets; returns the place after
 * them. */
enum { EDGE_TRIPLETS = 4 };
triplet *triplets_put_edge(uint32_t a, uint32_t b, double w, triplet *next);

/* Factorizes a positive definite matrix with `size` rows. Errors: SOLVER, MEMORY. */
starg_status triplets_factorise(starg_context *context, size_t size, const triplet *triplets,
                                size_t count, sparse_factors **out);

/* ---- a morph under construction (morph.c) ---- */

/* Branch-and-bound nodes for guards. */
enum { MORPH_COVER_NODES = 2000 };

/* Entries of starg_morph.weights for a face. */
enum { FACE_WEIGHTS = 4 };

/* Path of a face relative to a reference: A(t) = R0(t) R(t) ((1 - t) I + t S), with R0(t) = exp(t
 * w0) for all faces and R(t) = exp(t w). */
typedef struct face_path {
    double rotation[3];  /* w */
    double stretch[9];   /* S */
    double anchor[2][3]; /* from its guard to its centroid: in A, and in B rotated back to A */
} face_path;

/* Path of a guard relative to its parent in the tree of guards. */
typedef struct guard_path {
    uint32_t parent;    /* itself for the root */
    double rotation[3]; /* of the piece, w */
    double turn[3];     /* of the offset: the mean of both pieces' */
    double offset[3];   /* from the parent's place in A */
    double change[3];   /* total change of the offset, in A's frame */
    double weight;      /* share of the area */
} guard_path;

struct starg_morph {
    starg_context *context;
    starg_morph_method method;
    starg_mesh *mesh;        /* A about its centre, over its size */
    double centers[2][3];    /* of the boxes of A and of the images */
    double sizes[2];         /* units of both, for equal volumes */
    double *source, *target; /* vertex_count x 3, the inputs */
    double *images;          /* vertex_count x 3, about their centre, over their size */
    double turn[3];          /* w0 */
    face_path *faces;        /* per face */
    double *weights;         /* per face: cotangents at its corners, anchor's weight */
    uint8_t *loose;          /* per vertex: has no face */
    size_t tree_guards;      /* guards that are unknowns: all for star, otherwise none */
    size_t unknowns;         /* vertices, then guards */
    uint32_t *component;     /* per unknown: name of its component */
    sparse_factors *system;
    double *residual;     /* vertex_count x 3: residual of the least squares at 1 */
    double *late;         /* the part of it that is added last; NULL: none */
    size_t flipped_count; /* flipped faces (star) */
    uint8_t *flipped;     /* per face; NULL for other methods */

    size_t guard_count, unguarded;
    size_t candidate_count, lower_bound; /* of the common problem */
    double *candidates[2];               /* candidate_count x 3, in input coordinates */
    double *guards[2];                   /* guard_count x 3, in input coordinates */
    double *places[2];                   /* the same, scaled like the mesh */
    uint32_t *pieces;                    /* per face */
    uint8_t *guarded;                    /* per face: its guard sees it at both ends */
    guard_path *guard_paths;
    struct solid_path *solid; /* NULL for other methods */
    const double *seen_from;  /* 2 x 3, of the options; only while it is made */
};

/* Chooses corresponding guards and pieces (consistent.c). */
starg_status morph_guard(starg_morph *m, size_t candidates);

/* One end as a solid. Errors: MESH, MEMORY. */
starg_status morph_solid(const starg_morph *m, int end, starg_solid **out);

/* The centroid of a face. */
static inline void morph_centroid(const double *positions, const uint32_t corner[3],
                                  double out[3]) {
    for (size_t k = 0; k < 3; k++)
        out[k] = (positions[3 * (size_t)corner[0] + k] + positions[3 * (size_t)corner[1] + k] +
                  positions[3 * (size_t)corner[2] + k]) /
                 3;
}

/* The unit of length at t: volumes are linear in t. */
double morph_size(const starg_morph *m, double t);

/* Computes the global and the faces' paths (face_paths.c). */
starg_status morph_prepare_faces(starg_morph *m);

/* Finds the flipped faces and fills in their paths from their surroundings (flipped_faces.c). */
starg_status morph_fill_flipped(starg_morph *m);

/* Splits the residual of the least squares; adds its share at t (residual.c). */
starg_status morph_part_residual(starg_morph *m);
void morph_add_residual(const starg_morph *m, double t, double *out);

/* Factorizes the system and computes the residual; shapes at t, scaled (rigid.c). */
starg_status morph_prepare_rigid(starg_morph *m);
starg_status morph_frame_rigid(const starg_morph *m, double t, double *out);

/* Computes the guards' paths; requires those of the faces (guard_paths.c). */
starg_status morph_prepare_guards(starg_morph *m);
/* Spherical coordinates about the guards (spherical.c). */
starg_status morph_frame_spherical(const starg_morph *m, double t, double *out);

/* The path of tetrahedra: cones of two star-shaped ends, which prepares all (*found), or along the
 * frames of the rigid morph, which come first; shapes at t in (0, 1) (solid_path.c). */
starg_status morph_prepare_stars(starg_morph *m, bool *found);
starg_status morph_prepare_solid(starg_morph *m);
void morph_frame_solid(const starg_morph *m, double t, double *out);

/* Methods that solve for the paths of faces. */
static inline bool morph_is_rigid(const starg_morph *m) {
    return m->method == STARG_MORPH_STAR || m->method == STARG_MORPH_ARAP ||
           m->method == STARG_MORPH_SOLID;
}

static inline bool morph_has_guards(const starg_morph *m) {
    return m->method == STARG_MORPH_STAR || m->method == STARG_MORPH_SPHERICAL;
}

STARG_DROP(starg_morph, starg_morph)
