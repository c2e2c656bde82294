/* SPDX-License-Identifier: Apache-2.0 */
/* Functions that one of our libraries uses of another (starguard-shapes of starguard), though they
 * are not public: exported under a name that nobody else has, so that the plain one stays out of a
 * program's way. */
#ifndef STARG_CORE_PRIVATE_H
#define STARG_CORE_PRIVATE_H

/* Behind the declaration of NAME, before other attributes. Protected: calls from within its own
 * library stay direct. */
#define STARG_PRIVATE(NAME) __asm__("starg_private_" #NAME) __attribute__((visibility("protected")))

#endif
