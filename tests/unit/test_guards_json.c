/* SPDX-License-Identifier: Apache-2.0 */
/* Reading and rewriting GUARDS.json: nothing is lost, invented or truncated. */
#include "support.h"

#include <stdio.h>
#include <string.h>

#include "starguard/guard.h"

/* A file with some options and with or without its curve, as text. */
typedef struct file_text {
    char text[2048];
} file_text;

static file_text file_of(const char *options, const char *curve) {
    file_text file;
    snprintf(file.text, sizeof file.text,
             "{\"format\":\"starguard-guards\",\"version\":1,"
             "\"model\":{\"file\":\"m.off\",\"vertices\":4,\"faces\":4},"
             "\"options\":{\"candidates\":\"medial\",\"count\":10,\"target\":\"faces\","
             "\"faces\":\"vertices\",\"coverage\":1.0,\"max_guards\":0,\"range\":null,"
             "\"clearance\":0.0,%s},"
             "\"guards\":[{\"position\":[0.1,0.1,0.1],\"faces\":3,\"level\":0}],"
             "\"coverage\":{\"faces\":0.75,\"area\":0.7,\"coverable_faces\":3,"
             "\"uncovered_faces\":[2]%s},\"candidates\":5,\"lower_bound\":1,\"optimal\":true}",
             options, curve);
    return file;
}

static starg_guards *read_file(starg_context *context, const file_text *file) {
    starg_guards *guards = NULL;
    test_ok(context,
            starg_guards_read_memory(context, file->text, strlen(file->text), "text", &guards));
    return guards;
}

/* Writes it again, reads that and writes once more: both texts are equal; free with
 * starg_text_free. */
static char *rewrite(starg_context *context, const file_text *file) {
    char *text, *again;
    size_t size;
    starg_guards *guards = read_file(context, file), *second = NULL;
    test_ok(context, starg_guards_write_memory(context, guards, guards->file, &text, &size));
    test_ok(context, starg_guards_read_memory(context, text, size, "again", &second));
    test_ok(context, starg_guards_write_memory(context, second, second->file, &again, &size));
    assert_string_equal(text, again);
    starg_text_free(context, again);
    starg_guards_free(context, guards);
    starg_guards_free(context, second);
    return text;
}

static const char ILP[] = "\"method\":\"ilp\",\"redundancy\":1,\"cone\":null";
static const char CURVE[] = ",\"curve\":[[0.75,0.7]]";

/* Regression: writing crashed. */
static void test_file_without_curve(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    file_text with = file_of(ILP, CURVE), without = file_of(ILP, "");
    char *text = rewrite(context, &with);
    assert_non_null(strstr(text, "\"curve\":"));
    starg_text_free(context, text);
    text = rewrite(context, &without);
    assert_null(strstr(text, "\"curve\":"));
    starg_text_free(context, text);
    test_context_free(context);
}

/* Regression: they were dropped, and the step was written as -1. */
static void test_level_options_survive(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    file_text file = file_of("\"method\":\"pilp\",\"redundancy\":2,\"cone\":90,\"coarsest\":300,"
                             "\"step\":150,\"significance\":0.25,\"refine\":false",
                             CURVE);
    char *at = strstr(file.text, "\"level\":0");
    memmove(at + 9 + 20, at + 9, strlen(at + 9) + 1);
    memcpy(at + 9, ",\"direction\":[0,0,1]", 20);
    starg_guards *guards = read_file(context, &file);
    assert_int_equal(guards->options.coarsest, 300);
    assert_int_equal(guards->options.step, 150);
    assert_true(guards->options.significance == 0.25);
    assert_false(guards->options.refine);
    starg_guards_free(context, guards);
    char *text = rewrite(context, &file);
    assert_non_null(strstr(text, "\"coarsest\":300,\"step\":150"));
    assert_non_null(strstr(text, "\"refine\":false"));
    starg_text_free(context, text);
    test_context_free(context);
}

