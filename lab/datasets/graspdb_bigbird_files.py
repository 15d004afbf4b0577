"""The files of a folder in BigBIRD's layout: HDF5 datasets, clouds and meshes."""
import h5py
import numpy

# Depth maps count in 0.1 mm times the camera's own scale.
STEP_M = 1e-4
# Lenses of depth cameras are mild: each step removes most of the remaining distortion.
UNDISTORT_STEPS = 10
RIGID_TOLERANCE = 1e-3
PLY_TYPES = {"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "<i2", "int16": "<i2", "ushort": "<u2",
             "uint16": "<u2", "int": "<i4", "int32": "<i4", "uint": "<u4", "uint32": "<u4", "float": "<f4",
             "float32": "<f4", "double": "<f8", "float64": "<f8"}


class Failure(Exception):
    """An error for the user, in one sentence."""


def dataset(path, *names, shape):
    """The first of the named datasets, as numbers of that shape."""
    try:
        with h5py.File(path, "r") as file:
            for name in names:
                if name in file:
                    values = numpy.asarray(file[name], dtype=float)
                    break
            else:
                raise Failure(f"{path}: {names[-1]} is not there; copy the file again or choose other cameras")
    except FileNotFoundError as error:
        raise Failure(f"{path} is not there; copy the object's folder again") from error
    except (OSError, ValueError) as error:
        raise Failure(f"{path} is no HDF5 file with numbers ({error}); copy it again") from error
    if values.size != numpy.prod(shape):
        raise Failure(f"{path}: {names[-1]} has the shape {values.shape}, it must be {' x '.join(map(str, shape))}")
    if not numpy.isfinite(values).all():
        raise Failure(f"{path}: {names[-1]} is not finite; copy the file again")
    return values.reshape(shape)


def pose(path, name):
    matrix = dataset(path, name, shape=(4, 4))
    rotation = matrix[:3, :3]
    if not (numpy.allclose(matrix[3], (0, 0, 0, 1), atol=RIGID_TOLERANCE) and
            numpy.allclose(rotation.T @ rotation, numpy.eye(3), atol=RIGID_TOLERANCE) and
            numpy.linalg.det(rotation) > 0):
        raise Failure(f"{path}: {name} is no rigid transform; copy the file again or calibrate")
    u, _, v = numpy.linalg.svd(rotation)
    matrix[:3, :3] = u @ v
    matrix[3] = (0, 0, 0, 1)
    return matrix


def depth_points(path, calibration, camera):
    """The depth map as points in the frame of the infrared camera, lens distortion corrected."""
    k = dataset(calibration, f"{camera}_depth_K", f"{camera}_ir_K", shape=(3, 3))
    k1, k2, p1, p2, k3 = dataset(calibration, f"{camera}_depth_d", f"{camera}_ir_d", shape=(5,))
    step = STEP_M * dataset(calibration, f"{camera}_ir_depth_scale", shape=(1,))[0]
    if min(k[0, 0], k[1, 1], step) <= 0:
        raise Failure(f"{calibration}: a focal length or the depth scale of {camera} is not positive; copy the file again "
                      "or calibrate")
    depth = dataset(path, "depth", shape=(480, 640)) * step
    v, u = numpy.nonzero(depth > 0)
    seen = numpy.stack(((u - k[0, 2]) / k[0, 0], (v - k[1, 2]) / k[1, 1]))
    x, y = seen
    for _ in range(UNDISTORT_STEPS):
        r2 = x * x + y * y
        radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
        x, y = ((seen[0] - 2 * p1 * x * y - p2 * (r2 + 2 * x * x)) / radial,
                (seen[1] - p1 * (r2 + 2 * y * y) - 2 * p2 * x * y) / radial)
    z = depth[v, u]
    return numpy.stack((x * z, y * z, z), axis=1)


def write_pcd(path, points):
    with open(path, "wb") as file:
        file.write(f"VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {len(points)}\nHEIGHT 1\n"
                   f"VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {len(points)}\nDATA binary\n".encode())
        file.write(points.astype("<f4").tobytes())


