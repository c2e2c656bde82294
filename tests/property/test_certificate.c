/* SPDX-License-Identifier: Apache-2.0 */
/* Certificates of bounds for guards anywhere: those of searches verify, and are the same for any
 * number of threads; damaged and forged ones are rejected, or prove something true. */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/compiler.h"
#include "core/rng.h"
#include "guard/prices.h"
#include "models.h"
#include "verify/everywhere.h"
#include "verify/facts.h"
#include "verify/surface.h"

enum { DAMAGED = 10000 };

/* A model, what was proven about it, and the verifier's facts about it. */
typedef struct subject {
    starg_context *context;
    starg_solid *solid;
    const starg_mesh *mesh;
    starg_guards *guards;
    char *text;
    size_t size;
    verify_facts known;
} subject;

static starg_guard_options proving(uint64_t work) {
    starg_guard_options options;
    starg_guard_options_default(&options);
    options.candidate_count = 60;
    options.refine_lines = 20000;
    options.prove = true;
    options.prove_work = work;
    return options;
}

/* What the guards see, according to the verifier. */
static void find_known(subject *s) {
    verify_surface *surface = NULL;
    verify_sight *sight = NULL;
    const uint8_t *seen[2];
    test_ok(s->context, verify_surface_create(s->context, s->mesh, &surface));
    s->known = (verify_facts){.surface = surface, .guards = s->guards};
    s->known.scale = verify_scale(surface);
    s->known.inside = malloc(s->guards->count + 1);
    assert_non_null(s->known.inside);
    memset(s->known.inside, 1, s->guards->count);
    test_ok(s->context, verify_tree_create(surface, &s->known.tree));
    test_ok(s->context, verify_sight_create(surface, &sight));
    starg_bits **rows[2] = {&s->known.vertices, &s->known.patches};
    for (int k = 0; k < 2; k++)
        test_ok(s->context,
                starg_bits_create(s->context, s->guards->count,
                                  k == 0 ? surface->vertex_count : surface->face_count, rows[k]));
    for (size_t g = 0; g < s->guards->count; g++) {
        const verify_view view = verify_view_around(s->guards);
        test_ok(s->context,
                verify_look(sight, s->guards->positions + 3 * g, &view, &seen[0], &seen[1]));
        for (int k = 0; k < 2; k++)
            for (size_t j = 0; j < (*rows[k])->columns; j++)
                if (seen[k][j])
                    starg_bits_set(*rows[k], g, j);
    }
    verify_sight_free(sight);
}

static subject prove(starg_context *context, starg_solid *solid,
                     const starg_guard_options *options) {
    subject s = {.context = context, .solid = solid, .mesh = starg_solid_mesh(solid)};
    test_ok(context, starg_guard_certified(context, solid, options, &s.guards, &s.text, &s.size));
    find_known(&s);
    return s;
}

static subject prove_sample(const char *name, size_t vertices, uint64_t work) {
    starg_context *context = test_context(2);
    const starg_guard_options options = proving(work);
    return prove(context, test_sample(context, name, vertices), &options);
}

static void subject_clear(subject *s) {
    starg_bits_free(s->known.vertices);
    starg_bits_free(s->known.patches);
    free(s->known.inside);
    verify_tree_free(s->known.tree);
    verify_surface_free((verify_surface *)(uintptr_t)s->known.surface);
    starg_text_free(s->context, s->text);
    starg_guards_free(s->context, s->guards);
}

static void subject_free(subject *s) {
    subject_clear(s);
    starg_solid_free(s->solid);
    test_context_free(s->context);
}

/* ---- valid ones ---- */

static bool says(const starg_verdict *verdict, bool holds, const char *words) {
    for (size_t i = 0; i < verdict->count; i++)
        if (verdict->claims[i].holds == holds && strstr(verdict->claims[i].text, words) != NULL)
            return true;
    return false;
}

static bool is_in_cell(const starg_certificate_outline *o, const double p[3]) {
    for (size_t i = 0; i < o->cell_count; i++) {
        const double *cell = o->cells + 6 * i;
        if (p[0] >= cell[0] && p[1] >= cell[1] && p[2] >= cell[2] && p[0] <= cell[3] &&
            p[1] <= cell[4] && p[2] <= cell[5])
            return true;
    }
    return false;
}

/* Does guard g see its share of the witnesses, by their prices in the first node, if they have any?
 */
static bool sees_share(const subject *s, const starg_certificate *read, size_t g) {
    const everywhere_node *node = read->node_count > 0 ? &read->nodes[0] : NULL;
    const starg_bits *rows =
        read->target == STARG_TARGET_VERTICES ? s->known.vertices : s->known.patches;
    starg_uint128 seen = 0, all = 0;
    if (node == NULL || node->witness != UINT32_MAX) {
        for (size_t j = 0; j < read->witness_count; j++)
            seen += starg_bits_test(rows, g, read->witnesses[j]);
        return seen > 0 && seen * read->bound >= read->witness_count * read->redundancy;
    }
    for (size_t k = 0; k < node->count;) {
        const uint64_t *one = read->numbers.data + node->first + k;
        uint64_t count = one[0], held = 0, least = count * read->redundancy;
        for (size_t i = 1; i <= count; i++)
            held += starg_bits_test(rows, g, read->witnesses[one[i]]);
        seen += one[count + 1] * ((held + 1) / 2);
        all += one[count + 1] * (count == 1 ? least : (least + 1) / 2);
        k += count + 2;
    }
    return seen > 0 && seen * read->bound >= all;
}

/* Guards that see their share stand in cells of the outline. If there are no more guards than are
 * needed, one of them does. */
static void check_outline(const subject *s, const starg_certificate *read) {
    starg_certificate_outline *o = NULL;
    size_t sharing = 0;
    test_ok(s->context, starg_certificate_outline_create(s->context, read, &o));
    assert_int_equal(o->bound, read->bound);
    assert_int_equal(o->witness_count, read->witness_count);
    assert_memory_equal(o->witnesses, read->witnesses, o->witness_count * sizeof *o->witnesses);
    for (size_t g = 0; g < s->guards->count; g++)
        if (sees_share(s, read, g)) {
            assert_true(is_in_cell(o, s->guards->positions + 3 * g));
            sharing++;
        }
    assert_true(sharing > 0 || read->witness_count == 0 || s->guards->count > read->bound);
    starg_certificate_outline_free(s->context, o);
}

