/* SPDX-License-Identifier: Apache-2.0 */
/* Scenes: a solid with obstacles in it, or what is around one.
 *
 * One representation serves all: a closed, oriented mesh, and a number, `ambient`, that is added to
 * its winding number. Where the sum is at least 1, space is free.
 *   - A solid as it is: ambient 0.
 *   - Its outside: ambient 1 and all faces reversed, of cavities too, which are no part of it.
 *   - A closed obstacle: its faces, reversed, follow those of the model; the winding number within
 *     it is one less.
 *   - An open obstacle, or a soup: each triangle twice, front and back. Such a pair is a closed
 *     surface that encloses nothing: it blocks the view, and its winding number is zero everywhere.
 * So the exact engines always get a closed mesh. Shortcuts for an embedded boundary, whose faces
 * have no free space on their outer sides, apply only if the whole mesh is one, which is tested.
 *
 * Cost: that of the examinations. */

#include "geometry/vec3.h"
#include "mesh/examine.h"
#include "mesh/solid.h"

static const char STAGE[] = "scene";

void starg_space_options_default(starg_space_options *options) {
    *options = (starg_space_options){0};
}

/* Of the diagonal: how far around a soup guards may stand, if nothing says where. */
static const double ROOM = 0.1;

static bool is_bounded(const starg_space_options *o) {
    bool any = false;
    for (int k = 0; k < 6; k++)
        any = any || o->within[k] != 0;
    return any;
}

/* ---- arguments ---- */

static starg_status check_options(starg_context *context, const starg_space_options *o) {
    if (o->orientation > STARG_ORIENTATION_KEEP)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE, "unknown orientation %d",
                          (int)o->orientation);
    if (!(o->standoff_least >= 0 && o->standoff_least < 1e100 &&
          (o->standoff_most == 0 ||
           (o->standoff_most >= o->standoff_least && o->standoff_most < 1e100))))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "guards cannot stand at distances from %g to %g; the least must be zero "
                          "or more and the largest no smaller",
                          o->standoff_least, o->standoff_most);
    if (!(o->cell >= 0 && o->cell < 1e100))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "cubes of the size %g; it must be zero or more", o->cell);
    if (o->soup && (o->outside || o->orientation != STARG_ORIENTATION_NESTED))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "a soup has neither an outside nor an orientation; say where guards may "
                          "stand by a box, by distances or by a point");
    if (o->two_sided && !o->soup)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "faces of a solid have the free space on one side; only a soup is seen "
                          "from both");
    for (int k = 0; is_bounded(o) && k < 3; k++)
        if (!(fabs(o->within[k]) < 1e100 && fabs(o->within[k + 3]) < 1e100 &&
              o->within[k] < o->within[k + 3]))
            return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                              "the box for guards reaches from %g to %g along %c; both must be "
                              "finite and in this order",
                              o->within[k], o->within[k + 3], "xyz"[k]);
    return STARG_OK;
}

/* ---- the parts ---- */

typedef struct parts {
    starg_context *context;
    STARG_ARRAY(double) vertices;
    STARG_ARRAY(uint32_t) faces;
    STARG_ARRAY(uint32_t) sheets; /* fronts of which the backs follow at the end */
} parts;

static void parts_free(parts *p) {
    RELEASE(p->vertices.data, p->faces.data, p->sheets.data);
}

static starg_status push_face(parts *p, const uint32_t *corners, uint32_t offset, bool reversed) {
    PUSH(p->context, STAGE, &p->faces, corners[0] + offset);
    PUSH(p->context, STAGE, &p->faces, corners[reversed ? 2 : 1] + offset);
    PUSH(p->context, STAGE, &p->faces, corners[reversed ? 1 : 2] + offset);
    return STARG_OK;
}

static starg_status push_vertices(parts *p, const starg_mesh *mesh, uint32_t *offset) {
    *offset = (uint32_t)(p->vertices.count / 3);
    if (mesh->vertex_count + *offset >= UINT32_MAX / 4)
        return starg_fail(p->context, STARG_ERROR_RANGE, STAGE, "too many vertices");
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        PUSH(p->context, STAGE, &p->vertices, mesh->vertices[i]);
    return STARG_OK;
}

