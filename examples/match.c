/* SPDX-License-Identifier: Apache-2.0 */
/* How unlike are two models? match A B
 *
 * Distances are made of signatures; those by guards need a decomposition of each model, those by
 * the surface alone are quicker. Only distances of one kind compare with each other. */
#include <starguard/starguard.h>
#include <stdio.h>

static starg_status compare(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                            starg_signature_kind kind) {
    starg_signature *first = NULL, *second = NULL;
    double distance;
    starg_status status = starg_signature_create(context, a, kind, &first);
    if (status == STARG_OK)
        status = starg_signature_create(context, b, kind, &second);
    if (status == STARG_OK)
        status = starg_signature_distance(context, first, second, &distance);
    if (status == STARG_OK)
        printf("%-10s %g\n", starg_signature_name(kind), distance);
    starg_signature_free(context, first);
    starg_signature_free(context, second);
    return status;
}

int main(int argc, char **argv) {
    starg_context *context = NULL;
    starg_mesh *a = NULL, *b = NULL;
    int result = 1;
    if (argc != 3) {
        fprintf(stderr, "usage: %s A B\n", argv[0]);
        return 1;
    }
    if (starg_context_create(NULL, &context) != STARG_OK)
        return 1;
    if (starg_mesh_read(context, argv[1], &a) == STARG_OK &&
        starg_mesh_read(context, argv[2], &b) == STARG_OK &&
        compare(context, a, b, STARG_SIGNATURE_STAR) == STARG_OK &&
        compare(context, a, b, STARG_SIGNATURE_SHAPE_DNA) == STARG_OK)
        result = 0;
    if (result != 0)
        fprintf(stderr, "%s\n", starg_context_error(context)->message);
    starg_mesh_free(b);
    starg_mesh_free(a);
    starg_context_free(context);
    return result;
}
