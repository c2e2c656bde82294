/* SPDX-License-Identifier: Apache-2.0 */
/* Streams of random numbers: the second argument of starg_rng_make, where the first is the seed of
 * the context. Every search has a row here, so that two of them do not draw the same numbers
 * unless the table says so. The numbers are part of the results: a change of one changes those.
 *
 * Not listed: samples and the verifier, whose seeds are their own; linear programs and grown
 * regions, which count their streams by what they are about. */
#pragma once

#include <stdint.h>

/* Geometry: points of the kinetic order, and the order of insertion. */
#define STREAM_DELAUNAY_POINTS UINT64_C(0xde1a)
#define STREAM_DELAUNAY_ORDER  UINT64_C(0xde1b)

/* Guards. Moves take STREAM_MOVES + k in the k-th step of a search, so that they meet the streams
 * of local search and of companions; their items differ. */
#define STREAM_CELLS        UINT64_C(27)
#define STREAM_MOVES        UINT64_C(28)
#define STREAM_LOCAL_SEARCH UINT64_C(29)
#define STREAM_COMPANIONS   UINT64_C(30)

/* Pieces. The start takes STREAM_START + 1,000 k in its k-th stream. */
#define STREAM_IMPROVE    UINT64_C(77)
#define STREAM_START      UINT64_C(78)
#define STREAM_WIDEN      UINT64_C(78)
#define STREAM_RUIN       UINT64_C(79)
#define STREAM_UNCOLOURED UINT64_C(0x7265)

/* Pieces of two solids at once. */
#define STREAM_TWIN_GROUPS UINT64_C(0)
#define STREAM_TWIN_CUTS   UINT64_C(1)
#define STREAM_TWIN_PLANES UINT64_C(2)
#define STREAM_TWIN_CONES  UINT64_C(3)
#define STREAM_SOLID_STARS UINT64_C(0x73746172)

/* Shapes. */
#define STREAM_SAMPLES     UINT64_C(0x73616d70)
#define STREAM_RECONSTRUCT UINT64_C(0x7265636f)
#define STREAM_VIEWS       UINT64_C(0x76696577)
#define STREAM_D2          UINT64_C(0x6432)
#define STREAM_ALIGNMENT   UINT64_C(0x616c69676e)
