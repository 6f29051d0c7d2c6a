"""From linear light to the display's codes, averaged where light is averaged, and text as sharp as the display."""

from __future__ import annotations

import moderngl
import numpy as np
import pytest
from numpy.typing import NDArray

from experiment_app.render.picture import Picture, most_samples
from experiment_app.render.renderer import Renderer
from experiment_app.scene import Camera, Line, Marks, Page, Scene, Walker
from experiment_app.walkers import drawn_walkers


def linear(codes: NDArray[np.uint8]) -> NDArray[np.float64]:
    """IEC 61966-2-1, from codes to light."""
    grey = codes / 255.0
    return np.where(grey <= 0.04045, grey / 12.92, ((grey + 0.055) / 1.055) ** 2.4)


@pytest.mark.parametrize("samples", [1, 4])
def test_light_that_is_exactly_a_code_becomes_that_code_everywhere(context: moderngl.Context, samples: int) -> None:
    """The dither that keeps the sky from banding leaves stated luminances alone; dots as bright as the field vanish."""
    size = (64, 48)
    renderer, target = Renderer(context, size, 1.0, samples), context.simple_framebuffer(size)
    for code in (0, 1, 10, 64, 128, 188, 254, 255):
        light = float(linear(np.array([code], np.uint8))[0])
        marks = Marks(dot_size=2.0, brightness=light, background=light)
        scene = Scene((Walker("F1", 1.2, 105.0, 0.3, body="point_light"),), Camera("front"), "plain", marks=marks)
        renderer.draw(scene, drawn_walkers(scene), target)
        assert set(np.unique(renderer.read_pixels(target))) == {code}
    renderer.release()
    target.release()


def test_an_edge_is_averaged_in_light_and_not_in_codes(context: moderngl.Context) -> None:
    """White left of a slanted edge: the light of the whole picture is the area that is white.

    Averaging codes instead would make every half covered pixel a code of 128, which is 21.6 % of the light.
    """
    size = (64, 64)
    picture, target = Picture(context, size, 4), context.simple_framebuffer(size)
    program = context.program(
        vertex_shader="#version 330 core\nin vec2 at; void main() { gl_Position = vec4(at, 0.0, 1.0); }",
        fragment_shader="#version 330 core\nout vec4 pixel; void main() { pixel = vec4(1.0); }",
    )
    # from x = -0.1 below to x = 0.13 above; the strip that the edge crosses is 7.4 pixels wide
    corners = np.array([(-1, -1), (-0.1, -1), (0.13, 1), (-1, -1), (0.13, 1), (-1, 1)], np.float32)
    array = context.vertex_array(program, [(context.buffer(corners.tobytes()), "2f4", "at")])
    picture.begin()
    context.enable_only(moderngl.NOTHING)
    array.render(moderngl.TRIANGLES)
    picture.show(target)
    codes = np.frombuffer(target.read(components=1, alignment=1), np.uint8)
    between = (codes > 5) & (codes < 250)
    assert between.sum() > 40, "the edge is smoothed"
    assert linear(codes).mean() == pytest.approx((0.9 + 1.13) / 2 / 2, abs=0.002)
    assert set(np.unique(codes[between])) <= {136, 137, 138, 187, 188, 189, 224, 225, 226}, "a quarter, half, three"
    picture.release()
    target.release()


def test_text_is_as_sharp_on_a_dense_display(context: moderngl.Context) -> None:
    """Twice the density makes outlines twice as long in pixels and no wider; a magnified picture has four times
    as many pixels that are neither ink nor paper."""
    page = Page((Line("Which walk looks most natural?", "title"), Line("Hold the keys, try both directions. " * 3)))
    halftones = []
    for size, ratio in (((640, 360), 1.0), ((1280, 720), 2.0)):
        renderer, target = Renderer(context, size, ratio, 4), context.simple_framebuffer(size)
        renderer.draw(Scene(page=page), (), target)
        grey = renderer.read_pixels(target)[..., 0].astype(int)
        halftones.append(int(((grey > 70) & (grey < 210)).sum()))
        renderer.release()
        target.release()
    assert halftones[0] > 500
    assert 1.2 < halftones[1] / halftones[0] < 2.7


@pytest.mark.parametrize("wanted", [-1, 0, 1, 2, 4, 64])
def test_samples_are_what_the_driver_can_make(wanted: int) -> None:
    try:
        fresh = moderngl.create_context(standalone=True, backend="egl", require=330)
    except Exception as error:  # glcontext raises bare Exceptions
        pytest.skip(f"no OpenGL 3.3 through EGL on this machine: {error}")
    found = most_samples(fresh, wanted)
    assert 1 <= found <= max(1, min(wanted, fresh.max_samples))
    assert fresh.error == "GL_NO_ERROR"
    fresh.release()


def test_a_driver_that_boasts_is_not_believed(context: moderngl.Context) -> None:
    """Reports 64 samples, makes framebuffers of two at most."""

    class Boaster:
        max_samples = 64

        def renderbuffer(self, size: tuple[int, int], components: int, *, samples: int, dtype: str) -> object:
            if samples > 2:
                raise moderngl.Error("cannot create renderbuffer")
            return context.renderbuffer(size, components, samples=samples, dtype=dtype)

        def __getattr__(self, name: str) -> object:
            return getattr(context, name)

    assert most_samples(Boaster(), 8) == 2  # type: ignore[arg-type]
