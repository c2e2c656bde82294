/* SPDX-License-Identifier: Apache-2.0 */
/* Numbers and words of text files, against strtod and by hand. */
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "mesh/formats/scan.h"
#include "support.h"

static bool parses(const char *text, double *value) {
    return starg_parse_real(text, strlen(text), value);
}

/* cmocka runs in the "C" locale, so strtod is the oracle. */
static void expect_as_strtod(const char *text) {
    double value = 0, expected = strtod(text, NULL);
    if (!parses(text, &value) || memcmp(&value, &expected, sizeof value) != 0)
        fail_msg("%s is read as %.17g", text, value);
}

static void reals_have_the_nearest_double(void **state) {
    (void)state;
    static const char *const texts[] = {"0",
                                        "-0",
                                        "0.0",
                                        "1",
                                        "+1",
                                        "1.",
                                        ".5",
                                        "-.5e1",
                                        "1e22",
                                        "1e23",
                                        "1E-22",
                                        "1e-23",
                                        "9007199254740992",
                                        "9007199254740993",
                                        "9007199254740993e1",
                                        "123456789012345678901234567890",
                                        "0.000000000000000000000000000000012345678901234567890123",
                                        "4.9406564584124654e-324",
                                        "1e-400",
                                        "1e400",
                                        "-1e400",
                                        "2.2250738585072011e-308",
                                        "1.7976931348623157e308",
                                        "0e999999999999",
                                        "1e-999999999999",
                                        "00000000000000000000000000000000012",
                                        "0.1e00000000000000000000001"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        expect_as_strtod(texts[i]);
    starg_rng rng = starg_rng_make(1, 2, 3);
    for (int i = 0; i < 200000; i++) {
        char text[64];
        uint64_t bits = starg_rng_next(&rng);
        double any;
        memcpy(&any, &bits, sizeof any);
        if (isfinite(any)) {
            snprintf(text, sizeof text, "%.17g", any);
            expect_as_strtod(text);
        }
        int digits = (int)starg_rng_below(&rng, 20);
        snprintf(text, sizeof text, "%.*f", digits, 2000 * starg_rng_unit(&rng) - 1000);
        expect_as_strtod(text);
        snprintf(text, sizeof text, "%llue%d", (unsigned long long)(bits >> (digits + 1)),
                 (int)starg_rng_below(&rng, 50) - 25);
        expect_as_strtod(text);
    }
}

static void special_reals(void **state) {
    (void)state;
    double value = 0;
    assert_true(parses("nan", &value) && isnan(value));
    assert_true(parses("-NaN", &value) && isnan(value));
    assert_true(parses("inf", &value) && value == INFINITY);
    assert_true(parses("-Infinity", &value) && value == -INFINITY);
}

static void what_is_no_real(void **state) {
    (void)state;
    static const char *const texts[] = {
        "",     "+",     "-",   ".",      "e5",   "1e", "1e+",     "1,5", "1.5f", "0x10",  "0x1p3",
        "1..2", "1.2.3", "--1", "1.0abc", "nanx", "in", "infinit", "1 ",  " 1",   "nan(1)"};
    double value;
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        if (parses(texts[i], &value))
            fail_msg("'%s' is read as %g", texts[i], value);
    char digits[1001 + 1]; /* one more than the longest */
    memset(digits, '1', sizeof digits - 1);
    digits[sizeof digits - 1] = '\0';
    assert_false(parses(digits, &value));
    assert_true(parses(digits + 1, &value));
    assert_true(value == INFINITY);
}

static void integers(void **state) {
    (void)state;
    static const struct {
        const char *text;
        bool valid;
        int64_t value;
    } cases[] = {{"0", true, 0},
                 {"-17", true, -17},
                 {"+4", true, 4},
                 {"9223372036854775807", true, INT64_MAX},
                 {"9223372036854775808", false, 0},
                 {"99999999999999999999999", false, 0},
                 {"", false, 0},
                 {"-", false, 0},
                 {"1.0", false, 0},
                 {"1x", false, 0},
                 {"0x1", false, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        int64_t value = 0;
        assert_int_equal(starg_parse_integer(cases[i].text, strlen(cases[i].text), &value),
                         cases[i].valid);
        if (cases[i].valid)
            assert_int_equal(value, cases[i].value);
    }
}

static void words_know_their_lines(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    const char text[] = "a b # c\r\n\r\n d\re \\\n f\n#g\n\th";
    starg_source source = {context, "text", text, sizeof text - 1};
    starg_scan scan = starg_scan_make(&source);
    scan.continuations = true;
    static const struct {
        const char *text;
        size_t line;
    } expected[] = {{"a", 1}, {"b", 1}, {"d", 3}, {"e", 4}, {"f", 5}, {"h", 7}};
    starg_word word;
    for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++) {
        assert_true(starg_scan_word(&scan, &word));
        assert_true(starg_word_is(word, expected[i].text));
        assert_int_equal(word.line, expected[i].line);
    }
    assert_false(starg_scan_word(&scan, &word));

    scan = starg_scan_make(&source); /* a joined line is one line */
    scan.continuations = true;
    for (int line = 0; line < 3; line++)
        assert_true(starg_scan_next_line(&scan));
    assert_true(starg_scan_word_here(&scan, &word) && starg_word_is(word, "e"));
    assert_true(starg_scan_word_here(&scan, &word) && starg_word_is(word, "f"));
    assert_false(starg_scan_word_here(&scan, &word));
    test_context_free(context);
}

static void excerpts_are_short_and_printable(void **state) {
    (void)state;
    starg_word word = {"a\x01\xff%s", 5, 1};
    assert_string_equal(starg_word_excerpt(word).text, "a??%s");
    starg_word longer = {"0123456789012345678901234567890", 31, 1};
    assert_string_equal(starg_word_excerpt(longer).text, "012345678901234567890123...");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reals_have_the_nearest_double),
        cmocka_unit_test(special_reals),
        cmocka_unit_test(what_is_no_real),
        cmocka_unit_test(integers),
        cmocka_unit_test(words_know_their_lines),
        cmocka_unit_test(excerpts_are_short_and_printable),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
