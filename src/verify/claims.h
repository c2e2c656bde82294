/* SPDX-License-Identifier: Apache-2.0 */
/* A verdict under construction: claims one after the other. */
#ifndef STARG_VERIFY_CLAIMS_H
#define STARG_VERIFY_CLAIMS_H

#include "core/context.h"
#include "starguard/verify.h"

/* The most claims of a verdict, and the most that are not checked. */
enum { VERIFY_CLAIMS = 32, VERIFY_UNCHECKED = 16 };

starg_status verify_verdict_create(starg_context *context, starg_verdict **out);

/* Adds a claim: what was checked, and, where it does not hold, what was found. */
void verify_claim(starg_verdict *verdict, bool holds, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Adds what a result says and this verdict does not answer for. */
void verify_leave(starg_verdict *verdict, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#endif
