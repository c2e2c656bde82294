/* SPDX-License-Identifier: Apache-2.0 */
#include "mesh/solid.h"

#include <stdio.h>

#include "geometry/vec3.h"
#include "mesh/examine.h"

/* Findings that rule out a solid, in the order in which they are reported. */
static const starg_finding_kind FATAL[] = {
    STARG_FINDING_REPEATED_CORNER, STARG_FINDING_OPEN_EDGE, STARG_FINDING_NONMANIFOLD_EDGE,
    STARG_FINDING_NONMANIFOLD_VERTEX, STARG_FINDING_INCONSISTENT_EDGE};

/* Faces that bound nothing are taken for what they are, anything else is repaired. */
const char *starg_check_advice(const starg_check *check) {
    size_t fatal = 0;
    for (size_t i = 0; i < sizeof FATAL / sizeof *FATAL; i++)
        fatal += check->findings[FATAL[i]].count;
    if (check->one_sided_faces > 0 && check->one_sided_faces == check->faces)
        return "its surfaces are one-sided, which cannot be repaired; 'starguard guard "
               "--soup' takes them as triangles";
    if (check->underflows)
        return "scale its coordinates, by a power of two to keep them exact";
    if (fatal == 0 && check->faces > 0)
        return "'starguard guard --soup' takes it as triangles";
    if (check->findings[STARG_FINDING_OPEN_EDGE].count > check->faces)
        return "most of its faces are loose triangles: 'starguard guard --soup' takes them as they "
               "are; corners that should be one are joined by 'starguard repair --merge-distance "
               "D'";
    if (check->findings[STARG_FINDING_OPEN_EDGE].count > 0 &&
        check->findings[STARG_FINDING_SELF_CONTACT].count > 0)
        return "some faces touch where they share no edge (T-junctions): 'starguard repair MODEL "
               "-o "
               "SOLID.off' joins these, and then fills holes";
    return "try 'starguard repair'";
}

static starg_status fail_unusable(starg_context *context, const starg_check *check) {
    char list[256] = "";
    size_t used = 0;
    const starg_finding *first = NULL;
    for (size_t i = 0; i < sizeof FATAL / sizeof *FATAL; i++) {
        const starg_finding *finding = &check->findings[FATAL[i]];
        if (finding->count == 0)
            continue;
        if (first == NULL)
            first = finding;
        used += (size_t)snprintf(list + used, sizeof list - used, "%s%s: %zu", used ? ", " : "",
                                 starg_finding_name(FATAL[i]), finding->count);
    }
    if (first != NULL)
        return starg_fail_at(
            context, STARG_ERROR_MESH, "solid", first->element, first->first, first->shown,
            "the mesh does not bound a solid (%s); 'starguard check' shows where; %s", list,
            starg_check_advice(check));
    if (check->faces == 0)
        return starg_fail(context, STARG_ERROR_MESH, "solid", "the mesh has no faces");
    return starg_fail(context, STARG_ERROR_MESH, "solid", "the mesh is closed but %s; %s",
                      check->underflows ? "so small that its area or volume underflows"
                                        : "encloses no volume: its shells are flat or doubled",
                      starg_check_advice(check));
}

/* ---- vertices at one position ---- */

/* A copy in which corners at equal positions have the first vertex there; the others stay as
 * isolated vertices, so that vertices and faces keep their numbers. *out is NULL if there are none;
 * *welded counts them. */
static starg_status weld(starg_context *context, const starg_mesh *mesh, starg_mesh **out,
                         size_t *welded) {
    SCOPED uint32_t *first = NULL;
    TRY(mesh_find_coincident(context, mesh, &first, welded));
    if (*welded == 0)
        return STARG_OK;
    TRY(starg_mesh_create(context, mesh->vertices, mesh->vertex_count, mesh->faces,
                          mesh->face_count, out));
    for (size_t i = 0; i < 3 * mesh->face_count; i++)
        (*out)->faces[i] = first[mesh->faces[i]];
    return STARG_OK;
}

/* Takes *other and its examination if it bounds a solid, which may have to be one that only touches
 * itself; *other is then what it replaces. */
static starg_status take_if_usable(starg_context *context, starg_solid *solid, starg_mesh **other,
                                   bool touching, mesh_examination *all) {
    mesh_examination own = {0};
    starg_status status = mesh_examine(context, *other, &own);
    if (status == STARG_OK && own.check->usable && (!touching || mesh_only_touches(own.check))) {
        mesh_examination former = *all;
        *all = own;
        own = former;
        starg_mesh *given = solid->mesh;
        solid->mesh = *other;
        *other = given;
    }
    mesh_examination_free(&own);
    return status;
}

