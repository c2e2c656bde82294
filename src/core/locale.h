/* SPDX-License-Identifier: Apache-2.0 */
/* Numbers are read and written as in C, whatever the locale of the program. */
#ifndef STARG_CORE_LOCALE_H
#define STARG_CORE_LOCALE_H

#include <locale.h>

#include "core/context.h"
#include "core/private.h"

typedef struct starg_c_locale {
    locale_t own, before;
} starg_c_locale;

/* Gives the calling thread the C locale until it leaves; `locale` starts as zero. Errors: MEMORY.
 */
starg_status starg_c_locale_enter(starg_context *context, starg_c_locale *locale)
    STARG_PRIVATE(starg_c_locale_enter);
/* Does nothing if it was not entered. */
void starg_c_locale_leave(starg_c_locale *locale) STARG_PRIVATE(starg_c_locale_leave);

#endif