static starg_status push_closed(parts *p, const starg_mesh *mesh, bool reversed) {
    uint32_t offset;
    TRY(push_vertices(p, mesh, &offset));
    for (size_t f = 0; f < mesh->face_count; f++)
        TRY(push_face(p, mesh->faces + 3 * f, offset, reversed));
    return STARG_OK;
}

/* Corners at one position become one vertex: at its own corners a triangle blocks nothing. */
static starg_status push_sheet(parts *p, const starg_mesh *mesh, bool reversed) {
    SCOPED uint32_t *first = NULL;
    uint32_t offset;
    size_t count;
    TRY(mesh_find_coincident(p->context, mesh, &first, &count));
    TRY(push_vertices(p, mesh, &offset));
    for (size_t f = 0; f < mesh->face_count; f++) {
        const uint32_t *given = mesh->faces + 3 * f;
        const uint32_t corners[3] = {first[given[0]], first[given[1]], first[given[2]]};
        PUSH(p->context, STAGE, &p->sheets, (uint32_t)(p->faces.count / 3));
        TRY(push_face(p, corners, offset, reversed));
    }
    return STARG_OK;
}

/* The halfedge across an edge of two faces that run along it in opposite ways, by halfedge; else
 * TOPOLOGY_NONE. Of faces that stand once, before their backs follow: the same of the backs is then
 * its mirror image. NULL: there are no sheets. */
static starg_status pair_sheets(const parts *p, uint32_t **twin) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *mesh = NULL;
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    const uint32_t *corner = p->faces.data;
    *twin = NULL;
    if (p->sheets.count == 0)
        return STARG_OK;
    TRY(starg_mesh_create(p->context, p->vertices.data, p->vertices.count / 3, corner,
                          p->faces.count / 3, &mesh));
    TRY(topology_create(p->context, mesh, &topology));
    NEW(p->context, STAGE, *twin, p->faces.count);
    for (uint32_t h = 0; h < p->faces.count; h++) {
        uint32_t t = topology->twin[h];
        bool back = t != TOPOLOGY_NONE && corner[t] == corner[corner_next(h)];
        (*twin)[h] = back ? t : TOPOLOGY_NONE;
    }
    return STARG_OK;
}

/* The backs of all sheets, and who is whose other side. */
static starg_status push_backs(parts *p, uint32_t **other_side) {
    size_t count = p->faces.count / 3 + p->sheets.count;
    *other_side = NULL;
    if (p->sheets.count == 0)
        return STARG_OK;
    NEW(p->context, STAGE, *other_side, count);
    memset(*other_side, 0xff, count * sizeof **other_side);
    for (size_t i = 0; i < p->sheets.count; i++) {
        uint32_t front = p->sheets.data[i], back = (uint32_t)(p->faces.count / 3), corners[3];
        memcpy(corners, p->faces.data + 3 * (size_t)front, sizeof corners);
        TRY(push_face(p, corners, 0, true));
        (*other_side)[front] = back;
        (*other_side)[back] = front;
    }
    return STARG_OK;
}

/* ---- the model ---- */

/* A solid's faces face out of it, of its shells if the outside is free, or as given; those of the
 * scene face out of the free space. */
static starg_status push_model(parts *p, const starg_mesh *model, const starg_space_options *o) {
    SCOPED_BY(starg_solid_drop) starg_solid *solid = NULL;
    bool keeps = o->orientation == STARG_ORIENTATION_KEEP;
    if (o->soup) /* guards see the inner side of a face: of a soup that is its front */
        return push_sheet(p, model, true);
    TIME_RULE(p->context, STARG_TIME_FAILS);
    TRY(solid_make_facing(p->context, model,
                          keeps        ? SHELLS_AS_GIVEN
                          : o->outside ? SHELLS_OUTWARD
                                       : SHELLS_NESTED,
                          &solid));
    bool inward = keeps && starg_mesh_volume(solid->mesh) < 0;
    return push_closed(p, solid->mesh, inward != o->outside);
}

/* ---- obstacles ---- */

