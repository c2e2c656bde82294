# SPDX-License-Identifier: Apache-2.0
"""Every example in a docstring runs and prints what stands there, and the reference that is made of
them has every name."""
import doctest
import importlib
import importlib.util
import inspect
import os
import pkgutil

import starguard
from support import SOURCE, Case, main


class Examples(Case):
    def modules(self):
        names = [info.name for info in pkgutil.iter_modules(starguard.__path__)
                 if not info.name.startswith("lib")]
        self.assertGreater(len(names), 15)
        return [starguard] + [importlib.import_module(f"starguard.{name}") for name in names]

    def test_examples(self):
        tried = 0
        for module in self.modules():
            for test in doctest.DocTestFinder().find(module, module.__name__):
                with self.subTest(name=test.name):
                    said = []
                    results = doctest.DocTestRunner(verbose=False).run(test, out=said.append)
                    self.assertEqual(results.failed, 0, "".join(said))
                    tried += results.attempted
        self.assertGreater(tried, 100)


class Reference(Case):
    def test_the_reference_has_every_name(self):
        spec = importlib.util.spec_from_file_location(
            "make_reference", os.path.join(SOURCE, "python", "tools", "make_reference.py"))
        make_reference = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(make_reference)
        make_reference.main("python-api.md")
        document = self.read("python-api.md").decode()
        for name in starguard.__all__:
            value = getattr(starguard, name)
            if inspect.isfunction(value):
                self.assertIn(f"### `{name}()`", document)
            elif isinstance(value, type) and value is not starguard.Defaults:
                self.assertIn(f"### `{name}`", document)


if __name__ == "__main__":
    main()
