"""The shadow map of a crowd: it holds everybody whose shadow may be seen, and its texels stay where they are."""

import numpy as np
import pytest

from experiment_app.render.cameras import place_camera
from experiment_app.render.crowd_light import BLOCK, TALLEST, TEXEL, crowd_sunlight, map_size, may_shade
from experiment_app.scene import STREET_HALF_WIDTH, Camera

CAMERAS = [
    Camera("elevated", 30.0, 9.0, 40.0, 180.0),
    Camera("elevated", 12.0, 4.0, 55.0, 90.0),
    Camera("elevated", 25.0, 14.0, 30.0, 145.0, place=(3.0, -7.0)),
    Camera("first_person", height=1.6),
    Camera("first_person", height=1.6, heading=37.0, place=(0.0, 12.0)),
]


def seen_from(camera):
    return place_camera(camera, 16 / 9, 1.75, (0.0, 0.0, 0.0))


def people(seed=1, count=4000):
    """Anywhere between the kerbs; places (N, 3) m and statures (N,) m."""
    rng = np.random.default_rng(seed)
    places = np.zeros((count, 3))
    places[:, 0] = rng.uniform(-STREET_HALF_WIDTH, STREET_HALF_WIDTH, count)
    places[:, 2] = rng.uniform(-110.0, 110.0, count)
    return places, rng.uniform(1.45, TALLEST, count)


@pytest.mark.parametrize("camera", CAMERAS)
def test_everybody_whose_shadow_may_be_seen_is_in_the_map(camera):
    viewpoint = seen_from(camera)
    places, statures = people()
    casting = may_shade(viewpoint, places, statures)
    assert 50 < casting.sum() < len(places)
    limbs = np.array([(x, y, z) for x in (-0.4, 0.4) for y in (0.0, 1.0) for z in (-0.4, 0.4)])
    points = places[casting][:, None] + limbs * np.where([False, True, False], statures[casting][:, None, None], 1.0)
    at = (
        np.concatenate([points, np.ones((*points.shape[:2], 1))], axis=2)
        @ crowd_sunlight("street", viewpoint).world_to_map.T
    )
    assert at[..., :3].min() > 0.0
    assert at[..., :3].max() < 1.0


@pytest.mark.parametrize("camera", CAMERAS)
def test_whose_body_or_shadow_is_in_the_picture_casts_it(camera):
    """Found point by point: soles, crown, middle, and where the sun puts the last two on the ground."""
    viewpoint = seen_from(camera)
    sunlight = crowd_sunlight("street", viewpoint)
    places, statures = people(seed=2)
    for share, fallen in ((0.0, False), (0.5, False), (1.0, False), (0.5, True), (1.0, True)):
        points = places + share * statures[:, None] * (0.0, 1.0, 0.0)
        if fallen:
            points = points - points[:, 1:2] / sunlight.to_sun[1] * sunlight.to_sun
        clip = np.column_stack([points, np.ones(len(points))]) @ viewpoint.matrix.T
        inside = (clip[:, 3] > 0.1) & (np.abs(clip[:, :2]) < clip[:, 3:]).all(axis=1)
        near = np.linalg.norm(places - viewpoint.eye, axis=1) < 75.0
        assert may_shade(viewpoint, places, statures)[inside & near].all()


def test_the_texels_have_places_in_the_world_wherever_the_camera_stands():
    """So the edge of a shadow is cut by the same grid from one place of the camera to the next: it does not swim."""
    point = np.array([1.234, 0.5, -9.87, 1.0])
    offsets = []
    for step in np.linspace(0.0, 5.0, 41):
        sunlight = crowd_sunlight(
            "street", seen_from(Camera("elevated", 30.0, 9.0, 40.0, 180.0, place=(0.1 * step, step)))
        )
        assert all(side % BLOCK == 0 for side in map_size(sunlight))
        offsets.append((sunlight.world_to_map @ point)[:2] * map_size(sunlight))
    whole = np.array(offsets) - offsets[0]
    assert np.abs(whole).max() > 10.0  # the map has moved with the camera
    np.testing.assert_allclose(whole, np.rint(whole), atol=1e-6)


def test_the_map_is_as_fine_as_it_says_and_lies_along_the_street():
    sunlight = crowd_sunlight("street", seen_from(CAMERAS[0]))
    width, height = map_size(sunlight)
    along = (sunlight.world_to_map @ (0.0, 0.0, 1.0, 0.0))[:2] * (width, height)
    assert along[1] == pytest.approx(0.0, abs=1e-9)
    # a metre of the street, seen from the sun: the sine of the angle between them
    assert along[0] == pytest.approx(np.sqrt(1.0 - sunlight.to_sun[2] ** 2) / TEXEL)
    assert width * height < 2048 * 2048 / 2