/* Does the obstacle come near the model at all? */
static bool is_apart(const starg_mesh *a, const starg_mesh *b) {
    double low[2][3], high[2][3];
    bool apart = false;
    starg_mesh_bounds(a, low[0], high[0]);
    starg_mesh_bounds(b, low[1], high[1]);
    for (int k = 0; k < 3; k++)
        apart = apart || low[0][k] > high[1][k] || low[1][k] > high[0][k];
    return apart;
}

/* Those that are closed are pushed at once, for open ones the time comes later: `sheets`. */
static starg_status push_obstacle(parts *p, const starg_mesh *obstacle, bool sheets) {
    SCOPED_BY(starg_solid_drop) starg_solid *solid = NULL;
    starg_status status = solid_make(p->context, obstacle, &solid);
    if (status == STARG_ERROR_MESH || status == STARG_ERROR_RANGE)
        return sheets ? push_sheet(p, obstacle, false) : STARG_OK;
    TRY(status);
    return sheets ? STARG_OK : push_closed(p, solid->mesh, true);
}

static starg_status push_obstacles(parts *p, const starg_mesh *model,
                                   const starg_mesh *const *obstacles, size_t count, bool bounded) {
    for (size_t i = 0; i < count && bounded; i++)
        if (is_apart(model, obstacles[i]))
            return starg_fail(p->context, STARG_ERROR_ARGUMENT, STAGE,
                              "obstacle %zu lies beyond the bounding box of the model; check that "
                              "both have the same units and origin",
                              i);
    for (int sheets = 0; sheets < 2; sheets++)
        for (size_t i = 0; i < count; i++)
            TRY(push_obstacle(p, obstacles[i], sheets == 1));
    return STARG_OK;
}

/* ---- the whole ---- */

/* Has no face free space on its outer side? */
static bool faces_out(const starg_solid *solid, const mesh_examination *all) {
    bool out = true;
    for (size_t c = 0; c < all->topology->component_count; c++) {
        const mesh_shell *shell = &all->shells[c];
        out = out && shell->around - (shell->volume < 0) + solid->ambient <= 0;
    }
    return out;
}

/* A mesh with sheets is taken for what it is; any other is examined as a whole. */
static starg_status examine(starg_context *context, starg_solid *scene) {
    SCOPED_BY(mesh_examination_free) mesh_examination all = {0};
    const starg_mesh *mesh = scene->mesh;
    if (scene->other_side != NULL) {
        double lower[3], upper[3];
        NEW_ZERO(context, STAGE, scene->check, 1);
        starg_mesh_bounds(mesh, lower, upper);
        scene->check->vertices = mesh->vertex_count;
        scene->check->faces = mesh->face_count;
        scene->check->diagonal =
            hypot(hypot(upper[0] - lower[0], upper[1] - lower[1]), upper[2] - lower[2]);
        scene->check->usable = true;
        return bvh_create(context, mesh->vertices, mesh->faces, mesh->face_count, &scene->tree);
    }
    TRY(mesh_examine(context, mesh, &all));
    all.check->embedded = all.check->embedded && faces_out(scene, &all);
    scene->check = all.check;
    scene->tree = all.tree;
    all.check = NULL;
    all.tree = NULL;
    return STARG_OK;
}

static starg_status keep_model(starg_context *context, const starg_mesh *model,
                               starg_solid *scene) {
    TRY(starg_mesh_create(context, model->vertices, model->vertex_count, model->faces,
                          model->face_count, &scene->model));
    return bvh_create(context, scene->model->vertices, scene->model->faces,
                      scene->model->face_count, &scene->model_tree);
}

/* Keeps its own lists of the faces that guards are bound to. */
static starg_status bind_guards(starg_context *context, const starg_mesh *model,
                                starg_solid *scene) {
    starg_space_options *o = &scene->space;
    const double *vertices = scene->mesh->vertices;
    TRY(near_faces_make(context, model, vertices, o->over, o->over_count, &scene->over));
    TRY(near_faces_make(context, model, vertices, o->mount, o->mount_count, &scene->mount));
    o->over = scene->over.list;
    o->mount = scene->mount.list;
    return STARG_OK;
}