/* JSON readers hold whole numbers up to 2^63 - 1: larger ones are texts. */
static void test_seeds(void **state) {
    static const struct {
        uint64_t seed;
        const char *text;
    } seeds[] = {{1, NULL},
                 {7, "\"seed\": 7"},
                 {INT64_MAX, "\"seed\": 9223372036854775807,"},
                 {(uint64_t)INT64_MAX + 1, "\"seed\": \"9223372036854775808\""},
                 {UINT64_MAX, "\"seed\": \"18446744073709551615\""}};
    (void)state;
    starg_context *context = test_context(1);
    file_text file = file_of(ILP, CURVE);
    for (size_t i = 0; i < sizeof seeds / sizeof *seeds; i++) {
        char *text;
        size_t size;
        starg_guards *guards = read_file(context, &file);
        guards->seed = seeds[i].seed;
        test_ok(context, starg_guards_write_memory(context, guards, "m", &text, &size));
        const char *at = strstr(text, "\"seed\"");
        if (seeds[i].text == NULL)
            assert_null(at);
        else
            assert_memory_equal(at, seeds[i].text, strlen(seeds[i].text));
        starg_guards_free(context, guards);
        test_ok(context, starg_guards_read_memory(context, text, size, "again", &guards));
        assert_true(guards->seed == seeds[i].seed);
        starg_text_free(context, text);
        starg_guards_free(context, guards);
    }
    test_context_free(context);
}

static void test_wrong_seeds(void **state) {
    static const char *const seeds[] = {"\"\"",
                                        "\"7\"",
                                        "\"9223372036854775807\"",
                                        "\"18446744073709551616\"",
                                        "\"-9223372036854775808\"",
                                        "\"9223372036854775808 \"",
                                        "\"0x8000000000000000\"",
                                        "-1",
                                        "1.5"};
    (void)state;
    starg_context *context = test_context(1);
    file_text file = file_of(ILP, CURVE);
    const char *from = strstr(file.text, "\"guards\"");
    for (size_t i = 0; i < sizeof seeds / sizeof *seeds; i++) {
        char text[sizeof file.text + 64];
        starg_guards *guards;
        int size = snprintf(text, sizeof text, "%.*s\"seed\": %s, %s", (int)(from - file.text),
                            file.text, seeds[i], from);
        assert_int_equal(starg_guards_read_memory(context, text, (size_t)size, "m", &guards),
                         STARG_ERROR_FORMAT);
        assert_non_null(strstr(starg_context_error(context)->message, "\"seed\""));
    }
    test_context_free(context);
}

/* A file without the step stays without it; null means quarters. */
static void test_missing_step(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    file_text without = file_of("\"method\":\"pilp\",\"redundancy\":1,\"cone\":null", CURVE);
    char *text = rewrite(context, &without);
    assert_null(strstr(text, "\"step\""));
    starg_text_free(context, text);
    file_text quarters =
        file_of("\"method\":\"pilp\",\"redundancy\":1,\"cone\":null,\"step\":null", CURVE);
    text = rewrite(context, &quarters);
    assert_non_null(strstr(text, "\"step\":null"));
    starg_text_free(context, text);
    test_context_free(context);
}

/* Regression: casts truncated them, and a cone that is not a number became 360. */
static void test_numbers_out_of_range(void **state) {
    static const struct {
        const char *from, *to, *key;
    } changes[] = {{"\"redundancy\":1", "\"redundancy\":4294967298", "\"redundancy\""},
                   {"\"redundancy\":1", "\"redundancy\":0", "\"redundancy\""},
                   {"\"level\":0", "\"level\":4294967296", "\"level\""},
                   {"\"level\":0", "\"level\":-1", "\"level\""},
                   {"\"cone\":null", "\"cone\":\"wide\"", "\"cone\""},
                   {"\"cone\":null", "\"cone\":361", "\"cone\""}};
    (void)state;
    starg_context *context = test_context(1);
    file_text file = file_of(ILP, CURVE), changed;
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        const char *at = strstr(file.text, changes[i].from);
        starg_guards *guards = NULL;
        assert_non_null(at);
        snprintf(changed.text, sizeof changed.text, "%.*s%s%s", (int)(at - file.text), file.text,
                 changes[i].to, at + strlen(changes[i].from));
        assert_int_equal(
            starg_guards_read_memory(context, changed.text, strlen(changed.text), "text", &guards),
            STARG_ERROR_FORMAT);
        assert_null(guards);
        assert_non_null(strstr(starg_context_error(context)->message, changes[i].key));
    }
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_file_without_curve), cmocka_unit_test(test_level_options_survive),
        cmocka_unit_test(test_missing_step),       cmocka_unit_test(test_seeds),
        cmocka_unit_test(test_wrong_seeds),        cmocka_unit_test(test_numbers_out_of_range)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
