/* SPDX-License-Identifier: Apache-2.0 */
/* Runs a fuzz target without a fuzzer: over every file of a folder, then over so many mutations of
 * them in all (flipped, overwritten, inserted and dropped bytes, truncations, splices of two
 * files), the same ones in every run. When the target crashes, the last input is written to the
 * working folder as crash_<seed>_<mutation>. Usage: TARGET MUTATIONS FOLDER */
#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/rng.h"

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size);

enum { MOST_FILES = 256, MOST_BYTES = 1 << 16 };

typedef struct fuzz_seed {
    char *name;
    unsigned char *bytes;
    size_t size;
} fuzz_seed;

typedef struct fuzz_input {
    unsigned char bytes[2 * MOST_BYTES];
    size_t size;
} fuzz_input;

static void die(const char *what, const char *name) {
    fprintf(stderr, "%s: %s\n", name, what);
    exit(2);
}

static fuzz_seed load(const char *folder, const char *name) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    fuzz_seed seed = {strdup(name), malloc(MOST_BYTES), 0};
    if (file == NULL || seed.name == NULL || seed.bytes == NULL)
        die("cannot be read", path);
    seed.size = fread(seed.bytes, 1, MOST_BYTES, file);
    if (!feof(file))
        die("is larger than a seed should be", path);
    fclose(file);
    return seed;
}

static int by_name(const void *a, const void *b) {
    const fuzz_seed *left = a, *right = b;
    return strcmp(left->name, right->name);
}

static size_t load_folder(const char *folder, fuzz_seed *seeds) {
    DIR *listing = opendir(folder);
    size_t count = 0;
    if (listing == NULL)
        die("cannot be opened", folder);
    for (struct dirent *entry; (entry = readdir(listing)) != NULL;) {
        if (entry->d_name[0] == '.')
            continue;
        if (count == MOST_FILES)
            die("holds too many files", folder);
        seeds[count++] = load(folder, entry->d_name);
    }
    closedir(listing);
    qsort(seeds, count, sizeof *seeds, by_name); /* the order of a folder is chance */
    return count;
}

static size_t position(starg_rng *rng, size_t size) {
    return size == 0 ? 0 : (size_t)starg_rng_below(rng, size);
}

/* Numbers that readers might trip over. */
static void write_number(fuzz_input *input, starg_rng *rng) {
    static const char *const numbers[] = {"-1",         "0",   "4294967295", "9223372036854775807",
                                          "1e99",       "nan", "1e-999",     "99999",
                                          "2147483648", "."};
    const char *number = numbers[starg_rng_below(rng, sizeof numbers / sizeof numbers[0])];
    size_t length = strlen(number), at = position(rng, input->size);
    if (at + length <= input->size)
        memcpy(input->bytes + at, number, length);
}

/* Doubles a stretch or drops one. */
static void repeat_or_drop(fuzz_input *input, starg_rng *rng, bool drop) {
    size_t from = position(rng, input->size), length = position(rng, input->size - from);
    size_t tail = input->size - from - length;
    if (!drop && input->size + length > sizeof input->bytes)
        return;
    if (drop)
        memmove(input->bytes + from, input->bytes + from + length, tail);
    else
        memmove(input->bytes + from + length, input->bytes + from, tail + length);
    input->size = drop ? input->size - length : input->size + length;
}

/* Begins as this input and goes on as another seed. */
static void splice(fuzz_input *input, const fuzz_seed *other, starg_rng *rng) {
    size_t keep = position(rng, input->size), from = position(rng, other->size);
    size_t length = other->size - from;
    if (keep + length > sizeof input->bytes)
        return;
    if (length != 0)
        memcpy(input->bytes + keep, other->bytes + from, length);
    input->size = keep + length;
}

static void mutate(fuzz_input *input, const fuzz_seed *seeds, size_t count, starg_rng *rng) {
    switch (starg_rng_below(rng, 7)) {
    case 0:
        if (input->size != 0)
            input->bytes[position(rng, input->size)] ^=
                (unsigned char)(1 << starg_rng_below(rng, 8));
        break;
    case 1:
        if (input->size != 0)
            input->bytes[position(rng, input->size)] = (unsigned char)starg_rng_next(rng);
        break;
    case 2:
        input->size = position(rng, input->size);
        break;
    case 3:
        write_number(input, rng);
        break;
    case 4:
        repeat_or_drop(input, rng, true);
        break;
    case 5:
        repeat_or_drop(input, rng, false);
        break;
    default:
        splice(input, &seeds[starg_rng_below(rng, count)], rng);
        break;
    }
}

/* What runs now, for the signal handler. */
static fuzz_input current;
static char current_name[512];

/* Only calls that are safe in a handler. */
static void leave_input(int signal_number) {
    int file = open(current_name, O_WRONLY | O_CREAT | O_TRUNC, 0644);
    if (file >= 0 && write(file, current.bytes, current.size) == (ssize_t)current.size)
        close(file);
    signal(signal_number, SIG_DFL);
    raise(signal_number);
}

static void run(const fuzz_input *input, const char *target) {
    /* a block of the exact size lets sanitizers see what reads past its end */
    unsigned char *exact = malloc(input->size + (input->size == 0));
    if (exact == NULL)
        die("out of memory", target);
    memcpy(exact, input->bytes, input->size);
    LLVMFuzzerTestOneInput(exact, input->size);
    free(exact);
}

static void run_seed(const fuzz_seed *seeds, size_t count, size_t index, size_t mutations,
                     const char *target) {
    for (uint64_t i = 0; i <= mutations; i++) {
        starg_rng rng = starg_rng_make(1, index, i);
        memcpy(current.bytes, seeds[index].bytes, seeds[index].size);
        current.size = seeds[index].size;
        uint64_t steps = i == 0 ? 0 : 1 + starg_rng_below(&rng, 4);
        for (uint64_t step = 0; step < steps; step++)
            mutate(&current, seeds, count, &rng);
        snprintf(current_name, sizeof current_name, "crash_%s_%d", seeds[index].name, (int)i);
        run(&current, target);
    }
}

int main(int argc, char **argv) {
    static fuzz_seed seeds[MOST_FILES];
    if (argc != 3)
        die("takes a number of mutations and a folder of seeds", argv[0]);
    size_t count = load_folder(argv[2], seeds);
    if (count == 0)
        die("holds no seeds", argv[2]);
    size_t mutations = strtoul(argv[1], NULL, 10) / count;
    static const int signals[] = {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL};
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++)
        signal(signals[i], leave_input);
    for (size_t i = 0; i < count; i++)
        run_seed(seeds, count, i, mutations, argv[0]);
    printf("%zu seeds and %zu mutations of each\n", count, mutations);
    for (size_t i = 0; i < count; i++) {
        free(seeds[i].name);
        free(seeds[i].bytes);
    }
    return 0;
}