static void check_right(const subject *s) {
    bool of_points = s->guards->options.visibility.target == STARG_TARGET_POINTS;
    starg_certificate *read = NULL;
    starg_verdict *verdict = NULL;
    test_ok(s->context, starg_certificate_read_memory(s->context, s->text, s->size, "c", &read));
    assert_int_equal(read->bound, s->guards->lower_bound_everywhere);
    test_ok(s->context, starg_verify_guards_with(s->context, s->mesh,
                                                 &(starg_guards_evidence){.certificate = read},
                                                 s->guards, &verdict));
    for (size_t i = 0; i < verdict->count; i++)
        if (!verdict->claims[i].holds)
            print_message("%s\n", verdict->claims[i].text);
    assert_true(verdict->passed);
    assert_true(says(verdict, true, "wherever they stand"));
    for (size_t i = 0; i < verdict->not_checked_count; i++)
        assert_null(strstr(verdict->not_checked[i].text, "wherever"));
    assert_true(!of_points || says(verdict, true, "to see every point of the boundary"));
    if (!of_points)
        check_outline(s, read);
    starg_verdict_free(s->context, verdict);
    starg_certificate_free(read);
}

static void test_samples(void **state) {
    (void)state;
    static const char *const names[] = {"l-room", "gallery", "horse", "human"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        subject s = prove_sample(names[i], 500, 200000);
        check_right(&s);
        print_message("%s: %zu guards, bound %zu, %zu bytes\n", names[i], s.guards->count,
                      s.guards->lower_bound_everywhere, s.size);
        subject_free(&s);
    }
}

/* Real models with default options; the slower ones in check-long. */
static void test_shared(void **state) {
    (void)state;
    static const char *const names[] = {"table2/kitten_400", "solids/hand_1197",
                                        "solids/knight_502", "solids/hand_8k",
                                        "retrieval_shrec07/airplane_062"};
    const char *data = test_shared_data();
    if (data == NULL)
        skip();
    for (size_t i = 0; i < test_rounds(3, 5); i++) {
        char path[4400];
        starg_context *context = test_context(2);
        starg_mesh *mesh = NULL;
        starg_solid *solid = NULL;
        starg_guard_options options;
        snprintf(path, sizeof path, "%s/%s.off", data, names[i]);
        starg_guard_options_default(&options);
        options.prove = true;
        test_ok(context, starg_mesh_read(context, path, &mesh));
        test_ok(context, starg_solid_create(context, mesh, &solid));
        subject s = prove(context, solid, &options);
        check_right(&s);
        print_message("%s: %zu guards, bound %zu, %zu bytes%s\n", names[i], s.guards->count,
                      s.guards->lower_bound_everywhere, s.size,
                      strstr(s.text, "\n=") != NULL ? ", with rows" : "");
        starg_mesh_free(mesh);
        subject_free(&s);
    }
}

static void test_random_solids(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    size_t branched = 0, above = 0, rounds = test_rounds(4, 300);
    for (uint64_t item = 0; item < rounds; item++) {
        shape made = item % 4 == 0 ? shape_blob(2, item) : shape_heap(5, item);
        starg_mesh *mesh = test_mesh_of(context, &made);
        starg_solid *solid = NULL;
        if (starg_solid_create(context, mesh, &solid) == STARG_OK) {
            const starg_guard_options options = proving(200000);
            subject s = prove(context, solid, &options);
            check_right(&s);
            branched += strstr(s.text, "\nwitness ") != NULL || strstr(s.text, "\n=") != NULL;
            above += s.guards->lower_bound_everywhere > 1;
            subject_clear(&s);
        }
        starg_solid_free(solid);
        starg_mesh_free(mesh);
        shape_free(&made);
    }
    print_message("%zu bounds above 1, %zu of them by rows\n", above, branched);
    assert_true(above > 0);
    test_context_free(context);
}

/* Vertices, a range, whole faces, a distance from the walls, two guards per face, and cones. */
static void test_questions(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    shape made = shape_columns();
    starg_solid *solid = test_solid_of(context, &made);
    for (int question = 0; question < 6; question++) {
        starg_guard_options options = proving(200000);
        if (question == 0)
            options.visibility.target = STARG_TARGET_VERTICES;
        else if (question == 1)
            options.visibility.range = 3;
        else if (question == 2)
            options.visibility.face_rule = STARG_FACES_WHOLE;
        else if (question == 3)
            options.clearance = 0.2;
        else if (question == 4)
            options.redundancy = 2;
        else
            options.visibility.cone = 150;
        subject s = prove(context, solid, &options);
        assert_true(s.guards->lower_bound_everywhere > 1);
        check_right(&s);
        subject_clear(&s);
    }
    starg_solid_free(solid);
    shape_free(&made);
    test_context_free(context);
}

/* One guard is enough, or nothing can be seen. */
static void test_trivial(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape made = shape_cube(2);
    starg_solid *solid = test_solid_of(context, &made);
    starg_guard_options options = proving(1000);
    subject s = prove(context, solid, &options);
    assert_int_equal(s.guards->lower_bound_everywhere, 1);
    check_right(&s);
    subject_clear(&s);
    starg_solid_free(solid);
    shape_free(&made);
    test_context_free(context);
}

static void test_same_bytes(void **state) {
    (void)state;
    subject first = prove_sample("gallery", 500, 200000);
    for (int threads = 1; threads <= 5; threads += 4) {
        starg_context *context = test_context(threads);
        const starg_guard_options options = proving(200000);
        subject again = prove(context, test_sample(context, "gallery", 500), &options);
        assert_string_equal(first.text, again.text);
        subject_free(&again);
    }
    subject_free(&first);
}

static void test_needs_prove(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_solid *solid = test_sample(context, "l-room", 500);
    starg_guard_options options = proving(1000);
    starg_guards *guards;
    char *text;
    size_t size;
    options.prove = false;
    assert_int_equal(starg_guard_certified(context, solid, &options, &guards, &text, &size),
                     STARG_ERROR_ARGUMENT);
    assert_true(guards == NULL && text == NULL);
    starg_solid_free(solid);
    test_context_free(context);
}

/* ---- damaged ones ---- */

typedef struct number {
    size_t at, length;
} number;

