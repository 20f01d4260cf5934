"""The installed C library from a Python that has nothing else: no compiler, no package.

    python3 plan_by_ctypes.py [LIBRARY]
"""

import ctypes
import sys


class Task(ctypes.Structure):
    """The first fields of graphdrl_task [graphdrl_c.h]: its size says how many there are."""

    _fields_ = (
        ("size", ctypes.c_size_t),
        ("budget", ctypes.c_double),
        ("relative", ctypes.c_double),
        ("start", ctypes.c_int32),
        ("end", ctypes.c_int32),
        ("policy", ctypes.c_char_p),
        ("time_limit_s", ctypes.c_double),
        ("seed", ctypes.c_uint64),
        ("progress", ctypes.c_void_p),
        ("progress_data", ctypes.c_void_p),
    )


library = ctypes.CDLL(sys.argv[1] if len(sys.argv) > 1 else "libgraphdrl.so.0.1")
library.graphdrl_last_error.restype = ctypes.c_char_p
library.graphdrl_result_json.restype = ctypes.c_char_p
library.graphdrl_result_json.argtypes = [ctypes.c_void_p]
library.graphdrl_free.argtypes = [ctypes.c_void_p]
library.graphdrl_free.restype = None


def check(status):
    if status != 0:
        raise ValueError(library.graphdrl_last_error().decode())


world = ctypes.c_void_p()
check(library.graphdrl_world_from_file(b"paper:b", ctypes.byref(world)))
task = Task()
library.graphdrl_task_init_sized(ctypes.byref(task), ctypes.c_size_t(ctypes.sizeof(task)))
task.budget = 20
result = ctypes.c_void_p()
check(library.graphdrl_plan(world, ctypes.byref(task), ctypes.byref(result)))
print(library.graphdrl_result_json(result).decode())
library.graphdrl_free(result)
library.graphdrl_free(world)

try:
    check(library.graphdrl_world_from_file(b"no-such-map", ctypes.byref(world)))
except ValueError as error:
    print("and what goes wrong is said:", error)
