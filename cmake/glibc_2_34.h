/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Included before every source of the wheel (scripts/wheel.py), so that it runs with glibc 2.34: of
 * functions that a later glibc has in a new version, the version of before. It is the same function
 * but for how it reports errors through errno, which nothing here reads.
 */
#if defined(__x86_64__)
__asm__(".symver hypot, hypot@GLIBC_2.2.5");
#elif defined(__aarch64__)
__asm__(".symver hypot, hypot@GLIBC_2.17");
#endif
