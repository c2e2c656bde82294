/* SPDX-License-Identifier: Apache-2.0 */
/* The main loop of scene_sides, compiled per instruction set. */
#ifndef STARG_VISIBILITY_SIDES_H
#define STARG_VISIBILITY_SIDES_H

#include "visibility/isa.h"
#include "visibility/scene.h"

sides_run sides_run_plain;
#if defined(__aarch64__)
sides_run sides_run_neon;
#elif defined(__x86_64__)
sides_run sides_run_avx2, sides_run_avx512;
#endif

#endif
