/* SPDX-License-Identifier: Apache-2.0 */
/* 128-bit integers: an extension of gcc and clang. */
#pragma once

__extension__ typedef __int128 starg_int128;
__extension__ typedef unsigned __int128 starg_uint128;
