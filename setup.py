# SPDX-License-Identifier: Apache-2.0
"""`pip install .`: CMake builds the library and puts the package together, setuptools packs it.

All is built in a temporary folder, which is removed. STARGUARD_BUILD names a build folder of CMake to
use instead, with what is built there already.
"""
import atexit
import os
import re
import shutil
import subprocess
import sys
import tempfile

from setuptools import setup
from setuptools.command.build_py import build_py
from setuptools.dist import Distribution
from wheel.bdist_wheel import bdist_wheel

ROOT = os.path.dirname(os.path.abspath(__file__))
SCRATCH = tempfile.mkdtemp(prefix="starguard-")  # instead of folders beside the sources
atexit.register(shutil.rmtree, SCRATCH, ignore_errors=True)


def version():
    with open(os.path.join(ROOT, "include/starguard/version.h"), encoding="utf-8") as file:
        return ".".join(re.findall(r"^#define STARG_VERSION_[A-Z]+ (\d+)$", file.read(), re.MULTILINE))


def built_package():
    """The folder of the package that CMake makes."""
    folder = os.environ.get("STARGUARD_BUILD")
    if folder is None:
        folder = os.path.join(SCRATCH, "cmake")
        generator = ["-G", "Ninja"] if shutil.which("ninja") else []
        subprocess.check_call(["cmake", "-S", ROOT, "-B", folder, "-DSTARGUARD_TESTS=OFF",
                               "-DCMAKE_BUILD_TYPE=RelWithDebInfo", f"-DSTARGUARD_PYTHON={sys.executable}",
                               *generator])
    jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count() or 1))
    subprocess.check_call(["cmake", "--build", folder, "--target", "starguard_python", "-j", jobs])
    return os.path.join(folder, "python", "starguard")


class BuildPackage(build_py):
    def run(self):
        target = os.path.join(self.build_lib, "starguard")
        shutil.copytree(built_package(), target, dirs_exist_ok=True,
                        ignore=shutil.ignore_patterns("__pycache__", "*.stamp"))


class Wheel(bdist_wheel):
    """For any Python 3 of this machine: the library is C, but no extension module."""

    def get_tag(self):
        return "py3", "none", super().get_tag()[2]


class Binary(Distribution):
    def has_ext_modules(self):
        return True


setup(
    version=version(),
    distclass=Binary,
    cmdclass={"build_py": BuildPackage, "bdist_wheel": Wheel},
    options={"build": {"build_base": os.path.join(SCRATCH, "build")},
             "egg_info": {"egg_base": SCRATCH}},
)
