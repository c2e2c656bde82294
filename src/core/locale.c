/* SPDX-License-Identifier: Apache-2.0 */
#include "core/locale.h"

starg_status starg_c_locale_enter(starg_context *context, starg_c_locale *locale) {
    locale->own = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (locale->own == (locale_t)0)
        return starg_fail_memory(context, "locale");
    locale->before = uselocale(locale->own);
    return STARG_OK;
}

void starg_c_locale_leave(starg_c_locale *locale) {
    if (locale->own == (locale_t)0)
        return;
    uselocale(locale->before);
    freelocale(locale->own);
    *locale = (starg_c_locale){0};
}
