/* SPDX-License-Identifier: Apache-2.0 */
/* What all certificates are written with. */
#include "guard/certificate_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/checksum.h"
#include "core/memory.h"

static const char STAGE[] = "certificate";

void certificate_put_double(FILE *stream, char before, double x) {
    int exponent;
    long long whole = (long long)ldexp(frexp(x, &exponent), 53);
    for (exponent -= 53; whole != 0 && whole % 2 == 0; exponent++)
        whole /= 2;
    fprintf(stream, "%c%lld:%d", before, whole, whole == 0 ? 0 : exponent);
}

void certificate_put_model(FILE *stream, int version, const starg_solid *solid) {
    const starg_mesh *mesh = solid->mesh;
    uint64_t sum = STARG_CHECKSUM_BEGIN;
    for (size_t f = 0; f < mesh->face_count; f++)
        sum = starg_checksum_face(sum, mesh->vertices, mesh->faces + 3 * f);
    fprintf(stream, "starguard-certificate %d\nvertices %zu\nfaces %zu\nchecksum %016llx\n",
            version, mesh->vertex_count, mesh->face_count, (unsigned long long)sum);
}

void certificate_put_root(FILE *stream, const bvh_box *root) {
    fprintf(stream, "root");
    for (int k = 0; k < 3; k++)
        certificate_put_double(stream, ' ', root->lower[k]);
    for (int k = 0; k < 3; k++)
        certificate_put_double(stream, ' ', root->upper[k]);
    fprintf(stream, "\n");
}

starg_status certificate_write(starg_context *context, certificate_put *put, const void *what,
                               char **text, size_t *size) {
    starg_status status = STARG_OK;
    char *bytes = NULL;
    FILE *stream = open_memstream(&bytes, size);
    if (stream != NULL)
        put(stream, what);
    bool whole = stream != NULL && !ferror(stream);
    if (stream == NULL || fclose(stream) != 0 || !whole) {
        status = starg_fail_memory(context, STAGE);
        goto done;
    }
    STARG_NEW(context, STAGE, *text, *size + 1);
    memcpy(*text, bytes, *size + 1);
done:
    free(bytes);
    return status;
}
