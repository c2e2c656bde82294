# SPDX-License-Identifier: Apache-2.0
"""A horse that changes its pose, as an animation, with the quality of its frames.

    python3 morph.py [A B]
"""
import sys

import starguard

a, b = sys.argv[1:3] if len(sys.argv) > 2 else (starguard.sample("horse", pose=p, vertices=1000) for p in (0, 3))
surface_map = starguard.map_surface(a, b)
for method in ("linear", "star"):
    morph = starguard.Morph(a, surface_map, method=method)
    frames = [morph.measure(t) for t in (0.25, 0.5, 0.75)]
    print(f"{method}: {len(morph.guards[0])} guards, {max(f.intersections for f in frames)} intersections, "
          f"volume off by at most {max(abs(f.volume_drift) for f in frames):.2%}")
morph.write_animation("morph.glb", frames=11)  # opens in Blender and in browsers
