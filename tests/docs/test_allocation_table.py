# SPDX-License-Identifier: Apache-2.0
"""Every public call that can allocate is in the tables of tests/property/test_allocation_*.c, which let
each of its allocations fail, or it stands here with the reason why not."""
import glob
import os
import re
import unittest

SOURCE = os.environ.get("STARGUARD_SOURCE", os.path.join(os.path.dirname(__file__), "..", ".."))

# What gives memory back, what fills a struct of the caller, and static tables.
HARMLESS = re.compile(r"_(free|close|default|fields)$")

NUMBER = "returns a number, a pointer or a bit of a finished object"
TEXT = "returns static text or a static table"
ARITHMETIC = "computes from its arguments alone"
ELSEWHERE = "needs several processes at once: tests/unit/test_ranks.c lets each allocation fail"
WITHOUT = {
    "starg_bits_rows": NUMBER, "starg_bits_columns": NUMBER, "starg_bits_words": NUMBER,
    "starg_bits_row": NUMBER, "starg_bits_test": NUMBER, "starg_bits_count": NUMBER,
    "starg_bits_set": "sets a bit of a matrix that is there",
    "starg_space_model_faces": NUMBER, "starg_space_model_vertices": NUMBER,
    "starg_space_admits": NUMBER, "starg_space_leak": NUMBER, "starg_field_count": NUMBER, "starg_field_set_count": "stores a number",
    "starg_field_set_real": "stores a number", "starg_field_set_word": "stores a number", "starg_field_word": TEXT, "starg_field_real_word": TEXT, "starg_fields_word": TEXT, "starg_check_advice": TEXT,
    "starg_check_describe_grid": "writes into the text of the caller",
    "starg_mesh_colors": NUMBER, "starg_mesh_texture": NUMBER, "starg_mesh_left_out": NUMBER, "starg_mesh_origin": ARITHMETIC,
    "starg_field_expectation": TEXT, "starg_field_group": TEXT,
    "starg_field_default_text": "writes into the text of the caller",
    "starg_finding_name": TEXT, "starg_status_string": TEXT, "starg_version": TEXT,
    "starg_sample_count": TEXT, "starg_sample_at": TEXT, "starg_signature_name": TEXT, "starg_hand_name": TEXT,
    "starg_signature_version": TEXT, "starg_signature_needs_descriptor": TEXT,
    "starg_page_available": TEXT,
    "starg_context_cancel": "sets a flag; a signal handler may call it",
    "starg_context_finish": "sets a flag; a signal handler may call it", "starg_context_best": NUMBER,
    "starg_context_reset": "clears flags",
    "starg_context_set_time_limit": "stores a time",
    "starg_context_peak_bytes": NUMBER, "starg_context_live_blocks": NUMBER,
    "starg_context_work": NUMBER, "starg_space_leak": NUMBER,
    "starg_context_error": NUMBER,
    "starg_context_set_ranks": "stores a pointer",
    "starg_context_shared_seconds": NUMBER, "starg_context_helped_items": NUMBER,
    "starg_ranks_serve": ELSEWHERE, "starg_database_ranks_serve": ELSEWHERE,
    "starg_ranks_release": ELSEWHERE,
    "starg_density_depth": ARITHMETIC, "starg_depth_plane": ARITHMETIC, "starg_tilt_holds": ARITHMETIC,
    "starg_cone_cosine": ARITHMETIC, "starg_frustum": ARITHMETIC,
    "starg_guard_default_step": ARITHMETIC, "starg_guards_rotation": ARITHMETIC, "starg_guards_angles": ARITHMETIC, "starg_guards_level": ARITHMETIC, "starg_incidence_cosine": ARITHMETIC, "starg_descriptor_direction": ARITHMETIC,
    "starg_distinct_color": ARITHMETIC, "starg_map_positions": ARITHMETIC,
    "starg_overlay_positions": ARITHMETIC,
    "starg_descriptor_recognized": ARITHMETIC, "starg_tetmesh_recognized": ARITHMETIC,
    "starg_mesh_vertex_count": NUMBER, "starg_mesh_face_count": NUMBER,
    "starg_mesh_vertices": NUMBER, "starg_mesh_faces": NUMBER, "starg_mesh_bounds": ARITHMETIC,
    "starg_mesh_area": ARITHMETIC, "starg_mesh_volume": ARITHMETIC,
    "starg_morph_guard_count": NUMBER, "starg_morph_guards": NUMBER, "starg_morph_pieces": NUMBER,
    "starg_morph_unguarded": NUMBER, "starg_morph_key_count": NUMBER,
    "starg_morph_tetrahedron_count": NUMBER,
    "starg_solid_mesh": NUMBER, "starg_solid_check": NUMBER,
    "starg_solid_contains": "walks a tree that is there, on the stack",
    "starg_solid_distance": "walks a tree that is there, on the stack",
    "starg_tetmesh_vertex_count": NUMBER, "starg_tetmesh_count": NUMBER,
    "starg_tetmesh_vertices": NUMBER, "starg_tetmesh_tetrahedra": NUMBER,
    "starg_tetmesh_neighbours": NUMBER, "starg_tetmesh_regions": NUMBER,
    "starg_tetmesh_turned": NUMBER, "starg_tetmesh_volume": ARITHMETIC,
}


def text_of(pattern):
    parts = []
    for path in sorted(glob.glob(os.path.join(SOURCE, pattern))):
        with open(path, encoding="utf-8") as file:
            parts.append(file.read())
    return "\n".join(parts)


class Table(unittest.TestCase):
    def setUp(self):
        headers = re.sub(r"/\*.*?\*/", "", text_of("include/starguard/*.h"), flags=re.S)
        found = re.findall(r"^STARG_API ([^;]*?\b(starg_\w+)\([^;]*);", headers, flags=re.M)
        self.declared = {name: declaration for declaration, name in found}
        self.tested = set(re.findall(r'\((starg_\w+),\s*"',
                                     text_of("tests/property/test_allocation_*.c")))

    def test_all_are_told_of(self):
        self.assertGreater(len(self.declared), 150)
        missing = [name for name in self.declared if not HARMLESS.search(name)
                   and name not in self.tested and name not in WITHOUT]
        self.assertEqual(missing, [], "add these to a table of tests/property/test_allocation_*.c")

    def test_none_is_told_of_in_vain(self):
        told = self.tested | set(WITHOUT)
        self.assertEqual(told - set(self.declared), set())
        self.assertEqual(self.tested & set(WITHOUT), set())

    def test_what_is_left_out_cannot_say_memory(self):
        """What returns a status may return that of memory."""
        for name, reason in WITHOUT.items():
            self.assertTrue(reason)
            if reason != ELSEWHERE:
                self.assertNotIn("starg_status starg", self.declared[name])


if __name__ == "__main__":
    unittest.main(verbosity=2)
