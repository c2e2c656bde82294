/* SPDX-License-Identifier: Apache-2.0 */
/* Functions that compilers make vector code of: on x86-64 in versions for several instruction sets,
 * chosen when the program starts. None fuses multiplication and addition (-ffp-contract=off), so
 * all give the same bits.
 *
 * For static functions only: gcc gives an external one of several versions default visibility,
 * whatever the library hides. */
#pragma once

#if defined(__x86_64__) && defined(__ELF__) && !defined(__SANITIZE_ADDRESS__) && !defined(__clang__)
#define STARG_SEVERAL_VERSIONS __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define STARG_SEVERAL_VERSIONS
#endif
