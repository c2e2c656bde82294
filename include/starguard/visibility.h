/* SPDX-License-Identifier: Apache-2.0 */
/* Visible vertices and faces of a solid [YL11, section 3.1].
 *
 * A vertex q is visible from p if the segment p q meets the boundary only in q. A face is visible
 * if its three vertices are and p is strictly on its inner side; under the stricter rule "whole",
 * every point of it must be visible. A point that is not strictly inside the solid sees nothing.
 * All tests are exact: every engine gives the same bits. */
#ifndef STARGUARD_VISIBILITY_H
#define STARGUARD_VISIBILITY_H

#include <stdbool.h>
#include <stddef.h>

#include "bits.h"
#include "context.h"
#include "fields.h"
#include "solid.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum starg_visibility_engine {
    STARG_VISIBILITY_GRID = 0,     /* a direction grid about the point */
    STARG_VISIBILITY_BVH = 1,      /* each segment against a bounding volume hierarchy   */
    STARG_VISIBILITY_SWEEP = 2,    /* the published angular sweep */
    STARG_VISIBILITY_CONTOURS = 3, /* layers counted across contours, else the grid */
    STARG_VISIBILITY_FASTEST = 4   /* the faster of contours and grid per point */
} starg_visibility_engine;

typedef enum starg_target {
    STARG_TARGET_FACES = 0,
    STARG_TARGET_VERTICES = 1,
    STARG_TARGET_POINTS = 2, /* every point of faces, from their inner sides; of guards only */
    STARG_TARGET_CORNERS = 3 /* 3 f + k: corner k of face f, seen from points that see its vertex
                                and are strictly on the inner side of f. Of bounds for star-shaped
                                pieces (starg_decompose_options.prove); not to be asked for */
} starg_target;

typedef enum starg_face_rule {
    STARG_FACES_VERTICES = 0, /* the three vertices are visible                      */
    STARG_FACES_WHOLE = 1     /* every point of the face is visible                  */
} starg_face_rule;

/* A density of pixels by the names of EN 62676-4, which are numbers per metre: 12.5, 25, 62.5, 125
 * and 250. */
#define STARG_DENSITY_MONITOR   (-1.0)
#define STARG_DENSITY_DETECT    (-2.0)
#define STARG_DENSITY_OBSERVE   (-3.0)
#define STARG_DENSITY_RECOGNISE (-4.0)
#define STARG_DENSITY_IDENTIFY  (-5.0)

/* What a unit of the model's coordinates is. */
typedef enum starg_unit {
    STARG_UNIT_METRE = 0,
    STARG_UNIT_CENTIMETRE = 1,
    STARG_UNIT_MILLIMETRE = 2,
    STARG_UNIT_FOOT = 3,
    STARG_UNIT_INCH = 4
} starg_unit;

#define STARG_TILT_ANY   360.0

#define STARG_PATCH_AUTO (-1.0)
#define STARG_PATCH_OFF  (-2.0)

