/* The stages of an engine are compiled once for each instruction set; which of them run is chosen
 * when the program runs. All forms give the same bits: what floating point does not decide beyond
 * its error bound is decided exactly. */
#ifndef STARG_VISIBILITY_FORMS_H
#define STARG_VISIBILITY_FORMS_H

#include <stdbool.h>

/* Those that can be compiled for the processor's kind stand in this order after the plain one. */
typedef enum visibility_form {
    FORM_PLAIN,
#if defined(__aarch64__)
    FORM_NEON,
#elif defined(__x86_64__)
    FORM_AVX2,
    FORM_AVX512,
#endif
    FORM_WIDEST
} visibility_form;

/* The form itself, or for FORM_WIDEST the best one that the processor has. */
visibility_form form_resolve(visibility_form wanted);

bool form_is_supported(visibility_form form);

#endif
