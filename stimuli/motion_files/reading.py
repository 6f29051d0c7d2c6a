"""Reading any motion file: the reader by its ending, the settings from the YAML file beside it."""

from __future__ import annotations

from pathlib import Path

from stimuli.clip import Clip
from stimuli.motion_files.bvh import read_bvh
from stimuli.motion_files.c3d import read_c3d
from stimuli.motion_files.errors import MotionFileError
from stimuli.motion_files.gltf_motion import read_gltf_motion
from stimuli.motion_files.marker_skeleton import markers_to_clip
from stimuli.motion_files.mvnx import read_mvnx
from stimuli.motion_files.overrides import overrides_beside

ENDINGS = (".bvh", ".c3d", ".mvnx", ".glb", ".gltf")


def read_clip(path: Path | str) -> Clip:
    """The motion in a file of any format gaitlab knows, markers fitted with a skeleton.

    Raises MotionFileError naming file and reason; endings may be in capitals.
    """
    path = Path(path)
    ending = path.suffix.lower()
    if ending not in ENDINGS:
        raise MotionFileError(f"{path}: ends in {ending!r}; motion files end in {', '.join(ENDINGS)}")
    given = overrides_beside(path)
    if ending == ".c3d":
        unused = [k for k in ("rate", "skip_frames", "animation", "roles") if getattr(given, k)]
        if unused:
            raise MotionFileError(f"{path}: {', '.join(unused)} in the YAML file beside it is no setting of C3D files")
        return markers_to_clip(read_c3d(path, unit_to_m=given.unit_to_m, up=given.up))
    if ending in (".glb", ".gltf"):
        return read_gltf_motion(
            path,
            animation=given.animation,
            unit_to_m=given.unit_to_m or 1.0,
            up=given.up,
            rate=given.rate,
            skip_frames=given.skip_frames,
            roles=given.roles,
        )
    if ending == ".mvnx":
        return read_mvnx(
            path,
            unit_to_m=given.unit_to_m or 1.0,
            up=given.up,
            rate=given.rate,
            skip_frames=given.skip_frames,
            roles=given.roles,
        )
    return read_bvh(
        path,
        unit_to_m=given.unit_to_m,
        up=given.up,
        rate=given.rate,
        skip_frames=given.skip_frames,
        roles=given.roles,
    )