/* All runs of digits in the text except in the first line, which is the format's name. */
static number *find_numbers(const char *text, size_t *count) {
    number *list = NULL;
    *count = 0;
    for (size_t i = (size_t)(strchr(text, '\n') - text); text[i] != '\0'; i++) {
        number one = {i, 0};
        while (isdigit((unsigned char)text[i + one.length]))
            one.length++;
        if (one.length == 0)
            continue;
        list = realloc(list, (*count + 1) * sizeof *list);
        assert_non_null(list);
        list[(*count)++] = one;
        i += one.length;
        if (text[i] == '\0')
            break;
    }
    return list;
}

/* Another number: close, of similar size, or arbitrary. */
static unsigned long long other_number(unsigned long long value, unsigned long long elsewhere,
                                       starg_rng *rng) {
    switch (starg_rng_below(rng, 6)) {
    case 0:
        return value + 1;
    case 1:
        return value > 0 ? value - 1 : 1;
    case 2:
        return starg_rng_below(rng, 2 * value + 2);
    case 3:
        return elsewhere;
    case 4:
        return value * 10 + starg_rng_below(rng, 10);
    default:
        return starg_rng_below(rng, UINT64_C(1) << starg_rng_below(rng, 50));
    }
}

static char *damage(const char *text, const number *numbers, size_t count, starg_rng *rng) {
    const number *one = &numbers[starg_rng_below(rng, count)];
    const number *other = &numbers[starg_rng_below(rng, count)];
    unsigned long long value = strtoull(text + one->at, NULL, 10);
    size_t length = strlen(text) + 32;
    char *out = malloc(length);
    assert_non_null(out);
    unsigned long long changed = other_number(value, strtoull(text + other->at, NULL, 10), rng);
    snprintf(out, length, "%.*s%llu%s", (int)one->at, text, changed == value ? value + 7 : changed,
             text + one->at + one->length);
    return out;
}

/* What a certificate claims about a model, and whether all of it is accepted. */
static bool is_accepted(const subject *s, const char *text, size_t *bound, size_t *unread) {
    starg_certificate *read = NULL;
    starg_verdict *verdict = NULL;
    starg_status status =
        starg_certificate_read_memory(s->context, text, strlen(text), "damaged", &read);
    if (status != STARG_OK) {
        assert_int_equal(status, STARG_ERROR_FORMAT);
        assert_non_null(strstr(starg_context_error(s->context)->message, "line"));
        ++*unread;
        return false;
    }
    s->guards->lower_bound_everywhere = *bound = read->bound;
    test_ok(s->context, verify_verdict_create(s->context, &verdict));
    test_ok(s->context, verify_claim_everywhere(verdict, &s->known, read));
    bool passed = verdict->passed;
    starg_verdict_free(s->context, verdict);
    starg_certificate_free(read);
    return passed;
}

/* No bound above the proven one is accepted: that would take a better proof, not damage. */
static void check_damaged(subject *s, size_t rounds) {
    size_t count, accepted = 0, unread = 0, proven = s->guards->lower_bound_everywhere;
    number *numbers = find_numbers(s->text, &count);
    for (size_t i = 0; i < rounds; i++) {
        starg_rng rng = starg_rng_make(21, 3, i);
        char *text = damage(s->text, numbers, count, &rng);
        size_t bound = 0;
        if (is_accepted(s, text, &bound, &unread)) {
            if (bound > proven)
                fail_msg("round %zu: a bound of %zu is accepted, and %zu was proven", i, bound,
                         proven);
            accepted++;
        }
        free(text);
    }
    print_message("bound %zu, %zu numbers: of %zu damages %zu are unreadable, %zu refused, %zu "
                  "harmless\n",
                  proven, count, rounds, unread, rounds - unread - accepted, accepted);
    assert_true(accepted < rounds - rounds / 4); /* small ones have much that does not matter */
    free(numbers);
}

/* Proves something about a small shape (consumed), and damages the certificate. */
static void damage_shape(shape made, size_t rounds) {
    starg_context *context = test_context(2);
    starg_mesh *mesh = test_mesh_of(context, &made);
    const starg_guard_options options = proving(200000);
    starg_solid *solid = NULL;
    shape_free(&made);
    if (starg_solid_create(context, mesh, &solid) != STARG_OK) {
        starg_mesh_free(mesh);
        test_context_free(context);
        return;
    }
    subject s = prove(context, solid, &options);
    if (s.guards->lower_bound_everywhere > 1)
        check_damaged(&s, rounds);
    starg_mesh_free(mesh);
    subject_free(&s);
}

static void test_damaged(void **state) {
    (void)state;
    subject gallery = prove_sample("gallery", 500, 200000);
    check_damaged(&gallery, test_rounds(DAMAGED / 400, DAMAGED));
    subject_free(&gallery);
    damage_shape(shape_columns(), test_rounds(DAMAGED / 40, DAMAGED));
    for (uint64_t item = 1; item < 4 + test_rounds(0, 4); item++)
        damage_shape(shape_heap(5, item), test_rounds(DAMAGED / 200, DAMAGED));
}

/* ---- conclusions from what leaves may see ---- */

static void put_set(FILE *stream, const char *before, uint64_t set, const char *behind) {
    for (int j = 0; j < 64; j++)
        if (set >> j & 1)
            fprintf(stream, "%s%d%s", before, j, behind);
}

/* The lines before the rows. `size` has to live as long as the stream. */
static FILE *begin_certificate(size_t witnesses, size_t bound, char **text, size_t *size) {
    FILE *stream = open_memstream(text, size);
    assert_non_null(stream);
    fprintf(stream,
            "starguard-certificate 2\nvertices 99\nfaces 99\nchecksum 0123456789abcdef\n"
            "target faces\nrange none\nclearance 0:0\nredundancy 1\nbound %zu\nroot 0:0 0:0 0:0 "
            "1:0 1:0 1:0\n",
            bound);
    fprintf(stream, "witnesses %zu\n", witnesses);
    put_set(stream, "", (UINT64_C(1) << witnesses) - 1, "\n");
    return stream;
}