/* Many programs write a vertex per corner along a seam: coincident vertices are welded. Others
 * share vertices where parts only touch: each part gets its own. Either is done if the faces then
 * bound a solid; otherwise the mesh is examined as given. */
static starg_status mend_vertices(starg_context *context, starg_solid *solid,
                                  mesh_examination *all) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *welded = NULL, *parted = NULL;
    size_t count = 0;
    if (all->check->findings[STARG_FINDING_DUPLICATE_VERTEX].count > 0 && !all->check->closed)
        TRY(weld(context, solid->mesh, &welded, &count));
    starg_mesh **shared = welded != NULL ? &welded : &solid->mesh;
    TRY(wings_part(context, *shared, &parted));
    size_t copies = parted != NULL ? parted->vertex_count - (*shared)->vertex_count : 0;
    if (parted == NULL && welded == NULL)
        return STARG_OK;
    TRY(take_if_usable(context, solid, parted != NULL ? &parted : &welded, parted != NULL, all));
    if (!all->check->usable)
        return STARG_OK;
    if (copies > 0) { /* the mesh as given is in `parted` now */
        solid->shared = welded != NULL ? welded : parted;
        *(welded != NULL ? &welded : &parted) = NULL;
    }
    if (count > 0)
        starg_log(context, STARG_LOG_NOTICE,
                  "merged %zu vertices with earlier ones at the same position, which closes the "
                  "surface",
                  count);
    if (copies > 0)
        starg_log(context, STARG_LOG_NOTICE,
                  "parts of the surface share %zu %s where they touch; each part got its own",
                  copies, copies == 1 ? "vertex" : "vertices");
    return STARG_OK;
}

static void turn_shells(starg_mesh *mesh, const mesh_topology *topology, const mesh_shell *shells,
                        shell_facing facing) {
    for (size_t f = 0; f < mesh->face_count; f++) {
        const mesh_shell *own = &shells[topology->component[f]];
        if (!(facing == SHELLS_OUTWARD ? own->volume < 0 : own->turn))
            continue;
        uint32_t *corner = mesh->faces + 3 * f, swap = corner[1];
        corner[1] = corner[2];
        corner[2] = swap;
    }
}

void solid_tell(starg_context *context, const char *whose, const starg_check *check) {
    char grid[256];
    starg_check_describe_grid(check, grid, sizeof grid);
    if (check->coarse)
        starg_log(context, STARG_LOG_WARNING, "%s%s", whose, grid);
    if (mesh_is_rounded(check))
        return;
    size_t turned = check->findings[STARG_FINDING_INWARD_COMPONENT].count;
    size_t crossing = check->findings[STARG_FINDING_SELF_INTERSECTION].count;
    size_t flat = check->findings[STARG_FINDING_DEGENERATE_FACE].count;
    if (turned > 0)
        starg_log(context, STARG_LOG_NOTICE,
                  "%s%zu of %zu shells faced the wrong way and %s turned", whose, turned,
                  check->components, turned == 1 ? "was" : "were");
    if (crossing > 0)
        starg_log(context, STARG_LOG_WARNING,
                  "%s%zu %s of faces %s (first: %llu and %llu); each still blocks the view, and "
                  "'starguard repair --union' makes one solid of parts that overlap",
                  whose, crossing, crossing == 1 ? "pair" : "pairs",
                  crossing == 1 ? "intersects" : "intersect",
                  (unsigned long long)check->findings[STARG_FINDING_SELF_INTERSECTION].first[0],
                  (unsigned long long)check->findings[STARG_FINDING_SELF_INTERSECTION].first[1]);
    if (flat > 0)
        starg_log(context, STARG_LOG_WARNING, "%s%zu %s no area (first: %llu); nothing can see %s",
                  whose, flat, flat == 1 ? "face has" : "faces have",
                  (unsigned long long)check->findings[STARG_FINDING_DEGENERATE_FACE].first[0],
                  flat == 1 ? "it" : "them");
}

starg_status solid_make_facing(starg_context *context, const starg_mesh *mesh, shell_facing facing,
                               starg_solid **out) {
    SCOPED_BY(starg_solid_drop) starg_solid *solid = NULL;
    SCOPED_BY(mesh_examination_free) mesh_examination all = {0};
    *out = NULL;
    NEW_ZERO(context, "solid", solid, 1);
    solid->context = context;
    solid->model_vertices = mesh->vertex_count;
    TRY(starg_mesh_create(context, mesh->vertices, mesh->vertex_count, mesh->faces,
                          mesh->face_count, &solid->mesh));
    TRY(mesh_check_extent(context, mesh, "solid"));
    TRY(mesh_examine(context, solid->mesh, &all));
    if (!all.check->usable)
        TRY(mend_vertices(context, solid, &all));
    if (!all.check->usable)
        return fail_unusable(context, all.check);
    if (facing != SHELLS_AS_GIVEN)
        turn_shells(solid->mesh, all.topology, all.shells, facing);
    if (facing != SHELLS_AS_GIVEN && solid->shared != NULL)
        turn_shells(solid->shared, all.topology, all.shells, facing);
    solid->check = all.check;
    solid->tree = all.tree;
    all.check = NULL;
    all.tree = NULL;
    *out = solid;
    solid = NULL;
    return STARG_OK;
}

