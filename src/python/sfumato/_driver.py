"""The OpenGL driver that a wheel brings, for systems without one. Other installations have none of this."""
import ctypes
import glob
import os


def _system_has_one():
    try:
        ctypes.CDLL("libEGL.so.1")
    except OSError:
        return False
    return any(glob.glob(f"{folder}/glvnd/egl_vendor.d/*.json") for folder in ("/usr/share", "/etc"))


def prepare():
    """Before the engine is loaded: SFUMATO_GL=bundled or system chooses, else the system's where it has one. Libraries that are loaded already are
    found by their names, wherever they lie."""
    mesa = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "sfumato.libs", "mesa")
    choice = os.environ.get("SFUMATO_GL", "")
    if not os.path.isdir(mesa):
        return
    if choice == "system" or choice != "bundled" and _system_has_one():
        try:
            ctypes.CDLL("libOpenGL.so.0")
        except OSError:  # a driver that came without it, as on desktops that only knew libGL
            ctypes.CDLL(os.path.join(mesa, "libOpenGL.so.0"))
        return
    os.environ["__EGL_VENDOR_LIBRARY_FILENAMES"] = os.path.join(mesa, "egl.json")
    os.environ["LIBGL_DRIVERS_PATH"] = os.path.join(mesa, "dri")
    waiting = sorted(glob.glob(os.path.join(mesa, "*.so*")))
    while waiting:
        still = []
        for library in waiting:
            try:
                ctypes.CDLL(library)
            except OSError:  # one of those it needs comes later
                still.append(library)
        if len(still) == len(waiting):
            return
        waiting = still
