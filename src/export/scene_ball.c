/* SPDX-License-Identifier: Apache-2.0 */
/* The ball that stands for a guard: an octahedron whose faces are cut into a triangular grid,
 * pushed out to the sphere. Square roots alone: the same bits on every machine. */
#include <math.h>
#include <string.h>

#include "export/export.h"

enum { FINENESS = 3 }; /* edges along an edge of the octahedron */

/* Points of the grid have integer coordinates whose magnitudes sum to FINENESS. */
typedef struct ball_builder {
    scene_ball *ball;
    int grid[BALL_VERTICES][3];
    size_t vertices, faces;
} ball_builder;

/* The vertex at a point of the grid, which is added when it is new. */
static uint32_t vertex_at(ball_builder *b, const int p[3]) {
    for (size_t i = 0; i < b->vertices; i++)
        if (memcmp(b->grid[i], p, sizeof b->grid[i]) == 0)
            return (uint32_t)i;
    double length = sqrt((double)(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]));
    for (int k = 0; k < 3; k++) {
        b->grid[b->vertices][k] = p[k];
        b->ball->vertices[3 * b->vertices + (size_t)k] = p[k] / length;
    }
    return (uint32_t)b->vertices++;
}

/* A face of the grid of one octant; in octants of an odd number of negative axes it is turned, so
 * that it faces outward. */
static void add_face(ball_builder *b, const int sign[3], const int p[3], const int q[3],
                     const int r[3]) {
    const int *corners[3] = {p, q, r};
    bool turned = sign[0] * sign[1] * sign[2] < 0;
    for (int c = 0; c < 3; c++) {
        const int *corner = corners[turned ? 2 - c : c];
        int point[3];
        for (int k = 0; k < 3; k++)
            point[k] = sign[k] * corner[k];
        b->ball->faces[3 * b->faces + (size_t)c] = vertex_at(b, point);
    }
    b->faces++;
}

static void add_octant(ball_builder *b, const int sign[3]) {
    const int n = FINENESS;
    for (int x = 0; x < n; x++)
        for (int y = 0; x + y < n; y++) {
            int z = n - x - y;
            add_face(b, sign, (int[]){x, y, z}, (int[]){x + 1, y, z - 1}, (int[]){x, y + 1, z - 1});
            if (z > 1)
                add_face(b, sign, (int[]){x + 1, y, z - 1}, (int[]){x + 1, y + 1, z - 2},
                         (int[]){x, y + 1, z - 1});
        }
}

void scene_ball_make(scene_ball *ball) {
    ball_builder b = {.ball = ball};
    for (int octant = 0; octant < 8; octant++) {
        const int sign[3] = {octant & 1 ? -1 : 1, octant & 2 ? -1 : 1, octant & 4 ? -1 : 1};
        add_octant(&b, sign);
    }
}
