/* SPDX-License-Identifier: Apache-2.0 */
/* Internal functions of starguard that starguard-shapes uses. They are exported under prefixed
 * names, so that their plain names cannot clash with a program's own. */
#pragma once

/* Follows the declaration of NAME, before other attributes. Protected visibility keeps calls within
 * the library direct; WebAssembly has none, and no shared libraries here. */
#ifdef __wasm__
#define STARG_PRIVATE(NAME)
#else
#define STARG_PRIVATE(NAME) __asm__("starg_private_" #NAME) __attribute__((visibility("protected")))
#endif
