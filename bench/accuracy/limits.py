#!/usr/bin/python3
"""What the points of scans can tell of some traits, without knowing more than what was scanned.

    limits.py TRUTH_FOLDER... [--worst N]
    limits.py --check                     the formula against principal axes of points with noise; exit status 1 if it is off

Each folder is what `plantimeter simulate` writes (PLANT.labelled.ply, PLANT.mesh.ply, PLANT.truth.json; plants without a
mesh are passed over). Prints by scan mode, over the plants of all folders together; exit status 1 if there are none:

leaf inclination    RMSE of what noise alone does to the principal plane of a leaf whose labels, whole surface and noise are
                    known (no prior knowledge of how leaves hang): it turns the principal axis a against the normal n (moments
                    l_a, l_n of the true surface; covariance C of the noise) with the variance
                    (l_a C_nn + l_n C_aa + C_aa C_nn + C_an^2) / (N (l_a - l_n)^2), N points (of fused scans: pixels). The
                    noise of simulated depth cameras is along their rays, that of splats along the normal and at least a
                    quarter of it across. Sampling, lost rims and errors of views come on top.
of known shapes     the same of a leaf whose shape and place in its plane are known as well, and only its shift off that plane
                    and its turns out of it are not: RMSE of least squares by the true points' distances along the true
                    normals, and what independent noise of the plant's SD would leave (its Cramer-Rao bound).
stem diameter       of stems of 2 to 4 mm: how far twice the mean over sides of the median distance of the stem's true points
                    from its true axis, at the height of the diameter, is off between plants (SD: the mean offset, which a
                    model of the noise can take off, is left out).
"""
import argparse
import glob
import json
import math
import os
import sys
from collections import defaultdict

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
try:
    import numpy as np

    import bars
    import score
except ImportError as problem:  # a machine without numpy skips the test
    print(f"skipped: {problem}")
    sys.exit(77)

LEAF, STEM = 3, 1
MOST = math.radians(30)  # what is told of a plane that nothing determines
SLAB = 0.010  # along the stem, to both sides of the diameter's height
SECTORS = 12
SPLAT_ACROSS = 0.25  # noise of splats in the surface, of that along the normal, at least
BLOCK = 1024  # points that are compared with all triangles at a time
FAR = 4  # SD of noise: farther points are no leaf's
FEWEST = 4  # points that tell a shift and two turns
FACE = np.dtype([("corners", "u1"), ("corner", "<i4", 3), ("label", "u1"), ("organ", "<i4"), ("leaflet", "<i4")])


def read_mesh(path):
    with open(path, "rb") as file:
        data = file.read()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    sizes = [int(line.split()[2]) for line in data[:end].decode().splitlines() if line.startswith("element")]
    vertex = np.frombuffer(data, "<f8", 3 * sizes[0], end).reshape(-1, 3)
    return vertex, np.frombuffer(data, FACE, sizes[1], end + vertex.nbytes)


def surface_moments(vertex, corner):
    """Second moments (3, 3) of a surface of triangles about its centroid, over its area."""
    corners = [vertex[corner[:, k]] for k in range(3)]
    area = np.linalg.norm(np.cross(corners[1] - corners[0], corners[2] - corners[0]), axis=1) / 2
    middle = (area[:, None] * sum(corners) / 3).sum(0) / area.sum()
    corners = [c - middle for c in corners]
    parts = corners + [sum(corners)]
    return sum(np.einsum("n,ni,nj->ij", area / 12, p, p) for p in parts) / area.sum()


def noise_covariance(scan, normal):
    """Of a point, or of a pixel of a fused scan: (3, 3), square metres."""
    noise = scan.get("sigma_at_plant", scan.get("sigma", 0))
    if scan["mode"] == "splat":
        return noise**2 * (np.outer(normal, normal) + SPLAT_ACROSS**2 * (np.eye(3) - np.outer(normal, normal)))
    if "elevation" in scan:  # a ring of views
        level, up = math.cos(math.radians(scan["elevation"])) ** 2 / 2, math.sin(math.radians(scan["elevation"])) ** 2
        return noise**2 * np.diag([level, level, up])
    return noise**2 / 3 * np.eye(3)