/* Both sides of a face are. Then faces behind others may be the first to block a view. */
static starg_status take_clear(starg_context *context, starg_solid *scene) {
    starg_space_options *o = &scene->space;
    const uint32_t *list = o->clear;
    o->clear = NULL;
    if (o->clear_count == 0)
        return STARG_OK;
    NEW_ZERO(context, STAGE, scene->clear, starg_bit_words(scene->mesh->face_count));
    NEW(context, STAGE, scene->clear_list, o->clear_count);
    for (size_t i = 0; i < o->clear_count; i++) {
        scene->clear_list[i] = list[i];
        starg_bit_set(scene->clear, list[i]);
        if (scene->other_side != NULL && scene->other_side[list[i]] != TOPOLOGY_NONE)
            starg_bit_set(scene->clear, scene->other_side[list[i]]);
    }
    o->clear = scene->clear_list;
    scene->check->embedded = false;
    return o->clear_count < scene->model_faces
               ? starg_space_weigh(scene, NULL)
               : starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                            "all faces of the model are clear: nothing is to be seen");
}

/* What holds all zones in which guards may stand, is a box in which they stand. */
static starg_status take_zones(starg_context *context, starg_solid *scene) {
    starg_space_options *o = &scene->space;
    starg_status status = zones_make(context, o->zones, o->zone_count, &scene->zones);
    o->zones = NULL;
    if (status != STARG_OK || !scene->zones.limits || is_bounded(o))
        return status;
    vec3_copy(scene->zones.all.lower, o->within);
    vec3_copy(scene->zones.all.upper, o->within + 3);
    return status;
}

/* Where the free space has no end, and nothing else tells where guards may stand, it is a box. */
static void bind_to_box(starg_solid *scene) {
    starg_space_options *o = &scene->space;
    bool elsewhere = o->standoff_most > 0 || scene->over.count > 0 || scene->mount.count > 0;
    bvh_box reach;
    scene->own_box = scene->ambient > 0 && !elsewhere && !is_bounded(o);
    if (!scene->own_box)
        return;
    solid_reach(scene, &reach);
    vec3_copy(reach.lower, o->within);
    vec3_copy(reach.upper, o->within + 3);
}

static starg_status note_sizes(starg_solid *scene, const starg_mesh *const *obstacles,
                               size_t count) {
    NEW(scene->context, STAGE, scene->obstacle_sizes, 2 * count);
    scene->obstacle_count = count;
    for (size_t i = 0; i < count; i++) {
        scene->obstacle_sizes[2 * i] = obstacles[i]->vertex_count;
        scene->obstacle_sizes[2 * i + 1] = obstacles[i]->face_count;
    }
    return STARG_OK;
}

/* ---- targets ---- */

/* The bits of the faces that matter, and of their corners. */
static starg_status mark_targets(starg_solid *scene) {
    const starg_mesh *mesh = scene->mesh;
    const size_t columns[2] = {mesh->face_count, mesh->vertex_count};
    for (int k = 0; k < 2; k++) {
        starg_release(scene->context, scene->targets[k]);
        scene->targets[k] = NULL;
        NEW_ZERO(scene->context, STAGE, scene->targets[k], starg_bit_words(columns[k]));
    }
    for (size_t f = 0; f < mesh->face_count; f++) {
        if (!(scene->importance[f] > 0))
            continue;
        starg_bit_set(scene->targets[0], f);
        for (size_t k = 0; k < 3; k++)
            starg_bit_set(scene->targets[1], mesh->faces[3 * f + k]);
    }
    return STARG_OK;
}

