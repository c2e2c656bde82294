/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts a model into star-shaped pieces and lists them: pieces MODEL [PIECES.vtk]
 *
 * The search for few pieces ends when its time is over; progress is shown on the way. */
#include <starguard/starguard.h>
#include <stdio.h>

static const double SECONDS = 5;

/* Returning false would cancel the call. */
static bool show(void *user, const char *stage, double fraction) {
    (void)user;
    fprintf(stderr, "\r%-20s %3.0f %%", stage, 100 * fraction);
    return true;
}

static void tell(const starg_decomposition *d) {
    printf("%zu pieces, %zu of them proven to be star-shaped\n", d->piece_count, d->strictly_star);
    for (size_t i = 0; i < d->piece_count; i++) {
        const starg_piece *piece = &d->pieces[i];
        printf("  from %g %g %g: volume %g, %zu tetrahedra\n", piece->guard[0], piece->guard[1],
               piece->guard[2], piece->volume, piece->tetrahedra);
    }
}

int main(int argc, char **argv) {
    starg_context_options options;
    starg_context *context = NULL;
    starg_mesh *mesh = NULL;
    starg_solid *solid = NULL;
    starg_decomposition *pieces = NULL;
    int result = 1;
    if (argc < 2 || argc > 3) {
        fprintf(stderr, "usage: %s MODEL [PIECES.vtk]\n", argv[0]);
        return 1;
    }
    starg_context_options_default(&options);
    options.progress = show;
    if (starg_context_create(&options, &context) != STARG_OK)
        return 1;
    if (starg_mesh_read(context, argv[1], &mesh) != STARG_OK ||
        starg_solid_create(context, mesh, &solid) != STARG_OK)
        goto done;
    starg_context_set_time_limit(context, SECONDS);
    if (starg_decompose(context, solid, NULL, &pieces) != STARG_OK)
        goto done;
    fputc('\n', stderr);
    tell(pieces);
    starg_context_set_time_limit(context, 0);
    if (argc == 3 && starg_decomposition_write(context, pieces, argv[2], false) != STARG_OK)
        goto done;
    result = 0;
done:
    if (result != 0)
        fprintf(stderr, "%s\n", starg_context_error(context)->message);
    starg_decomposition_free(context, pieces);
    starg_solid_free(solid);
    starg_mesh_free(mesh);
    starg_context_free(context);
    return result;
}