def inclination_variance(moments, covariance, count):
    value, axis = np.linalg.eigh(moments)
    steep = max(math.hypot(axis[0, 0], axis[1, 0]), 1e-3)  # sine of the tilt
    along = axis.T @ covariance @ axis
    variance = 0
    for a in (1, 2):
        noise = value[a] * along[0, 0] + (value[0] + along[0, 0]) * along[a, a] + along[0, a] ** 2
        variance += noise / (count * max(value[a] - value[0], 1e-18) ** 2) * (axis[2, a] / steep) ** 2
    return min(variance, MOST**2)


def turn_of_known_shape(vertex, corner, points):
    """How far points lie turned, about the level line in the plane of the triangles that they are of: the distances (n)
    along normals, and the rows that give turn (radians) and leverage from them, by least squares in shift and two turns."""
    corners = [vertex[corner[:, k]] for k in range(3)]
    normal, middle = np.cross(corners[1] - corners[0], corners[2] - corners[0]), sum(corners) / 3
    normal = normal / np.maximum(np.linalg.norm(normal, axis=1), 1e-30)[:, None]
    centred = middle - middle.mean(0)
    square = 0.5 * (centred**2).sum(1)
    blocks = np.array_split(points - middle.mean(0), len(points) // BLOCK + 1)
    near = np.concatenate([(square - b @ centred.T).argmin(1) for b in blocks])
    off = np.linalg.eigh(surface_moments(vertex, corner))[1][:, 0]
    level = np.cross(off, [0, 0, 1]) if abs(off[2]) < 1 - 1e-9 else np.array([1.0, 0, 0])
    level = level / np.linalg.norm(level)
    arm = np.cross(points - points.mean(0), normal[near])
    rows = np.column_stack([normal[near] @ off, arm @ level, arm @ np.cross(off, level)])
    return ((points - middle[near]) * normal[near]).sum(1), rows


def solve_turn(distance, rows, noise):
    """The turn and its variance, in a second round without points that are off by more than FAR times the noise; what the
    points do not determine is not known."""
    found, kept = np.zeros(3), np.ones(len(distance), bool)
    for _ in range(2):
        matrix = rows[kept].T @ rows[kept]
        if np.count_nonzero(kept) < FEWEST or np.linalg.matrix_rank(matrix) < 3:
            return MOST, MOST**2
        inverse = np.linalg.inv(matrix)
        found = inverse @ rows[kept].T @ distance[kept]
        kept = np.abs(distance - rows @ found) <= FAR * noise
    return float(np.clip(found[1], -MOST, MOST)), min(noise**2 * inverse[1, 1], MOST**2)


def stem_offset(stem, points):
    """Twice the mean over sides of the median distance from the true axis, less the diameter; None: too few points."""
    along, at = np.array(stem["stem_axis"]), points - np.array(stem["stem_diameter_point"])
    height = at @ along
    across = (at - np.outer(height, along))[np.abs(height) < SLAB]
    if len(across) < 2 * SECTORS:
        return None
    u = np.cross(along, [1, 0, 0])
    turn = np.arctan2(across @ u, across @ np.cross(along, u)) / (2 * math.pi)
    sector = np.floor(turn * SECTORS).astype(int) % SECTORS
    distance = np.linalg.norm(across, axis=1)
    sides = [np.median(distance[sector == k]) for k in range(SECTORS) if np.any(sector == k)]
    return 2 * float(np.mean(sides)) - stem["stem_diameter"]


def add_known(plant, leaves, known):
    """leaves: what turn_of_known_shape gives, of all leaves of a plant."""
    if not leaves:
        return
    noise = 1.4826 * float(np.median(np.abs(np.concatenate([distance for distance, _ in leaves]))))
    for distance, rows in leaves:
        turn, variance = solve_turn(distance, rows, noise)
        known[plant["scan"]["mode"]].append((turn**2, variance, plant["kind"]))


def add_plant(path, leaves, stems, known):
    with open(path + ".truth.json", encoding="utf-8") as file:
        truth = json.load(file)
    vertex, face = read_mesh(path + ".mesh.ply")
    cloud = score.read_ply(path + ".labelled.ply")
    scan, plant = truth["scan"], np.count_nonzero(cloud["label"])
    pixels = scan["pixels"] / plant if scan.get("pixels") else 1
    xyz, shapes = np.column_stack([cloud[k] for k in "xyz"]).astype(float), []
    for organ in truth["organs"]:
        if organ["organ"] == "leaf" and organ["points"]:
            mine = (face["label"] == LEAF) & (face["organ"] == organ["organ_id"])
            moments = surface_moments(vertex, face["corner"][mine])
            covariance = noise_covariance(scan, np.linalg.eigh(moments)[1][:, 0])
            variance = inclination_variance(moments, covariance, organ["points"] * pixels)
            leaves[scan["mode"]].append((variance, truth["kind"], truth["plant_id"], organ["organ_id"]))
            own = xyz[(cloud["label"] == LEAF) & (cloud["organ"] == organ["organ_id"])]
            if len(own):
                shapes.append(turn_of_known_shape(vertex, face["corner"][mine], own))
        if organ["organ"] == "stem" and bars.THIN_STEM[0] <= organ.get("stem_diameter", 0) <= bars.THIN_STEM[1]:
            offset = stem_offset(organ, xyz[cloud["label"] == STEM])
            if offset is not None:
                stems[scan["mode"]].append(offset)
    add_known(truth, shapes, known)


def check():
    """Plane pieces of 6 by 3 mm at all tilts, 600 fixed points, noise of 0.1 to 0.2 mm by axis of space, which the principal
    axes are freed of: RMSE of the tilt over 400 throws."""
    random, worst = np.random.default_rng(5), 0
    a, b = np.meshgrid(np.linspace(-3e-3, 3e-3, 40), np.linspace(-1.5e-3, 1.5e-3, 15))
    flat, sigmas = np.column_stack([a.ravel(), b.ravel(), np.zeros(a.size)]), np.array([2e-4, 1.5e-4, 1e-4])
    for tilt, turn in ((0.6, 0.0), (0.6, 0.9), (1.2, 0.4), (1.5, 1.5)):
        c, s, ct, st = math.cos(tilt), math.sin(tilt), math.cos(turn), math.sin(turn)
        points = flat @ np.array([[ct, st, 0], [-st, ct, 0], [0, 0, 1]]) @ np.array([[1, 0, 0], [0, c, s], [0, -s, c]])
        squares = 0
        for _ in range(400):
            thrown = points + random.normal(0, 1, points.shape) * sigmas
            axis = np.linalg.eigh(np.cov(thrown.T) - np.diag(sigmas**2))[1]
            squares += (math.acos(min(abs(axis[2, 0]), 1)) - tilt) ** 2 / 400
        told = inclination_variance(np.cov(points.T), np.diag(sigmas**2), len(points))
        worst = max(worst, abs(math.sqrt(squares / told) - 1))
        print(f"tilt {tilt}: {degrees([squares]):.3f} deg, {degrees([told]):.3f} told")
    return worst < 0.15 and check_known()


def check_known():
    """A curled leaf of 6 by 4 mm, 300 points with 0.3 mm of noise, turned by 2 degrees: their mean turn and scatter."""
    random, turn, found, told = np.random.default_rng(6), math.radians(2), [], []
    u, v = np.meshgrid(np.linspace(-3e-3, 3e-3, 25), np.linspace(-2e-3, 2e-3, 17))
    vertex = np.column_stack([u.ravel(), v.ravel(), 60 * u.ravel() ** 2])
    at = np.arange(u.size).reshape(u.shape)
    corner = np.concatenate([np.column_stack([a.ravel() for a in (at[:-1, :-1], at[:-1, 1:], at[1:, 1:])]),
                             np.column_stack([a.ravel() for a in (at[:-1, :-1], at[1:, 1:], at[1:, :-1])])])
    lean = np.array([[1, 0, 0], [0, math.cos(0.7), -math.sin(0.7)], [0, math.sin(0.7), math.cos(0.7)]])
    more = np.array([[1, 0, 0], [0, math.cos(turn), -math.sin(turn)], [0, math.sin(turn), math.cos(turn)]])
    for _ in range(200):
        points = vertex[corner].mean(1)[random.integers(0, len(corner), 300)] @ (lean @ more).T
        distance, rows = turn_of_known_shape(vertex @ lean.T, corner, points + random.normal(0, 3e-4, points.shape))
        turned, variance = solve_turn(distance, rows, 3e-4)
        found.append(abs(turned))
        told.append(variance)
    print(f"known shape turned by 2 deg: {math.degrees(np.mean(found)):.2f} deg, scatter "
          f"{math.degrees(np.std(found)):.2f}, {degrees(told):.2f} told")
    return abs(math.degrees(np.mean(found)) - 2) < 0.2 and abs(np.std(found) / math.sqrt(np.mean(told)) - 1) < 0.2


def by_kind(rows):
    """Of rows (variance, kind): '0.3 deg of 40 leaves: maize 0.1, ...'."""
    kinds = defaultdict(list)
    for variance, kind in rows:
        kinds[kind].append(variance)
    return (f"{degrees([r[0] for r in rows]):.3f} deg of {len(rows)} leaves: "
            + ", ".join(f"{k} {degrees(v):.2f}" for k, v in sorted(kinds.items())))


def degrees(variances):
    return math.degrees(math.sqrt(sum(variances) / len(variances)))


def main():
    parser = argparse.ArgumentParser(description="What the points of scans can tell of some traits.")
    parser.add_argument("folder", nargs="*", help="folder of plantimeter simulate")
    parser.add_argument("--check", action="store_true", help="test the formula by throws of noise")
    parser.add_argument("--worst", type=int, default=0, help="leaves to name")
    options = parser.parse_args()
    if options.check:
        sys.exit(0 if check() else 1)
    if not options.folder:
        parser.error("no folder")
    leaves, stems, known = defaultdict(list), defaultdict(list), defaultdict(list)
    for folder in options.folder:
        for path in sorted(glob.glob(os.path.join(folder, "*.truth.json"))):
            plant = path[: -len(".truth.json")]
            if os.path.exists(plant + ".mesh.ply"):
                add_plant(plant, leaves, stems, known)
    if not leaves:
        sys.exit("no virtual plant with a mesh in " + ", ".join(options.folder))
    for mode, rows in leaves.items():
        print(f"{mode}: leaf inclination {by_kind([r[:2] for r in rows])}")
        for variance, _, plant, organ in sorted(rows, reverse=True)[: options.worst]:
            print(f"    {plant} leaf {organ}: {math.degrees(math.sqrt(variance)):.1f} deg")
    for mode, rows in known.items():
        print(f"{mode}: of known shapes {by_kind([(r[0], r[2]) for r in rows])}")
        print(f"{mode}: of known shapes, told {by_kind([r[1:] for r in rows])}")
    for mode, rows in stems.items():
        print(f"{mode}: stem diameter {1e3 * np.std(rows):.3f} mm of {len(rows)} stems of 2 to 4 mm "
              f"(mean offset {1e3 * np.mean(rows):.3f} mm)")


if __name__ == "__main__":
    main()
