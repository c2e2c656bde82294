# SPDX-License-Identifier: Apache-2.0
"""The notebook of the tutorial is its page, and runs."""
import importlib.util
import json
import os
import shutil

from support import SOURCE, Case, main

FOLDER = os.path.join(SOURCE, "docs", "tutorials")


class Tutorial(Case):
    def test_notebook(self):
        spec = importlib.util.spec_from_file_location("notebook", os.path.join(SOURCE, "scripts", "notebook.py"))
        script = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(script)
        with open(os.path.join(FOLDER, "pieces.ipynb"), encoding="utf-8") as file:
            text = file.read()
        self.assertEqual(text, script.notebook(os.path.join(FOLDER, "pieces.md")), "scripts/notebook.py makes it anew")
        code = ["".join(cell["source"]) for cell in json.loads(text)["cells"] if cell["cell_type"] == "code"]
        self.assertGreaterEqual(len(code), 5)
        if shutil.which("tetgen") is None:
            print("skipped: tetgen is not installed")
            self.skipTest("tetgen is not installed")
        names = {}
        for cell in code:
            exec(compile(cell, "pieces.ipynb", "exec"), names)  # pylint: disable=exec-used
        self.assertTrue(os.path.exists("pieces.vtk"))


if __name__ == "__main__":
    main()
