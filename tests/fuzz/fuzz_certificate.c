/* SPDX-License-Identifier: Apache-2.0 */
/* Any bytes as a certificate: read, or rejected with a message. What is read is checked against a U
 * of cells that two guards see, whatever model it names: no bound above two is ever proven. */
#include "starguard/solid.h"
#include "support.h"
#include "verify/everywhere.h"
#include "verify/facts.h"
#include "verify/surface.h"

static shape make_u(void) {
    return shape_cells("#.#"
                       "###",
                       3, 2, 1);
}

static void check(starg_context *context, starg_certificate *own) {
    shape u = make_u();
    starg_mesh *mesh = fuzz_mesh(context, &u);
    verify_surface *surface = NULL;
    verify_tree *tree = NULL;
    starg_guards guards = {.options.visibility.target = own->target};
    size_t cell, reason;
    bool follows;
    everywhere_words why;
    fuzz_require_ok(context, verify_surface_create(context, mesh, &surface), "a U is a surface");
    fuzz_require_ok(context, verify_tree_create(surface, &tree), "and has a tree");
    const verify_facts known = {
        .surface = surface, .guards = &guards, .tree = tree, .scale = verify_scale(surface)};
    const bool fits =
        own->vertex_count == surface->vertex_count && own->face_count == surface->face_count;
    if (fits) {
        fuzz_require_ok(context, verify_check_cells(own, &known, &cell, &reason),
                        "cells can be checked");
        fuzz_require_ok(context, verify_check_bound(own, &follows, &why), "so can the bound");
        bool all = own->cells[0].box.lower[0] <= 0 && own->cells[0].box.lower[1] <= 0 &&
                   own->cells[0].box.lower[2] <= 0 && own->cells[0].box.upper[0] >= 3 &&
                   own->cells[0].box.upper[1] >= 2 && own->cells[0].box.upper[2] >= 1;
        fuzz_require(!(all && cell == own->cell_count && follows && own->bound > 2 &&
                       own->range >= 4 && own->clearance == 0 && own->redundancy == 1),
                     "two guards see all of a U");
    }
    verify_tree_free(tree);
    verify_surface_free(surface);
    starg_mesh_free(mesh);
    shape_free(&u);
}

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
    starg_context *context = fuzz_context();
    starg_certificate *own = NULL;
    starg_status status = starg_certificate_read_memory(context, data, size, "fuzz", &own);
    if (status == STARG_OK)
        check(context, own);
    else
        fuzz_require_explained(context, status);
    starg_certificate_free(own);
    fuzz_context_end(context);
    return 0;
}
