/* SPDX-License-Identifier: Apache-2.0 */
/* SHA-256 against the examples of FIPS 180-4 and its test vectors. */
#include "shape/database.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support.h"

static void expect(const void *bytes, size_t size, const char *digest) {
    uint8_t found[STARG_SHA256_BYTES];
    char text[2 * STARG_SHA256_BYTES + 1];
    starg_sha256(bytes, size, found);
    for (size_t i = 0; i < sizeof found; i++)
        snprintf(text + 2 * i, 3, "%02x", found[i]);
    assert_string_equal(text, digest);
}

static void known_digests(void **state) {
    (void)state;
    static const char two_blocks[] = "abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq";
    expect(NULL, 0, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    expect("abc", 3, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    expect(two_blocks, sizeof two_blocks - 1,
           "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    char *million = malloc(1000000);
    assert_non_null(million);
    memset(million, 'a', 1000000);
    expect(million, 1000000, "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
    free(million);
}

/* Lengths around the block size have different digests, and the digest depends on every byte. */
static void lengths_and_bytes(void **state) {
    (void)state;
    uint8_t bytes[130] = {0}, seen[260][STARG_SHA256_BYTES];
    size_t count = 0;
    for (size_t size = 0; size <= sizeof bytes; size++)
        starg_sha256(bytes, size, seen[count++]);
    for (size_t i = 0; i < 129; i++) {
        bytes[i] = 1;
        starg_sha256(bytes, 129, seen[count++]);
        bytes[i] = 0;
    }
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < i; k++)
            assert_memory_not_equal(seen[i], seen[k], sizeof seen[i]);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(known_digests),
                                       cmocka_unit_test(lengths_and_bytes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
