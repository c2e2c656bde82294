#include "visibility/forms.h"

bool form_is_supported(visibility_form form) {
#if defined(__x86_64__)
    bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
    bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl");
    return form == FORM_PLAIN || (avx2 && (form == FORM_AVX2 || avx512));
#else
    return form == FORM_PLAIN;
#endif
}

visibility_form form_resolve(visibility_form wanted) {
    if (wanted != FORM_WIDEST)
        return wanted;
    return form_is_supported(FORM_AVX512) ? FORM_AVX512
           : form_is_supported(FORM_AVX2) ? FORM_AVX2
                                          : FORM_PLAIN;
}
