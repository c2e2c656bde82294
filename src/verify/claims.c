/* SPDX-License-Identifier: Apache-2.0 */
#include "verify/facts.h"

#include <stdio.h>

starg_status verify_verdict_create(starg_context *context, starg_verdict **out) {
    SCOPED_BY(starg_verdict_drop) starg_verdict *verdict = NULL;
    *out = NULL;
    NEW_ZERO(context, "verify", verdict, 1);
    verdict->passed = true;
    NEW_ZERO(context, "verify", verdict->claims, VERIFY_CLAIMS);
    NEW_ZERO(context, "verify", verdict->not_checked, VERIFY_UNCHECKED);
    *out = verdict;
    verdict = NULL;
    return STARG_OK;
}

void verify_claim(starg_verdict *verdict, bool holds, const char *format, ...) {
    verdict->passed = verdict->passed && holds;
    if (verdict->count == VERIFY_CLAIMS)
        return;
    starg_claim *claim = &verdict->claims[verdict->count++];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(claim->text, sizeof claim->text, format, arguments);
    va_end(arguments);
    claim->holds = holds;
}

void verify_claim_all(starg_verdict *verdict, size_t bad, size_t first, const char *format, ...) {
    char text[sizeof verdict->claims->text];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (bad == 0)
        verify_claim(verdict, true, "%s", text);
    else
        verify_claim(verdict, false, "%.180s (not: %zu, the first is %zu)", text, bad, first);
}

static void leave(starg_verdict *verdict, bool asked, const char *format, va_list arguments) {
    if (verdict->not_checked_count == VERIFY_UNCHECKED)
        return;
    starg_unchecked *claim = &verdict->not_checked[verdict->not_checked_count++];
    vsnprintf(claim->text, sizeof claim->text, format, arguments);
    claim->asked = asked;
}

void verify_leave(starg_verdict *verdict, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    leave(verdict, false, format, arguments);
    va_end(arguments);
}

void verify_leave_asked(starg_verdict *verdict, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    leave(verdict, true, format, arguments);
    va_end(arguments);
}

void starg_verdict_free(starg_context *context, starg_verdict *verdict) {
    (void)context;
    if (verdict == NULL)
        return;
    RELEASE(verdict->claims, verdict->not_checked, verdict);
}
