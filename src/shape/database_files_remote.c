/* SPDX-License-Identifier: Apache-2.0 */
/* Files described by other processes.
 *
 * A job contains the names of all files, which helpers read themselves by the same paths, and the
 * hashes of what is stored. A reply contains the descriptions of a block, file by file. */
#include "guard/cells.h"
#include "shape/database.h"
#include "visibility/scene.h"

/* The fixed parts of a job, and of a file in a reply. */
typedef struct job_head {
    uint64_t count, name_bytes, stored;
} job_head;

typedef struct file_head {
    database_digest hash;
    uint64_t known, vertices, faces, message_bytes, warning_bytes, sizes[STARG_SIGNATURE_KINDS];
} file_head;

/* ---- rank 0 ---- */

starg_status database_files_pack(starg_context *context, const database_files *all,
                                 starg_bytes *out) {
    job_head head = {.count = all->count, .stored = all->stored_count};
    for (size_t i = 0; i < all->count; i++)
        head.name_bytes += strlen(all->names[i]) + 1;
    TRY(starg_bytes_put(context, out, &head, 1, sizeof head));
    for (size_t i = 0; i < all->count; i++)
        TRY(starg_bytes_put(context, out, all->names[i], strlen(all->names[i]) + 1, 1));
    return starg_bytes_put(context, out, all->stored, all->stored_count, sizeof *all->stored);
}

static starg_status take_file(starg_context *context, starg_bytes_reader *reply,
                              database_file *file) {
    file_head head;
    void *block;
    if (!starg_bytes_take(reply, &head, 1, sizeof head))
        return STARG_ERROR_RANK;
    file->hash = head.hash;
    file->known = head.known != 0;
    file->vertices = head.vertices;
    file->faces = head.faces;
    if (head.message_bytes > 0) {
        TRY(starg_bytes_take_block(context, reply, head.message_bytes, 1, &block));
        file->message = block;
    }
    if (head.warning_bytes > 0) {
        TRY(starg_bytes_take_block(context, reply, head.warning_bytes, 1, &block));
        file->warning = block;
    }
    for (int kind = 0; kind < STARG_SIGNATURE_KINDS; kind++) {
        TRY(starg_bytes_take_block(context, reply, head.sizes[kind], 1, &block));
        file->numbers[kind] = block;
        file->sizes[kind] = head.sizes[kind];
    }
    return STARG_OK;
}

starg_status database_files_take(starg_context *context, void *shared, size_t first, size_t count,
                                 starg_bytes_reader *reply) {
    const database_files *all = shared;
    for (size_t i = first; i < first + count; i++)
        TRY(take_file(context, reply, &all->files[i]));
    return STARG_OK;
}

/* ---- helpers ---- */

typedef struct remote_files {
    char *names;         /* concatenated */
    const char **starts; /* by file */
    database_digest *stored;
    size_t count, stored_count;
} remote_files;

static void end(starg_context *context, void *state) {
    (void)context;
    remote_files *all = state;
    if (all == NULL)
        return;
    RELEASE(all->names, all->starts, all->stored, all);
}

static starg_status begin(starg_context *context, starg_bytes_reader *bytes, void **state) {
    remote_files *all = NULL;
    job_head head;
    void *names, *stored;
    end(context, *state);
    *state = NULL;
    NEW_ZERO(context, DATABASE_STAGE, all, 1);
    *state = all;
    if (!starg_bytes_take(bytes, &head, 1, sizeof head))
        return STARG_ERROR_RANK;
    TRY(starg_bytes_take_block(context, bytes, head.name_bytes, 1, &names));
    all->names = names;
    TRY(starg_bytes_take_block(context, bytes, head.stored, sizeof *all->stored, &stored));
    all->stored = stored;
    all->stored_count = head.stored;
    NEW(context, DATABASE_STAGE, all->starts, head.count);
    const char *name = all->names;
    for (; all->count < head.count && name < all->names + head.name_bytes; name += strlen(name) + 1)
        all->starts[all->count++] = name;
    return STARG_OK;
}

static starg_status put_file(starg_context *context, const database_file *file,
                             starg_bytes *reply) {
    file_head head = {.hash = file->hash,
                      .known = file->known,
                      .vertices = file->vertices,
                      .faces = file->faces,
                      .message_bytes = file->message != NULL ? strlen(file->message) + 1 : 0,
                      .warning_bytes = file->warning != NULL ? strlen(file->warning) + 1 : 0};
    for (int kind = 0; kind < STARG_SIGNATURE_KINDS; kind++)
        head.sizes[kind] = file->sizes[kind];
    TRY(starg_bytes_put(context, reply, &head, 1, sizeof head));
    TRY(starg_bytes_put(context, reply, file->message, head.message_bytes, 1));
    TRY(starg_bytes_put(context, reply, file->warning, head.warning_bytes, 1));
    for (int kind = 0; kind < STARG_SIGNATURE_KINDS; kind++)
        TRY(starg_bytes_put(context, reply, file->numbers[kind], file->sizes[kind], 1));
    return STARG_OK;
}

static starg_status run(starg_context *context, void *state, size_t first, size_t count,
                        starg_bytes *reply) {
    starg_status status = STARG_OK;
    const remote_files *all = state;
    if (count > all->count || first > all->count - count)
        return STARG_ERROR_RANK;
    database_files files = {.names = all->starts + first,
                            .count = count,
                            .stored = all->stored,
                            .stored_count = all->stored_count};
    const starg_parallel_loop loop = {.stage = "add",
                                      .count = count,
                                      .shared = &files,
                                      .item = database_files_describe,
                                      .make_scratch = database_files_scratch,
                                      .free_scratch = database_files_free_scratch};
    STARG_NEW_ZERO(context, DATABASE_STAGE, files.files, count);
    STARG_TRY(starg_parallel_for(context, &loop));
    for (size_t i = 0; i < count; i++)
        STARG_TRY(put_file(context, &files.files[i], reply));
done:
    for (size_t i = 0; files.files != NULL && i < count; i++)
        database_file_clear(&files.files[i]);
    starg_release(context, files.files);
    return status;
}

static const ranks_work DESCRIBE = {begin, run, end};

starg_status starg_database_ranks_serve(starg_context *context, const starg_ranks *ranks) {
    const ranks_work *const works[RANKS_WORKS] = {[RANKS_VISIBILITY] = &visibility_ranks_work,
                                                  [RANKS_CELLS] = &cells_ranks_work,
                                                  [RANKS_DESCRIBE] = &DESCRIBE};
    return ranks_serve(context, ranks, works);
}
