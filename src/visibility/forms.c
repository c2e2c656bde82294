#include "visibility/forms.h"

bool form_is_supported(visibility_form form) {
#if defined(__x86_64__)
    bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
    bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl");
    return form == FORM_PLAIN || (avx2 && (form == FORM_AVX2 || avx512));
#else
    return form < FORM_WIDEST; /* NEON is part of every aarch64 */
#endif
}

visibility_form form_resolve(visibility_form wanted) {
    if (wanted != FORM_WIDEST)
        return wanted;
    while (--wanted > FORM_PLAIN)
        if (form_is_supported(wanted))
            return wanted;
    return FORM_PLAIN;
}
