/* SPDX-License-Identifier: Apache-2.0 */
/* Places guards inside a model and lists them: guards MODEL [GUARDS.json]
 *
 * Outputs are NULL until a call succeeds and every free takes NULL, so that one place at the end
 * frees whatever there is. */
#include <inttypes.h>
#include <starguard/starguard.h>
#include <stdio.h>

/* What went wrong, and with which vertices, faces or lines. */
static void print_error(const starg_context *context) {
    const starg_error *error = starg_context_error(context);
    fprintf(stderr, "%s: %s\n", error->stage, error->message);
    for (size_t i = 0; i < error->index_count; i++)
        fprintf(stderr, "  element %" PRIu64 "\n", error->indices[i]);
}

static void tell(const starg_guards *guards) {
    printf("%zu guards, and no fewer than %zu of the candidates do\n", guards->count,
           guards->lower_bound);
    for (size_t i = 0; i < guards->count; i++) {
        const double *p = guards->positions + 3 * i;
        printf("  %g %g %g sees %zu of %zu faces\n", p[0], p[1], p[2], guards->seen_faces[i],
               guards->face_count);
    }
}

int main(int argc, char **argv) {
    starg_context *context = NULL;
    starg_mesh *mesh = NULL;
    starg_solid *solid = NULL;
    starg_guards *guards = NULL;
    int result = 1;
    if (argc < 2 || argc > 3) {
        fprintf(stderr, "usage: %s MODEL [GUARDS.json]\n", argv[0]);
        return 1;
    }
    if (starg_context_create(NULL, &context) != STARG_OK)
        return 1;
    if (starg_mesh_read(context, argv[1], &mesh) != STARG_OK ||
        starg_solid_create(context, mesh, &solid) != STARG_OK ||
        starg_guard(context, solid, NULL, &guards) != STARG_OK)
        goto done;
    tell(guards);
    if (argc == 3 && starg_guards_write(context, guards, argv[1], argv[2]) != STARG_OK)
        goto done;
    result = 0;
done:
    if (result != 0)
        print_error(context);
    starg_guards_free(context, guards);
    starg_solid_free(solid);
    starg_mesh_free(mesh);
    starg_context_free(context);
    return result;
}
