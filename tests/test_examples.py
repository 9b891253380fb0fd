"""The examples run, and give what they promise."""

import importlib.util
import warnings
from pathlib import Path

import numpy as np
import pytest

import bedrad
from bedrad import heat
from bedrad.jobs.ensemble import run_ensemble
from bedrad.jobs.job import parse_job
from bedrad.jobs.pipeline import run_job

EXAMPLES = Path(__file__).parent.parent / "examples"


@pytest.mark.dem
def test_hot_tube_as_a_shorter_and_coarser_job(tmp_path):
    """The demo's job with a bed of 12 diameters and fewer rays; every stage, from settling to prediction."""
    text = (EXAMPLES / "hot_tube.toml").read_text()
    for old, new in (
        ('height = "18 mm"', 'height = "7.2 mm"'),
        ("tolerance = 1e-4", "tolerance = 1e-3"),
        ("rays = 2097152", "rays = 32768"),
        ("reference_rays = 67108864", "reference_rays = 1048576"),
    ):
        assert old in text
        text = text.replace(old, new)
    with pytest.warns(heat.RangeWarning, match=r"Table 5\.2|12\.9"):
        results = run_job(parse_job(text, EXAMPLES / "hot_tube.toml"), tmp_path / "hot_tube.h5")
    assert set(results.digests()) == {"packing", "statistics", "view_factors", "convergence", "prediction"}
    factors = results.read("view_factors")
    assert factors["layers"].sum() + factors["beyond"] + factors["wall"] + factors["escaped"] == pytest.approx(
        1, abs=1e-12
    )
    prediction = results.read("prediction")
    cases = {"measured", "correlations", "configuration_2", "configuration_5", "configuration_6"}
    assert cases <= set(prediction)
    for name in cases:
        case = prediction[name]
        # hotter is better, and radiation only adds
        assert (np.diff(case["heat_transfer_coefficient"]) > 0).all()
        assert (case["heat_transfer_coefficient"] > case["heat_transfer_coefficient_without"]).all()
    measured = prediction["measured"]
    assert measured["packing_fraction"] == results.read("statistics")["packing_fraction"]
    np.testing.assert_array_equal(measured["view_factors"], factors["layers"])


def load(name):
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    return example


@pytest.mark.dem
def test_python_interface(capsys):
    """The general form of k_wa is published to lie within 1 % of the exact cylinder (Watkins 2018, after eq. 42)."""
    example = load("python_interface")
    packing, total = example.main()
    assert "solid fraction" in capsys.readouterr().out
    stats = bedrad.statistics(packing)
    factors = bedrad.view_factors(packing, tolerance=1e-3, seed=0)
    exact = heat.wall_layer.conductivity(
        heat.gas.air_conductivity(example.WALL_TEMPERATURE),
        2.1,
        8.0,
        600e-6,
        stats.contacts_per_area,
        stats.packing_fraction,
        stats.nc_distance_closing,
        form="cylinder",
    )
    radiative = heat.radiation.conductivity(factors.layers, 600e-6, example.WALL_TEMPERATURE)
    assert total - radiative == pytest.approx(exact, rel=0.01)


@pytest.mark.dem
def test_flow_statistics_of_a_shorter_flow(capsys):
    """Means over frames against single frames, and against other rays."""
    with pytest.warns(UserWarning, match="short of independent structures"):
        flow, stats, shares, errors = load("flow_statistics").main(frames=3, flush=1.0)
    printed = capsys.readouterr().out
    assert f"layer 1    {shares[0]:.4f} ± {errors[0]:.4f}" in printed
    # windows of equal volume: the solid fraction of all frames together is the mean of theirs
    alone = [bedrad.statistics(bed, stats.edges, window=flow.window) for bed in flow]
    assert stats.packing_fraction == pytest.approx(np.mean([one.packing_fraction for one in alone]), rel=1e-12)
    assert shares.sum() == pytest.approx(1, abs=1e-12)
    rays = [bedrad.view_factors(bed, stats.edges, tolerance=2e-3, seed=100, window=flow.window) for bed in flow]
    other = np.mean([[*one.layers, one.beyond, one.wall, one.escaped] for one in rays], axis=0)
    # two means over three frames, each of an error below 2e-3, and six shares: one false alarm in 10^5
    assert np.abs(shares - other).max() < 4.8 * 2e-3 * np.sqrt(2 / 3)
    # frames half a diameter apart tell little more than one: the error is that of a bed, not of the rays
    assert errors[0] > 2e-3


@pytest.mark.dem
def test_ensemble_as_a_shorter_sweep(tmp_path):
    """Two sizes of low beds: smaller spheres leave more of the wall covered by more of them."""
    text = (EXAMPLES / "ensemble.toml").read_text()
    for old, new in (
        ('height = "18 mm"', 'height = "5.4 mm"\nstiffness = "40 N/m"'),
        ("seed = [1, 2, 3]", "seed = [2]"),
        ("[statistics]", "[layers]\nmargin = 2.0\n[statistics]"),
        ("tolerance = 1e-3", "rays = 16384"),
    ):
        assert old in text
        text = text.replace(old, new)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        outcome = run_ensemble(parse_job(text, EXAMPLES / "ensemble.toml"), tmp_path / "e.h5")
    assert (outcome.done, outcome.failed) == (2, ())
    ensemble = outcome.results.read("ensemble")
    assert ensemble["units"].tolist() == [1, 1]
    contacts = ensemble["statistics"]["contacts_per_area"]
    assert contacts[0] > contacts[1]
    beds = sorted((tmp_path / "e_beds").iterdir())
    assert {round(1e6 * bedrad.read(bed).mean_diameter) for bed in beds} == {500, 600}
    h = ensemble["prediction"]["measured"]["heat_transfer_coefficient"]
    assert (np.diff(h, axis=1) > 0).all()
