/* SPDX-License-Identifier: Apache-2.0 */
/* Describes files to add to a database: reads and hashes them, and computes all signatures, unless
 * the content is already stored.
 *
 * Each worker has its own context (its errors belong to a file, not to the call), which checks the
 * call's context for cancellation. It ignores the time limit, which would change what is stored.
 *
 * Cost: that of the signatures. */
#include "mesh/mesh.h"
#include "shape/database.h"

#include <stdio.h>
#include <stdlib.h>

#include "core/file.h"

int database_by_digest(const void *a, const void *b) {
    return memcmp(a, b, sizeof(database_digest));
}

void database_file_clear(database_file *file) {
    RELEASE(file->message, file->warning);
    for (int kind = 0; kind < STARG_SIGNATURE_KINDS; kind++)
        RELEASE(file->numbers[kind]);
    *file = (database_file){0};
}

static bool go_on(void *user, const char *stage, double fraction) {
    const starg_context *parent = user;
    (void)stage, (void)fraction;
    return !atomic_load(&parent->cancelled) && !starg_time_is_over(parent);
}

/* A context of its own, and the first warning about the file at hand. */
typedef struct describer {
    starg_context *worker;
    char warning[512];
} describer;

static void keep_warning(void *user, starg_log_level level, const char *message) {
    describer *own = user;
    if (level == STARG_LOG_WARNING && own->warning[0] == '\0')
        snprintf(own->warning, sizeof own->warning, "%s", message);
}

starg_status database_files_scratch(starg_context *context, void *shared, void **scratch) {
    SCOPED describer *own = NULL;
    starg_context_options options;
    (void)shared;
    *scratch = NULL;
    NEW_ZERO(context, DATABASE_STAGE, own, 1);
    starg_context_options_default(&options);
    options.allocator = context->allocator;
    options.threads = 1;
    options.seed = context->seed;
    options.progress = go_on;
    options.progress_user = context;
    options.log = keep_warning;
    options.log_user = own;
    TRY(starg_context_create(&options, &own->worker));
    *scratch = own;
    own = NULL;
    return STARG_OK;
}

void database_files_free_scratch(starg_context *context, void *scratch) {
    describer *own = scratch;
    if (own == NULL)
        return;
    starg_context_free(own->worker);
    starg_release(context, own);
}

/* Little-endian on any machine. */
static starg_status keep_numbers(starg_context *context, const starg_signature *from,
                                 database_file *d) {
    uint8_t *bytes = NULL;
    NEW(context, DATABASE_STAGE, bytes, 8 * from->count);
    for (size_t i = 0; i < from->count; i++) {
        uint64_t bits;
        memcpy(&bits, &from->numbers[i], sizeof bits);
        for (size_t k = 0; k < 8; k++)
            bytes[8 * i + k] = (uint8_t)(bits >> (8 * k));
    }
    d->numbers[from->kind] = bytes;
    d->sizes[from->kind] = 8 * from->count;
    return STARG_OK;
}

static starg_status describe_mesh(starg_context *context, starg_context *worker,
                                  const starg_mesh *mesh, database_file *d) {
    starg_status status = STARG_OK;
    starg_signature *signatures[STARG_SIGNATURE_KINDS] = {NULL};
    d->vertices = starg_mesh_vertex_count(mesh);
    d->faces = starg_mesh_face_count(mesh);
    STARG_TRY(starg_signature_create_all(worker, mesh, signatures));
    for (int kind = 0; kind < STARG_SIGNATURE_KINDS; kind++)
        STARG_TRY(keep_numbers(context, signatures[kind], d));
done:
    for (int kind = 0; kind < STARG_SIGNATURE_KINDS; kind++)
        starg_signature_free(worker, signatures[kind]);
    return status;
}

static starg_status describe_file(starg_context *context, const database_files *all,
                                  starg_context *worker, const char *name, database_file *d) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *mesh = NULL;
    SCOPED char *bytes = NULL;
    size_t size = 0;
    TRY(starg_file_read(worker, DATABASE_STAGE, name, &bytes, &size));
    starg_sha256(bytes, size, d->hash.bytes);
    d->known = all->stored_count > 0 && bsearch(&d->hash, all->stored, all->stored_count,
                                                sizeof *all->stored, database_by_digest) != NULL;
    if (d->known)
        return STARG_OK;
    TRY(starg_mesh_read_memory(worker, bytes, size, name, &mesh));
    return describe_mesh(context, worker, mesh, d);
}

starg_status database_files_describe(starg_context *context, void *shared, void *scratch,
                                     size_t item) {
    const database_files *all = shared;
    database_file *d = &all->files[item];
    describer *own = scratch;
    own->warning[0] = '\0';
    starg_status status = describe_file(context, all, own->worker, all->names[item], d);
    if (status == STARG_OK && own->warning[0] != '\0') {
        d->warning = database_copy(context, own->warning);
        return d->warning != NULL ? STARG_OK : STARG_ERROR_MEMORY;
    }
    if (status == STARG_ERROR_CANCELLED && !atomic_load(&context->cancelled))
        return STARG_ERROR_TIME;
    if (status == STARG_OK || status == STARG_ERROR_MEMORY || status == STARG_ERROR_CANCELLED)
        return status;
    const char *message = starg_context_error(own->worker)->message;
    d->message = database_copy(context, message);
    return d->message != NULL ? STARG_OK : STARG_ERROR_MEMORY;
}
