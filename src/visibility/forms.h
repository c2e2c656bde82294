/* The stages of an engine are compiled once for each instruction set; which of them run is chosen
 * when the program runs. All forms give the same bits: what floating point does not decide beyond
 * its error bound is decided exactly. */
#ifndef STARG_VISIBILITY_FORMS_H
#define STARG_VISIBILITY_FORMS_H

#include <stdbool.h>

typedef enum visibility_form { FORM_PLAIN, FORM_AVX2, FORM_AVX512, FORM_WIDEST } visibility_form;

/* The form itself, or for FORM_WIDEST the best one that the processor has. */
visibility_form form_resolve(visibility_form wanted);

bool form_is_supported(visibility_form form);

#endif
