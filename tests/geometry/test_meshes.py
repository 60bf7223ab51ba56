"""The drawn bodies are closed, have the printed volumes, fit together, and load.

A parser of the tests reads the committed OBJ files, and the divergence theorem measures
them. Table 3 is typed again from the document.
"""

from __future__ import annotations

import itertools
import json
import math
import re
import struct
from pathlib import Path

import numpy as np
import pytest
from drawn_bodies import BODIES, LINKS, MESHES, Mesh, finger_pose
from reference import COB, VOLUME, inertial_frames, rotation_z

import alpha5_model as a5
from alpha5_model._support.paths import REPOSITORY_PATH
from alpha5_model.description.srdf import NAMED_POSES
from alpha5_model.errors import Alpha5Error, InputError

#: Table 3: volume [L], centre of buoyancy [mm].
TABLE_3 = dict(zip(LINKS, zip(VOLUME, COB, strict=True), strict=True))
FINGER_VOLUME = {"finger_1": 0.0061, "finger_2": 0.0077}
#: Measured outer bounds [mm], or None if unknown. Fingers: length 85, from the pivot.
BOUNDS = {
    "link_0": ((-126.65, 20), (-24, 20), (-20, 20)),
    "link_1": ((-20, 40), (-20, 20), (14, 67)),
    "link_2": ((-20, 170.7), None, (-20, 20)),
    "link_3": ((-20, 40), (-33, 20), (-20, 20)),
    "link_4": ((-20, 20), (-20, 20), (-144.75, -33)),
    "finger_1": (None, (-5.25, 85), (-16, 16)),
    "finger_2": (None, (-85, 5.25), (-16, 16)),
}


def open_edges(faces: np.ndarray) -> int:
    """Directed edges that do not have exactly one partner in the other direction."""
    edges = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    count: dict[tuple[int, int], int] = {}
    for a, b in edges.tolist():
        count[a, b] = count.get((a, b), 0) + 1
    return sum(n != 1 or count.get((b, a), 0) != 1 for (a, b), n in count.items())


def pieces(faces: np.ndarray, n: int) -> int:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    ones = np.ones(len(faces))
    links = [
        coo_array((ones, (faces[:, i], faces[:, i - 1])), shape=(n, n))
        for i in range(3)
    ]
    return connected_components(sum(links), directed=False)[0]


@pytest.fixture(scope="module")
def meshes() -> dict[str, Mesh]:
    return {name: Mesh((MESHES / f"{name}.obj").read_text("ascii")) for name in BODIES}


def link_poses(q: np.ndarray) -> dict[str, np.ndarray]:
    """Inertial frames in the base frame by link [m]."""
    return dict(zip(LINKS, inertial_frames(np.asarray(q, float)), strict=True))


@pytest.mark.parametrize("name", BODIES)
def test_closed_outward_and_not_degenerate(meshes, name):
    mesh = meshes[name]
    assert open_edges(mesh.f) == 0
    assert len(np.unique(mesh.v, axis=0)) == len(mesh.v)
    assert len(np.unique(mesh.f)) == len(mesh.v)
    assert pieces(mesh.f, len(mesh.v)) == 1
    assert mesh.volume_and_centroid()[0] > 0
    c = mesh.corners
    sides = np.linalg.norm(c - np.roll(c, 1, axis=1), axis=2)
    doubled = np.linalg.norm(np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0]), axis=1)
    assert (doubled / sides.max(1)).min() > 1e-6, (
        "a triangle less than 1 micrometre high"
    )
    assert len(mesh.f) <= 6000


def test_the_closedness_check_sees_a_hole_and_a_flip(meshes):
    faces = meshes["link_1"].f
    assert open_edges(faces[1:]) == 3
    flipped = faces.copy()
    flipped[0] = flipped[0][::-1]
    assert open_edges(flipped) > 0


@pytest.mark.parametrize("name", BODIES)
def test_normals_are_smooth_and_outward(meshes, name):
    mesh = meshes[name]
    c = mesh.corners
    flat = np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0])
    flat /= np.linalg.norm(flat, axis=1, keepdims=True)
    assert np.linalg.norm(mesh.normals, axis=2) == pytest.approx(1.0, abs=2e-4)
    along = np.einsum("fx,fcx->fc", flat, mesh.normals)
    assert along.min() > math.cos(math.radians(60))
    # Where a body is round, neighbours share normals that are neither one's own.
    assert (along < 0.9999).mean() > 0.15