static void put_leaves(FILE *stream, const witness_row *const *rows, size_t count, size_t witnesses,
                       bool named) {
    fprintf(stream, "cells %zu\n", 2 * count - 1);
    for (size_t i = 0; i < count; i++) {
        fprintf(stream, i + 1 < count ? "x\n" : "");
        if (named)
            fprintf(stream, "=%zu", i);
        else
            fprintf(stream, ".");
        put_set(stream, " ", ((UINT64_C(1) << witnesses) - 1) & ~rows[i]->bits[0], "n");
        fprintf(stream, "\n");
    }
}

/* A certificate of random rows without a model: each row is what one leaf may see. */
static char *certificate_of_rows(const witness_row *const *rows, size_t count, size_t witnesses,
                                 size_t bound, const branch_record *record) {
    char *text = NULL;
    size_t size;
    FILE *stream = begin_certificate(witnesses, bound, &text, &size);
    fprintf(stream, "rows %zu\n", count);
    for (size_t i = 0; i < count; i++) {
        uint64_t lowest = rows[i]->bits[0] & -rows[i]->bits[0];
        put_set(stream, "", lowest, "");
        put_set(stream, " ", rows[i]->bits[0] & ~lowest, "");
        fprintf(stream, "\n");
    }
    put_leaves(stream, rows, count, witnesses, true);
    fprintf(stream, "nodes %zu\n", record->nodes.count);
    for (size_t i = 0; i < record->nodes.count; i++) {
        const branch_node *node = &record->nodes.data[i];
        const uint64_t *numbers = record->numbers.data + node->first;
        bool prices = node->witness == UINT32_MAX;
        fprintf(stream, prices ? "prices" : "witness %u", node->witness);
        for (size_t k = 0; k < node->count; k++)
            fprintf(stream, "%c%llu", prices && k % 2 != 0 ? ':' : ' ',
                    (unsigned long long)numbers[k]);
        fprintf(stream, "\n");
    }
    fclose(stream);
    return text;
}

/* The same, proven by prices of witnesses and odd sets. */
static char *certificate_of_prices(const witness_row *const *rows, size_t count, size_t witnesses,
                                   size_t bound, const whole_prices *prices) {
    char *text = NULL;
    size_t size;
    FILE *stream = begin_certificate(witnesses, bound, &text, &size);
    fprintf(stream, "rows 0\n");
    put_leaves(stream, rows, count, witnesses, false);
    fprintf(stream, "nodes 1\nprices");
    for (size_t j = 0; j < witnesses; j++)
        fprintf(stream, " %zu:%llu", j, (unsigned long long)prices->price[j]);
    for (size_t k = 0; k < prices->sets.count; k++) {
        const odd_set *set = &prices->sets.set[k];
        for (size_t i = 0; i < set->count; i++)
            fprintf(stream, "%c%u", i == 0 ? ' ' : '+', set->witness[i]);
        fprintf(stream, ":%llu", (unsigned long long)prices->odd[k]);
    }
    fprintf(stream, "\n");
    fclose(stream);
    return text;
}

/* The fewest sets that cover everything, by exhaustive search. */
static size_t fewest(const uint64_t *sets, size_t count, uint64_t left, size_t most) {
    size_t best = SIZE_MAX;
    if (left == 0)
        return 0;
    for (size_t i = 0; i < count && most > 0; i++)
        if (sets[i] & left & -left) {
            size_t rest = fewest(sets, count, left & ~sets[i], most - 1);
            best = rest < best ? rest + 1 : best;
        }
    return best;
}

/* What the leaves may see; cells follow the x that cuts them, and one half is a leaf. */
static size_t leaf_sets(const starg_certificate *read, uint64_t *sets) {
    size_t count = 0;
    uint64_t above = 0; /* hidden from the enclosing cells */
    for (size_t i = 0; i < read->cell_count; i++) {
        uint64_t hidden = 0;
        for (size_t k = 0; k < read->cells[i].count; k++)
            hidden |= UINT64_C(1) << read->reasons.data[read->cells[i].first + k].witness;
        if (read->cells[i].kind < EVERYWHERE_LEAF)
            above |= hidden;
        else if (read->cells[i].kind == EVERYWHERE_LEAF)
            sets[count++] = ((UINT64_C(1) << read->witness_count) - 1) & ~(above | hidden);
    }
    return count;
}

/* If the bound is accepted, asserts that it is true; returns whether it is accepted. */
static bool check_follows(starg_context *context, const char *text) {
    starg_certificate *read = NULL;
    everywhere_words why;
    bool follows = false;
    if (starg_certificate_read_memory(context, text, strlen(text), "rows", &read) != STARG_OK)
        return false;
    test_ok(context, verify_check_bound(read, &follows, &why));
    if (follows && read->bound > 1 && read->witness_count < 64) {
        uint64_t sets[256];
        assert_true(read->cell_count < 256);
        size_t count = leaf_sets(read, sets);
        uint64_t all = (UINT64_C(1) << read->witness_count) - 1;
        size_t needed = fewest(sets, count, all, read->bound);
        if (needed < read->bound)
            fail_msg("%zu sets hold all, and a bound of %zu follows from\n%s", needed, read->bound,
                     text);
    }
    starg_certificate_free(read);
    return follows;
}

/* Random rows over some witnesses, and the fewest that cover them, or 3 where none do. */
typedef struct random_rows {
    witness_row rows[24], wanted;
    const witness_row *list[24];
    size_t count, witnesses, bound;
} random_rows;

static void draw_rows(starg_rng *rng, random_rows *r) {
    uint64_t sets[24];
    *r = (random_rows){.count = 12 + starg_rng_below(rng, 13)};
    r->witnesses = 8 + starg_rng_below(rng, 13);
    double share = 0.2 + 0.2 * starg_rng_unit(rng);
    r->wanted.bits[0] = (UINT64_C(1) << r->witnesses) - 1;
    for (size_t i = 0; i < r->count; i++) {
        starg_bit_set(r->rows[i].bits, starg_rng_below(rng, r->witnesses));
        for (size_t j = 0; j < r->witnesses; j++)
            if (starg_rng_unit(rng) < share)
                starg_bit_set(r->rows[i].bits, j);
        r->list[i] = &r->rows[i];
        sets[i] = r->rows[i].bits[0];
    }
    size_t needed = fewest(sets, r->count, r->wanted.bits[0], r->count);
    r->bound = needed > r->count ? 3 : needed;
}