starg_status starg_space_weigh(starg_solid *scene, const double *weights) {
    size_t faces = starg_space_model_faces(scene);
    double most = 0;
    for (size_t f = 0; f < faces && weights != NULL; f++) {
        uint64_t face = f;
        if (!(weights[f] >= 0 && weights[f] < 1e100))
            return starg_fail_at(
                scene->context, STARG_ERROR_ARGUMENT, STAGE, STARG_ELEMENT_FACE, &face, 1,
                "face %zu has a weight of %g; it must be zero or more, and finite", f, weights[f]);
        most = solid_is_clear(scene, f) ? most : fmax(most, weights[f]);
    }
    if (weights != NULL && most == 0)
        return starg_fail(scene->context, STARG_ERROR_ARGUMENT, STAGE,
                          "all faces have a weight of 0: nothing is to be seen");
    if (scene->importance == NULL)
        NEW_ZERO(scene->context, STAGE, scene->importance, scene->mesh->face_count);
    for (size_t f = 0; f < faces; f++)
        scene->importance[f] = solid_is_clear(scene, f) ? 0
                               : weights != NULL        ? weights[f] / most
                                                        : 1;
    return mark_targets(scene);
}

enum { DENSITY_NAMES = 5 }; /* as negative numbers */

starg_status starg_space_require(starg_solid *scene, const starg_face_need *needs, size_t count) {
    starg_context *context = scene->context;
    size_t faces = starg_space_model_faces(scene), all = scene->mesh->face_count;
    SCOPED uint32_t *times = NULL;
    SCOPED double *density = NULL;
    NEW_ZERO(context, STAGE, times, all);
    NEW_ZERO(context, STAGE, density, all);
    for (size_t i = 0; i < count; i++) {
        const starg_face_need *need = &needs[i];
        uint64_t face = need->face;
        if (face >= faces || need->times > 1000 ||
            !(need->density >= -DENSITY_NAMES && need->density < 1e100))
            return starg_fail_at(context, STARG_ERROR_ARGUMENT, STAGE, STARG_ELEMENT_FACE, &face, 1,
                                 "face %u of %zu is to be seen by %u guards with the density %g; "
                                 "that is no face of the model, or beyond 1,000 guards",
                                 need->face, faces, need->times, need->density);
        times[face] = need->times;
        density[face] = need->density;
        if (scene->other_side != NULL && scene->other_side[face] != TOPOLOGY_NONE) {
            times[scene->other_side[face]] = need->times;
            density[scene->other_side[face]] = need->density;
        }
    }
    RELEASE(scene->times, scene->density);
    scene->times = times;
    scene->density = density;
    times = NULL;
    density = NULL;
    return STARG_OK;
}

/* ---- what is reached ---- */

/* A solid has an inside that cannot leak; a soup's is what is reached. */
static starg_status reach_from(starg_context *context, starg_solid *scene) {
    const starg_space_options *o = &scene->space;
    const double *from = o->from;
    flood_leak leak;
    TRY(flood_create(context, scene, from, o->cell, &scene->reached));
    if (!o->soup)
        return STARG_OK;
    bvh_box model =
        scene->tree->nodes[0].box; /* nobody gets out where a box ends no later than it */
    for (int k = 0; k < 3 && is_bounded(o) && !scene->own_box; k++) {
        model.lower[k] = o->within[k] >= model.lower[k] ? -INFINITY : model.lower[k];
        model.upper[k] = o->within[k + 3] <= model.upper[k] ? INFINITY : model.upper[k];
    }
    TRY(flood_find_leak(scene->reached, &model, from, &leak));
    scene->leak = leak.way.data;
    scene->leak_points = leak.way.count / 3;
    if (scene->leak_points > 0)
        starg_log(context, STARG_LOG_WARNING,
                  "the space that is reached from (%g, %g, %g) leaks %s%s at (%g, %g, %g): guards "
                  "may stand there, too; --leak FILE shows the way; close it, or choose other "
                  "cubes (--cell) or a box (--within)",
                  from[0], from[1], from[2], leak.outside ? "to the outside of the model" : "",
                  !leak.gap      ? ","
                  : leak.outside ? ", through a gap hardly wider than a cube"
                                 : "through a gap hardly wider than a cube",
                  leak.place[0], leak.place[1], leak.place[2]);
    return STARG_OK;
}

/* ---- the call ---- */

