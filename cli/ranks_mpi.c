/* SPDX-License-Identifier: Apache-2.0 */
/* Messages by MPI.
 *
 * A message is its size, then its bytes in parts within MPI's count limit. Waiting processes sleep
 * between polls: MPI's own waiting occupies a whole processor, which others may need.
 *
 * MPI is initialized only if a launcher has started several processes; otherwise the program starts
 * as fast as any other build, and runs where MPI cannot. */
#include "session.h"

#include <mpi.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

enum { TAG_SIZE = 1, TAG_BYTES = 2, PART = 1 << 30 };

static const struct timespec NAP = {.tv_nsec = 300000};

static starg_ranks ranks; /* count 0: MPI is not initialized */
static int own_threads;

static bool send_message(void *user, int to, const void *bytes, size_t size) {
    (void)user;
    uint64_t whole = size;
    if (MPI_Send(&whole, 1, MPI_UINT64_T, to, TAG_SIZE, MPI_COMM_WORLD) != MPI_SUCCESS)
        return false;
    for (size_t done = 0; done < size; done += PART) {
        int part = size - done < PART ? (int)(size - done) : PART;
        if (MPI_Send((const char *)bytes + done, part, MPI_BYTE, to, TAG_BYTES, MPI_COMM_WORLD) !=
            MPI_SUCCESS)
            return false;
    }
    return true;
}

static bool wait_for_message(void *user, double seconds, int *from, size_t *size) {
    (void)user;
    MPI_Status status;
    uint64_t whole;
    double until = MPI_Wtime() + seconds;
    int found = 0;
    *from = -1;
    for (;;) {
        if (MPI_Iprobe(MPI_ANY_SOURCE, TAG_SIZE, MPI_COMM_WORLD, &found, &status) != MPI_SUCCESS)
            return false;
        if (found || MPI_Wtime() >= until)
            break;
        nanosleep(&NAP, NULL);
    }
    if (!found)
        return true;
    if (MPI_Recv(&whole, 1, MPI_UINT64_T, status.MPI_SOURCE, TAG_SIZE, MPI_COMM_WORLD,
                 MPI_STATUS_IGNORE) != MPI_SUCCESS)
        return false;
    *from = status.MPI_SOURCE;
    *size = whole;
    return true;
}

static bool receive_message(void *user, int from, void *bytes, size_t size) {
    (void)user;
    for (size_t done = 0; done < size; done += PART) {
        int part = size - done < PART ? (int)(size - done) : PART;
        if (MPI_Recv((char *)bytes + done, part, MPI_BYTE, from, TAG_BYTES, MPI_COMM_WORLD,
                     MPI_STATUS_IGNORE) != MPI_SUCCESS)
            return false;
    }
    return true;
}

/* Open MPI, PMIx (Slurm), MPICH and derivatives. */
static bool was_launched(void) {
    return getenv("OMPI_COMM_WORLD_SIZE") != NULL || getenv("PMIX_RANK") != NULL ||
           getenv("PMI_SIZE") != NULL;
}

/* The processors to which the launcher has bound this process, or its share of the machine's.
 * Collective: all processes must call it. */
static int count_own_threads(void) {
    MPI_Comm machine;
    cpu_set_t bound;
    int here = 1;
    if (MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine) ==
        MPI_SUCCESS) {
        MPI_Comm_size(machine, &here);
        MPI_Comm_free(&machine);
    }
    int all = (int)sysconf(_SC_NPROCESSORS_ONLN), threads = all / here;
    if (sched_getaffinity(0, sizeof bound, &bound) == 0 && CPU_COUNT(&bound) < all)
        threads = CPU_COUNT(&bound);
    return threads > 1 ? threads : 1;
}

void cli_ranks_begin(int *argc, char ***argv) {
    int level;
    if (!was_launched() || MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &level) != MPI_SUCCESS)
        return;
    MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
    ranks =
        (starg_ranks){.send = send_message, .wait = wait_for_message, .receive = receive_message};
    MPI_Comm_rank(MPI_COMM_WORLD, &ranks.rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks.count);
    own_threads = ranks.count > 1 ? count_own_threads() : 0;
}

const starg_ranks *cli_ranks(void) {
    return ranks.count > 1 ? &ranks : NULL;
}

int cli_ranks_threads(void) {
    return own_threads;
}

int cli_ranks_serve(void) {
    starg_context *context = NULL;
    starg_context_options options;
    starg_context_options_default(&options);
    options.threads = cli_ranks_threads();
    starg_status status = starg_context_create(&options, &context);
    if (status == STARG_OK)
        status = starg_database_ranks_serve(context, &ranks);
    if (status != STARG_OK) {
        fprintf(stderr, "starguard: rank %d failed: %s\n", ranks.rank, starg_status_string(status));
        MPI_Abort(MPI_COMM_WORLD, CLI_EXIT_UNFINISHED);
    }
    starg_context_free(context);
    MPI_Finalize();
    return CLI_EXIT_DONE;
}

int cli_ranks_end(int result) {
    starg_context *context = NULL;
    starg_status status = STARG_OK;
    if (ranks.count == 0)
        return result;
    if (ranks.count > 1) {
        status = result == CLI_EXIT_CANCELLED ? STARG_ERROR_CANCELLED
                                              : starg_context_create(NULL, &context);
        if (status == STARG_OK)
            status = starg_ranks_release(context, &ranks);
        starg_context_free(context);
    }
    fflush(NULL);
    if (status != STARG_OK) /* the others may be busy for long, or unreachable */
        MPI_Abort(MPI_COMM_WORLD, result != CLI_EXIT_DONE ? result : CLI_EXIT_UNFINISHED);
    MPI_Finalize();
    return result;
}
