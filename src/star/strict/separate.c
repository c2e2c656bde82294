/* How the surface of a piece hangs together; connected parts made pieces of their own.
 *
 * Stages: vertices of a facet are in one part (union-find); parts numbered in the order of the
 * facets; their volumes: a negative one is the surface of a cavity; facets change hands.
 *
 * Cost: linear in the facets of the piece but for the clearing of an array over the points. */
#include "star/strict/separate.h"

#include <stdlib.h>

#include "geometry/vec3.h"

typedef struct separator {
    partition *p;
    uint32_t number;
    uint32_t *leader; /* by vertex */
    uint32_t *part;   /* by leading vertex: 1 + part, 0: none yet */
    STARG_ARRAY(double) volumes;
} separator;

static uint32_t find_leader(uint32_t *leader, uint32_t vertex) {
    while (leader[vertex] != vertex)
        vertex = leader[vertex] = leader[leader[vertex]];
    return vertex;
}

static void link_vertices(separator *s) {
    partition *p = s->p;
    for (size_t v = 0; v < p->points.count / 3; v++)
        s->leader[v] = (uint32_t)v;
    for (uint32_t k = p->start.data[s->number]; k < p->start.data[s->number + 1]; k++) {
        const uint32_t *c = p->facets.data[p->index.data[k] / 2].corners;
        for (int i = 1; i < 3; i++)
            s->leader[find_leader(s->leader, c[0])] = find_leader(s->leader, c[i]);
    }
}

static starg_status number_parts(separator *s) {
    starg_status status = STARG_OK;
    partition *p = s->p;
    for (uint32_t k = p->start.data[s->number]; k < p->start.data[s->number + 1]; k++) {
        uint32_t entry = p->index.data[k], c[3];
        facet_outward(&p->facets.data[entry / 2], (int)(entry % 2), c);
        uint32_t *part = &s->part[find_leader(s->leader, c[0])];
        if (*part == 0) {
            STARG_PUSH(p->context, PARTITION_STAGE, &s->volumes, 0);
            *part = (uint32_t)s->volumes.count;
        }
        s->volumes.data[*part - 1] +=
            vec3_triple(partition_unit(p, c[0]), partition_unit(p, c[1]), partition_unit(p, c[2])) /
            6;
    }
done:
    return status;
}

static bool has_cavity(const separator *s) {
    for (size_t i = 0; i < s->volumes.count; i++)
        if (s->volumes.data[i] <= 0)
            return true;
    return false;
}

static starg_status hand_out(separator *s) {
    starg_status status = STARG_OK;
    partition *p = s->p;
    uint32_t first = (uint32_t)p->pieces.count - 1; /* the second part's number is one more */
    for (size_t i = 1; i < s->volumes.count; i++) {
        const piece fresh = {.volume = s->volumes.data[i], .stamp = ++p->stamps};
        STARG_PUSH(p->context, PARTITION_STAGE, &p->pieces, fresh);
    }
    p->pieces.data[s->number].volume = s->volumes.data[0];
    for (uint32_t k = p->start.data[s->number]; k < p->start.data[s->number + 1]; k++) {
        uint32_t entry = p->index.data[k];
        facet *f = &p->facets.data[entry / 2];
        uint32_t part = s->part[find_leader(s->leader, f->corners[0])] - 1;
        if (part > 0)
            f->side[entry % 2] = first + part;
    }
    STARG_TRY(partition_build_index(p));
done:
    return status;
}

starg_status partition_separate(partition *p, uint32_t number) {
    starg_status status = STARG_OK;
    separator s = {.p = p, .number = number};
    STARG_NEW(p->context, PARTITION_STAGE, s.leader, p->points.count / 3);
    STARG_NEW_ZERO(p->context, PARTITION_STAGE, s.part, p->points.count / 3);
    link_vertices(&s);
    STARG_TRY(number_parts(&s));
    if (s.volumes.count == 1)
        p->pieces.data[number].volume = s.volumes.data[0];
    else if (!has_cavity(&s))
        STARG_TRY(hand_out(&s));
done:
    starg_release(p->context, s.leader);
    starg_release(p->context, s.part);
    STARG_ARRAY_FREE(p->context, &s.volumes);
    return status;
}

static int compare_edges(const void *a, const void *b) {
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

starg_status partition_touches_itself(const partition *p, uint32_t number, bool *touches) {
    starg_status status = STARG_OK;
    STARG_ARRAY(uint64_t) edges = {0};
    *touches = false;
    for (uint32_t k = p->start.data[number]; k < p->start.data[number + 1]; k++) {
        const uint32_t *c = p->facets.data[p->index.data[k] / 2].corners;
        for (int i = 0; i < 3; i++) {
            uint64_t a = c[i], b = c[(i + 1) % 3];
            STARG_PUSH(p->context, PARTITION_STAGE, &edges, a < b ? a << 32 | b : b << 32 | a);
        }
    }
    if (edges.count > 0)
        qsort(edges.data, edges.count, sizeof *edges.data, compare_edges);
    for (size_t i = 0; i < edges.count && !*touches; i += 2)
        *touches = i + 1 == edges.count || edges.data[i] != edges.data[i + 1] ||
                   (i + 2 < edges.count && edges.data[i] == edges.data[i + 2]);
done:
    STARG_ARRAY_FREE(p->context, &edges);
    return status;
}