typedef struct starg_visibility_options {
    starg_visibility_engine engine;
    starg_target target;       /* meaning of the columns of the result */
    starg_face_rule face_rule; /* for STARG_TARGET_FACES                            */
    double range;     /* largest distance of vertices (all three of a face); INFINITY: unlimited */
    double near;      /* smallest distance of vertices (all three of a face) */
    double incidence; /* of faces: largest angle in degrees, up to 90, between their normal and the
                         line to the point, at each corner and so at every point; 0: any */
    double cone; /* full opening angle in degrees, above 0; 360: all directions. A vertex is in the
                    cone if the cosine of its angle to the direction is at least that of half the
                    opening. With STARG_FACES_WHOLE at most 180, or 360 */
    double fov[2]; /* horizontal and vertical opening in degrees, below 180, of a rectangular view:
                      a vertex is in it if it is on the positive side of the planes of
                      starg_frustum, or in them; both 0: not rectangular */
    double patch;  /* of guards and of starg_seen_shares: faces are seen in parts whose edges are at
                      most so long, above 0 (docs/visibility.md); STARG_PATCH_AUTO: chosen by guards,
                      elsewhere off; STARG_PATCH_OFF: faces are seen as they are */
    double up[3];  /* what is up, with fov and tilt; all 0: (0, 1, 0) */
    double tilt[2]; /* of guards that look in one direction: least and most angle in degrees of that
                       direction above the horizon, -90 to 90, up to a millionth of a degree;
                       STARG_TILT_ANY both: any. A limit of the directions that are chosen, not of
                       what is seen */
    double resolution[2]; /* with fov: pixels across and down; 0: not told */
    double density; /* with resolution: at least so many pixels for each unit of length at the depth
                       of every corner, or a name of STARG_DENSITY_MONITOR ...; 0: any */
    starg_unit unit; /* of the model, for densities by name */
    /* Of views that look in one direction, by a cone below 360 or fov; not kept. */
    const double *directions; /* count x 3, not zero                                          */
    const double *ups;        /* with fov: count x 3, all 0: `up`; NULL: `up` for all           */
} starg_visibility_options;

/* The fastest engine, faces by vertices, no limits, all directions. */
STARG_API void starg_visibility_options_default(starg_visibility_options *options);

/* Names, ranges and descriptions of the options. */
STARG_API const starg_fields *starg_visibility_options_fields(void);

/* The cosine of half an opening angle in degrees, as used by the test. */
STARG_API double starg_cone_cosine(double degrees);

/* The cosine of an incidence, as used by the test; 0: any. */
STARG_API double starg_incidence_cosine(double degrees);

/* The normals of the four planes through the point of a rectangular view, of about unit length, as
 * used by the test: left, right, below and above of a direction. Right is direction x up; where
 * that is zero, the first of the axes y, z and x that makes it not zero stands in for up. */
STARG_API void starg_frustum(const double direction[3], const double up[3], const double fov[2],
                             double planes[4][3]);

/* The largest depth, along the direction, at which a view with a resolution has a density (of the
 * options, if it is 0): width / (2 tan(fov[0] / 2)) / density; INFINITY: any. A corner is within
 * that depth if it is on the near side of the plane across the direction through the point at that
 * depth, rounded, or in it. */
STARG_API double starg_density_depth(const starg_visibility_options *options, double density);

/* The plane at a depth (below 1e100) along a direction: a point of it, rounded, and its normal,
 * which looks back and has about unit length. */
STARG_API void starg_depth_plane(const double point[3], const double direction[3], double depth,
                                 double at[3], double normal[3]);

/* Is the direction within the tilt of the options? */
STARG_API bool starg_tilt_holds(const starg_visibility_options *options, const double direction[3]);

/* Computes what each of `count` points (count x 3 doubles) sees: a matrix of count rows with one
 * column per face (or vertex). `options` may be NULL. Parallel over the points.
 * Errors: ARGUMENT (a limit out of range, a point or direction that is not finite), MEMORY,
 * CANCELLED, TIME. */
STARG_API starg_status starg_visibility(starg_context *context, const starg_solid *solid,
                                        const double *points, size_t count,
                                        const starg_visibility_options *options, starg_bits **out);

/* Computes the potentially visible set of each of `count` boxes (count x 6 doubles, lower corner
 * first): a matrix of count rows with one column per face (or vertex). A 0 proves that no interior
 * point of the solid in the closed box sees it. A 1 is conservative: smaller boxes give fewer false
 * ones. Only the options `target` and `range` are used; faces visible by either rule are included;
 * what looks in one direction is an error. `options` may be NULL. Parallel over the boxes. Errors:
 * ARGUMENT (range negative or NaN, a cone, a box with corners that are not finite or in the wrong
 * order), MEMORY, CANCELLED, TIME. */
STARG_API starg_status starg_visibility_region(starg_context *context, const starg_solid *solid,
                                               const double *boxes, size_t count,
                                               const starg_visibility_options *options,
                                               starg_bits **out);

#ifdef __cplusplus
}
#endif

#endif
