/* SPDX-License-Identifier: Apache-2.0 */
/* Includes all headers. Each header also compiles alone. */
#ifndef STARGUARD_STARGUARD_H
#define STARGUARD_STARGUARD_H

#include "animation.h"
#include "bits.h"
#include "check.h"
#include "context.h"
#include "cover.h"
#include "database.h"
#include "decompose.h"
#include "descriptor.h"
#include "fields.h"
#include "guard.h"
#include "kernel.h"
#include "mesh.h"
#include "morph.h"
#include "page.h"
#include "picture.h"
#include "ranks.h"
#include "repair.h"
#include "sample.h"
#include "scene.h"
#include "shape.h"
#include "simplify.h"
#include "skeleton.h"
#include "solid.h"
#include "solidmap.h"
#include "space.h"
#include "status.h"
#include "tetra.h"
#include "verify.h"
#include "version.h"
#include "visibility.h"

#endif
