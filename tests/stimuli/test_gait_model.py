"""The gait model against the people it was fitted to and people it was not."""

from pathlib import Path

import numpy as np
import pytest

from stimuli.gait_model import Step, basis, curves, load_gait_model

SHARED = Path(__file__).parents[2].parent / "shared"
needs_shared = pytest.mark.skipif(not (SHARED / "gait-tables").exists(), reason="the shared recordings are not here")


def test_the_fourier_basis_is_one_and_cosines_and_sines():
    np.testing.assert_allclose(basis(np.array([0.25]))[0, :5], [1, 0, 1, -1, 0], atol=1e-12)


def test_the_coefficients_are_small_and_credited():
    folder = Path(__file__).parents[2] / "stimuli" / "data"
    assert (folder / "gait_model.npz").stat().st_size < 1_000_000
    credit = (folder / "ATTRIBUTION.md").read_text()
    assert "The data used in this project was obtained from\n  mocap.cs.cmu.edu" in credit
    assert "6:111" in credit


def test_every_data_file_says_where_it_comes_from():
    stimuli = Path(__file__).parents[2] / "stimuli"
    credits = " ".join(path.read_text(encoding="utf-8") for path in stimuli.rglob("ATTRIBUTION.md"))
    data = [path for path in stimuli.rglob("*") if path.suffix in (".npz", ".csv", ".glb")]
    assert len(data) > 6
    assert [path.name for path in data if path.name not in credits] == []


def test_an_unknown_person_is_named():
    with pytest.raises(ValueError, match="CMU-99"):
        load_gait_model().manner({"CMU-99": 1.0})


def test_steps_are_normalised_by_leg_length_as_in_hof_1996():
    step = Step.of(speed=1.2, step_frequency=120.0, leg_length=0.9)
    assert step.length == pytest.approx(0.6 / 0.9)
    assert step.frequency == pytest.approx(2.0 * np.sqrt(0.9 / 9.81))


@needs_shared
@pytest.mark.parametrize("sex", [-0.5, 0.5])
def test_the_average_walk_lies_inside_two_sd_of_the_gait_tables(sex):
    from stimuli.fitting.tables import mean_curves

    model = load_gait_model()
    tables = mean_curves(SHARED / "gait-tables", "C4")
    step = Step.of(1.15, 111.0, 0.80)  # mean of the tables' walks at comfortable speed
    walk = {
        name: np.degrees(curve) for name, curve in curves(model.coefficients(step, sex), np.arange(101) / 100).items()
    }
    standing = np.degrees(model.standing)
    thigh, shank = walk["thigh"] - standing[0], walk["shank"] - standing[1]
    for quantity, drawn in (
        ("thigh_incl_deg", thigh),
        ("knee_flex_deg", thigh - shank),
        ("ankle_dorsi_deg", walk["foot"] - shank),
    ):
        mean, sd = tables[quantity].T
        assert np.mean(np.abs(drawn - mean) <= 2 * sd) >= 0.95, quantity


@needs_shared
def test_fitting_again_gives_the_same_coefficients(tmp_path):
    pytest.importorskip("ezc3d")
    from stimuli.fitting.gait_model import main

    main(["--mocap", str(SHARED), "--out", str(tmp_path / "again.npz")])
    with np.load(tmp_path / "again.npz") as again:
        shipped = load_gait_model()
        np.testing.assert_allclose(again["effects"], shipped.effects, atol=1e-6)
        np.testing.assert_allclose(again["offsets"], shipped.offsets, atol=1e-6)


@needs_shared
@pytest.mark.slow
def test_people_left_out_of_the_fit_are_foretold_within_some_degrees():
    pytest.importorskip("ezc3d")
    from stimuli.fitting.gait_model import read_all
    from stimuli.fitting.validation import error_lines, left_out_errors

    errors = left_out_errors(*read_all(SHARED))
    documented = (Path(__file__).parents[2] / "docs" / "actors.md").read_text(encoding="utf-8").splitlines()
    assert set(error_lines(errors)) <= set(documented)
    assert errors["thigh"][0] < 3.0
    assert errors["shank"][0] < 3.0
    assert errors["foot"][0] < 4.5
    assert all(total < 10.0 for total, _ in errors.values())


def test_women_tilt_the_pelvis_more_and_sway_the_trunk_less_than_men():
    """As Smith et al. 2002 (pelvic obliquity) and Troje 2002 (men's lateral sway of the upper body) found."""
    model = load_gait_model()
    step = Step.of(1.2, 111.0, 0.80)
    woman, man = (curves(model.coefficients(step, sex), np.arange(100) / 100) for sex in (0.5, -0.5))
    assert np.ptp(woman["hips_z"]) > np.ptp(man["hips_z"])
    assert np.ptp(woman["chest_z"]) < np.ptp(man["chest_z"])