def test_normals_on_the_wrist_tube_are_radial(meshes):
    mesh = meshes["link_4"]
    at = mesh.corners.reshape(-1, 3)
    normals = mesh.normals.reshape(-1, 3)
    plain = (np.hypot(at[:, 0], at[:, 1]) > 0.01999) & (np.abs(normals[:, 2]) < 0.1)
    plain &= at[:, 2] > -0.130
    assert plain.sum() > 500
    radial = at[plain, :2] / np.hypot(at[plain, 0], at[plain, 1])[:, None]
    assert np.einsum("ij,ij->i", radial, normals[plain, :2]).min() > 0.99


def total_link_4(meshes) -> tuple[float, np.ndarray]:
    """Volume [L] and centroid [mm] of wrist and closed fingers."""
    volume, centroid = meshes["link_4"].volume_and_centroid()
    moment = volume * centroid
    for name in ("finger_1", "finger_2"):
        v, c = meshes[name].volume_and_centroid()
        pose = finger_pose(name)
        volume = volume + v
        moment = moment + v * (pose[:3, :3] @ c + pose[:3, 3] * 1e3)
    return volume, moment / volume


def measured(meshes, name: str) -> tuple[float, np.ndarray]:
    return (
        total_link_4(meshes) if name == "link_4" else meshes[name].volume_and_centroid()
    )


@pytest.mark.parametrize("name", LINKS)
def test_volume_is_the_printed_one(meshes, name):
    volume, _ = measured(meshes, name)
    assert volume == pytest.approx(TABLE_3[name][0], rel=1e-4)


@pytest.mark.parametrize("name", ["finger_1", "finger_2"])
def test_finger_volume_is_the_measured_one(meshes, name):
    assert meshes[name].volume_and_centroid()[0] == pytest.approx(
        FINGER_VOLUME[name], rel=1e-4
    )


@pytest.mark.parametrize("name", ["link_0", "link_1", "link_2", "link_4"])
def test_centroid_is_within_a_millimetre_of_the_printed_centre_of_buoyancy(
    meshes, name
):
    _, centroid = measured(meshes, name)
    assert np.linalg.norm(centroid - TABLE_3[name][1]) < 1.0


def test_link_3_printed_centre_of_buoyancy_is_outside_the_body(meshes):
    """The printed point is no centroid; the corrected one is near the body's."""
    from alpha5_model import parameters

    printed = np.array(TABLE_3["link_3"][1])
    _, centroid = meshes["link_3"].volume_and_centroid()
    assert printed[2] > meshes["link_3"].v[:, 2].max() * 1e3 + 8
    assert np.linalg.norm(centroid - printed) > 35
    corrected = parameters(("base_frame", "link3_cob")).links[3].cob * 1e3
    assert np.linalg.norm(centroid - corrected) < 2.5


@pytest.mark.parametrize("name", BODIES)
def test_outside_stays_within_two_millimetres_of_the_measured_bounds(meshes, name):
    low = meshes[name].v.min(0) * 1e3
    high = meshes[name].v.max(0) * 1e3
    for axis, bounds in enumerate(BOUNDS[name]):
        if bounds is not None:
            assert (low[axis], high[axis]) == pytest.approx(bounds, abs=2.0)


def test_measured_dimensions_agree_with_the_recorded_bounds():
    from meshes.dimensions import drawn_dimensions

    from alpha5_model import parameters

    d = drawn_dimensions()
    bounds = [link.bounds * 1e3 for link in parameters().links]
    assert pytest.approx(bounds[0][0, 0]) == d.base.rear
    assert pytest.approx(bounds[0][1, 0]) == d.base.tube_low
    assert pytest.approx(bounds[0][2, 0]) == d.base.hub_low
    assert pytest.approx(-bounds[3][1, 0], abs=2.0) == d.shell.collar_face
    assert pytest.approx(-bounds[4][2, 1]) == d.wrist.tube_start
    assert pytest.approx(bounds[1][1, 1]) == d.radius


