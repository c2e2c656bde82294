/* SPDX-License-Identifier: Apache-2.0 */
#include "visibility/isa.h"

bool isa_is_supported(visibility_isa isa) {
#if defined(__x86_64__)
    bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
    bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl");
    return isa == ISA_PLAIN || (avx2 && (isa == ISA_AVX2 || avx512));
#else
    return isa < ISA_WIDEST; /* NEON is part of every aarch64 */
#endif
}

visibility_isa isa_resolve(visibility_isa wanted) {
    if (wanted != ISA_WIDEST)
        return wanted;
    while (--wanted > ISA_PLAIN)
        if (isa_is_supported(wanted))
            return wanted;
    return ISA_PLAIN;
}
