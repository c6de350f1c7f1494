"""A compiled model of MuJoCo as the tables of a model file."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._errors import InputError, need, read_by
from ._inertia import Inertia, rotation_matrix

Array = NDArray[np.float64]
PathLike = str | os.PathLike[str]

_ELEMENTS = ("xx", "yy", "zz", "xy", "xz", "yz")
_MASSLESS: dict[str, Any] = {"mass_kg": 0.0, "com_m": [0.0] * 3, "inertia_kg_m2": dict.fromkeys(_ELEMENTS, 0.0)}
# No turn, scalar first as in MuJoCo.
_UNIT_WXYZ = np.array([1.0, 0.0, 0.0, 0.0])


def compiled(path: PathLike) -> Any:
    """Compile a file of MJCF (or a URDF file, which MuJoCo reads too)."""
    mujoco = need("mujoco", "mujoco")
    return read_by(path, lambda: mujoco.MjModel.from_xml_path(os.fspath(path)), missing="E0101", broken="E0101")


def base_of(model: Any, base: int | str | None, *, welded: bool) -> int:
    """Number of the body that floats: `base`, by default the first one with a free joint.

    A body that is welded to the world is a base where `welded` allows it.
    """
    mujoco = need("mujoco", "mujoco")
    free = [b for b in range(1, model.nbody) if _types(model, b) == [int(mujoco.mjtJoint.mjJNT_FREE)]]
    if base is None:
        if not free:
            raise InputError("E0001 model: no body has a free joint; add <freejoint/> to the base, or name the base")
        return free[0]
    try:
        root = int(model.body(base).id)
    except (KeyError, IndexError):
        names = ", ".join(body_name(model, b) for b in range(1, model.nbody))
        raise InputError(f"E0001 base '{base}': there is no such body; use one of {names}") from None
    if root not in free and (not welded or root == 0 or int(model.body_weldid[root]) != 0):
        raise InputError(f"E0001 base '{base}': the body is not free; add <freejoint/> to it")
    return root


def body_name(model: Any, body: int) -> str:
    """Name of a body; one without a name is called by its number."""
    return str(model.body(body).name or f"body{body}")


def _joints(model: Any, body: int) -> range:
    first = int(model.body_jntadr[body])
    return range(first, first + int(model.body_jntnum[body]))


def _types(model: Any, body: int) -> list[int]:
    return [int(model.jnt_type[k]) for k in _joints(model, body)]


def _joint_name(model: Any, joint: int) -> str:
    body = int(model.jnt_bodyid[joint])
    several = joint - int(model.body_jntadr[body]) + 1 if int(model.body_jntnum[body]) > 1 else ""
    return str(model.joint(joint).name or f"{body_name(model, body)}_joint{several}")


def bodies_of(model: Any, root: int) -> Iterator[int]:
    """Numbers of the bodies that `root` carries, itself first, each after its parent."""
    taken = {root}
    yield root
    for body in range(root + 1, model.nbody):
        if int(model.body_parentid[body]) in taken:
            taken.add(body)
            yield body


def moving_joints(model: Any, body: int) -> list[tuple[str, str, int]]:
    """Hinges and slides of a body in their order: name, type in a model file, number."""
    mujoco = need("mujoco", "mujoco")
    kinds = {int(mujoco.mjtJoint.mjJNT_HINGE): "revolute", int(mujoco.mjtJoint.mjJNT_SLIDE): "prismatic"}
    found: list[tuple[str, str, int]] = []
    for joint in _joints(model, body):
        kind = kinds.get(int(model.jnt_type[joint]))
        if kind is None:
            raise InputError(f"E0001 joint '{_joint_name(model, joint)}': it is a ball joint; replace it by three hinges")
        found.append((_joint_name(model, joint), kind, joint))
    return found


def _refuse_constraints(model: Any) -> None:
    mujoco = need("mujoco", "mujoco")
    for k in range(model.neq):
        if model.eq_active0[k]:
            kind = mujoco.mjtEq(int(model.eq_type[k])).name.removeprefix("mjEQ_").lower()
            label = model.equality(k).name or k
            raise InputError(f"E0001 equality '{label}': a model has no {kind} constraint; remove it, or set active to false")


def tables(model: Any, base: int | str | None = None) -> dict[str, Any]:
    """Bodies and joints of the subtree of `base`.

    A body of MuJoCo with several joints becomes a chain of links, of which all but the last are massless. The frame of a
    link has its origin at its joint, in the axes of the body.
    """
    root = base_of(model, base, welded=True)
    _refuse_constraints(model)
    bodies: list[dict[str, Any]] = []
    joints: list[dict[str, Any]] = []
    # The last link of every body, and the point of the body where that link has its origin.
    links: dict[int, tuple[str, Array]] = {}
    for body in bodies_of(model, root):
        label, point = body_name(model, body), np.zeros(3)
        if body != root:
            outer = _chain(model, body, *links[int(model.body_parentid[body])])
            joints += outer
            bodies += [{"name": joint["child"], **_MASSLESS} for joint in outer[:-1]]
            moving = moving_joints(model, body)
            if moving:
                point = np.array(model.jnt_pos[moving[-1][2]])
        links[body] = label, point
        inertia = Inertia.from_mujoco(model, body)
        tensor = {e: inertia.inertia_kg_m2["xyz".index(e[0]), "xyz".index(e[1])] for e in _ELEMENTS}
        bodies.append({"name": label, "mass_kg": inertia.mass_kg, "com_m": inertia.com_m - point, "inertia_kg_m2": tensor})
    name = bytes(model.names).split(b"\0", 1)[0].decode()
    return {"schema": "poinsot.model/1", "name": name, "body": bodies, "joint": joints}


def _chain(model: Any, body: int, parent: str, parent_point: Array) -> list[dict[str, Any]]:
    """The joints of a body, each from the link before it to its own; one fixed joint where the body has none.

    MuJoCo applies the joints of a body one after the other, each at its point of the body, by its coordinate less its
    reference.
    """
    mujoco = need("mujoco", "mujoco")
    label = body_name(model, body)
    place, turn = np.array(model.body_pos[body]) - parent_point, np.array(model.body_quat[body])
    moving = moving_joints(model, body)
    if not moving:
        fixed = {"name": f"{label}_fixed", "type": "fixed", "parent": parent, "child": label}
        return [fixed | {"origin_m": place, "rotation_xyzw": np.roll(turn, -1)}]
    out: list[dict[str, Any]] = []
    before = np.zeros(3)
    for name, kind, k in moving:
        axis, point = np.array(model.jnt_axis[k]), np.array(model.jnt_pos[k])
        back = -float(model.qpos0[model.jnt_qposadr[k]])
        origin, rotation = place + rotation_matrix(turn) @ (point - before), turn.copy()
        if kind == "prismatic":
            origin = origin + rotation_matrix(turn) @ (back * axis)
        else:
            reference = np.zeros(4)
            mujoco.mju_axisAngle2Quat(reference, axis, back)
            mujoco.mju_mulQuat(rotation, turn, reference)
        child = label if k == moving[-1][2] else f"{label}_{name}"
        out.append(
            {
                "name": name,
                "type": kind,
                "parent": parent,
                "child": child,
                "axis": axis,
                "origin_m": origin,
                "rotation_xyzw": np.roll(rotation, -1),
            }
        )
        parent, before, place, turn = child, point, np.zeros(3), _UNIT_WXYZ
    return out
