#!/usr/bin/python3
"""camera_errors.py FOLDER: the errors of real depth cameras, for rendering/camera/camera_presets.cc.

FOLDER has frames.json as `graspdb eval` reads it, with "intrinsics" and "plane" of each frame. Of
the planes: the noise of single pixels, errors over some pixels ("bumps") and over the image
("warps"), in mm along the ray and scaled to 1 m. Of the objects whose pose is known: the shares of
measured pixels by the distance from the silhouette and by the angle of incidence. Needs python3-numpy and
python3-scipy.
"""
import json
import os
import re
import sys

import numpy as np
from scipy import ndimage

NEAR_M = 0.006  # a pixel this near to the mesh, across the surface, belongs to it
PLANE_M = 0.012  # and this near to the plane to the plane


def read_pcd(path):
    with open(path, "rb") as file:
        data = file.read()
    body = data.index(b"DATA binary\n") + len(b"DATA binary\n")
    size = [int(re.search(key + rb" (\d+)", data[:body])[1]) for key in (b"HEIGHT", b"WIDTH")]
    return np.frombuffer(data[body:], "<f4")[: size[0] * size[1] * 3].reshape(*size, 3).copy()


def read_obj(path):
    vertices, faces = [], []
    with open(path, encoding="latin1") as file:
        for words in map(str.split, file):
            if words[:1] == ["v"]:
                vertices.append([float(x) for x in words[1:4]])
            if words[:1] == ["f"]:
                corners = [int(x.split("/")[0]) - 1 for x in words[1:]]
                faces += [[corners[0], corners[k], corners[k + 1]] for k in range(1, len(corners) - 1)]
    return np.array(vertices), np.array(faces)


def read_ply(path):
    """Vertices and triangles; ascii or little-endian."""
    kinds = {"float": "f4", "float32": "f4", "double": "f8", "uchar": "u1", "uint8": "u1", "char": "i1",
             "int": "i4", "int32": "i4", "uint": "u4", "ushort": "u2", "short": "i2"}
    with open(path, "rb") as file:
        data = file.read()
    body = data.index(b"\n", data.index(b"end_header")) + 1
    header = data[:body].decode("latin1")
    counts, names = [int(n) for n in re.findall(r"element \w+ (\d+)", header)], []
    for block in header.split("element ")[1:]:
        names.append([line.split()[1:] for line in block.split("\n") if line.startswith("property")])
    if "format ascii" in header:
        lines = data[body:].decode("latin1").split("\n")
        vertices = [[float(x) for x in line.split()[:3]] for line in lines[: counts[0]]]
        faces = [[int(x) for x in line.split()[1:4]] for line in lines[counts[0] : sum(counts[:2])]]
        return np.array(vertices), np.array(faces)
    point = np.dtype([(name, "<" + kinds[kind]) for kind, name in names[0]])
    points = np.frombuffer(data, point, counts[0], body)
    _, count, index, _ = names[1][0]
    face = np.dtype([("n", "<" + kinds[count]), ("corners", "<" + kinds[index], 3)] +
                    [(name, "<" + kinds[kind]) for kind, name in names[1][1:]])
    faces = np.frombuffer(data, face, counts[1], body + point.itemsize * counts[0])
    return np.stack([points[axis] for axis in "xyz"], 1).astype(float), faces["corners"].astype(int)


def sample(vertices, faces, count):
    random = np.random.default_rng(0)
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    areas = np.linalg.norm(normals, axis=1)
    of = random.choice(len(faces), count, p=areas / areas.sum())
    u = random.random((count, 2))
    u[u.sum(1) > 1] = 1 - u[u.sum(1) > 1]
    points = a[of] + u[:, :1] * (b - a)[of] + u[:, 1:] * (c - a)[of]
    return points, normals[of] / np.maximum(areas[of], 1e-12)[:, None]


def smooth(values, mask, width):
    share = ndimage.uniform_filter(mask.astype(float), width)
    total = ndimage.uniform_filter(np.where(mask, values, 0), width)
    return np.where(share > 0.3, total / np.maximum(share, 1e-9), np.nan)


