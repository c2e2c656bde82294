/* SPDX-License-Identifier: Apache-2.0 */
/* Marks the symbols that the library makes public; everything else is hidden. */
#ifndef STARGUARD_EXPORT_H
#define STARGUARD_EXPORT_H

#if defined(__GNUC__)
#define STARG_API __attribute__((visibility("default")))
#else
#define STARG_API
#endif

#endif