/* A proof that holds and its damaged copies: whatever follows is true. Returns the number of copies
 * that are harmless. */
static size_t check_copies(starg_context *context, char *text, starg_rng *rng, size_t copies) {
    size_t places, accepted = 0;
    number *numbers = find_numbers(text, &places);
    assert_true(check_follows(context, text));
    for (size_t k = 0; k < copies; k++) {
        char *other = damage(text, numbers, places, rng);
        accepted += check_follows(context, other);
        free(other);
    }
    free(numbers);
    free(text);
    return accepted;
}

enum { COPIES = 30 };

static void test_rows(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t proofs = 0, branched = 0, accepted = 0, rounds = test_rounds(225, 20000);
    for (uint64_t item = 0; item < rounds; item++) {
        starg_rng rng = starg_rng_make(31, 4, item);
        random_rows r;
        branch_record record = {0};
        uint64_t work = 0;
        bool proven = false;
        draw_rows(&rng, &r);
        const branch_question question = {r.list, r.count, &r.wanted, r.bound - 1, 100000};
        if (r.bound > 1)
            test_ok(context, bound_by_branching(context, &question, &proven, &record, &work));
        if (proven) {
            char *text = certificate_of_rows(r.list, r.count, r.witnesses, r.bound, &record);
            accepted += check_copies(context, text, &rng, COPIES);
            proofs++;
            branched += record.nodes.count > 1;
        }
        branch_record_free(&record);
    }
    print_message("%zu proofs, %zu with branches; %zu of %zu damaged ones are harmless\n", proofs,
                  branched, accepted, COPIES * proofs);
    assert_true(30 * branched > rounds && accepted < COPIES * proofs);
    test_context_free(context);
}

/* Prices of all rows, some of them empty, with as many odd sets as are found. */
static void find_prices(starg_context *context, const random_rows *r, whole_prices *whole) {
    odd_sets sets = {0};
    size_t added = 1;
    uint64_t work = 0;
    for (int round = 0; round < 5 && added > 0; round++) {
        witness_prices prices;
        test_ok(context, prices_find(context, r->list, r->count, &r->wanted, &sets, &prices));
        bound_round(&prices, &sets, whole);
        const odd_sets_question question = {r->list, prices.share, r->count, prices.price};
        test_ok(context, odd_sets_renew(context, &question, &sets, prices.odd, &added, &work));
        prices_free(&prices);
    }
}

static void test_odd_sets(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t proofs = 0, odd = 0, accepted = 0;
    for (uint64_t item = 0; item < test_rounds(150, 20000); item++) {
        starg_rng rng = starg_rng_make(33, 4, item);
        random_rows r;
        whole_prices whole;
        witness_row held = {{0}};
        draw_rows(&rng, &r);
        for (size_t i = 0; i < r.count; i++)
            held.bits[0] |= r.rows[i].bits[0];
        if (held.bits[0] != r.wanted.bits[0])
            continue;
        find_prices(context, &r, &whole);
        size_t bound = bound_of_prices(r.list, r.count, &whole, 1);
        assert_true(bound <= r.bound);
        if (bound < 2)
            continue;
        char *text = certificate_of_prices(r.list, r.count, r.witnesses, bound, &whole);
        odd += strchr(text, '+') != NULL;
        accepted += check_copies(context, text, &rng, COPIES);
        proofs++;
        text = certificate_of_prices(r.list, r.count, r.witnesses, bound + 1, &whole);
        assert_false(check_follows(context, text));
        free(text);
    }
    print_message("%zu proofs, %zu with odd sets; %zu of %zu damaged ones are harmless\n", proofs,
                  odd, accepted, COPIES * proofs);
    assert_true(odd > 10 && accepted < COPIES * proofs);
    test_context_free(context);
}

/* Three leaves that see two of three witnesses each: two guards, by one odd set. */
static void test_one_odd_set(void **state) {
    (void)state;
    static const struct {
        int bound;
        const char *prices;
        bool read, follows;
    } proofs[] = {
        {2, "0+1+2:1", true, true},     {3, "0+1+2:1", true, false},
        {2, "0:1 1:1 2:1", true, true}, {3, "0:1 1:1 2:1 0+1+2:7", true, false},
        {2, "0+1:1", false, false},     {2, "0+2+1:1", false, false},
        {2, "0+1+1:1", false, false},   {2, "0+1+3:1", false, false},
        {2, "0+1+2", false, false},
    };
    starg_context *context = test_context(1);
    for (size_t i = 0; i < sizeof proofs / sizeof *proofs; i++) {
        char *text = NULL;
        size_t size;
        const witness_row rows[3] = {{{3}}, {{6}}, {{5}}};
        const witness_row *list[3] = {&rows[0], &rows[1], &rows[2]};
        FILE *stream = begin_certificate(3, (size_t)proofs[i].bound, &text, &size);
        starg_certificate *read = NULL;
        fprintf(stream, "rows 0\n");
        put_leaves(stream, list, 3, 3, false);
        fprintf(stream, "nodes 1\nprices %s\n", proofs[i].prices);
        fclose(stream);
        starg_status status =
            starg_certificate_read_memory(context, text, strlen(text), "c", &read);
        assert_int_equal(status == STARG_OK, proofs[i].read);
        starg_certificate_free(read);
        assert_int_equal(check_follows(context, text), proofs[i].follows);
        free(text);
    }
    test_context_free(context);
}