starg_status starg_space_create(starg_context *context, const starg_mesh *model,
                                const starg_mesh *const *obstacles, size_t obstacle_count,
                                const starg_space_options *options, starg_solid **out) {
    starg_space_options defaults;
    SCOPED_BY(starg_solid_drop) starg_solid *scene = NULL;
    SCOPED_BY(parts_free) parts p = {.context = context};
    *out = NULL;
    starg_space_options_default(&defaults);
    const starg_space_options *o = options != NULL ? options : &defaults;
    TRY(check_options(context, o));
    TRY(near_faces_check(context, o, model->face_count));
    TRY(push_model(&p, model, o));
    TRY(push_obstacles(&p, model, obstacles, obstacle_count, !o->outside && !o->soup));
    NEW_ZERO(context, STAGE, scene, 1);
    scene->context = context;
    scene->scene = true;
    scene->ambient = o->outside || o->soup ? 1 : 0;
    scene->space = *o;
    scene->model_vertices = model->vertex_count;
    scene->model_faces = model->face_count;
    scene->once_faces = p.faces.count / 3;
    TRY(pair_sheets(&p, &scene->once_twin));
    TRY(push_backs(&p, &scene->other_side));
    TRY(starg_mesh_create(context, p.vertices.data, p.vertices.count / 3, p.faces.data,
                          p.faces.count / 3, &scene->mesh));
    TRY(examine(context, scene));
    TRY(bind_guards(context, model, scene));
    TRY(take_zones(context, scene));
    TRY(take_clear(context, scene));
    TRY(note_sizes(scene, obstacles, obstacle_count));
    if (obstacle_count > 0)
        TRY(keep_model(context, model, scene));
    bind_to_box(scene);
    if (scene->mesh->face_count > scene->model_faces)
        TRY(starg_space_weigh(scene, NULL));
    if (o->cell > 0)
        TRY(reach_from(context, scene));
    *out = scene;
    scene = NULL;
    return STARG_OK;
}

/* ---- questions ---- */

size_t starg_space_model_vertices(const starg_solid *scene) {
    return scene->model_vertices;
}

size_t starg_space_model_faces(const starg_solid *scene) {
    return scene->scene ? scene->model_faces : scene->mesh->face_count;
}

const double *starg_space_leak(const starg_solid *scene, size_t *count) {
    *count = scene->leak_points;
    return scene->leak;
}

bool starg_space_admits(const starg_solid *scene, const double p[3]) {
    const starg_space_options *o = &scene->space;
    if (!scene->scene)
        return starg_solid_contains(scene, p);
    for (int k = 0; is_bounded(o) && k < 3; k++)
        if (p[k] < o->within[k] || p[k] > o->within[k + 3])
            return false;
    if (scene->reached != NULL && !flood_reaches(scene->reached, p))
        return false;
    if (!zones_admit(&scene->zones, p))
        return false;
    if (!near_faces_admit(&scene->over, &scene->mount, o, p))
        return false;
    if (o->standoff_least > 0 || o->standoff_most > 0) {
        double distance =
            bvh_distance(scene->model_tree != NULL ? scene->model_tree : scene->tree, p);
        if (distance < o->standoff_least || (o->standoff_most > 0 && distance > o->standoff_most))
            return false;
    }
    return starg_solid_contains(scene, p);
}

/* Half the diagonal and distances come with roundings, for which a millionth is more than enough
 * unless coordinates are huge beside the box: then it bars nothing. */
bool solid_bars(const starg_solid *solid, const bvh_box *box) {
    const starg_space_options *o = &solid->space;
    double centre[3], largest = 0, reach = 0.5 * vec3_distance(box->lower, box->upper);
    if (!solid->scene)
        return false;
    if (solid->reached != NULL && !flood_meets(solid->reached, box))
        return true;
    if (zones_bar(&solid->zones, box))
        return true;
    if (near_faces_bar(&solid->over, &solid->mount, o, box))
        return true;
    if (!(o->standoff_least > 0 || o->standoff_most > 0))
        return false;
    for (int k = 0; k < 3; k++) {
        centre[k] = 0.5 * box->lower[k] + 0.5 * box->upper[k];
        largest = fmax(largest, fmax(fabs(box->lower[k]), fabs(box->upper[k])));
    }
    double distance =
        bvh_distance(solid->model_tree != NULL ? solid->model_tree : solid->tree, centre);
    double room = 1e-6 * (reach + distance);
    if (largest > 1e6 * (reach + distance))
        return false;
    return distance + reach + room < o->standoff_least ||
           (o->standoff_most > 0 && distance - reach - room > o->standoff_most);
}

