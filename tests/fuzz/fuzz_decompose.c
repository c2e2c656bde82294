/* SPDX-License-Identifier: Apache-2.0 */
/* A small solid is cut into star-shaped pieces, with little effort: the verifier, from the files
 * that are written, accepts them all. */
#include <string.h>

#include "starguard/decompose.h"
#include "starguard/verify.h"
#include "support.h"

/* The result as other programs see it. */
static starg_result *reread(starg_context *context, const char *path) {
    starg_result *result = NULL;
    fuzz_require_ok(context, starg_result_read(context, path, &result), "results can be read");
    return result;
}

static void verify(starg_context *context, const starg_mesh *model, const starg_decomposition *d,
                   bool binary) {
    const char *pieces_path = fuzz_path(".vtk"), *report_path = fuzz_path(".json");
    starg_verdict *verdict = NULL;
    fuzz_require_ok(context, starg_decomposition_write(context, d, pieces_path, binary),
                    "pieces can be written");
    fuzz_require_ok(context, starg_decomposition_write_report(context, d, NULL, report_path),
                    "reports can be written");
    starg_result *pieces = reread(context, pieces_path), *report = reread(context, report_path);
    fuzz_require(pieces->pieces != NULL && report->report != NULL, "results are recognized");
    fuzz_require_ok(context,
                    starg_verify_pieces(context, model, pieces->pieces, report->report, &verdict),
                    "pieces can be verified");
    for (size_t i = 0; i < verdict->count; i++)
        fuzz_require(verdict->claims[i].holds, verdict->claims[i].text);
    starg_verdict_free(context, verdict);
    starg_result_free(context, pieces);
    starg_result_free(context, report);
}

static starg_decompose_options choose_options(fuzz_input *in) {
    starg_decompose_options options;
    starg_decompose_options_default(&options);
    options.mode = (starg_decompose_mode)(fuzz_below(in, 4) == 0);
    options.tetra.generator = STARG_TETRA_STUFFING; /* no other program for each input */
    options.tetra.target = 10 + fuzz_below(in, 50);
    options.effort = 1 + fuzz_below(in, 3);
    options.max_pieces = fuzz_below(in, 3);
    return options;
}

static void decompose(starg_context *context, const starg_solid *solid,
                      const starg_decompose_options *options, bool binary) {
    starg_decomposition *d = NULL;
    starg_status status = starg_decompose(context, solid, options, &d);
    if (status != STARG_OK && status != STARG_ERROR_SOLVER)
        fuzz_require_ok(context, status, "a solid is cut, or too thin to be filled");
    if (d == NULL)
        return;
    fuzz_require(options->mode == STARG_DECOMPOSE_PAPER || d->strictly_star == d->piece_count,
                 "strict pieces are star-shaped");
    verify(context, starg_solid_mesh(solid), d, binary);
    starg_decomposition_free(context, d);
}

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
    fuzz_input in = {data, size};
    starg_context *context = fuzz_context();
    starg_decompose_options options = choose_options(&in);
    bool binary = fuzz_below(&in, 2) == 1;
    shape s = fuzz_shape(&in);
    starg_mesh *mesh = fuzz_mesh(context, &s);
    starg_solid *solid = NULL;
    if (starg_solid_create(context, mesh, &solid) == STARG_OK)
        decompose(context, solid, &options, binary);
    starg_solid_free(solid);
    starg_mesh_free(mesh);
    shape_free(&s);
    fuzz_context_end(context);
    return 0;
}