/* Proofs by rows of one or two witnesses: valid ones, and nearly valid ones. */
static void test_false_proofs(void **state) {
    (void)state;
    static const char APART[] = "rows 2\n0\n1\ncells 3\nx\n=0 1n\n=1 0n\n";
    static const char BOTH[] = "rows 2\n0\n0 1\ncells 3\nx\n=0 1n\n=1\n";
    static const char FIRST[] = "rows 2\n0\n0\ncells 3\nx\n=0 1n\n=1 1n\n";
    static const struct {
        int bound;
        const char *rows, *nodes;
        bool follows;
    } proofs[] = {
        {2, APART, "nodes 1\nprices 0:1 1:1\n", true},
        {3, APART, "nodes 1\nprices 0:1 1:1\n", false},
        {2, APART, "nodes 1\nwitness 0 0\n", true},
        {2, BOTH, "nodes 1\nwitness 0 0\n", false},
        {2, BOTH, "nodes 1\nwitness 0 1\n", false},
        {2, APART, "nodes 1\nwitness 0\n", false},
        {2, APART, "nodes 2\nwitness 0 0\nprices\n", false},
        {2, APART, "nodes 1\nprices 0:1 0:1 1:1\n", true},
        {2, APART, "nodes 1\nprices 0:1 0:1\n", false},
        {2, APART, "nodes 1\nprices\n", false},
        {2, APART, "nodes 0\n", false},
        {3, APART, "nodes 2\nwitness 0 0\nwitness 1 1\n", false},
        {3, FIRST, "nodes 2\nwitness 0 0\nwitness 1\n", true},
        {3, FIRST, "nodes 3\nwitness 0 0 0\nwitness 1\nwitness 1\n", false},
    };
    starg_context *context = test_context(1);
    for (size_t i = 0; i < sizeof proofs / sizeof *proofs; i++) {
        char text[1000];
        starg_certificate *read = NULL;
        everywhere_words why = {""};
        bool follows;
        snprintf(text, sizeof text,
                 "starguard-certificate 1\nvertices 9\nfaces 9\nchecksum 0123456789abcdef\n"
                 "target faces\nrange none\nclearance 0:0\nredundancy 1\nbound %d\n"
                 "root 0:0 0:0 0:0 1:0 1:0 1:0\nwitnesses 2\n0\n1\n%s%s",
                 proofs[i].bound, proofs[i].rows, proofs[i].nodes);
        test_ok(context, starg_certificate_read_memory(context, text, strlen(text), "c", &read));
        test_ok(context, verify_check_bound(read, &follows, &why));
        if (follows != proofs[i].follows)
            fail_msg("proof %zu: it %s %s", i, follows ? "follows" : "does not follow:", why.text);
        starg_certificate_free(read);
    }
    test_context_free(context);
}

/* A cube of side 2: a corner of side a quarter is within half of the walls, half of the cube is
 * not. */
static void test_too_close(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape made = shape_cube(2);
    starg_guard_options options = proving(1000);
    options.clearance = 0.5;
    subject s = prove(context, test_solid_of(context, &made), &options);
    for (int wrong = 0; wrong < 4; wrong++) {
        char text[1000];
        starg_certificate *read = NULL;
        size_t cell, reason;
        snprintf(text, sizeof text,
                 "starguard-certificate 1\nvertices 9\nfaces 9\nchecksum 0123456789abcdef\n"
                 "target faces\nrange none\nclearance 1:-%d\nredundancy 1\nbound 0\n"
                 "root 0:0 0:0 0:0 1:1 1:1 1:1\nwitnesses 0\nrows 0\ncells 19\n"
                 "x\ny\nz\nx\ny\nz\nx\ny\nz\n%s\n.\n.\n.\n.\n.\n.\n.\n.\n%s\nnodes 0\n",
                 wrong == 1 ? 2 : 1, wrong == 2 ? "o" : "c", wrong == 3 ? "c" : ".");
        test_ok(context, starg_certificate_read_memory(context, text, strlen(text), "c", &read));
        test_ok(context, verify_check_cells(read, &s.known, &cell, &reason));
        assert_int_equal(cell, wrong == 0 ? 19 : wrong == 3 ? 18 : 9);
        starg_certificate_free(read);
    }
    subject_free(&s);
    shape_free(&made);
}

/* ---- forged ones ---- */

/* Replaces the first occurrence of a text. */
static char *replaced(const char *text, const char *old, const char *new) {
    const char *at = strstr(text, old);
    size_t length = strlen(text) + strlen(new) + 1;
    char *out = malloc(length);
    assert_true(at != NULL && out != NULL);
    snprintf(out, length, "%.*s%s%s", (int)(at - text), text, new, at + strlen(old));
    return out;
}

/* The claim of the verdict that names the fault. */
static void check_refused(const subject *s, char *text, const char *why) {
    starg_certificate *read = NULL;
    starg_verdict *verdict = NULL;
    test_ok(s->context, starg_certificate_read_memory(s->context, text, strlen(text), "c", &read));
    test_ok(s->context, starg_verify_guards_with(s->context, s->mesh,
                                                 &(starg_guards_evidence){.certificate = read},
                                                 s->guards, &verdict));
    assert_false(verdict->passed);
    if (!says(verdict, false, why))
        fail_msg("no claim says \"%s\"", why);
    starg_verdict_free(s->context, verdict);
    starg_certificate_free(read);
    free(text);
}

static void check_unread(const subject *s, char *text, const char *why) {
    starg_certificate *read = NULL;
    assert_int_equal(starg_certificate_read_memory(s->context, text, strlen(text), "name", &read),
                     STARG_ERROR_FORMAT);
    assert_null(read);
    const starg_error *error = starg_context_error(s->context);
    assert_int_equal(error->element, STARG_ELEMENT_LINE);
    if (strstr(error->message, why) == NULL || strstr(error->message, "name") == NULL)
        fail_msg("\"%s\" does not say \"%s\"", error->message, why);
    free(text);
}

/* The price of the first witness, times ten. */
static char *with_higher_price(const char *text) {
    char *out = replaced(text, "\nprices ", "\nprices ");
    size_t end = (size_t)(strchr(strchr(strstr(out, "\nprices "), ':'), ' ') - out);
    char *longer = malloc(strlen(out) + 2);
    assert_non_null(longer);
    snprintf(longer, strlen(out) + 2, "%.*s0%s", (int)end, out, out + end);
    free(out);
    return longer;
}

/* Replaces the first line after the number of cells, or of nodes, that starts with a character. */
static char *with_line(const char *text, const char *behind, char begin, const char *line) {
    const char *at = strstr(text, behind) + 1;
    do
        at = strchr(at, '\n') + 1;
    while (*at != begin);
    size_t length = strlen(text) + strlen(line) + 1;
    char *out = malloc(length);
    assert_non_null(out);
    snprintf(out, length, "%.*s%s%s", (int)(at - text), text, line, strchr(at, '\n') + 1);
    return out;
}