void solid_reach(const starg_solid *solid, bvh_box *out) {
    const starg_space_options *o = &solid->space;
    *out = solid->model_tree != NULL ? solid->model_tree->nodes[0].box : solid->tree->nodes[0].box;
    if (!solid->scene)
        return;
    const bool open = solid->ambient > 0, bounded = is_bounded(o);
    bvh_box bound;
    const bool near = near_faces_box(&solid->over, &solid->mount, o, &bound);
    const bool alone = open && !o->outside && !(o->standoff_most > 0); /* a soup's own box */
    double grow = 0;
    if (open && !alone)
        grow = o->standoff_most > 0 ? o->standoff_most : 4 * solid->check->diagonal;
    else if (alone && o->cell == 0)
        grow = ROOM * solid->check->diagonal;
    for (int k = 0; k < 3; k++) {
        out->lower[k] -= grow;
        out->upper[k] += grow;
        if (bounded) {
            out->lower[k] = open ? o->within[k] : fmax(out->lower[k], o->within[k]);
            out->upper[k] = open ? o->within[k + 3] : fmin(out->upper[k], o->within[k + 3]);
        }
        if (near && alone && !bounded) {
            out->lower[k] = bound.lower[k];
            out->upper[k] = bound.upper[k];
        } else if (near) {
            out->lower[k] = fmax(out->lower[k], bound.lower[k]);
            out->upper[k] = fmin(out->upper[k], bound.upper[k]);
        }
    }
}

void solid_extent(const starg_solid *solid, bvh_box *out) {
    const bvh_box *mesh = &solid->tree->nodes[0].box;
    solid_reach(solid, out);
    for (int k = 0; k < 3; k++) {
        out->lower[k] = fmin(out->lower[k], mesh->lower[k]);
        out->upper[k] = fmax(out->upper[k], mesh->upper[k]);
    }
}

/* (a, b, c) and (a, c, b): edges 0, 1 and 2 of the one are 2, 1 and 0 of the other. */
static uint32_t mirror(const starg_solid *solid, uint32_t halfedge) {
    return 3 * solid->other_side[halfedge / 3] + 2 - halfedge % 3;
}

uint32_t solid_twin(const starg_solid *solid, const uint32_t *twins, uint32_t halfedge) {
    if (solid->other_side == NULL || solid->other_side[halfedge / 3] == TOPOLOGY_NONE)
        return twins[halfedge];
    bool back = halfedge / 3 >= solid->once_faces;
    uint32_t twin = solid->once_twin[back ? mirror(solid, halfedge) : halfedge];
    if (twin == TOPOLOGY_NONE)
        return mirror(solid, halfedge);
    return back ? mirror(solid, twin) : twin;
}

void solid_finish_row(const starg_solid *solid, bool vertices, uint64_t *row) {
    for (size_t f = 0; !vertices && solid_is_two_sided(solid) && f < solid->model_faces; f++) {
        size_t front = solid_first_patch(solid, f), end = solid_first_patch(solid, f + 1);
        size_t back = solid_first_patch(solid, solid->other_side[f]);
        for (size_t i = front; i < end; i++)
            if (starg_bit_test(row, back + i - front))
                starg_bit_set(row, i);
    }
    const uint64_t *targets = solid->targets[vertices];
    bool parted = !vertices && solid->patches != NULL;
    size_t columns = vertices ? solid->mesh->vertex_count : solid_patch_count(solid);
    for (size_t w = 0; targets != NULL && !parted && w < starg_bit_words(columns); w++)
        row[w] &= targets[w];
    for (size_t i = 0; targets != NULL && parted && i < columns; i++)
        if (!starg_bit_test(targets, solid->patches->face.data[i]))
            starg_bit_clear(row, i);
    for (size_t i = 0; solid->need != NULL && i < columns; i++)
        if (solid->need[i] == 0)
            starg_bit_clear(row, i);
}
