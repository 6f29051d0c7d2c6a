"""All shaders against Khronos' reference compiler: a driver here may take what another one refuses."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import moderngl
import pytest

from experiment_app.render.renderer import Renderer
from experiment_app.scene import Camera, Crowd, Ground, Scene
from experiment_app.walkers import drawn_walkers
from tests.experiment_app.test_figures_and_parts import SCENES, drawn_anew

COMPILER = shutil.which("glslangValidator")
GROUNDS: tuple[Ground, ...] = ("street", "plain", "open_ground")


@pytest.mark.skipif(COMPILER is None, reason="glslangValidator (Debian: glslang-tools) is not installed")
def test_every_program_is_glsl_3_30_without_a_warning(
    context: moderngl.Context, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    programs = programs_of_all_scenes(context, monkeypatch)
    assert len(programs) > 30
    for number, (vertex, fragment) in enumerate(programs):
        files = [tmp_path / f"{number}.vert", tmp_path / f"{number}.frag"]
        for file, text in zip(files, (vertex, fragment), strict=True):
            file.write_text(text, encoding="utf-8")
        said = subprocess.run([str(COMPILER), "-l", *map(str, files)], capture_output=True, text=True)
        assert said.returncode == 0, said.stdout
        assert "WARNING" not in said.stdout


def programs_of_all_scenes(context: moderngl.Context, monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, str]]:
    """Vertex and fragment shader of everything that the golden scenes, crowds and part maps are drawn with."""
    found: dict[tuple[str, str], None] = {}
    make = moderngl.Context.program

    def noted(self: moderngl.Context, *, vertex_shader: str, **others: str) -> moderngl.Program:
        if "fragment_shader" in others:
            found[vertex_shader, others["fragment_shader"]] = None
        return make(self, vertex_shader=vertex_shader, **others)

    monkeypatch.setattr(moderngl.Context, "program", noted)
    for name in SCENES:
        drawn_anew(context, name)
    target = context.simple_framebuffer((64, 36))
    for ground in GROUNDS:
        scene = Scene((), Camera("elevated"), ground, crowd=Crowd(250, "1:1", seed=1))
        renderer = Renderer(context, (64, 36), 1.0, 1)
        renderer.draw(scene, drawn_walkers(scene), target)
        renderer.draw_parts()
        renderer.release()
    target.release()
    return list(found)
