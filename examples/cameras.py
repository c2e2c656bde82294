# SPDX-License-Identifier: Apache-2.0
"""Where should five cameras of 90 degrees stand, and what remains unseen?

    python3 cameras.py [MODEL]
"""
import sys

import starguard

room = starguard.Mesh.read(sys.argv[1]) if len(sys.argv) > 1 else starguard.sample("gallery", vertices=500)
cameras = starguard.guard(room, max_guards=5, cone=90)
for camera in cameras:
    print(f"at {camera.position.round(2)} looking along {camera.direction.round(2)}: "
          f"{camera.seen_faces} faces")
print(f"{len(cameras)} cameras see {cameras.coverage_area:.1%} of the area; "
      f"no {len(cameras)} of the candidates see more than {cameras.area_bound:.1%}")
cameras.write_poses("cameras.csv")  # for other programs
unseen = [[210, 70, 60] if i in set(cameras.uncovered.tolist()) else [200, 205, 210]
          for i in range(len(room.faces))]
starguard.write_picture("cameras.png", room, points=cameras.positions, face_colors=unseen)
