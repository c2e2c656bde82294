/* SPDX-License-Identifier: Apache-2.0 */
/* What benchmarks beside Embree share: its scene of triangles, and a ray between two points. */
#pragma once

#include <stdint.h>
#include <string.h>

#include <embree3/rtcore.h>

/* Triangles of `faces` x 3 indices of `vertices` x 3 coordinates; the caller's. */
static inline RTCScene embree_scene(RTCDevice device, const double *points, size_t vertices,
                                    const uint32_t *corners, size_t faces) {
    RTCScene scene = rtcNewScene(device);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float *v = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                       3 * sizeof(float), vertices);
    uint32_t *f = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          3 * sizeof(uint32_t), faces);
    for (size_t i = 0; i < 3 * vertices; i++)
        v[i] = (float)points[i];
    memcpy(f, corners, 3 * faces * sizeof *f);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    return scene;
}

/* Is nothing between p and q, short of the last 0.01 %? In single precision. */
static inline bool embree_is_free(RTCScene scene, const double p[3], const double q[3]) {
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    struct RTCRay ray = {.org_x = (float)p[0],
                         .org_y = (float)p[1],
                         .org_z = (float)p[2],
                         .dir_x = (float)(q[0] - p[0]),
                         .dir_y = (float)(q[1] - p[1]),
                         .dir_z = (float)(q[2] - p[2]),
                         .tnear = 0,
                         .tfar = 0.9999F,
                         .mask = UINT32_MAX};
    rtcOccluded1(scene, &context, &ray);
    return ray.tfar > 0;
}
