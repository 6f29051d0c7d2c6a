"""Mesa's softpipe, a rasteriser of its own, draws what llvmpipe draws: no picture depends on one driver's habits."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import moderngl
import numpy as np
import pytest

from experiment_app.render.renderer import Renderer
from experiment_app.scene import Camera, Crowd, Scene
from experiment_app.timing.facts import is_software
from experiment_app.walkers import drawn_walkers
from tests.experiment_app.test_figures_and_parts import SCENES

CROWD = Crowd(40, "1:10", seed=1, seconds=10.0)
STREET = Scene((), Camera("elevated", 14.0, 4.0, 40.0, 180.0), "street", crowd=CROWD)
SIZE = (320, 180)
PICTURES = {**{name: scene for name, (scene, _) in SCENES.items()}, "crowd": STREET}


def pictures(context: moderngl.Context) -> dict[str, np.ndarray]:
    """The golden images' scenes and a crowd, without multisampling, which softpipe does not have; sRGB codes."""
    target = context.simple_framebuffer(SIZE)
    renderer = Renderer(context, SIZE, 1.0, 1)
    drawn = {}
    for name, scene in PICTURES.items():
        renderer.draw(scene, drawn_walkers(scene), target)
        drawn[name] = renderer.read_pixels(target)
    renderer.release()
    target.release()
    return drawn


@pytest.mark.slow
def test_two_rasterisers_draw_the_same_pictures(context: moderngl.Context, tmp_path: Path) -> None:
    """Colours within 3 codes but for pixels at edges, which each driver gives to one side or the other."""
    if not is_software(context.info["GL_RENDERER"]):
        pytest.skip("softpipe is chosen where Mesa draws with the processor")
    file = tmp_path / "softpipe.npz"
    subprocess.run(
        [sys.executable, "-m", __name__, str(file)], env={**os.environ, "GALLIUM_DRIVER": "softpipe"}, check=True
    )
    here = pictures(context)
    with np.load(file) as there:
        if "softpipe" not in str(there["driver"]):
            pytest.skip(f"this Mesa has no softpipe: {there['driver']}")
        for name, picture in here.items():
            assert np.ptp(picture) > 100, name
            apart = np.abs(picture.astype(int) - there[name]).max(axis=2)
            assert np.mean(apart > 3) < 0.01, name
            assert np.mean(apart) < 0.2, name


if __name__ == "__main__":
    from experiment_app.windows.offscreen import offscreen_context

    made = offscreen_context()
    np.savez(sys.argv[1], driver=made.info["GL_RENDERER"], **pictures(made))
