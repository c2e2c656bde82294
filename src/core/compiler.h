/* SPDX-License-Identifier: Apache-2.0 */
/* What compilers know beyond C17. */
#pragma once

/* ---- 128-bit integers: an extension of gcc and clang ---- */

__extension__ typedef __int128 starg_int128;
__extension__ typedef unsigned __int128 starg_uint128;

/* ---- functions of starguard that starguard-shapes uses ---- */
/* They are exported under prefixed names, so that their plain names cannot clash with a program's
 * own. */

/* Follows the declaration of NAME, before other attributes. Protected visibility keeps calls within
 * the library direct; WebAssembly has none, and no shared libraries here. */
#ifdef __wasm__
#define STARG_PRIVATE(NAME)
#else
#define STARG_PRIVATE(NAME) __asm__("starg_private_" #NAME) __attribute__((visibility("protected")))
#endif

/* ---- functions in versions for several instruction sets ---- */
/* Compilers make vector code of them: on x86-64 in versions that are chosen when the program
 * starts. None fuses multiplication and addition (-ffp-contract=off), so all give the same bits.
 *
 * For static functions only: gcc gives an external one of several versions default visibility,
 * whatever the library hides. */

#if defined(__x86_64__) && defined(__ELF__) && !defined(__SANITIZE_ADDRESS__) && !defined(__clang__)
#define STARG_SEVERAL_VERSIONS __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define STARG_SEVERAL_VERSIONS
#endif