class Mesh:
    """The vertices of a PLY or STL file; the rest of the file is kept as it is."""

    def __init__(self, path):
        with open(path, "rb") as file:
            self.bytes = file.read()
        try:
            self.read_ply() if path.endswith(".ply") else self.read_stl()
        except (ValueError, IndexError, KeyError, TypeError) as error:
            raise Failure(f"{path} cannot be read ({error}); convert it to a binary PLY or STL file") from error

    def read_ply(self):
        self.begin = self.bytes.index(b"end_header\n") + len(b"end_header\n")
        header = self.bytes[:self.begin].decode("ascii").split("\n")
        elements = [i for i, line in enumerate(header) if line.startswith("element ")]
        if not header[elements[0]].startswith("element vertex "):
            raise ValueError("its first element is not vertex")
        count = int(header[elements[0]].split()[2])
        end = elements[1] if len(elements) > 1 else len(header)
        fields = [line.split() for line in header[elements[0]:end] if line.startswith("property ")]
        self.ascii = "format ascii 1.0" in header
        if not self.ascii and "format binary_little_endian 1.0" not in header:
            raise ValueError("its format is neither ascii nor binary_little_endian")
        if self.ascii:
            body = self.bytes[self.begin:].split(b"\n", count)
            self.rows, self.rest = [row.split() for row in body[:count]], body[count]
            self.columns = [[field[2] for field in fields].index(axis) for axis in "xyz"]
            self.vertices = numpy.array([[float(row[c]) for c in self.columns] for row in self.rows])
        else:
            kind = numpy.dtype([(field[2], PLY_TYPES[field[1]]) for field in fields])
            self.table = numpy.frombuffer(self.bytes, kind, count, self.begin).copy()
            self.rest = self.bytes[self.begin + self.table.nbytes:]
            self.vertices = numpy.stack([self.table[axis] for axis in "xyz"], axis=1).astype(float)

    def read_stl(self):
        kind = numpy.dtype([("normal", "<f4", 3), ("vertices", "<f4", (3, 3)), ("attribute", "<u2")])
        self.begin, self.ascii = 84, False
        self.table = numpy.frombuffer(self.bytes, kind, int.from_bytes(self.bytes[80:84], "little"), self.begin).copy()
        self.rest = b""
        self.vertices = self.table["vertices"].reshape(-1, 3).astype(float)

    def write(self, path, vertices):
        if self.ascii:
            for row, vertex in zip(self.rows, vertices):
                for column, value in zip(self.columns, vertex):
                    row[column] = repr(float(value)).encode()
            body = b"".join(b" ".join(row) + b"\n" for row in self.rows)
        elif "vertices" in self.table.dtype.names:
            self.table["vertices"] = vertices.reshape(-1, 3, 3)
            body = self.table.tobytes()
        else:
            for axis, values in zip("xyz", vertices.T):
                self.table[axis] = values
            body = self.table.tobytes()
        with open(path, "wb") as file:
            file.write(self.bytes[:self.begin] + body + self.rest)


def pcd_points(path):
    """Points of an ascii or binary PCD file; None of a compressed one, which is not checked."""
    with open(path, "rb") as file:
        data = file.read()
    end = data.index(b"\n", data.index(b"\nDATA ") + 1) + 1
    header = dict(line.split(" ", 1) for line in data[:end].decode("ascii", "replace").splitlines() if " " in line)
    sizes, counts = header["SIZE"].split(), header.get("COUNT", "1 " * len(header["SIZE"].split())).split()
    names, kinds = header["FIELDS"].split(), header["TYPE"].split()
    if header["DATA"] == "ascii":
        columns = [names.index(axis) for axis in "xyz"]
        return numpy.array([[float(line.split()[c]) for c in columns] for line in data[end:].splitlines()]).reshape(-1, 3)
    if header["DATA"] != "binary":
        return None
    kind = numpy.dtype([(f"{name}{i}" if name not in "xyz" else name, f"<{kind.lower()}{size}", (int(n),) * (int(n) > 1))
                        for i, (name, kind, size, n) in enumerate(zip(names, kinds, sizes, counts))])
    table = numpy.frombuffer(data, kind, int(header["POINTS"]), end)
    return numpy.stack([table[axis] for axis in "xyz"], axis=1).astype(float)
