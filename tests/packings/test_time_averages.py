"""Standard errors over frames against processes whose true error is known: correlated in time, travelling, standing."""

import numpy as np
import pytest
import scipy.signal
import scipy.stats

from bedrad.packings.time_averages import block_averaged_variance, errors_of_mean, renewal_frames

PIECES = 8
RUNS = 1000
FALSE_ALARM = 3e-5  # of each comparison below, one-sided: four standard errors
SURE = scipy.stats.norm.isf(FALSE_ALARM)


def autoregressive(frames, time, shape, seed):
    """Series of unit variance whose autocorrelation is exp(-lag/time)."""
    kept = np.exp(-1.0 / time) if time else 0.0
    noise = np.random.default_rng(seed).normal(size=(frames, *shape))
    noise[1:] *= np.sqrt(1.0 - kept**2)
    return scipy.signal.lfilter([1.0], [1.0, -kept], noise, axis=0)


def variance_of_mean(correlation, frames):
    """Variance of the mean of a stationary series of unit variance, from its autocorrelation by lag (slow sum)."""
    return sum(correlation(abs(i - j)) for i in range(frames) for j in range(frames)) / frames**2


def travelling(frames, crossing, runs, seed):
    """White noise along a line, seen through a window of `PIECES` pieces that it crosses in `crossing` frames."""
    fine = 30  # cells a piece
    step = PIECES * fine // crossing
    line = np.random.default_rng(seed).normal(size=(PIECES * fine + step * frames, runs)) * np.sqrt(fine)
    views = [line[t * step : t * step + PIECES * fine] for t in range(frames)]
    return np.array([view.reshape(PIECES, fine, runs).mean(axis=1) for view in views])


def judge(cells, variance, least, most):
    """Hold stated errors against the true variance of the mean, whose value is zero, over independent runs."""
    errors, structures = errors_of_mean(cells)
    squares = errors**2 / variance
    spread = SURE * squares.std() / np.sqrt(squares.size)
    assert least**2 < squares.mean() + spread
    assert squares.mean() - spread < most**2
    inside = np.abs(cells.mean(axis=(0, 1))) < 2.0 * errors
    # 95.4 % of a normal deviate; few structures have fat tails
    assert inside.mean() > 0.9 - SURE * np.sqrt(0.9 * 0.1 / len(inside))
    assert (structures >= 1.0).all()
    assert (structures <= len(cells)).all()
    return structures


# ---- one source of scatter at a time ----


@pytest.mark.parametrize("time", [0, 2, 5, 20])
@pytest.mark.parametrize("frames", [10, 30, 100, 300])
def test_pieces_that_change_on_their_own(frames, time):
    cells = autoregressive(frames, time, (PIECES, RUNS), seed=frames + time)
    one_frame = variance_of_mean(lambda lag: np.exp(-lag / time) if time else float(lag == 0), frames)
    structures = judge(cells, one_frame / PIECES, 0.97, 1.6)
    assert 0.35 / one_frame < np.median(structures) < 1.2 / one_frame


@pytest.mark.parametrize("crossing", [3, 10, 30])
@pytest.mark.parametrize("frames", [10, 30, 100])
def test_structures_that_travel_past_the_window(frames, crossing):
    cells = travelling(frames, crossing, RUNS, seed=frames + crossing)
    variance = variance_of_mean(lambda lag: max(0.0, 1.0 - lag / crossing), frames) / PIECES
    judge(cells, variance, 0.97, 1.5)


def test_what_either_sees_alone_is_not_enough_for_structures_that_travel():
    cells = travelling(30, 30, RUNS, seed=14)
    true = variance_of_mean(lambda lag: max(0.0, 1.0 - lag / 30), 30) / PIECES
    assert block_averaged_variance(cells.mean(axis=1)).mean() < true / 9
    assert (cells.mean(axis=0).var(axis=0, ddof=1) / PIECES).mean() < true / 9


def test_parts_that_stand_still_while_others_move():
    rng = np.random.default_rng(5)
    still, quick = rng.normal(size=(PIECES, RUNS)), rng.normal(size=(100, PIECES, RUNS))
    cells = np.sqrt(0.4) * still + np.sqrt(0.6) * quick
    structures = judge(cells, (0.4 + 0.006) / PIECES, 0.9, 1.3)
    assert np.median(structures) < 4


def test_a_frozen_bed_with_a_little_noise_is_one_structure():
    rng = np.random.default_rng(6)
    cells = rng.normal(size=(PIECES, RUNS)) + 0.1 * rng.normal(size=(200, PIECES, RUNS))
    structures = judge(cells, 1.0 / PIECES, 0.97, 1.1)
    assert np.median(structures) == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize(("crossing", "scale"), [(80, 1.0), (40, 1.0), (16, 2.0)])
