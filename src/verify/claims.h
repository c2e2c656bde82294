/* SPDX-License-Identifier: Apache-2.0 */
/* A verdict under construction: a list of claims. */
#ifndef STARG_VERIFY_CLAIMS_H
#define STARG_VERIFY_CLAIMS_H

#include "core/context.h"
#include "starguard/verify.h"

/* Limits on the claims of a verdict, and on those left unchecked. */
enum { VERIFY_CLAIMS = 64, VERIFY_UNCHECKED = 32 };

starg_status verify_verdict_create(starg_context *context, starg_verdict **out);

/* Adds a claim: what was checked, and, if it does not hold, what was found. */
void verify_claim(starg_verdict *verdict, bool holds, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Adds a claim that holds of all but `bad` elements, the first of which is named if there are any:
 * "text (not: 3, the first is 17)". */
void verify_claim_all(starg_verdict *verdict, size_t bad, size_t first, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Adds a statement of the result that is not checked; the second one, that the verdict is about. */
void verify_leave(starg_verdict *verdict, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void verify_leave_asked(starg_verdict *verdict, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#endif