def test_link_2_tube_is_slanted_as_its_product_of_inertia_says(meshes):
    """Only a slanted tube between the axes gives Table 2's product, -74.836 kg mm^2."""
    mesh = meshes["link_2"]
    volume, centroid = mesh.volume_and_centroid()
    c = mesh.corners * 1e3 - centroid
    # Integral of x y over a tetrahedron with one corner at the centroid [mm^5].
    det = np.einsum("fi,fi->f", c[:, 0], np.cross(c[:, 1], c[:, 2]))
    x = c[..., 0]
    y = c[..., 1]
    integral = (det * (x.sum(1) * y.sum(1) + (x * y).sum(1))).sum() / 120
    product = a5.parameters().links[2].mass * integral / (volume * 1e6)
    assert -100 < product < -40, (
        "a straight tube would give 0, one slanted the other way +"
    )


def test_base_is_a_plain_round_tube_below_the_hub(meshes):
    for x in (-110.0, -80.0, -50.0):
        radii = _section_radii(meshes["link_0"], x)
        assert radii.size > 50
        assert radii == pytest.approx(20.0, abs=0.1)


def _section_radii(mesh: Mesh, x: float) -> np.ndarray:
    """Distances from the base tube's axis of the points where edges cross x [mm]."""
    corners = mesh.corners * 1e3
    found = []
    for a, b in ((0, 1), (1, 2), (2, 0)):
        start = corners[:, a]
        stop = corners[:, b]
        crosses = (start[:, 0] < x) != (stop[:, 0] < x)
        share = (x - start[crosses, 0]) / (stop - start)[crosses, 0]
        found.append(start[crosses] + share[:, None] * (stop - start)[crosses])
    y, z = np.vstack(found).T[1:]
    return np.hypot(y + 4.0, z)