def test_noise_of_the_measurement_does_not_pass_for_renewal(crossing, scale):
    """A bed that hardly moves, seen with noise as large as its own scatter: frames differ, the bed stays the same."""
    frames = 50
    cells = travelling(frames, crossing, 400, seed=crossing)
    cells += scale * np.random.default_rng(7).normal(size=cells.shape)
    noise = np.full(400, scale**2 / PIECES)
    true = np.sqrt((cells.mean(axis=(0, 1)) ** 2).mean())
    told, blind = (np.sqrt((errors_of_mean(cells, *known)[0] ** 2).mean()) for known in ((noise,), ()))
    assert 0.85 * true < told < 1.3 * true
    assert blind < 0.9 * told


def test_pieces_that_change_together_are_not_taken_for_independent():
    # one value for all pieces: the pieces differ by little, the frames by much
    common = autoregressive(400, 3, (1, RUNS), seed=7)
    cells = common + 0.1 * np.random.default_rng(8).normal(size=(400, PIECES, RUNS))
    variance = variance_of_mean(lambda lag: np.exp(-lag / 3), 400)
    judge(cells, variance, 0.9, 1.2)


# ---- exact cases ----


def test_one_frame_has_the_error_of_its_pieces():
    cells = np.random.default_rng(1).normal(size=(1, PIECES, 5))
    errors, structures = errors_of_mean(cells)
    assert errors == pytest.approx(cells[0].std(axis=0, ddof=1) / np.sqrt(PIECES), rel=1e-14)
    assert structures.tolist() == [1.0] * 5


@pytest.mark.parametrize("frames", [2, 3, 7, 64, 500])
def test_identical_frames_have_the_error_of_one(frames):
    one = np.random.default_rng(2).normal(size=(1, PIECES, 5))
    errors, structures = errors_of_mean(np.repeat(one, frames, axis=0))
    assert errors == pytest.approx(errors_of_mean(one)[0], rel=1e-12)
    assert structures == pytest.approx([1.0] * 5, abs=1e-12)


def test_with_one_piece_only_time_tells():
    cells = np.random.default_rng(3).normal(size=(256, 1, 400))
    errors, structures = errors_of_mean(cells)
    assert np.sqrt(np.mean(errors**2)) == pytest.approx(1 / 16, rel=0.1)
    assert np.median(structures) > 150
    same = np.repeat(cells[:1], 5, axis=0)
    assert np.isnan(errors_of_mean(same)).all()
    assert np.isnan(errors_of_mean(cells[:1])).all()


def test_where_nothing_varies_the_error_is_zero():
    errors, structures = errors_of_mean(np.full((9, PIECES, 2), 0.25))
    assert errors.tolist() == [0.0, 0.0]
    assert np.isnan(structures).all()


def test_a_value_that_is_not_there_spoils_only_its_own_quantity():
    cells = np.random.default_rng(4).normal(size=(20, PIECES, 3))
    alone, _ = errors_of_mean(cells[:, :, [0, 2]])
    cells[4, 1, 1] = np.nan
    errors, structures = errors_of_mean(cells)
    assert np.isnan(errors).tolist() == [False, True, False]
    assert np.isnan(structures).tolist() == [False, True, False]
    assert errors[[0, 2]] == pytest.approx(alone, rel=1e-12)


def test_errors_scale_with_their_quantity():
    cells = autoregressive(50, 4, (PIECES, 3), seed=9)
    errors, structures = errors_of_mean(cells)
    scaled, same = errors_of_mean(1e-6 * cells + 1.0)
    assert scaled == pytest.approx(1e-6 * errors, rel=1e-5)
    assert same == pytest.approx(structures, rel=1e-5)


# ---- the parts ----


@pytest.mark.parametrize("time", [0.5, 3, 10])
def test_block_averages_reach_the_plateau_of_long_series(time):
    n = 4096
    series = autoregressive(n, time, (RUNS,), seed=11)
    kept = np.exp(-1.0 / time)
    exact = (1 + kept) / (1 - kept) / n - 2 * kept * (1 - kept**n) / (n * (1 - kept)) ** 2
    assert np.mean(block_averaged_variance(series)) == pytest.approx(exact, rel=0.08)


def test_renewal_of_a_steady_stream_is_its_crossing():
    cells = travelling(2000, 20, 20, seed=12)
    found = renewal_frames(cells.mean(axis=1), np.full(20, 1.0 / PIECES))
    assert found.mean() == pytest.approx(20.0, rel=0.1)


def test_half_rise_by_a_slow_sum():
    series = autoregressive(60, 6, (70,), seed=13)
    variance = np.linspace(0.1, 6.0, 70)
    expected = []
    for column, half in zip(series.T, variance / 2, strict=True):
        rise = [0.0] + [0.5 * np.mean((column[lag:] - column[:-lag]) ** 2) for lag in range(1, 60)]
        lag = next((k for k in range(1, 60) if rise[k] >= half), None)
        at = 60.0 if lag is None else lag - 1 + (half - rise[lag - 1]) / (rise[lag] - rise[lag - 1])
        expected.append(min(60.0, max(1.0, 2 * at)))
    assert renewal_frames(series, variance) == pytest.approx(expected, rel=1e-9)
    assert len(set(expected)) > 20
