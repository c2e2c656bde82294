/* SPDX-License-Identifier: Apache-2.0 */
/* An audit of cameras in a soup of boxes, against Embree casting the same rays; one thread.
 *
 *     bench_audit [TRIANGLES [CAMERAS]]
 *
 * A hall of 200 x 10 x 200 is strewn with boxes, 12 triangles each. Cameras of 90 by 60 degrees
 * stand at random places and look slightly down. The rays are those from each camera to the corners
 * in its view of faces that are turned to it, each corner once: what an audit has to find out.
 * Embree casts them as they come, and sorted by cells of their directions. Prints seconds of the
 * clock for both scenes and both audits, and the ratio; Embree only where it is installed. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/context.h"
#include "core/rng.h"
#include "starguard/guard.h"
#include "starguard/space.h"

#ifdef HAVE_EMBREE
#include "embree.h"
#endif

enum { CORNERS = 8, SIDES = 12 };

static const double FOV[2] = {90, 60};

typedef struct hall {
    size_t vertices, faces, cameras;
    double *points, *places, *ways;
    uint32_t *corners;
} hall;

static void *need(void *block) {
    if (block != NULL)
        return block;
    fputs("bench_audit: out of memory\n", stderr);
    exit(EXIT_FAILURE);
}

static void stop_unless(starg_context *context, starg_status status) {
    if (status == STARG_OK)
        return;
    fprintf(stderr, "bench_audit: %s\n", starg_context_error(context)->message);
    exit(EXIT_FAILURE);
}

static void add_box(hall *h, size_t box) {
    static const uint32_t sides[SIDES][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6},
                                             {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                                             {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    static const double size[3] = {200, 10, 200};
    starg_rng rng = starg_rng_make(1, 1, box);
    double low[3], high[3];
    for (int k = 0; k < 3; k++) {
        low[k] = size[k] * starg_rng_unit(&rng);
        high[k] = low[k] + 0.05 + 0.5 * starg_rng_unit(&rng);
    }
    for (size_t c = 0; c < CORNERS; c++)
        for (size_t k = 0; k < 3; k++)
            h->points[3 * (CORNERS * box + c) + k] = c >> (2 - k) & 1 ? high[k] : low[k];
    for (size_t f = 0; f < SIDES; f++)
        for (size_t k = 0; k < 3; k++)
            h->corners[3 * (SIDES * box + f) + k] = (uint32_t)(CORNERS * box) + sides[f][k];
}

static hall make_hall(size_t triangles, size_t cameras) {
    size_t boxes = (triangles + SIDES - 1) / SIDES;
    hall h = {.vertices = CORNERS * boxes, .faces = SIDES * boxes, .cameras = cameras};
    h.points = need(malloc(3 * h.vertices * sizeof *h.points));
    h.corners = need(malloc(3 * h.faces * sizeof *h.corners));
    h.places = need(malloc(3 * cameras * sizeof *h.places));
    h.ways = need(malloc(3 * cameras * sizeof *h.ways));
    for (size_t i = 0; i < boxes; i++)
        add_box(&h, i);
    for (size_t i = 0; i < cameras; i++) {
        starg_rng rng = starg_rng_make(1, 2, i);
        double turn = 8 * atan(1) * starg_rng_unit(&rng);
        h.places[3 * i] = 200 * starg_rng_unit(&rng);
        h.places[3 * i + 1] = 11 + starg_rng_unit(&rng);
        h.places[3 * i + 2] = 200 * starg_rng_unit(&rng);
        h.ways[3 * i] = cos(turn);
        h.ways[3 * i + 1] = -0.4;
        h.ways[3 * i + 2] = sin(turn);
    }
    return h;
}

static double audit(const hall *h, size_t *seen) {
    starg_context *context;
    starg_context_options used;
    starg_mesh *mesh;
    starg_solid *scene;
    starg_guards *guards;
    starg_space_options space;
    starg_visibility_options view;
    starg_context_options_default(&used);
    used.threads = 1;
    if (starg_context_create(&used, &context) != STARG_OK)
        exit(EXIT_FAILURE);
    starg_space_options_default(&space);
    space.soup = true;
    starg_visibility_options_default(&view);
    memcpy(view.fov, FOV, sizeof FOV);
    view.patch = STARG_PATCH_OFF;
    double start = starg_clock();
    stop_unless(context,
                starg_mesh_create(context, h->points, h->vertices, h->corners, h->faces, &mesh));
    stop_unless(context, starg_space_create(context, mesh, NULL, 0, &space, &scene));
    printf("starguard scene %.2f s\n", starg_clock() - start);
    const starg_poses poses = {.points = h->places, .directions = h->ways, .count = h->cameras};
    start = starg_clock();
    stop_unless(context, starg_guards_audit(context, scene, &poses, &view, &guards));
    double seconds = starg_clock() - start;
    *seen = 0;
    for (size_t i = 0; i < guards->count; i++)
        *seen += guards->seen_faces[i];
    starg_guards_free(context, guards);
    starg_solid_free(scene);
    starg_mesh_free(mesh);
    starg_context_free(context);
    return seconds;
}

#ifdef HAVE_EMBREE
typedef struct ray {
    uint32_t cell, vertex;
} ray;

static int by_cell(const void *left, const void *right) {
    const ray *a = left, *b = right;
    return a->cell != b->cell ? (a->cell > b->cell) - (a->cell < b->cell)
                              : (a->vertex > b->vertex) - (a->vertex < b->vertex);
}

/* Is a corner in the view? Its cell of 64 x 64. */
static bool is_in_view(const double *p, double planes[4][3], const double *q, uint32_t *cell) {
    double line[3], distance[4], sum[2];
    for (int k = 0; k < 3; k++)
        line[k] = q[k] - p[k];
    for (int i = 0; i < 4; i++) {
        distance[i] = line[0] * planes[i][0] + line[1] * planes[i][1] + line[2] * planes[i][2];
        if (distance[i] < 0)
            return false;
    }
    *cell = 0;
    for (int i = 0; i < 2; i++) {
        sum[i] = distance[2 * i] + distance[2 * i + 1];
        uint32_t at = (uint32_t)(63 * distance[2 * i] / fmax(sum[i], 1e-300));
        for (uint32_t bit = 0; bit < 6; bit++)
            *cell |= (at >> bit & 1) << (2 * bit + (uint32_t)i);
    }
    return true;
}

