"""The shaders against arithmetic in NumPy: skinning, and the step from linear light to sRGB codes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import moderngl
import numpy as np
import pytest

from experiment_app.crowds import drawn_crowd
from experiment_app.render.body_buffers import LIT_FORMAT, LIT_NAMES, packed
from experiment_app.render.drawn import PLACE
from experiment_app.render.light import LIGHTS, ON_WALKERS, fit_sunlight
from experiment_app.render.picture import Picture
from experiment_app.render.programs import compose, shader_text
from experiment_app.render.treadmill_model import BELT_WIDTH, FLOOR, treadmill
from experiment_app.scene import Crowd, Scene, Walker
from experiment_app.walkers import drawn_walkers
from stimuli.bodies.body import Surface
from stimuli.bodies.skinning import skin
from tests.stimuli.transforms import as_matrices

CAPTURE = """
in vec4 normal_sky;
out vec3 skinned;
out vec3 turned;
void main() {
    vec4 x_row, y_row, z_row;
    blend_matrix(x_row, y_row, z_row);
    vec4 bound = bind_vertex();
    vec3 normal = normal_sky.xyz;
    skinned = vec3(dot(x_row, bound), dot(y_row, bound), dot(z_row, bound)) + walker_place();
    turned = vec3(dot(x_row.xyz, normal), dot(y_row.xyz, normal), dot(z_row.xyz, normal));
}
"""

SQUARELY = """
uniform sampler2D directions;
void main() {
    vec3 direction = texelFetch(directions, ivec2(gl_FragCoord.xy), 0).xyz;
    float left = apart(direction, direction);
    pixel = vec4(highlight(direction, direction, direction, 0.5), pow(left, 3.0), pow(left, 4.0), pow(left, 5.0));
}
"""


def test_skinning_on_the_gpu_is_skinning_in_numpy(context: moderngl.Context) -> None:
    """Positions within 0.01 mm, normals within 1e-5, for two walkers in one draw."""
    first = Walker("M1", 1.3, 110.0, 0.1, distance=2.0)
    walkers = (first, replace(first, phase=0.6, place=(1.0, 0.0)))
    drawn = drawn_walkers(Scene(walkers))
    surfaces = drawn[0].body.levels[0]
    vertices, _ = packed(surfaces)
    rows = np.zeros((2, 64, 4), np.float32)
    for row, walker in zip(rows, drawn, strict=True):
        row[:63] = walker.matrices.reshape(63, 4)
        row[63, :3] = walker.place

    got = _skinned(context, vertices, rows, crowd=False)
    for one, walker in zip(got, drawn, strict=True):
        _assert_skinned(one, surfaces, walker.matrices, walker.place)


def test_skinning_a_crowd_on_the_gpu_is_skinning_in_numpy(context: moderngl.Context) -> None:
    """A crowd's quaternions against the matrices of each walker alone, at a size that is not 1.

    Positions within 0.02 mm: they are 100 m from the origin, where a float32 has steps of 0.008 mm.
    """
    crowd = drawn_crowd(Crowd(30, "1:1", seed=4, seconds=2.0))
    own = np.flatnonzero(crowd.cast.body == crowd.cast.body[5])[:2]
    assert np.abs(np.linalg.norm(crowd.rows[own, 0], axis=1) - 1.0).min() > 1e-3
    surfaces = crowd.cast.bodies[crowd.cast.body[5]].levels[1]
    vertices, _ = packed(surfaces)
    got = _skinned(context, vertices, crowd.rows[own], crowd=True)
    for one, row in zip(got, crowd.rows[own], strict=True):
        _assert_skinned(one, surfaces, as_matrices(row[:PLACE].reshape(-1, 2, 4)), np.zeros(3), within=2e-5)


def test_what_faces_the_eye_and_the_sun_squarely_shines_with_a_number(context: moderngl.Context) -> None:
    """Cosines of equal unit vectors come out above 1 for some: no power of what is then left may be taken."""
    rng = np.random.default_rng(1)
    directions = rng.normal(size=(64, 64, 3))
    directions /= np.linalg.norm(directions, axis=2, keepdims=True)
    given = np.float32(directions)
    assert np.any(np.einsum("ijk,ijk->ij", given, given) > 1.0)
    lit = compose("walker.frag.glsl", ON_WALKERS).replace("void main()", "void unused()")
    program = context.program(vertex_shader=shader_text("full_screen.vert.glsl"), fragment_shader=lit + SQUARELY)
    table = context.texture((64, 64), 3, given.tobytes(), dtype="f4")
    result = context.texture((64, 64), 4, dtype="f4")
    table.use(0)
    context.framebuffer([result]).use()
    context.enable_only(moderngl.NOTHING)
    program["directions"] = 0
    context.vertex_array(program, []).render(moderngl.TRIANGLES, vertices=3)
    shining = np.frombuffer(result.read(), np.float32).reshape(-1, 4)
    assert np.all(np.isfinite(shining))
    assert np.all(shining[:, 0] > 0.0)
    assert np.abs(shining[:, 1:]).max() < 1e-15


def _skinned(context: moderngl.Context, vertices: np.ndarray, rows: np.ndarray, crowd: bool) -> np.ndarray:
    """(2, V, 2, 3): positions and turned normals, of any length, of two rows of poses."""
    lines = ["#version 330 core", *(["#define CROWD 1"] if crowd else []), shader_text("skinning.glsl"), CAPTURE]
    program = context.program(vertex_shader="\n".join(lines), varyings=["skinned", "turned"])
    poses = context.texture((rows.shape[1], 2), 4, np.ascontiguousarray(rows).tobytes(), dtype="f4")
    poses.use(0)
    content: list[tuple[object, ...]] = [(context.buffer(vertices.tobytes()), LIT_FORMAT, *LIT_NAMES)]
    if crowd:
        instances = np.array([[0, 0, 1, 0], [1, 0, 1, 0]], np.float32)
        content.append((context.buffer(instances.tobytes()), "4f4/i", "instance"))
    array = context.vertex_array(program, content)
    result = context.buffer(reserve=2 * len(vertices) * 24)
    context.simple_framebuffer((4, 4)).use()  # without a window nothing runs unless some framebuffer is bound
    array.transform(result, moderngl.POINTS, vertices=len(vertices), instances=2)
    return np.frombuffer(result.read(), np.float32).reshape(2, len(vertices), 2, 3)


def _assert_skinned(
    one: np.ndarray, surfaces: tuple[Surface, ...], matrices: np.ndarray, place: Sequence[float], within: float = 1e-5
) -> None:
    expected = [skin(surface, matrices) for surface in surfaces]
    positions = np.concatenate([part[0] for part in expected]) + place
    normals = np.concatenate([part[1] for part in expected])
    turned = one[:, 1] / np.linalg.norm(one[:, 1], axis=1, keepdims=True)
    assert np.abs(one[:, 0] - positions).max() < within
    assert np.abs(turned - normals).max() < 1e-5


@pytest.mark.parametrize("samples", [1, 4])
def test_linear_light_becomes_exact_srgb_codes(context: moderngl.Context, samples: int) -> None:
    """Each of the 256 codes, as linear light (IEC 61966-2-1), comes back as itself at every pixel."""
    picture = Picture(context, (64, 8), samples)
    target = context.simple_framebuffer((64, 8))
    for code in range(256):
        value = code / 255
        light = value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4
        picture.begin()
        context.fbo.clear(light, light, light, 1.0)
        picture.show(target)
        pixels = np.frombuffer(target.read(components=3), np.uint8)
        assert pixels.min() == code
        assert pixels.max() == code
    picture.release()
    target.release()


def test_every_vertex_in_any_pose_is_inside_the_shadow_map() -> None:
    for phase in np.arange(8) / 8:
        drawn = drawn_walkers(Scene((Walker("M1", 1.4, 100.0, float(phase), distance=3.0),)))
        sunlight = fit_sunlight("open_ground", -0.7, drawn, np.zeros((0, 3)))
        points = np.concatenate([skin(s, drawn[0].matrices)[0] for s in drawn[0].body.levels[0]]) + drawn[0].place
        seen = points @ sunlight.world_to_map[:3, :3].T + sunlight.world_to_map[:3, 3]
        assert seen.min() > 0.0
        assert seen.max() < 1.0


def test_the_sun_is_warmer_than_the_sky_and_stronger() -> None:
    for lights in LIGHTS.values():
        assert sum(lights.sun) > sum(lights.sky) > sum(lights.bounce)
        assert lights.sun[0] / lights.sun[2] > lights.sky[0] / lights.sky[2]


def test_the_treadmill_faces_outwards_and_its_belt_is_level() -> None:
    mesh = treadmill()
    corners = mesh["position"].reshape(-1, 3, 3).astype(float)
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    big = np.linalg.norm(flat, axis=1) > 1e-10
    agree = np.einsum("ij,ij->i", flat, mesh["normal"].reshape(-1, 3, 3).mean(axis=1))[big]
    assert (agree > 0.0).all()
    belt = mesh[mesh["belt"][:, 1] > 0.5]
    assert belt["position"][:, 1].max() == pytest.approx(0.0, abs=1e-6)
    assert np.abs(belt["position"][:, 0]).max() == pytest.approx(BELT_WIDTH / 2, abs=1e-6)
    assert mesh["position"][:, 1].min() == pytest.approx(FLOOR, abs=1e-6)