static void test_forged(void **state) {
    (void)state;
    subject s = prove_sample("horse", 500, 200000);
    subject other = prove_sample("gallery", 500, 200000);
    char line[64], wanted[64];
    size_t bound = s.guards->lower_bound_everywhere;
    assert_true(bound > 1);
    check_right(&s);
    check_refused(&s, replaced(other.text, "range", "range"), "another model");
    snprintf(line, sizeof line, "\nbound %zu\n", bound);
    snprintf(wanted, sizeof wanted, "\nbound %zu\n", bound + 1);
    check_refused(&s, replaced(s.text, line, wanted), "does not follow");
    check_refused(&s, replaced(s.text, "range none", "range 3:0"), "range is another");
    check_refused(&s, with_line(s.text, "\nnodes ", 'p', "prices 0:1\n"), "worth too much");
    check_refused(&s, with_higher_price(s.text), "worth too much");
    check_refused(&s, with_line(s.text, "\ncells ", '.', ". 0n 1n 2n 3n 4n 5n 6n 7n 8n 9n\n"),
                  "reasons of the certificate are right");
    check_refused(&s, with_line(s.text, "\ncells ", '.', "o\n"), "no guard may stand");
    check_refused(&s, with_line(s.text, "\ncells ", '.', "c\n"), "no guard may stand");
    check_refused(&s, replaced(s.text, "clearance 0:0", "clearance 1:0"), "clearance is another");
    check_refused(&s, replaced(s.text, "redundancy 1", "redundancy 2"), "redundancy is another");
    check_refused(&s, with_line(s.text, "\ncells ", '.', ".\n"), "worth too much");
    check_unread(&s, with_line(s.text, "\ncells ", '.', "?\n"), "a cell is expected");
    check_unread(&s, with_line(s.text, "\ncells ", '.', "x\n"), "cell");
    check_unread(&s, replaced(s.text, "target faces", "target edges"), "line 5: \"faces\"");

    s.guards->options.coverage = 0.9;
    check_refused(&s, replaced(s.text, "range", "range"), "see a part");
    s.guards->options.coverage = 1;
    s.guards->lower_bound_everywhere = s.guards->lower_bound = s.guards->count = bound;
    s.guards->optimal = s.guards->optimal_everywhere = true;
    snprintf(wanted, sizeof wanted, "\nbound %zu\n", bound - 1);
    check_refused(&s, replaced(s.text, line, wanted), "says no more than");
    subject_free(&s);
    subject_free(&other);
}

/* ---- points ---- */

static subject prove_points(starg_context *context, starg_solid *solid) {
    starg_guard_options options = proving(200000);
    options.visibility.target = STARG_TARGET_POINTS;
    return prove(context, solid, &options);
}

/* The certificate with another first witness: `face` and what stands behind it. */
static char *with_witness(const char *text, const char *witness) {
    const char *at = strchr(strstr(text, "\nwitnesses ") + 1, '\n') + 1;
    char old[64];
    snprintf(old, sizeof old, "\n%.*s\n", (int)(strchr(at, '\n') - at), at);
    return replaced(text, old, witness);
}

/* With other letters, or without the reason: each in turn, at most `most` of them. */
static void forge_reasons(subject *s, size_t most) {
    static const char letters[] = "nrspfeRSPFE";
    const char *end = strstr(s->text, "\nnodes ");
    size_t refused = 0, tried = 0, unread = 0, proven = s->guards->lower_bound_everywhere;
    for (const char *at = strstr(s->text, "\ncells ") + 7; at < end && tried < most; at++) {
        if (*at != ' ')
            continue;
        size_t begin = (size_t)(at - s->text), length = 1 + strcspn(at + 1, " \n");
        size_t letter = begin + 1 + strspn(at + 1, "0123456789"), bound = 0;
        char *text = strdup(s->text);
        assert_non_null(text);
        if (tried % 2 == 0)
            text[letter] = letters[tried / 2 % (sizeof letters - 1)];
        else
            memmove(text + begin, text + begin + length, strlen(text + begin + length) + 1);
        bool accepted = is_accepted(s, text, &bound, &unread);
        assert_true(!accepted || bound <= proven);
        refused += !accepted;
        tried++;
        free(text);
    }
    s->guards->lower_bound_everywhere = proven;
    print_message("of %zu reasons that were changed or dropped %zu are refused\n", tried, refused);
    assert_true(2 * refused > tried);
}

/* Its first witness elsewhere in its face or in another one: that is refused, or proves no more. */
static void forge_witnesses(subject *s, size_t rounds) {
    size_t refused = 0, unread = 0, proven = s->guards->lower_bound_everywhere;
    for (size_t i = 0; i < rounds; i++) {
        starg_rng rng = starg_rng_make(8, 4, i);
        const char *at = strchr(strstr(s->text, "\nwitnesses ") + 1, '\n') + 1;
        unsigned long face = strtoul(at, NULL, 10);
        unsigned a = (unsigned)starg_rng_below(&rng, 17),
                 b = (unsigned)starg_rng_below(&rng, 17 - a);
        char witness[64];
        size_t bound = 0;
        if (i % 2 == 1)
            face = (unsigned long)starg_rng_below(&rng, s->known.surface->face_count);
        snprintf(witness, sizeof witness, "\n%lu %u %u %u 4\n", face, a, b, 16 - a - b);
        char *text = with_witness(s->text, witness);
        bool accepted = is_accepted(s, text, &bound, &unread);
        assert_true(!accepted || bound <= proven);
        refused += !accepted;
        free(text);
    }
    s->guards->lower_bound_everywhere = proven;
    print_message("of %zu witnesses that were moved %zu are refused\n", rounds, refused);
    assert_true(refused > 0);
}

static void check_points(subject *s) {
    char line[64], wanted[64];
    size_t bound = s->guards->lower_bound_everywhere;
    check_right(s);
    assert_non_null(strstr(s->text, "starguard-certificate 5\n"));
    check_unread(s, with_witness(s->text, "\n0 1 1 1 2\n"), "do not sum to 2");
    check_unread(s, with_witness(s->text, "\n0 1 1 2\n"), "is expected");
    check_unread(s, with_witness(s->text, "\n0 1 0 0 29\n"), "out of range");
    check_unread(s, replaced(s->text, "target points", "target faces"), "\"points\"");
    check_unread(s, replaced(s->text, "certificate 5", "certificate 4"), "\"faces\"");
    check_refused(s, with_higher_price(s->text), "does not follow");
    snprintf(line, sizeof line, "\nbound %zu\n", bound);
    snprintf(wanted, sizeof wanted, "\nbound %zu\n", bound + 1);
    check_refused(s, replaced(s->text, line, wanted), "does not follow");
    /* faces and points have certificates of their own */
    s->guards->options.visibility.target = STARG_TARGET_FACES;
    check_refused(s, replaced(s->text, "range", "range"), "its targets are others");
    s->guards->options.visibility.target = STARG_TARGET_POINTS;
    forge_reasons(s, 100);
    forge_witnesses(s, 60);
    check_damaged(s, test_rounds(DAMAGED / 100, DAMAGED));
    s->guards->lower_bound_everywhere = bound;
}