/* The corners of faces that are turned to the camera and in its view as a whole. */
static size_t list_rays(const hall *h, size_t camera, uint8_t *wanted, ray *rays) {
    static const double up[3] = {0, 1, 0};
    const double *p = h->places + 3 * camera;
    double planes[4][3];
    size_t count = 0;
    starg_frustum(h->ways + 3 * camera, up, FOV, planes);
    memset(wanted, 0, h->vertices);
    for (size_t f = 0; f < h->faces; f++) {
        const double *t[3];
        double a[3], b[3], c[3];
        uint32_t cell;
        for (int k = 0; k < 3; k++)
            t[k] = h->points + 3 * (size_t)h->corners[3 * f + (size_t)k];
        for (int k = 0; k < 3; k++) {
            a[k] = t[1][k] - t[0][k];
            b[k] = t[2][k] - t[0][k];
            c[k] = p[k] - t[0][k];
        }
        double side = (a[1] * b[2] - a[2] * b[1]) * c[0] + (a[2] * b[0] - a[0] * b[2]) * c[1] +
                      (a[0] * b[1] - a[1] * b[0]) * c[2];
        if (side > 0 && is_in_view(p, planes, t[0], &cell) && is_in_view(p, planes, t[1], &cell) &&
            is_in_view(p, planes, t[2], &cell))
            for (int k = 0; k < 3; k++)
                wanted[h->corners[3 * f + (size_t)k]] = 1;
    }
    for (uint32_t v = 0; v < h->vertices; v++) {
        uint32_t cell;
        if (wanted[v] && is_in_view(p, planes, h->points + 3 * (size_t)v, &cell))
            rays[count++] = (ray){cell, v};
    }
    return count;
}

static size_t cast_rays(const hall *h, RTCScene scene, size_t camera, const ray *rays,
                        size_t count) {
    size_t open = 0;
    const double *p = h->places + 3 * camera;
    for (size_t i = 0; i < count; i++) {
        const double *q = h->points + 3 * (size_t)rays[i].vertex;
        open += embree_is_free(scene, p, q);
    }
    return open;
}

static void run_embree(const hall *h, double ours) {
    RTCDevice device = rtcNewDevice("threads=1");
    double start = starg_clock(), listing = 0, plain = 0, sorting = 0, sorted = 0;
    RTCScene scene = embree_scene(device, h->points, h->vertices, h->corners, h->faces);
    printf("Embree scene %.2f s\n", starg_clock() - start);
    uint8_t *wanted = need(malloc(h->vertices));
    ray *rays = need(malloc(h->vertices * sizeof *rays));
    size_t all = 0, open = 0;
    for (size_t i = 0; i < h->cameras; i++) {
        start = starg_clock();
        size_t count = list_rays(h, i, wanted, rays);
        listing += starg_clock() - start;
        start = starg_clock();
        open += cast_rays(h, scene, i, rays, count);
        plain += starg_clock() - start;
        start = starg_clock();
        qsort(rays, count, sizeof *rays, by_cell);
        sorting += starg_clock() - start;
        start = starg_clock();
        (void)cast_rays(h, scene, i, rays, count);
        sorted += starg_clock() - start;
        all += count;
    }
    printf("rays %zu, of which %zu free; listed in %.2f s\n", all, open, listing);
    printf("Embree, as they come %.2f s; sorted in %.2f s, then %.2f s\n", plain, sorting, sorted);
    printf("ratio to the faster, listing included: %.2f\n",
           ours / (listing + fmin(plain, sorting + sorted)));
    free(wanted);
    free(rays);
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
}
#endif

int main(int count, char **words) {
    size_t triangles = count > 1 ? strtoul(words[1], NULL, 10) : 1000000, seen;
    hall h = make_hall(triangles, count > 2 ? strtoul(words[2], NULL, 10) : 100);
    double ours = audit(&h, &seen);
    printf("audit of %zu cameras, %zu triangles: %.2f s; they see %zu faces, some more than once\n",
           h.cameras, h.faces, ours, seen);
#ifdef HAVE_EMBREE
    run_embree(&h, ours);
#endif
    free(h.points);
    free(h.corners);
    free(h.places);
    free(h.ways);
    return EXIT_SUCCESS;
}
