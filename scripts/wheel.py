#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Builds the wheel that needs nothing but Python and NumPy: `make wheel`.

    wheel.py BUILD OUTPUT_FOLDER

1. CMake builds the package in BUILD.
2. Every library that it needs is copied into starguard/libs, except what each Linux has (SYSTEM), stripped,
   and renamed by its contents, so that another package's library of the same name is never taken
   for it. The libraries find each other by $ORIGIN.
3. The versions of all symbols that are taken from SYSTEM say which glibc the wheel needs, and so its
   manylinux tag (PEP 600). Whatever that tag does not allow is an error.
4. Licences: the copyright file of each library's Debian package, the licences which that refers to,
   and BUNDLED.md, which lists libraries, versions, sources, sizes.
"""
import glob
import hashlib
import os
import platform
import re
import shutil
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(ROOT, "python", "tools"))
sys.dont_write_bytecode = True
import backend  # noqa: E402  (pylint: disable=wrong-import-position)

#: Libraries that manylinux lets a wheel take from the system. zlib is one too, but a lean one may lack it.
SYSTEM = {"libc.so.6", "libm.so.6", "libpthread.so.0", "libdl.so.2", "librt.so.1", "libgcc_s.so.1",
          "libstdc++.so.6", "ld-linux-x86-64.so.2", "ld-linux-aarch64.so.1"}
#: The latest symbol versions of libstdc++ and libgcc in distributions with a glibc (they come together).
POLICIES = {(2, 31): {"GLIBCXX": (3, 4, 28), "CXXABI": (1, 3, 12), "GCC": (7, 0, 0)},
            (2, 34): {"GLIBCXX": (3, 4, 29), "CXXABI": (1, 3, 13), "GCC": (7, 0, 0)},
            (2, 35): {"GLIBCXX": (3, 4, 30), "CXXABI": (1, 3, 13), "GCC": (12, 0, 0)}}


def output(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def build(folder):
    """The folder of the package."""
    flags = f"-include {ROOT}/cmake/glibc_2_34.h -ffile-prefix-map={ROOT}=."
    subprocess.check_call(["cmake", "-G", "Ninja", "-S", ROOT, "-B", folder, "-DSTARGUARD_TESTS=OFF",
                           "-DCMAKE_BUILD_TYPE=RelWithDebInfo", f"-DCMAKE_C_FLAGS={flags}"],
                          stdout=subprocess.DEVNULL)
    subprocess.check_call(["cmake", "--build", folder, "--target", "starguard_python"])
    return os.path.join(folder, "python", "starguard")


# ---- bundling ----


def needed(library):
    """The names of the libraries that it asks for itself."""
    return re.findall(r"\(NEEDED\).*\[(.*)\]", output("readelf", "-d", library))


def found_libraries(library, folder):
    """Where the loader finds all that a library needs, directly or not: name and path."""
    listed = subprocess.run(["ldd", library], check=True, capture_output=True, text=True,
                            env={**os.environ, "LD_LIBRARY_PATH": folder}).stdout
    if "not found" in listed:
        sys.exit(f"wheel.py: {library} needs a library that is not found:\n{listed}")
    return dict(re.findall(r"(\S+) => (/\S+)", listed))


def bundle(package, target):
    """Copies the package with all libraries; returns what has been bundled: (file, origin)."""
    shutil.rmtree(target, ignore_errors=True)
    for path, name in backend.files_below(package):
        os.makedirs(os.path.dirname(os.path.join(target, name)), exist_ok=True)
        shutil.copy(path, os.path.join(target, name))
    own = sorted(glob.glob(os.path.join(target, "libstarguard*.so.*")))
    names = {os.path.basename(path) for path in own}
    origins = {}
    for path in own:
        origins.update(found_libraries(path, target))
    origins = {name: path for name, path in origins.items() if name not in SYSTEM | names}
    libs = os.path.join(target, "libs")
    os.mkdir(libs)
    renamed = {}
    for name, origin in sorted(origins.items()):
        with open(origin, "rb") as file:
            mark = hashlib.sha256(file.read()).hexdigest()[:8]
        renamed[name] = re.sub(r"\.so", f"-{mark}.so", name, count=1)
        copy = os.path.join(libs, renamed[name])
        shutil.copy(os.path.realpath(origin), copy)
        subprocess.check_call(["strip", "--strip-unneeded", copy])
        subprocess.check_call(["patchelf", "--set-soname", renamed[name], "--set-rpath", "$ORIGIN", copy])
    for path in own:
        subprocess.check_call(["strip", "--strip-unneeded", path])
        subprocess.check_call(["patchelf", "--set-rpath", "$ORIGIN:$ORIGIN/libs", path])
    for path in own + glob.glob(os.path.join(libs, "*")):
        for name in needed(path):
            if name in renamed:
                subprocess.check_call(["patchelf", "--replace-needed", name, renamed[name], path])
    return [(os.path.join("libs", renamed[name]), os.path.realpath(origins[name])) for name in sorted(renamed)]


# ---- the tag ----


def wanted_versions(library):
    """The symbol versions that a library takes from SYSTEM: {"GLIBC": {(2, 34), ...}, ...}."""
    wanted = {}
    origin = ""
    for line in output("readelf", "-V", library).partition("Version needs section")[2].splitlines():
        named = re.search(r"File: (\S+)", line)
        origin = named[1] if named else origin
        version = re.search(r"Name: (\S+)", line)
        if version and origin in SYSTEM:
            kind, _, number = version[1].rpartition("_")
            if not re.fullmatch(r"[0-9.]+", number):
                sys.exit(f"wheel.py: {library} takes {version[1]} from {origin}, which no manylinux has")
            wanted.setdefault(kind, set()).add(tuple(map(int, number.split("."))))
    return wanted


def tag(target):
    """The manylinux tag of the package. Exits where a library asks for what the tag does not grant."""
    libraries = sorted(glob.glob(os.path.join(target, "**", "*.so*"), recursive=True))
    inside = {os.path.basename(path) for path in libraries}
    most = {}
    for path in libraries:
        foreign = set(needed(path)) - inside - SYSTEM
        rpath = re.search(r"\((?:RUNPATH|RPATH)\).*\[(.*)\]", output("readelf", "-d", path))
        if foreign or rpath is None or not all(part.startswith("$ORIGIN") for part in rpath[1].split(":")):
            sys.exit(f"wheel.py: {path}: needs {sorted(foreign)}, looks for libraries in {rpath and rpath[1]}")
        for kind, versions in wanted_versions(path).items():
            latest = max(versions)
            if latest > most.get(kind, ((0,), ""))[0]:
                most[kind] = latest, os.path.basename(path)
    glibc = most.pop("GLIBC")[0]
    policies = [policy for policy in sorted(POLICIES) if policy >= glibc
                and all(version <= POLICIES[policy][kind] for kind, (version, _) in most.items())]
    if not policies:
        sys.exit(f"wheel.py: no manylinux allows glibc {glibc} with {most}")
    fewest = policies[0]
    print(f"glibc {'.'.join(map(str, glibc))}, " + ", ".join(
        f"{kind} {'.'.join(map(str, version))} ({file})" for kind, (version, file) in sorted(most.items())))
    return f"manylinux_{fewest[0]}_{fewest[1]}_{platform.machine()}"


# ---- licences ----


def package_of(path):
    """The Debian package of a file: name, version, source."""
    for candidate in (path, path.replace("/usr/lib/", "/lib/", 1), "/usr" + path):
        found = subprocess.run(["dpkg-query", "--search", candidate], capture_output=True, text=True, check=False)
        if found.returncode == 0:
            name = found.stdout.split(": ")[0].split(",")[0]
            return output("dpkg-query", "-W", "-f", "${Package}\t${Version}\t${source:Package}\t${source:Version}",
                          name).split("\t")
    sys.exit(f"wheel.py: no Debian package has {path}, so that its licence is not known")


def licences(target, bundled):
    """The files of licences, and the list of what is bundled."""
    files, references = {}, set()
    rows = ["# Libraries in this wheel", "",
            "Debian's builds, unchanged but for their names and for where they look for each other. Each is a",
            "file of its own and can be replaced. Licences: the files `*.copyright` beside this one. Sources:",
            "the named source package of Debian.", "",
            "| file | bytes | package | source |", "|---|---|---|---|"]
    for file, origin in bundled:
        package, version, source, source_version = package_of(origin)
        with open(f"/usr/share/doc/{package}/copyright", "rb") as copyright_file:
            files[f"{package}.copyright"] = copyright_file.read()
        references |= set(re.findall(rb"/usr/share/common-licenses/([A-Za-z0-9.-]*[A-Za-z0-9])",
                                     files[f"{package}.copyright"]))
        size = os.path.getsize(os.path.join(target, file))
        rows.append(f"| {file} | {size} | {package} {version} | {source} {source_version} |")
    for name in sorted(references):
        with open(b"/usr/share/common-licenses/" + name, "rb") as file:
            files[f"common-licenses/{name.decode()}"] = file.read()
    files["BUNDLED.md"] = ("\n".join(rows) + "\n").encode()
    return sorted(files.items())


def main(build_folder, output_folder):
    target = os.path.join(build_folder, "wheel", "starguard")
    bundled = bundle(build(build_folder), target)
    os.makedirs(output_folder, exist_ok=True)
    for old in glob.glob(os.path.join(output_folder, "starguard-*.whl")):
        os.remove(old)
    wheel = backend.pack(target, output_folder, tag(target), licences(target, bundled))
    path = os.path.join(output_folder, wheel)
    inside = sum(os.path.getsize(file) for file, _ in backend.files_below(target))
    print(f"{path}: {os.path.getsize(path) / 1e6:.1f} MB, {inside / 1e6:.1f} MB installed, "
          f"{len(bundled)} libraries bundled")


if __name__ == "__main__":
    main(*sys.argv[1:])
