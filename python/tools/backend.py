# SPDX-License-Identifier: Apache-2.0
"""`pip install .`: CMake builds the libraries, this module packs them (PEP 517).

It needs Python 3.9 and nothing of PyPI, so that an installation works under every Python and offline. All is
built in a temporary folder, which is removed. STARGUARD_BUILD names a build folder of CMake to use
instead, with what is built there already.

`pack` is also what scripts/wheel.py uses.
"""
import base64
import hashlib
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
METADATA = """\
Metadata-Version: 2.1
Name: starguard
Version: {version}
Summary: The fewest guards inside a solid that see its whole boundary, and star-shaped pieces
License: Apache-2.0
License-File: LICENSE
Requires-Python: >=3.9
Requires-Dist: numpy>=1.20
Classifier: License :: OSI Approved :: Apache Software License
Classifier: Operating System :: POSIX :: Linux
Classifier: Programming Language :: C
Classifier: Programming Language :: Python :: 3
Classifier: Topic :: Scientific/Engineering
Classifier: Typing :: Typed
Description-Content-Type: text/markdown

"""
WHEEL = """\
Wheel-Version: 1.0
Generator: starguard
Root-Is-Purelib: false
Tag: {tag}
"""
#: What the build uses: the name of a program, a pkg-config file or a header, and Debian's package.
PROGRAMS = [("cmake", "cmake"), ("cc", "gcc"), ("c++", "g++"), ("pkg-config", "pkg-config")]
LIBRARIES = [("cbc", "coinor-libcbc-dev"), ("jansson", "libjansson-dev"), ("sqlite3", "libsqlite3-dev"),
             ("zlib", "zlib1g-dev")]
HEADERS = [("ldl.h", "libsuitesparse-dev"), ("Spectra/SymEigsSolver.h", "libspectra-dev"),
           ("Eigen/Core", "libeigen3-dev")]


def version():
    with open(os.path.join(ROOT, "include/starguard/version.h"), encoding="utf-8") as file:
        return ".".join(re.findall(r"^#define STARG_VERSION_[A-Z]+ (\d+)$", file.read(), re.MULTILINE))


def missing_packages():
    """The Debian packages of what the build would miss."""
    missing = [package for program, package in PROGRAMS if shutil.which(program) is None]
    if "pkg-config" not in missing:
        missing += [package for name, package in LIBRARIES
                    if subprocess.run(["pkg-config", "--exists", name], check=False).returncode != 0]
    return missing + [package for header, package in HEADERS
                      if not any(os.path.exists(os.path.join(folder, below, header))
                                 for folder in ("/usr/include", "/usr/local/include")
                                 for below in ("", "suitesparse", "eigen3"))]


def built_package(scratch):
    """The folder of the package that CMake makes."""
    folder = os.environ.get("STARGUARD_BUILD")
    if folder is None:
        if sys.version_info < (3, 9):
            sys.exit("starguard needs Python 3.9 or later")
        missing = missing_packages()
        if missing:
            sys.exit("To build starguard, these are missing: " + ", ".join(missing)
                     + " (names of Debian's packages: apt install " + " ".join(missing) + ")")
        folder = os.path.join(scratch, "cmake")
        generator = ["-G", "Ninja"] if shutil.which("ninja") else []
        subprocess.check_call(["cmake", "-S", ROOT, "-B", folder, "-DSTARGUARD_TESTS=OFF",
                               "-DCMAKE_BUILD_TYPE=RelWithDebInfo", f"-DSTARGUARD_PYTHON={sys.executable}",
                               *generator])
    jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count() or 1))
    subprocess.check_call(["cmake", "--build", folder, "--target", "starguard_python", "-j", jobs])
    return os.path.join(folder, "python", "starguard")


# ---- the wheel ----


def files_below(folder):
    """All files of a package, as (path, name below the folder), without what is not for installation."""
    found = []
    for root, folders, names in os.walk(folder):
        folders[:] = sorted(name for name in folders if name != "__pycache__")
        found += [(os.path.join(root, name), os.path.relpath(os.path.join(root, name), folder))
                  for name in sorted(names) if not name.endswith(".stamp")]
    return found


def metadata():
    with open(os.path.join(ROOT, "README.md"), encoding="utf-8") as file:
        return METADATA.format(version=version()) + file.read()


def pack(package, wheel_folder, platform, licences=()):
    """Writes the wheel of a package folder; `licences` are more files, as (name, bytes). The same files
    give the same bytes. Returns the name of the wheel."""
    tag = f"py3-none-{platform}"
    info = f"starguard-{version()}.dist-info"
    with open(os.path.join(ROOT, "LICENSE"), "rb") as file:
        members = [(f"{info}/licenses/LICENSE", file.read())]
    members += [(f"{info}/licenses/{name}", content) for name, content in licences]
    members += [(f"{info}/METADATA", metadata().encode()), (f"{info}/WHEEL", WHEEL.format(tag=tag).encode())]
    for path, name in files_below(package):
        with open(path, "rb") as file:
            members.append((f"starguard/{name}", file.read()))
    record = [f"{name},sha256={base64.urlsafe_b64encode(hashlib.sha256(content).digest()).decode().rstrip('=')},"
              f"{len(content)}" for name, content in sorted(members)]
    members.append((f"{info}/RECORD", "\n".join([*record, f"{info}/RECORD,,", ""]).encode()))
    wheel = f"starguard-{version()}-{tag}.whl"
    with zipfile.ZipFile(os.path.join(wheel_folder, wheel), "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in sorted(members, key=lambda member: (".dist-info/" in member[0], member[0])):
            entry = zipfile.ZipInfo(name)  # dated 1980: the same files give the same bytes
            entry.external_attr = 0o100644 << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, content)
    return wheel


# ---- what pip calls ----


def get_requires_for_build_wheel(config_settings=None):
    return []


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    scratch = tempfile.mkdtemp(prefix="starguard-")
    try:
        return pack(built_package(scratch), wheel_directory, platform)
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