static void test_points(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    shape made = shape_columns();
    subject columns = prove_points(context, test_solid_of(context, &made));
    assert_true(columns.guards->lower_bound_everywhere > 1);
    check_points(&columns);
    shape_free(&made);
    subject_free(&columns);
    if (test_rounds(0, 1) == 0)
        return;
    context = test_context(2);
    subject horse = prove_points(context, test_sample(context, "horse", 500));
    check_points(&horse);
    subject_free(&horse);
}

/* Does a place in the solid see the point, past all faces? */
static bool sees(const verify_surface *surface, const double p[3], uint32_t face,
                 const verify_spot *point) {
    const double *t[3];
    bool on_surface;
    verify_corners(surface, face, t);
    if (verify_side(t[0], t[1], t[2], p) <= 0 ||
        verify_winding(surface, NULL, surface->face_count, p, &on_surface) < 1 || on_surface)
        return false;
    for (size_t f = 0; f < surface->face_count; f++) {
        verify_corners(surface, f, t);
        if (verify_blocks_from(verify_side(t[0], t[1], t[2], p), p, point, t))
            return false;
    }
    return true;
}

/* A box of a few sizes about a place in the solid's bounds, and a point between vertices. */
static uint32_t make_question(const verify_surface *surface, starg_rng *rng, verify_box *box,
                              uint32_t weight[3]) {
    for (int k = 0; k < 3; k++) {
        double extent = surface->upper[k] - surface->lower[k];
        double a = surface->lower[k] + extent * starg_rng_unit(rng);
        box->lower[k] = a;
        box->upper[k] = a + extent * ldexp(1, -1 - (int)starg_rng_below(rng, 6));
    }
    int depth = 2 + (int)starg_rng_below(rng, 27);
    uint32_t all = UINT32_C(1) << depth, unit = UINT32_C(1) << (VERIFY_UNIT_BITS - depth);
    uint32_t first = 1 + (uint32_t)starg_rng_below(rng, all - 1);
    uint32_t second = (uint32_t)starg_rng_below(rng, all - first + 1);
    weight[0] = first * unit;
    weight[1] = second * unit;
    weight[2] = (all - first - second) * unit;
    return (uint32_t)starg_rng_below(rng, surface->face_count);
}

/* Whatever is said to be hidden from a box is hidden from places in it, one by one. */
static void test_hidden_points(void **state) {
    (void)state;
    static const char kinds[] = "npPeE";
    starg_context *context = test_context(1);
    shape made = shape_columns();
    starg_mesh *mesh = test_mesh_of(context, &made);
    verify_surface *surface = NULL;
    verify_tree *tree = NULL;
    verify_scene scene;
    verify_watch *watch = NULL;
    size_t hidden[5] = {0}, rounds = test_rounds(1500, 60000);
    test_ok(context, verify_surface_create(context, mesh, &surface));
    test_ok(context, verify_tree_create(surface, &tree));
    test_ok(context, verify_scene_create(surface, tree, true, &scene));
    test_ok(context, verify_watch_create(&scene, &watch));
    for (size_t i = 0; i < rounds; i++) {
        starg_rng rng = starg_rng_make(5, 77, i);
        verify_box box;
        uint32_t weight[3];
        uint32_t face = make_question(surface, &rng, &box, weight);
        const verify_mix mix = verify_mix_of(surface, face, weight);
        const verify_spot point = verify_mix_spot(surface, &mix, verify_blur(surface));
        verify_watch_box(watch, &box);
        bool any = false;
        for (size_t k = 0; k < 5; k++) {
            bool clipped = kinds[k] < 'a', patch = kinds[k] == 'p' || kinds[k] == 'P', it = false;
            char kind = clipped ? (char)(kinds[k] - 'A' + 'a') : kinds[k];
            for (uint32_t seed = 0; seed < (patch ? surface->face_count : 1) && !it; seed++) {
                const verify_reason reason = {0, UINT32_MAX, seed, kind, clipped};
                it = verify_box_hides_point(watch, face, &point, INFINITY, &reason);
            }
            hidden[k] += it;
            any = any || it;
        }
        for (int place = 0; place < 10 && any; place++) {
            double p[3];
            for (int k = 0; k < 3; k++)
                p[k] = fmin(box.lower[k] + (box.upper[k] - box.lower[k]) *
                                               (place < 8 ? place >> k & 1 : starg_rng_unit(&rng)),
                            box.upper[k]);
            if (sees(surface, p, face, &point))
                fail_msg("round %zu: place %d sees what is hidden", i, place);
        }
    }
    print_message("hidden by planes %zu, patches %zu and %zu, entries %zu and %zu\n", hidden[0],
                  hidden[1], hidden[2], hidden[3], hidden[4]);
    for (int k = 0; k < 5; k++)
        assert_true(hidden[k] > 0);
    verify_watch_free(watch);
    verify_scene_free(&scene);
    verify_tree_free(tree);
    verify_surface_free(surface);
    starg_mesh_free(mesh);
    shape_free(&made);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_samples),       cmocka_unit_test(test_shared),
        cmocka_unit_test(test_random_solids), cmocka_unit_test(test_questions),
        cmocka_unit_test(test_trivial),       cmocka_unit_test(test_same_bytes),
        cmocka_unit_test(test_needs_prove),   cmocka_unit_test(test_damaged),
        cmocka_unit_test(test_rows),          cmocka_unit_test(test_false_proofs),
        cmocka_unit_test(test_odd_sets),      cmocka_unit_test(test_one_odd_set),
        cmocka_unit_test(test_too_close),     cmocka_unit_test(test_forged),
        cmocka_unit_test(test_points),        cmocka_unit_test(test_hidden_points),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
