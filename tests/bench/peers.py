# The engine beside what others would use, in one process: peers.py LIBOURS [LIBEIGEN]
# Prints how many times faster the engine is. Times are the least of many rounds, the engine's taken
# before and after each peer's. A peer that is not installed is skipped, and said so.
import ctypes
import sys
import time

RADIUS_MM = 40.0


def load_ours(path):
    lib = ctypes.CDLL(path)
    lib.ours_create.restype = ctypes.c_void_p
    lib.ours_create.argtypes = [ctypes.c_double]
    lib.ours_count.argtypes = [ctypes.c_void_p]
    lib.ours_count.restype = ctypes.c_uint32
    lib.ours_rows.argtypes = [ctypes.c_void_p] * 5
    lib.ours_shown.argtypes = [ctypes.c_void_p] * 2
    for name in ("ours_anchored_ns", "ours_unanchored_ns"):
        getattr(lib, name).restype = ctypes.c_double
        getattr(lib, name).argtypes = [ctypes.c_void_p, ctypes.c_uint32]
    return lib


class Ours:
    def __init__(self, path):
        self.lib = load_ours(path)
        self.self = self.lib.ours_create(RADIUS_MM)
        if not self.self:
            sys.exit("the engine could not be set up")
        self.count = self.lib.ours_count(self.self)

    def anchored_ns(self):
        return self.lib.ours_anchored_ns(self.self, 200)

    def unanchored_ns(self):
        return self.lib.ours_unanchored_ns(self.self, 60)


def least_ns(work, rounds, seconds=3.0):
    work()
    least, end = 1e30, time.perf_counter() + seconds
    for _ in range(rounds):
        start = time.perf_counter_ns()
        work()
        least = min(least, time.perf_counter_ns() - start)
        if time.perf_counter() > end:
            break
    return least


def compare(ours, name, measure, against):
    anchored, unanchored = [ours.anchored_ns()], [ours.unanchored_ns()]
    peer = measure()
    anchored.append(ours.anchored_ns())
    unanchored.append(ours.unanchored_ns())
    line = f"{name:44s} {peer / 1e6:9.3f} ms"
    line += f"   anchored {peer / min(anchored):8.1f} x" if "anchored" in against else " " * 23
    line += f"   unanchored {peer / min(unanchored):7.1f} x" if "unanchored" in against else ""
    print(line, flush=True)


def rows(ours, numpy):
    n = ours.count
    xyz = numpy.empty((n, 3), numpy.float32)
    start, pull = numpy.empty((10, 3)), numpy.empty((10, 3))
    response = numpy.empty((n, 10), numpy.float32)
    ours.lib.ours_rows(ours.self, *(a.ctypes.data for a in (xyz, start, pull, response)))
    return xyz, start, pull, response


def check(ours, numpy, xyz, pull, response):
    ours.anchored_ns()
    shown = numpy.empty_like(xyz)
    ours.lib.ours_shown(ours.self, shown.ctypes.data)
    off = numpy.abs(shown - (xyz + response @ pull.astype(numpy.float32))).max()
    print(f"the same frame by numpy: {off:.1e} mm apart")
    if not off < 1e-4:
        sys.exit("the engine and numpy do not agree: nothing here would mean anything")


def numpy_peers(ours, numpy, xyz, pull, response):
    forms = {}
    for name, kind, order in (("float32, columns", numpy.float32, "F"),
                              ("float32, rows", numpy.float32, "C"),
                              ("float64, rows", numpy.float64, "C")):
        b = numpy.array(response, kind, order=order)
        e = numpy.array(pull, kind)
        rest = numpy.array(xyz, kind, order=order)
        forms[name] = (b, e, rest)

    def best():
        return min(least_ns(lambda f=f: f[2] + f[0] @ f[1], 200, 1.0) for f in forms.values())

    compare(ours, "numpy, best of 3 forms of rest + B pull", best, ("anchored",))


def eigen_peers(ours, numpy, path, xyz, pull, response):
    lib = ctypes.CDLL(path)
    e = numpy.ascontiguousarray(pull, numpy.float32)

    def best():
        out = (ctypes.c_double * 6)()
        lib.eigen_forms_ns(ctypes.c_void_p(xyz.ctypes.data), ctypes.c_void_p(response.ctypes.data),
                           ctypes.c_void_p(e.ctypes.data), ctypes.c_uint(ours.count),
                           ctypes.c_uint(200), out)
        return min(out)

    compare(ours, "Eigen -O3 -march=native, best of 6 forms", best, ("anchored",))


def scipy_peers(ours, xyz, start, pull):
    try:
        from scipy.interpolate import RBFInterpolator
    except ImportError:
        print("scipy: not installed, skipped")
        return
    at = xyz.astype(float)
    for kernel in ("thin_plate_spline", "cubic"):
        def frame(kernel=kernel):
            RBFInterpolator(start, pull, kernel=kernel)(at)
        compare(ours, f"scipy RBFInterpolator, {kernel}", lambda f=frame: least_ns(f, 20),
                ("anchored", "unanchored"))


def vtk_peers(ours, xyz, start, pull):
    try:
        from vtkmodules.util.numpy_support import numpy_to_vtk
        from vtkmodules.vtkCommonCore import vtkPoints
        from vtkmodules.vtkCommonTransforms import vtkThinPlateSplineTransform
    except ImportError:
        print("VTK: not installed, skipped")
        return

    def as_points(array):
        points = vtkPoints()
        points.SetData(numpy_to_vtk(array, deep=True))
        return points

    source, here = as_points(start), as_points(xyz.astype(float))
    for name in ("R", "R2LogR"):
        transform = vtkThinPlateSplineTransform()
        transform.SetSourceLandmarks(source)
        getattr(transform, f"SetBasisTo{name}")()

        def frame(transform=transform):
            transform.SetTargetLandmarks(as_points(start + pull))
            there = vtkPoints()
            there.SetDataTypeToDouble()
            transform.TransformPoints(here, there)
        compare(ours, f"VTK vtkThinPlateSplineTransform, {name}",
                lambda f=frame: least_ns(f, 100), ("anchored", "unanchored"))


def main():
    ours = Ours(sys.argv[1])
    print(f"{ours.count} vertices, ten controls, R = {RADIUS_MM:g} mm, one thread; the engine: "
          f"anchored {ours.anchored_ns() / 1e6:.4f} ms, "
          f"unanchored, the whole step, {ours.unanchored_ns() / 1e6:.4f} ms")
    try:
        import numpy
    except ImportError:
        print("numpy: not installed, and with it all that is measured here: skipped")
        return
    xyz, start, pull, response = rows(ours, numpy)
    check(ours, numpy, xyz, pull, response)
    numpy_peers(ours, numpy, xyz, pull, response)
    if len(sys.argv) > 2:
        eigen_peers(ours, numpy, sys.argv[2], xyz, pull, response)
    else:
        print("Eigen: not installed, skipped")
    vtk_peers(ours, xyz, start, pull)
    scipy_peers(ours, xyz, start, pull)


if __name__ == "__main__":
    main()