def test_tubes_of_links_1_to_3_end_in_half_balls(meshes):
    """All that lies beyond the middle of a ball is on it, but for what adjoins."""
    in_link_2 = rotation_z(math.atan2(40.0, 145.3))[:3, :3]
    upper_arm = (meshes["link_2"].v * 1e3) @ in_link_2.T
    ends = {
        "link_2": (upper_arm - (30.5, 20.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
        "link_1": (
            meshes["link_1"].v * 1e3 - (0.0, 0.0, 46.2 - 13.5),
            (0.0, 0.0, 1.0),
            (-1.0, 0.0, 0.0),
        ),
    }
    for name, (points, beyond, aside) in ends.items():
        chosen = (points @ beyond > 1.0) & (points @ aside > 1.0)
        distances = np.linalg.norm(points[chosen], axis=1)
        assert (np.abs(distances - 20.0) < 0.1).sum() > 100, name
        assert distances.max() < 20.1, name


@pytest.mark.parametrize("name", ["finger_1", "finger_2"])
def test_a_finger_has_five_holes_beside_its_hinge_and_teeth(meshes, name):
    mesh = meshes[name]
    euler = len(mesh.v) - len(mesh.f) // 2
    assert 1 - euler // 2 == 5 + 1
    assert len(_valleys_along_the_hinge(mesh)) == 15


def _valleys_along_the_hinge(mesh: Mesh) -> set[tuple[float, ...]]:
    """x and y [mm] of edges along z at which two faces meet at 90 deg, hollow."""
    c = mesh.corners * 1e3
    normals = np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    faces_of_edge: dict[tuple[int, int], int] = {}
    for number, face in enumerate(mesh.f.tolist()):
        for corner in range(3):
            faces_of_edge[face[corner], face[corner - 2]] = number
    found = set()
    for (start, stop), one in faces_of_edge.items():
        other = faces_of_edge[stop, start]
        along = mesh.v[stop] - mesh.v[start]
        is_along_z = abs(along[2]) > 0.99 * np.linalg.norm(along)
        is_right_angle = abs(normals[one] @ normals[other]) < 0.1
        is_hollow = np.cross(normals[one], normals[other]) @ along < 0
        if is_along_z and is_right_angle and is_hollow:
            found.add(tuple(np.round(mesh.v[start, :2] * 1e3, 2).tolist()))
    return found


def test_all_files_together_are_small():
    assert sum(path.stat().st_size for path in MESHES.iterdir()) < 3e6


# How the bodies fit together. The second route is exact intersections by manifold3d.


@pytest.fixture(scope="module")
def solids(meshes):
    kernel = pytest.importorskip("manifold3d")
    made = {
        name: kernel.Manifold(kernel.Mesh64(mesh.v * 1e3, mesh.f.astype(np.uint64)))
        for name, mesh in meshes.items()
    }
    assert all(solid.status() == kernel.Error.NoError for solid in made.values())
    return made


def placed(solid, pose: np.ndarray):
    in_mm = pose[:3].copy()
    in_mm[:, 3] *= 1e3
    return solid.transform(in_mm)


NEIGHBOURS = list(itertools.pairwise(LINKS))
#: Each named pose, the limits, and what lies between.
JOINT_POSES = [
    *NAMED_POSES.values(),
    *np.linspace((0.02, 0.02, 0.02, 0.02), (6.1, 3.4, 3.4, 6.1), 9),
]


@pytest.mark.parametrize("pair", NEIGHBOURS, ids="-".join)
def test_neighbours_touch_at_no_joint_position_and_leave_no_gap(solids, pair):
    for q in JOINT_POSES:
        poses = link_poses(q)
        one, other = (placed(solids[name], poses[name]) for name in pair)
        assert (one ^ other).volume() == 0.0, q
        assert one.min_gap(other, 5.0) < 1.0, "nothing floats"


def test_the_intersection_check_sees_an_overlap(solids):
    poses = link_poses(np.array([0.5, 1.0, 1.0, 1.0]))
    poses["link_2"][:3, 3] += 0.003 * poses["link_2"][:3, 2]
    one, other = (placed(solids[name], poses[name]) for name in ("link_1", "link_2"))
    assert (one ^ other).volume() > 100


def test_fingers_open_without_touching_collar_or_each_other(solids, meshes):
    wrist = solids["link_4"]
    tips = []
    tip = meshes["finger_1"].v[meshes["finger_1"].v[:, 1].argmax()]
    for angle in np.linspace(0.0, 51 * 0.012, 5):
        one, two = (
            placed(solids[name], finger_pose(name, angle))
            for name in ("finger_1", "finger_2")
        )
        assert (one ^ two).volume() == 0.0
        assert (one.min_gap(two, 5.0) < 0.5) == (angle == 0.0), (
            "they meet when closed, and only then"
        )
        for finger in (one, two):
            assert (finger ^ wrist).volume() == 0.0
            assert finger.min_gap(wrist, 2.0) < 1.0
        tips.append(-(finger_pose("finger_1", angle) @ [*tip, 1.0])[0] * 1e3)
    assert np.all(np.diff(tips) > 0), "a positive angle opens"
    assert tips[-1] > 40, "wide open, half of the distance between the tips [mm]"


def test_base_lies_on_the_negative_x_side(meshes):
    x = meshes["link_0"].v[:, 0] * 1e3
    assert x.min() < -120
    assert x.max() < 21


# The files.


@pytest.mark.slow
def test_committed_files_are_what_is_drawn():
    """Texts number by number, to their last digits; the GLB by its vertices."""
    pytest.importorskip("manifold3d")
    from io import BytesIO

    import trimesh
    from generate import mesh_files

    drawn = mesh_files()
    assert set(drawn) == {path.name for path in MESHES.iterdir()}
    for name, content in drawn.items():
        committed = (MESHES / name).read_bytes()
        if name.endswith(".glb"):
            ours, theirs = (
                trimesh.load(BytesIO(data), file_type="glb").to_geometry()
                for data in (content, committed)
            )
            np.testing.assert_array_equal(ours.faces, theirs.faces)
            np.testing.assert_allclose(ours.vertices, theirs.vertices, atol=2e-7)
            continue
        fresh, old = (parted(data.decode()) for data in (content, committed))
        assert fresh[0] == old[0], name
        np.testing.assert_allclose(fresh[1], old[1], rtol=0, atol=1.1e-5, err_msg=name)


def parted(text: str) -> tuple[list[str], list[float]]:
    """Words that are no numbers, and numbers."""
    words = []
    numbers = []
    for word in text.split():
        try:
            numbers.append(float(word))
        except ValueError:
            words.append(word)
    return words, numbers


def test_materials(meshes):
    mtl = (MESHES / "alpha5.mtl").read_text("ascii")
    lines = mtl.splitlines()
    materials = {line.split()[1] for line in lines if line.startswith("newmtl")}
    assert materials == {"anodised", "bare_metal"}
    for name in BODIES:
        wanted = "bare_metal" if name.startswith("finger") else "anodised"
        text = (MESHES / f"{name}.obj").read_text("ascii")
        used = [line for line in text.splitlines() if line.startswith("usemtl")]
        assert used == [f"usemtl {wanted}"]
        assert "mtllib alpha5.mtl" in text


@pytest.fixture(scope="module")
def glb() -> dict:
    """The scene of alpha5.glb, as its JSON says it: nothing of trimesh."""
    data = (MESHES / "alpha5.glb").read_bytes()
    magic, version, length = struct.unpack_from("<4sII", data)
    assert (magic, version, length) == (b"glTF", 2, len(data))
    size, kind = struct.unpack_from("<I4s", data, 12)
    assert kind == b"JSON"
    return {**json.loads(data[20 : 20 + size]), "binary": data[20 + size + 8 :]}


def world_pose(scene, node):
    """The product of the matrices from the root to the node with this number."""
    matrix = scene["nodes"][node].get("matrix", np.eye(4).ravel())
    pose = np.reshape(matrix, (4, 4)).T
    for number, other in enumerate(scene["nodes"]):
        if node in other.get("children", []):
            return world_pose(scene, number) @ pose
    return pose


def test_glb_shows_the_home_pose_with_y_up(meshes, glb):
    poses = link_poses(np.array(NAMED_POSES["home"]))
    for name in ("finger_1", "finger_2"):
        poses[name] = poses["link_4"] @ finger_pose(name)
    drawn = {node["name"]: n for n, node in enumerate(glb["nodes"]) if "mesh" in node}
    assert set(drawn) == set(BODIES)
    for name, number in drawn.items():
        mesh = glb["meshes"][glb["nodes"][number]["mesh"]]["primitives"][0]
        points = _accessor(glb, mesh["attributes"]["POSITION"])
        pose = world_pose(glb, number)
        world = points @ pose[:3, :3].T + pose[:3, 3]
        z_up = np.column_stack([world[:, 0], -world[:, 2], world[:, 1]])
        in_body = (z_up - poses[name][:3, 3]) @ poses[name][:3, :3]
        wanted = meshes[name].v
        assert in_body.min(0) == pytest.approx(wanted.min(0), abs=1e-6)
        assert in_body.max(0) == pytest.approx(wanted.max(0), abs=1e-6)
        some = in_body[::7]
        assert some == pytest.approx(_nearest(wanted, some), abs=1e-6)


def test_glb_has_the_triangles_of_the_bodies_with_normals_and_colours(meshes, glb):
    for node in glb["nodes"]:
        if "mesh" not in node:
            continue
        mesh = glb["meshes"][node["mesh"]]["primitives"][0]
        triangles = _accessor(glb, mesh["indices"]).reshape(-1, 3)
        assert len(triangles) == len(meshes[node["name"]].f)
        normals = _accessor(glb, mesh["attributes"]["NORMAL"])
        assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0, abs=1e-5)
        is_finger = node["name"].startswith("finger")
        material = glb["materials"][mesh["material"]]
        assert material["name"] == ("bare_metal" if is_finger else "anodised")
        # 0.72 and 0.17 in sRGB, in linear light, to 1/255.
        red = material["pbrMetallicRoughness"]["baseColorFactor"][0]
        assert red == pytest.approx(0.477 if is_finger else 0.0245, abs=2.5e-3)


def _accessor(scene: dict, index: int) -> np.ndarray:
    accessor = scene["accessors"][index]
    view = scene["bufferViews"][accessor["bufferView"]]
    width = {"SCALAR": 1, "VEC3": 3}[accessor["type"]]
    kind = {5126: "<f4", 5123: "<u2", 5125: "<u4"}[accessor["componentType"]]
    start = view["byteOffset"] + accessor.get("byteOffset", 0)
    flat = np.frombuffer(scene["binary"], kind, accessor["count"] * width, start)
    return flat.reshape(-1, width) if width > 1 else flat


def _nearest(candidates: np.ndarray, points: np.ndarray) -> np.ndarray:
    from scipy.spatial import cKDTree

    return candidates[cKDTree(candidates).query(points)[1]]


# What reads them.


@pytest.mark.parametrize("urdf", ["alpha5.urdf", "alpha5_jaws.urdf"])
def test_pinocchio_loads_every_visual(urdf):
    import pinocchio as pin

    path = Path(REPOSITORY_PATH) / "urdf" / urdf
    model = pin.buildModelFromUrdf(str(path))
    visual = pin.buildGeomFromUrdf(
        model, str(path), pin.GeometryType.VISUAL, package_dirs=[str(path.parent)]
    )
    assert len(visual.geometryObjects) == len(BODIES)
    for item in visual.geometryObjects:
        assert Path(item.meshPath).name in {f"{name}.obj" for name in BODIES}
        assert item.geometry.num_tris > 1000


def test_trimesh_agrees_on_volume_and_closedness(meshes):
    import trimesh

    for name in BODIES:
        loaded = trimesh.load_mesh(MESHES / f"{name}.obj", merge_norm=True)
        assert loaded.is_watertight
        assert loaded.is_winding_consistent
        volume, centroid = meshes[name].volume_and_centroid()
        assert loaded.volume * 1e3 == pytest.approx(volume, rel=1e-9)
        assert loaded.center_mass * 1e3 == pytest.approx(centroid, abs=1e-6)


def test_yourdfpy_shows_the_home_pose(meshes):
    import yourdfpy

    robot = yourdfpy.URDF.load(str(Path(REPOSITORY_PATH) / "urdf" / "alpha5.urdf"))
    q = np.array(NAMED_POSES["home"])
    robot.update_cfg(
        dict(zip(("axis_e", "axis_d", "axis_c", "axis_b"), q, strict=True))
    )
    poses = link_poses(q)
    for name in ("finger_1", "finger_2"):
        poses[name] = poses["link_4"] @ finger_pose(name)
    corners = np.vstack(
        [meshes[name].v @ poses[name][:3, :3].T + poses[name][:3, 3] for name in BODIES]
    )
    assert robot.scene.bounds[0] == pytest.approx(corners.min(0), abs=1e-6)
    assert robot.scene.bounds[1] == pytest.approx(corners.max(0), abs=1e-6)


def test_mujoco_loads_the_meshes_and_measures_the_same_volume(meshes):
    mujoco = pytest.importorskip("mujoco")
    assets = "".join(
        f'<mesh name="{n}" file="{MESHES / n}.obj" inertia="exact"/>' for n in BODIES
    )
    geoms = "".join(f'<geom type="mesh" mesh="{n}" density="1000"/>' for n in BODIES)
    model = mujoco.MjModel.from_xml_string(
        f"<mujoco><asset>{assets}</asset><worldbody><body><freejoint/>{geoms}</body></worldbody></mujoco>"
    )
    wanted = sum(meshes[name].volume_and_centroid()[0] for name in BODIES)
    assert model.body_mass[1] == pytest.approx(wanted, rel=1e-6)


# What goes wrong.


def test_a_volume_out_of_reach_is_refused():
    pytest.importorskip("manifold3d")
    from meshes.drawing import solve_volume
    from meshes.solid import cylinder

    found, height = solve_volume(lambda h: cylinder(10.0, 0.0, h), 5000.0, 1.0, 100.0)
    # A regular 56-gon inscribed in the circle.
    assert height == pytest.approx(
        5000.0 / (28 * 100.0 * math.sin(2 * math.pi / 56)), rel=1e-9
    )
    assert found.volume() == pytest.approx(5000.0, rel=1e-9)
    # In litres: from 1 mm to 100 mm of height.
    least = 28 * 100.0 * math.sin(2 * math.pi / 56) * 1e-6
    words = f"volume: expected a volume of {least:.4f} to {100 * least:.4f} L, got 5000"
    with pytest.raises(InputError, match=re.escape(words)):
        solve_volume(lambda h: cylinder(10.0, 0.0, h), 5e9, 1.0, 100.0)


def test_a_surface_that_rounding_would_fold_is_refused():
    pytest.importorskip("manifold3d")
    from meshes.triangles import check_closed

    closed = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    check_closed(closed)
    with pytest.raises(Alpha5Error, match="closed"):
        check_closed(closed[1:])
    with pytest.raises(Alpha5Error, match="closed"):
        check_closed(np.vstack([closed, closed[:1]]))