starg_status solid_make(starg_context *context, const starg_mesh *mesh, starg_solid **out) {
    return solid_make_facing(context, mesh, SHELLS_NESTED, out);
}

starg_status solid_make_in_time(starg_context *context, const starg_mesh *mesh, starg_solid **out) {
    TIME_RULE(context, STARG_TIME_FAILS);
    return solid_make(context, mesh, out);
}

starg_status starg_solid_create(starg_context *context, const starg_mesh *mesh, starg_solid **out) {
    starg_status status = solid_make_in_time(context, mesh, out);
    if (status == STARG_OK)
        solid_tell(context, "", (*out)->check);
    return status;
}

starg_status solid_must_not_share(starg_context *context, const starg_solid *solid,
                                  const char *stage) {
    if (solid->shared == NULL)
        return STARG_OK;
    return starg_fail(
        context, STARG_ERROR_MESH, stage,
        "parts of the surface share %zu vertices where they touch; give each part its "
        "own by 'starguard repair'",
        solid->mesh->vertex_count - solid->shared->vertex_count);
}

starg_status solid_of_parts(starg_context *context, const double *vertices, size_t vertex_count,
                            const uint32_t *faces, size_t face_count, const starg_check *check,
                            starg_solid **out) {
    SCOPED_BY(starg_solid_drop) starg_solid *solid = NULL;
    *out = NULL;
    NEW_ZERO(context, "solid", solid, 1);
    solid->context = context;
    solid->model_vertices = vertex_count;
    TRY(starg_mesh_create(context, vertices, vertex_count, faces, face_count, &solid->mesh));
    NEW(context, "solid", solid->check, 1);
    *solid->check = *check;
    solid->check->face_marks = NULL;
    TRY(bvh_create(context, solid->mesh->vertices, solid->mesh->faces, face_count, &solid->tree));
    *out = solid;
    solid = NULL;
    return STARG_OK;
}

starg_status solid_of_level(starg_context *context, const starg_solid *fine,
                            const starg_mesh *level, starg_solid **out) {
    double lower[3], upper[3];
    starg_check check = *fine->check;
    if (!check.embedded)
        return solid_make_in_time(context, level, out);
    starg_mesh_bounds(level, lower, upper);
    check.diagonal = vec3_distance(lower, upper);
    check.area = starg_mesh_area(level);
    check.volume = starg_mesh_volume(level);
    check_steps(level, &check);
    check.vertices = level->vertex_count;
    check.faces = level->face_count;
    check.edges = level->face_count / 2 * 3;
    return solid_of_parts(context, level->vertices, level->vertex_count, level->faces,
                          level->face_count, &check, out);
}

void starg_solid_free(starg_solid *solid) {
    if (solid == NULL)
        return;
    starg_context *context = solid->context;
    starg_mesh_free(solid->mesh);
    starg_mesh_free(solid->shared);
    starg_check_free(context, solid->check);
    bvh_free(solid->tree);
    RELEASE(solid->obstacle_sizes, solid->other_side, solid->once_twin);
    flood_free(solid->reached);
    starg_release(context, solid->leak);
    near_faces_free(&solid->over);
    near_faces_free(&solid->mount);
    zones_free(&solid->zones);
    RELEASE(solid->importance, solid->targets[0], solid->targets[1], solid->clear,
            solid->clear_list, solid->times, solid->density);
    bvh_free(solid->model_tree);
    starg_mesh_free(solid->model);
    starg_release(context, solid);
}

const starg_mesh *starg_solid_mesh(const starg_solid *solid) {
    return solid->shared != NULL ? solid->shared : solid->mesh;
}

const starg_check *starg_solid_check(const starg_solid *solid) {
    return solid->check;
}

bool starg_solid_contains(const starg_solid *solid, const double p[3]) {
    bool on_surface;
    int winding = bvh_winding(solid->tree, p, &on_surface);
    return winding + solid->ambient > 0 && !on_surface;
}

double starg_solid_distance(const starg_solid *solid, const double p[3]) {
    return bvh_distance(solid->tree, p);
}
