"""From CMake's build of the package to a wheel: what pip asks of a project (PEP 517 and 660), with nothing but CMake and Ninja.

config_settings: cmake-args, options for CMake: ``pip install . --config-settings=cmake-args=-DCMAKE_CXX_COMPILER=clang++``.
"""
import base64
import hashlib
import os
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tomllib
import zipfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


def _build(config_settings):
    """The folder with the built package."""
    # Debian's interpreter shares the build of `make`; another one gets a build of its own.
    debian = os.path.realpath(sys.executable) == os.path.realpath("/usr/bin/python3")
    folder = os.path.join(ROOT, "build", "release" if debian else f"python-{sys.version_info[0]}.{sys.version_info[1]}")
    options = ["-DSFUMATO_PYTHON=ON", "-DSFUMATO_TESTS=OFF"]
    if not debian:
        options += [f"-DPython_EXECUTABLE={sys.executable}", "-DSFUMATO_BENCH=OFF"]
    if shutil.which("ccache"):
        options += ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache", "-DSFUMATO_PRECOMPILE=OFF", "-DSFUMATO_UNITY=OFF"]
    given = (config_settings or {}).get("cmake-args", "")
    options += shlex.split(given) if isinstance(given, str) else given
    subprocess.run(["cmake", "--preset", "release", "-B", folder, *options], cwd=ROOT, check=True)
    subprocess.run(["cmake", "--build", folder, "--target", "python"], cwd=ROOT, check=True)
    return os.path.join(folder, "python")


def _project():
    with open(os.path.join(ROOT, "pyproject.toml"), "rb") as file:
        project = tomllib.load(file)["project"]
    with open(os.path.join(ROOT, "CMakeLists.txt"), encoding="utf-8") as file:
        project["version"] = re.search(r"project\(sfumato VERSION ([0-9.]+)", file.read())[1]
    return project


def _metadata(project):
    lines = ["Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {project['version']}",
             f"Summary: {project['description']}", f"License: {project['license']['text']}",
             f"Requires-Python: {project['requires-python']}", *(f"Requires-Dist: {each}" for each in project["dependencies"])]
    return "\n".join(lines) + "\n"


def write_wheel(wheel_directory, files, system=None):
    """`files`: names in the wheel and their bytes; `system`: of the tag, else this one. Returns the wheel's name."""
    project = _project()
    python = f"cp{sys.version_info[0]}{sys.version_info[1]}"
    tag = f"{python}-{python}-{system or re.sub('[-.]', '_', sysconfig.get_platform())}"
    name = f"{project['name']}-{project['version']}"
    info = f"{name}.dist-info"
    with open(os.path.join(ROOT, "LICENSE"), "rb") as file:
        files[f"{info}/LICENSE"] = file.read()
    files[f"{info}/METADATA"] = _metadata(project).encode()
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: sfumato\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    record = ""
    with zipfile.ZipFile(os.path.join(wheel_directory, f"{name}-{tag}.whl"), "w", zipfile.ZIP_DEFLATED) as wheel:
        for each, content in files.items():
            entry = zipfile.ZipInfo(each)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if each.endswith("/sfumato-decoder") else 0o644) << 16
            wheel.writestr(entry, content)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).decode().rstrip("=")
            record += f"{each},sha256={digest},{len(content)}\n"
        wheel.writestr(f"{info}/RECORD", record + f"{info}/RECORD,,\n")
    return f"{name}-{tag}.whl"


def package_files(package):
    """Names in a wheel and bytes of the package in that folder."""
    files = {}
    for name in sorted(os.listdir(package)):
        if name.endswith((".py", ".pyi", ".so")) or name in ("py.typed", "sfumato-decoder"):
            with open(os.path.join(package, name), "rb") as file:
                files[f"sfumato/{name}"] = file.read()
    return files


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    return write_wheel(wheel_directory, package_files(os.path.join(_build(config_settings), "sfumato")))


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    """The built package where it lies: `cmake --build` renews it."""
    return write_wheel(wheel_directory, {"_sfumato.pth": (_build(config_settings) + "\n").encode()})