def print_plane(frame, points):
    normal, point = (np.array(frame["plane"][key]) for key in ("normal_to_camera", "point"))
    for _ in range(6):  # fitted again to its own points
        off = (points - point) @ normal
        mask = np.isfinite(off) & (np.abs(off) < PLANE_M)
        own = points[mask]
        point = own.mean(0)
        fitted = np.linalg.svd((own - point)[:: max(1, len(own) // 20000)], full_matrices=False)[2][2]
        normal = fitted * np.sign(fitted @ normal)
    off = (points - point) @ normal
    mask = np.isfinite(off) & (np.abs(off) < PLANE_M)
    depth = np.median(points[..., 2][mask])
    rays = points[mask] / np.linalg.norm(points[mask], axis=1)[:, None]
    off = off / abs(np.median(rays @ normal))
    inner = ndimage.binary_erosion(mask, iterations=2)
    image = smooth(off, mask, 61)
    single, bumps, warps = (1000 * np.nanstd(values[inner]) for values in
                            (off - smooth(off, mask, 3), smooth(off, mask, 5) - image, image))
    print(f"  plane at {depth:.2f} m: single pixels {single:.2f} mm, at 1 m: bumps "
          f"{bumps / depth**2:.1f} mm, warps {warps / depth**2:.1f} mm")


def print_shares(what, low, high, chosen, state):
    if chosen.sum() < 30:
        return
    shares = ", ".join(f"{name} {(state[chosen] == name).mean():.2f}"
                       for name in ("there", "behind", "before", "lost"))
    print(f"    {what} {low} to {high}: {chosen.sum():5d} pixels, {shares}")


def print_object(folder, frame, object, points):
    pose = np.array(object["T_sensor_mesh"])
    path = os.path.join(folder, object["mesh"])
    vertices, faces = (read_obj if path.endswith(".obj") else read_ply)(path)
    unit = 0.001 if object["meshUnit"] == "mm" else 1
    at, normals = sample(vertices * unit, faces, 400000)
    at = at @ pose[:3, :3].T + pose[:3, 3]
    cosines = -(normals @ pose[:3, :3].T * at).sum(1) / np.linalg.norm(at, axis=1)
    k = frame["intrinsics"]
    column = np.round(at[:, 0] / at[:, 2] * k["fx"] + k["cx"]).astype(int)
    row = np.round(at[:, 1] / at[:, 2] * k["fy"] + k["cy"]).astype(int)
    height, width = points.shape[:2]
    seen = (column >= 0) & (column < width) & (row >= 0) & (row < height) & (cosines > 0.02)
    order = np.argsort(-at[:, 2])  # nearest last
    order = order[seen[order]]
    depth, cosine = np.full((height, width), np.nan), np.zeros((height, width))
    depth[row[order], column[order]] = at[order, 2]
    cosine[row[order], column[order]] = cosines[order]
    mask = np.isfinite(depth)
    inside = ndimage.distance_transform_edt(ndimage.binary_closing(mask))
    off = points[..., 2] - depth
    state = np.where(~np.isfinite(points[..., 2]), "lost", np.where(
        np.abs(off) * cosine < NEAR_M, "there", np.where(off > 0, "behind", "before")))
    print(f"  {object['object']}: {1000 * np.nanmean(depth) / k['fx']:.2f} mm a pixel")
    for low, high in ((1, 1.5), (1.5, 2.5), (2.5, 3.5), (3.5, 5), (5, 8), (8, 99)):
        print_shares("pixels from the silhouette", low, high, mask & (inside >= low) & (inside < high),
                     state)
    angle = np.degrees(np.arccos(np.clip(cosine, 0, 1)))
    for low, high in ((0, 30), (30, 50), (50, 60), (60, 70), (70, 80), (80, 90)):
        print_shares("degrees", low, high, mask & (inside >= 4) & (angle >= low) & (angle < high), state)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = sys.argv[1]
    with open(os.path.join(folder, "frames.json"), encoding="utf-8") as file:
        frames = json.load(file)
    for frame in frames:
        print(f"{frame['frame']}: {frame['sensor']}")
        points = read_pcd(os.path.join(folder, frame["frame"]))
        print_plane(frame, points)
        for object in frame["objects"]:
            if object.get("T_sensor_mesh"):
                print_object(folder, frame, object, points)


if __name__ == "__main__":
    main()
