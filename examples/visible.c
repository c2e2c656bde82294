/* SPDX-License-Identifier: Apache-2.0 */
/* Which faces of a model does a point see? visible MODEL X Y Z
 *
 * The result is a matrix of bits: a row for each point asked about, a column for each face. */
#include <starguard/starguard.h>
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv) {
    starg_context *context = NULL;
    starg_mesh *mesh = NULL;
    starg_solid *solid = NULL;
    starg_bits *seen = NULL;
    int result = 1;
    if (argc != 5) {
        fprintf(stderr, "usage: %s MODEL X Y Z\n", argv[0]);
        return 1;
    }
    const double point[3] = {atof(argv[2]), atof(argv[3]), atof(argv[4])};
    if (starg_context_create(NULL, &context) != STARG_OK)
        return 1;
    if (starg_mesh_read(context, argv[1], &mesh) != STARG_OK ||
        starg_solid_create(context, mesh, &solid) != STARG_OK ||
        starg_visibility(context, solid, point, 1, NULL, &seen) != STARG_OK)
        goto done;
    if (!starg_solid_contains(solid, point))
        printf("the point is not inside: it sees nothing\n");
    printf("%zu of %zu faces are visible", starg_bits_count(seen, 0), starg_bits_columns(seen));
    for (size_t face = 0, shown = 0; face < starg_bits_columns(seen) && shown < 5; face++)
        if (starg_bits_test(seen, 0, face))
            printf(shown++ == 0 ? ", the first of them %zu" : " %zu", face);
    printf("\n");
    result = 0;
done:
    if (result != 0)
        fprintf(stderr, "%s\n", starg_context_error(context)->message);
    starg_bits_free(seen);
    starg_solid_free(solid);
    starg_mesh_free(mesh);
    starg_context_free(context);
    return result;
}
