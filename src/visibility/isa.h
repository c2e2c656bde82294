/* SPDX-License-Identifier: Apache-2.0 */
/* The stages of an engine are compiled once per instruction set and selected at run time. All
 * variants give the same bits: whatever floating point cannot decide within its error bound is
 * decided exactly. */
#ifndef STARG_VISIBILITY_ISA_H
#define STARG_VISIBILITY_ISA_H

#include <stdbool.h>

/* Variants for the processor's architecture, in this order after the plain one. */
typedef enum visibility_isa {
    ISA_PLAIN,
#if defined(__aarch64__)
    ISA_NEON,
#elif defined(__x86_64__)
    ISA_AVX2,
    ISA_AVX512,
#endif
    ISA_WIDEST
} visibility_isa;

/* The given variant, or for ISA_WIDEST the best one that the processor supports. */
visibility_isa isa_resolve(visibility_isa wanted);

bool isa_is_supported(visibility_isa isa);

#endif
