/* SPDX-License-Identifier: Apache-2.0 */
/* A small mesh is checked, repaired and guarded. What is called usable makes a solid and nothing
 * else does; what was repaired is usable, and needs no more of it when nothing is found any more;
 * the verifier accepts the guards; and another engine finds as many. */
#include <math.h>
#include <string.h>

#include "starguard/check.h"
#include "starguard/guard.h"
#include "starguard/repair.h"
#include "starguard/verify.h"
#include "support.h"

/* ---- check and repair ---- */

static starg_check *check(starg_context *context, const starg_mesh *mesh) {
    starg_check *found = NULL;
    fuzz_require_ok(context, starg_mesh_check(context, mesh, &found), "any mesh can be checked");
    return found;
}

static bool is_spotless(const starg_check *found) {
    size_t findings = 0;
    for (int kind = 0; kind < STARG_FINDING_KINDS; kind++)
        findings += found->findings[kind].count;
    return found->usable && findings == 0;
}

static bool same_mesh(const starg_mesh *a, const starg_mesh *b) {
    size_t vertices = starg_mesh_vertex_count(a), faces = starg_mesh_face_count(a);
    return vertices == starg_mesh_vertex_count(b) && faces == starg_mesh_face_count(b) &&
           memcmp(starg_mesh_vertices(a), starg_mesh_vertices(b), 3 * vertices * sizeof(double)) ==
               0 &&
           memcmp(starg_mesh_faces(a), starg_mesh_faces(b), 3 * faces * sizeof(uint32_t)) == 0;
}

/* The mended mesh, or NULL where that cannot be. */
static starg_mesh *repair(starg_context *context, const starg_mesh *mesh) {
    starg_mesh *mended = NULL;
    starg_repair_report report;
    starg_status status = starg_mesh_repair(context, mesh, NULL, &mended, &report);
    fuzz_require(status == STARG_OK || status == STARG_ERROR_MESH || status == STARG_ERROR_RANGE,
                 "a mesh is repaired or cannot be");
    if (mended == NULL)
        return NULL;
    starg_check *found = check(context, mended);
    fuzz_require(found->usable, "what was repaired is usable");
    if (is_spotless(found)) {
        starg_mesh *again = NULL;
        fuzz_require_ok(context, starg_mesh_repair(context, mended, NULL, &again, &report),
                        "a good mesh can be repaired");
        fuzz_require(same_mesh(mended, again), "a good mesh comes back as it is");
        starg_mesh_free(again);
    }
    starg_check_free(context, found);
    return mended;
}

/* ---- guard ---- */

static starg_guard_options choose_options(fuzz_input *in) {
    static const double coverages[4] = {1, 1, 0.9, 0.3};
    starg_guard_options o;
    starg_guard_options_default(&o);
    o.method = (starg_guard_method)fuzz_below(in, 3);
    o.candidates = (starg_candidates)fuzz_below(in, 2); /* of the medial axis, or a lattice */
    o.candidates = fuzz_below(in, 4) == 0 ? STARG_CANDIDATES_SKELETON : o.candidates;
    o.candidate_count = 1 + fuzz_below(in, 24);
    o.visibility.engine = (starg_visibility_engine)fuzz_below(in, 5);
    o.visibility.face_rule = (starg_face_rule)fuzz_below(in, 2);
    o.visibility.target = (starg_target)(fuzz_below(in, 4) == 3);
    o.coverage = coverages[fuzz_below(in, 4)];
    o.redundancy = 1 + fuzz_below(in, 2);
    o.max_guards = fuzz_below(in, 4) == 0 ? 1 + fuzz_below(in, 3) : 0;
    o.clearance = fuzz_below(in, 4) == 0 ? 0.01 : 0;
    o.max_nodes = 20;
    o.coarsest = 4 + fuzz_below(in, 16);
    o.step = 2 + fuzz_below(in, 16);
    o.refine = fuzz_below(in, 2) == 1;
    o.refine_lines = 3000;
    return o;
}

static void require_verified(starg_context *context, const starg_mesh *mesh,
                             const starg_guards *guards) {
    starg_verdict *verdict = NULL;
    fuzz_require_ok(context, starg_verify_guards(context, mesh, guards, &verdict),
                    "a result can be verified");
    for (size_t i = 0; i < verdict->count; i++)
        fuzz_require(verdict->claims[i].holds, verdict->claims[i].text);
    starg_verdict_free(context, verdict);
}

static starg_guards *guard(starg_context *context, const starg_solid *solid,
                           const starg_guard_options *options) {
    starg_guards *guards = NULL;
    starg_status status = starg_guard(context, solid, options, &guards);
    if (status != STARG_OK && status != STARG_ERROR_MESH)
        fuzz_require_ok(context, status, "a solid is guarded, or no candidate is inside");
    return guards;
}

static void guard_twice(starg_context *context, const starg_solid *solid,
                        starg_guard_options options) {
    starg_guards *first = guard(context, solid, &options), *second;
    options.visibility.engine = STARG_VISIBILITY_BVH;
    second = guard(context, solid, &options);
    fuzz_require((first == NULL) == (second == NULL), "engines agree on what is possible");
    if (first != NULL) {
        require_verified(context, starg_solid_mesh(solid), first);
        fuzz_require(
            first->count == second->count &&
                memcmp(first->positions, second->positions, 3 * first->count * sizeof(double)) == 0,
            "engines agree on the guards");
    }
    starg_guards_free(context, first);
    starg_guards_free(context, second);
}

/* ---- all of it ---- */

static void use_mesh(starg_context *context, const starg_mesh *mesh,
                     const starg_guard_options *options) {
    starg_check *found = check(context, mesh);
    starg_solid *solid = NULL;
    starg_status status = starg_solid_create(context, mesh, &solid);
    fuzz_require((status == STARG_OK) == found->usable, "usable meshes are solids");
    if (solid != NULL)
        guard_twice(context, solid, *options);
    starg_solid_free(solid);
    starg_check_free(context, found);
}

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
    fuzz_input in = {data, size};
    starg_context *context = fuzz_context();
    starg_guard_options options = choose_options(&in);
    shape s = fuzz_shape(&in);
    starg_mesh *mesh = fuzz_mesh(context, &s), *mended = repair(context, mesh);
    use_mesh(context, mended != NULL ? mended : mesh, &options);
    starg_mesh_free(mended);
    starg_mesh_free(mesh);
    shape_free(&s);
    fuzz_context_end(context);
    return 0;
}
