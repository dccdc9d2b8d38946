"""Makes a wheel of this tree with CMake (PEP 517), without anything from the network.

The wheel holds what `cmake --install` puts down: the package, the libraries it loads, which find each other by relative
paths, the plugins, and the program `withy`. With `--config-settings build-dir=build/release` a build that is there is
used and brought up to date.
"""

import base64
import hashlib
import os
import pathlib
import re
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = pathlib.PurePosixPath("lib/python3/dist-packages")


def _version():
    return re.search(r"^project\(withy VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text(), re.MULTILINE).group(1)


def _metadata():
    return (f"Metadata-Version: 2.1\nName: withy\nVersion: {_version()}\nLicense: MIT\nRequires-Python: >=3.9\n"
            "Summary: Dynamics of trees of rigid and flexible bodies\nRequires-Dist: numpy\n"
            "Provides-Extra: plot\nRequires-Dist: matplotlib; extra == 'plot'\n"
            "Provides-Extra: pandas\nRequires-Dist: pandas; extra == 'pandas'\n")


def _tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{re.sub('[-.]', '_', sysconfig.get_platform())}"


def _cmake(*arguments):
    subprocess.run(["cmake", *map(str, arguments)], check=True, cwd=ROOT, stdout=sys.stderr)


def _install(settings, prefix):
    """Configures, builds and installs into a folder, for the interpreter that runs this."""
    build = pathlib.Path(settings.get("build-dir", "build/wheel"))
    if not (ROOT / build / "CMakeCache.txt").exists():
        _cmake("--preset", "release", "-B", build, "-DWITHY_TESTS=OFF", "-DWITHY_ANY_PROCESSOR=ON",
               "-DCMAKE_INSTALL_LIBDIR=lib", f"-DPython3_EXECUTABLE={sys.executable}")
    _cmake("--build", build, "--target", "withy-package", "--parallel", os.cpu_count() or 1)
    _cmake("--install", build, "--prefix", prefix)
    if not (prefix / PACKAGE / "withy").exists():
        raise SystemExit(f"The Python module was not built: ask cmake -B {build} what it lacks.")


def _contents(prefix):
    """Files of the wheel: the name in it and the file. Of a library's names the one that is asked for at run time."""
    data = f"withy-{_version()}.data"
    for file in sorted(p for p in prefix.rglob("*") if p.is_file()):
        name = file.relative_to(prefix).as_posix()
        if name.startswith(f"{PACKAGE}/"):
            yield name.removeprefix(f"{PACKAGE}/"), file
        elif name.startswith("bin/"):
            yield f"{data}/scripts/{name.removeprefix('bin/')}", file
        elif name.startswith("lib/withy/") or re.search(r"^lib/.*libwithy-(hdf5\.so|.*\.so\.\d+\.\d+)$", name):
            yield f"{data}/data/{name}", file


def get_requires_for_build_wheel(config_settings=None):
    return []


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    name = f"withy-{_version()}-{_tag()}.whl"
    info = f"withy-{_version()}.dist-info"
    records = []
    with tempfile.TemporaryDirectory() as folder, \
            zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        _install(config_settings or {}, pathlib.Path(folder))

        def add(path, content, mode=0o644):
            entry = zipfile.ZipInfo(path)
            entry.external_attr = (0o100000 | mode) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            wheel.writestr(entry, content)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            records.append(f"{path},sha256={digest},{len(content)}\n")

        for path, file in _contents(pathlib.Path(folder)):
            add(path, file.read_bytes(), 0o755 if os.access(file, os.X_OK) else 0o644)
        add(f"{info}/METADATA", _metadata().encode())
        add(f"{info}/WHEEL", f"Wheel-Version: 1.0\nGenerator: withy\nRoot-Is-Purelib: false\nTag: {_tag()}\n".encode())
        wheel.writestr(f"{info}/RECORD", "".join(records) + f"{info}/RECORD,,\n")
    return name


def build_sdist(sdist_directory, config_settings=None):
    raise SystemExit("Archives of the sources are made with git archive.")
