"""The budget of uncertainty: identities of scale, closed forms, and drawing against first order."""

import warnings

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from bedrad.heat import RangeWarning, prediction
from bedrad.heat.bulk import find_fit
from bedrad.heat.gas import air_conductivity
from bedrad.heat.prediction import Bulk, System, Uncertainties, ViewFactors, WallLayer

TUBE = System(7.75e-3, 300e-6, 0.058)
T = np.array([400.0, 900.0, 1373.15])
MEASURED = WallLayer(0.45, 6.0e6, 0.36, 0.004, 1e5, 0.02)
NOTHING = ViewFactors([0.0])


def elasticities(*arguments, **options):
    """Elasticities of h at 900 K by name, and those of one input where several scale together."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RangeWarning)
        budget = prediction.predict(*arguments, **options).budget
    return dict(zip(budget.names, budget.elasticities[:, -1], strict=True))


def constant_gas(temperature):
    return np.full_like(temperature, 0.05)


@pytest.mark.parametrize("correlation", ["watkins", "bedrad"])
def test_scaled_with_its_velocity_a_flow_without_radiation_keeps_its_nusselt_number(correlation):
    """D and d times s, U times its root: A and U/sqrt(g d) stay, so h falls as 1/s, whatever the correlation."""
    found = elasticities(TUBE, 900.0, None, NOTHING, Bulk(0.4, 0.4), correlation)
    sum_ = found["tube_diameter"] + found["particle_diameter"] + 0.5 * found["velocity"]
    assert sum_ == pytest.approx(-1.0, abs=2e-8)


@pytest.mark.parametrize("form", ["general", "flat", "cylinder"])
def test_all_conductivities_together_scale_h(form):
    layer = WallLayer(0.45, 6.0e6, 0.36, form=form)
    found = elasticities(TUBE, 900.0, layer, NOTHING, Bulk(0.4, 0.4))
    together = found["gas_conductivity"] + found["solid_conductivity"] + found["bulk_conductivity"]
    assert together == pytest.approx(1.0, abs=2e-8)


def test_zehner_bauer_and_schluender_scale_too_but_for_radiation():
    """Gas and solid scale bulk and wall layer alike; what is missing to 1 is what radiation carries."""
    hot, cold = elasticities(TUBE, 1373.15, bulk="zbs"), elasticities(TUBE, 4.0, None, NOTHING, "zbs",
                                                                     gas_conductivity=constant_gas)  # fmt: skip
    assert cold["gas_conductivity"] + cold["solid_conductivity"] == pytest.approx(1.0, abs=1e-7)
    assert 0.7 < hot["gas_conductivity"] + hot["solid_conductivity"] < 0.95


def test_temperature_acts_through_radiation_alone_where_nothing_else_depends_on_it():
    found = elasticities(TUBE, 900.0, MEASURED, ViewFactors([0.8, 0.2]), Bulk(0.4, 0.3), gas_conductivity=constant_gas)
    assert found["wall_temperature"] == pytest.approx(3.0 * found["view_factors"], rel=1e-7)


def test_elasticity_of_the_view_factors_in_closed_form():
    """d ln h/d ln k_rad = k_rad/k times the share of the wall layer in the resistance, by eq. 22."""
    one = prediction.predict(TUBE, 1000.0, MEASURED, ViewFactors([0.8, 0.15, 0.03]), Bulk(0.5, 0.4))
    W4 = (1.0 - 1.0 / TUBE.diameter_ratio) ** 4
    kappa = float(one.conductivity_ratio)
    share = kappa * (1.0 - W4) / (W4 + kappa * (1.0 - W4))
    k_rad = float(one.radiative_conductivity)
    expected = share * k_rad / (k_rad + float(one.wall_layer_conductivity))
    found = dict(zip(one.budget.names, one.budget.elasticities[:, 0], strict=True))
    assert found["view_factors"] == pytest.approx(expected, rel=1e-7)


def test_covariance_of_the_view_factors_counts():
    """Rays that layer 2 loses layer 1 wins: only F_1 + 2 F_2 + 3 F_3 matters, and its variance is w C w."""
    covariance = 1e-4 * np.array([[1.0, -0.9, -0.1], [-0.9, 0.9, 0.05], [-0.1, 0.05, 0.1]])
    F = ViewFactors([0.80, 0.15, 0.03], covariance=covariance)
    assert F.errors == pytest.approx(np.sqrt(np.diag(covariance)))
    one = prediction.predict(TUBE, 1000.0, WallLayer(0.45, 6.0e6, 0.36), F, Bulk(0.5, 0.4))
    w = np.array([1.0, 2.0, 3.0])
    slope = 4 * 5.670374419e-8 * 150e-6 * 1000.0**3
    assert one.radiative_conductivity_error == pytest.approx(slope * np.sqrt(w @ covariance @ w), rel=1e-7)
    apart = ViewFactors([0.80, 0.15, 0.03], np.sqrt(np.diag(covariance)))
    alone = prediction.predict(TUBE, 1000.0, WallLayer(0.45, 6.0e6, 0.36), apart, Bulk(0.5, 0.4))
    assert alone.radiative_conductivity_error > 1.2 * one.radiative_conductivity_error
    assert one.budget.total[0] == one.heat_transfer_coefficient_error
    assert one.budget.shares.sum() == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize(
    ("covariance", "message"),
    [
        (np.eye(2), r"shape \(2, 2\); expected \(3, 3\)"),
        ([[1, 0, 0], [0.1, 1, 0], [0, 0, 1]], "not symmetric"),
        ([[1, 2, 0], [2, 1, 0], [0, 0, 1]], "negative eigenvalue -1e-06;"),
    ],
)
def test_a_covariance_that_is_none_is_refused(covariance, message):
    with pytest.raises(ValueError, match=message):
        ViewFactors([0.8, 0.15, 0.03], covariance=np.asarray(covariance, dtype=float) * 1e-6)


def test_errors_and_covariance_that_disagree_are_refused():
    with pytest.raises(ValueError, match="differ from the diagonal"):
        ViewFactors([0.8], [0.01], np.array([[1e-6]]))


def test_inputs_at_the_end_of_their_meaning_are_moved_to_one_side_only():
    """No contacts, a = 0, a standing bed, black particles: one-sided, and the slope is still that of the model."""
    edge = System(7.75e-3, 300e-6, 0.0, emissivity=1.0)
    layer = WallLayer(0.45, 0.0, 0.0, contacts_per_area_error=1e5)
    budget = prediction.predict(edge, 900.0, layer, ViewFactors([0.8]), "zbs").budget
    slope = dict(zip(budget.names, budget.contributions[:, 0], strict=True))["contacts_per_area"]

    def h(contacts):
        return float(prediction.predict(edge, 900.0, WallLayer(0.45, contacts, 0.0), ViewFactors([0.8])).
                     heat_transfer_coefficient)  # fmt: skip

    # at a = 0 contact and no-contact particles are the same but for the rounding of the curvature, 1.35/A for 1/A
    assert slope == pytest.approx(abs(h(1e5) - h(0.0)), rel=2e-3)
    found = dict(zip(budget.names, budget.elasticities[:, 0], strict=True))
    assert found["emissivity"] > 0.0
    assert found["nc_distance"] == found["velocity"] == 0.0


@pytest.mark.parametrize("name", ["tube_diameter", "emissivity", "bulk_conductivity"])
@pytest.mark.parametrize("value", [-1e-9, np.nan, np.inf])
def test_a_standard_error_without_meaning_is_refused(name, value):
    with pytest.raises(ValueError, match=f"standard error of {name} is"):
        Uncertainties(**{name: value})


def test_published_uncertainties_act_on_the_correlated_layer_only():
    given = Uncertainties.published()
    correlated = prediction.predict(TUBE, T, uncertainties=given).budget
    errors = dict(zip(correlated.names, correlated.errors[:, 0], strict=True))
    values = dict(zip(correlated.names, correlated.values[:, 0], strict=True))
    assert errors["packing_fraction"] == pytest.approx(0.05 / np.sqrt(3) * values["packing_fraction"])
    assert errors["contacts_per_area"] == pytest.approx(0.16 / np.sqrt(3) * values["contacts_per_area"])
    # half of the 95 % of the bulk, and nearly all there is: the bulk holds most of the resistance
    assert (correlated.shares[correlated.names.index("bulk_conductivity")] > 0.9).all()
    measured = prediction.predict(TUBE, T, MEASURED, uncertainties=given).budget
    errors = dict(zip(measured.names, measured.errors[:, 0], strict=True))
    assert (errors["packing_fraction"], errors["contacts_per_area"]) == (0.004, 1e5)
    rows = str(measured).splitlines()
    assert rows[0].endswith("at 1373.15 K")
    assert rows[2].startswith("bulk conductivity")


GIVEN = Uncertainties(
    tube_diameter=2e-5, particle_diameter=3e-6, velocity=1e-3, solid_conductivity=0.05, porosity=0.004, emissivity=0.02,
    wall_temperature=4.0, gas_conductivity=0.01, bulk_conductivity=0.02,
)  # fmt: skip


@pytest.mark.parametrize("options", [{}, {"property_temperature": "layers", "heat_flux": 3e4}])
def test_drawing_agrees_with_first_order(options):
    """All inputs at once; the errors are small, so that curvature stays below the error of 8,000 draws."""
    one = prediction.predict(
        TUBE,
        T[1:],
        MEASURED,
        ViewFactors([0.8, 0.15], [0.004, 0.003]),
        uncertainties=GIVEN,
        samples=8000,
        seed=3,
        **options,
    )
    many = one.monte_carlo
    assert many.rejected < 0.01
    for name in ("heat_transfer_coefficient", "nusselt", "wall_layer_conductivity", "radiative_conductivity"):
        first = getattr(one, f"{name}_error")
        # relative error of a standard deviation 1/sqrt(2 n): 4.5 of them, 8 times 2 cases, 1e-4 in all; 1 % curvature
        assert many.standard_deviation[name] == pytest.approx(first, rel=4.5 / np.sqrt(16000) + 0.01), name
        assert (np.abs(many.mean[name] - getattr(one, name)) < 4.5 * first / np.sqrt(8000) + 0.05 * first).all(), name
        low, high = many.interval[name]
        assert (high - low) / first == pytest.approx(2 * 1.96, rel=0.06)
    assert "8000 draws from seed 3" in str(many)


def test_drawing_repeats_with_its_seed_and_shrinks_with_the_root_of_its_size():
    def run(samples, seed):
        return prediction.predict(TUBE, 900.0, uncertainties=GIVEN, samples=samples, seed=seed).monte_carlo

    name = "heat_transfer_coefficient"
    assert run(50, 1).mean[name] == run(50, 1).mean[name] != run(50, 2).mean[name]
    sizes = np.array([16, 64, 256, 1024])
    scatter = [np.std([run(int(n), seed).mean[name][0] for seed in range(48)]) for n in sizes]
    # the slope has a standard error of 0.04; 4 of them
    assert np.polyfit(np.log(sizes), np.log(scatter), 1)[0] == pytest.approx(-0.5, abs=0.16)


def test_draws_without_meaning_are_drawn_again_and_told():
    """Contacts fill the wall layer but for 0.1 %: half of the draws leave a negative number of other particles."""
    full = 0.45 * (1 - 0.5 / TUBE.diameter_ratio) / (2 * np.pi / 3) / 150e-6**2
    layer = WallLayer(0.45, 0.999 * full, 0.3, contacts_per_area_error=0.1 * full)
    many = prediction.predict(TUBE, 900.0, layer, samples=2000).monte_carlo
    assert 0.4 < many.rejected < 0.6
    impossible = WallLayer(0.45, 0.999 * full, 0.3, packing_fraction_error=1e6)
    with pytest.raises(ValueError, match=r"draws have a meaning; the standard errors are too large"):
        prediction.predict(TUBE, 900.0, impossible, samples=100)
    with pytest.raises(ValueError, match="samples is 1; expected at least 2"):
        prediction.predict(TUBE, 900.0, samples=1)


def variable_coefficient(system, layer, wall_temperature, q):
    """h of the developed plug flow, k dT/dr = q r/R with k at the local temperature; the bulk is that of Table 5.2."""
    R, edge = system.tube_diameter / 2, (system.tube_diameter - system.particle_diameter) / 2
    fit = find_fit(system.particle_diameter)

    def inwards(conductivity, outer, inner, start):
        # T and the integral of T r, over r from outer to inner
        def slopes(r, y):
            return q * r / (R * float(conductivity(y[0]))), y[0] * r

        found = solve_ivp(slopes, (outer, inner), [start, 0.0], method="DOP853", rtol=1e-12, atol=1e-12)
        return found.y[0, -1], -found.y[1, -1]

    at_edge, moment = inwards(lambda T: layer.conductivity(system, air_conductivity(T)), R, edge, wall_temperature)
    _, rest = inwards(fit.conductivity, edge, 0.0, at_edge)
    return q / (wall_temperature - 2.0 * (moment + rest) / R**2)


class TestPropertyTemperature:
    def test_all_are_the_same_without_a_flux(self):
        base = prediction.predict(TUBE, T)
        for choice in ("mean", "layers"):
            same = prediction.predict(TUBE, T, property_temperature=choice, heat_flux=0.0)
            assert same.heat_transfer_coefficient == pytest.approx(base.heat_transfer_coefficient, rel=1e-13)
            assert same.mean_temperature == pytest.approx(T, rel=1e-15)
        assert np.isnan(base.mean_temperature).all()

    def test_mean_is_the_prediction_at_the_mean_temperature(self):
        q = np.array([1e4, 2e4, 5e4])
        one = prediction.predict(TUBE, T, property_temperature="mean", heat_flux=q)
        there = prediction.predict(TUBE, one.mean_temperature)
        assert one.heat_transfer_coefficient == pytest.approx(there.heat_transfer_coefficient, rel=1e-10)
        assert one.mean_temperature == pytest.approx(T - q / there.heat_transfer_coefficient, rel=1e-10)

    def test_layers_by_hand(self):
        q = 4e4
        one = prediction.predict(TUBE, 1300.0, MEASURED, ViewFactors([0.8, 0.15]), "zbs", property_temperature="layers",
                                 heat_flux=q)  # fmt: skip
        k_wa, k_rad = float(one.wall_layer_conductivity), float(one.radiative_conductivity)
        # the developed plug flow takes its heat evenly, so the flux is proportional to the radius
        R, r = 3.875e-3, 150e-6
        step = q * (R**2 - (R - r) ** 2) / (2 * R * (k_wa + k_rad))
        assert one.wall_layer_temperature == pytest.approx(1300.0 - step / 2, rel=1e-11)
        flux = 5.670374419e-8 * sum(F * (1300.0**4 - (1300.0 - j * step) ** 4) for j, F in ((1, 0.8), (2, 0.15)))
        assert k_rad == pytest.approx(flux * r / step, rel=1e-9)
        assert k_wa == pytest.approx(float(MEASURED.conductivity(TUBE, air_conductivity(1300.0 - step / 2))), rel=1e-11)
        # the bulk's mean temperature is what is left of the whole mean, the wall layer's being that of its middle
        W2 = (1 - r / R) ** 2
        mean = (float(one.mean_temperature) - (1 - W2) * (1300.0 - step / 2)) / W2
        assert one.bulk_temperature == pytest.approx((1300.0 - step) / 3 + 2 / 3 * mean, rel=1e-11)
        assert one.mean_temperature == pytest.approx(1300.0 - q / one.heat_transfer_coefficient, rel=1e-11)
        bulk = prediction.bulk_conductivity(TUBE, one.bulk_temperature, "zbs")
        assert one.bulk_conductivity == pytest.approx(bulk.with_radiation, rel=1e-11)

    def test_layers_are_right_where_wall_and_mean_are_off_in_proportion_to_the_flux(self):
        """Against the developed flow whose conductivities follow the local temperature, solved by quadrature."""
        system = prediction.TABLE_5_1[0]
        fluxes = np.array([32e3, 16e3, 8e3])
        exact = np.array([variable_coefficient(system, MEASURED, 900.0, q) for q in fluxes])
        off = {}
        for choice in ("wall", "mean", "layers"):
            found = [
                prediction.predict(
                    system, 900.0, MEASURED, NOTHING, property_temperature=choice, heat_flux=q
                ).heat_transfer_coefficient
                for q in fluxes
            ]
            off[choice] = np.array(found, dtype=float) / exact - 1.0
        assert off["wall"][0] > 0.03
        assert off["mean"][0] < -0.02
        for choice in ("wall", "mean"):
            order = np.polyfit(np.log(fluxes), np.log(np.abs(off[choice])), 1)[0]
            assert order == pytest.approx(1.0, abs=0.1), choice
        # second order, but for a first-order rest of 1e-3 of the wall's: the mean of the wall layer itself
        assert (np.abs(off["layers"]) < 5e-3 * off["wall"]).all()
        assert np.abs(off["layers"][0] / off["layers"][1]) > 2.0**2

    def test_the_choice_matters_in_proportion_to_the_flux(self):
        base = float(prediction.predict(TUBE, 1200.0).heat_transfer_coefficient)
        fluxes = np.array([4e3, 2e3, 1e3])
        for choice in ("mean", "layers"):
            off = [
                base - float(prediction.predict(TUBE, 1200.0, property_temperature=choice, heat_flux=q).
                             heat_transfer_coefficient)
                for q in fluxes
            ]  # fmt: skip
            assert min(off) > 0.0
            assert np.polyfit(np.log(fluxes), np.log(off), 1)[0] == pytest.approx(1.0, abs=0.02)

    def test_a_cooled_flow_is_hotter_than_its_wall(self):
        one = prediction.predict(TUBE, 800.0, property_temperature="layers", heat_flux=-2e4)
        assert one.mean_temperature > one.wall_layer_temperature > 800.0

    @pytest.mark.parametrize(
        ("options", "message"),
        [
            ({"property_temperature": "film"}, "property_temperature is 'film'; expected 'wall', 'mean' or 'layers'"),
            ({"property_temperature": "mean"}, "property_temperature 'mean' needs a heat_flux"),
            (
                {"property_temperature": "mean", "heat_flux": 1e7},
                "heat_flux is 1e[+]07 W/m2; expected less: no flow above",
            ),
            ({"property_temperature": "layers", "heat_flux": 1e9}, "heat_flux is 1e[+]09 W/m2; expected less"),
            ({"heat_flux": np.nan}, "heat_flux is nan; expected one finite number"),
            ({"heat_flux": [1.0, 2.0]}, "expected one finite number, or one for each of 3 wall temperatures"),
        ],
    )
    def test_what_cannot_be_is_refused(self, options, message):
        with pytest.raises(ValueError, match=message):
            prediction.predict(TUBE, T, **options)


def test_a_matrix_of_temperatures_is_refused():
    with pytest.raises(ValueError, match=r"wall_temperature has the shape \(1, 2\); expected one number or a row"):
        prediction.predict(TUBE, [[400.0, 500.0]])


NARROW = System(7.75e-3, 450e-6, 0.058)


class TestWhatNobodyCanMean:
    """Found by reading and trying: each gave a number, or another error than the one that helps."""

    @pytest.mark.parametrize("choice", ["wall", "mean", "layers"])
    def test_no_flow_is_colder_than_absolute_zero(self, choice):
        for T_w, q in ((373.15, 1e5), (900.0, 1e6)):
            with pytest.raises(ValueError, match=r"expected less: no flow above absolute zero takes it from a wall of"):
                prediction.predict(TUBE, T_w, property_temperature=choice, heat_flux=q)

    def test_strong_cooling_settles_on_the_only_solution(self):
        """Where radiation rules, plain repetition swings ever more widely."""
        large = System(56.4e-3, 2e-3, 0.015)
        one = prediction.predict(large, 400.0, property_temperature="mean", heat_flux=-1e5)
        # by bisection
        low, high = 400.0, 3000.0
        for _ in range(80):
            middle = 0.5 * (low + high)
            there = float(prediction.predict(large, middle).heat_transfer_coefficient)
            low, high = (middle, high) if 400.0 + 1e5 / there > middle else (low, middle)
        assert one.mean_temperature == pytest.approx(low, rel=1e-9)

    def test_draws_far_out_are_drawn_again(self):
        """Diameters near zero, walls near zero, factors below zero: no draw ends the run, and none counts as heat."""
        wide = Uncertainties(particle_diameter=1e-4, wall_temperature=300.0)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RangeWarning)
            many = prediction.predict(TUBE, 900.0, uncertainties=wide, samples=1500).monte_carlo
            walls = Uncertainties(wall_temperature=200.0)
            layers = prediction.predict(
                TUBE, 900.0, property_temperature="layers", heat_flux=4e4, uncertainties=walls, samples=1500
            ).monte_carlo
        loose = prediction.predict(TUBE, 900.0, MEASURED, ViewFactors([0.8], [2.0]), samples=1500).monte_carlo
        for found in (many, layers, loose):
            assert np.isfinite(found.mean["heat_transfer_coefficient"]).all()
            assert 100 < found.mean["heat_transfer_coefficient"][0] < 1000
        assert loose.rejected > 0.2

    @pytest.mark.parametrize(
        ("options", "message"),
        [
            ({"uncertainties": {"bulk_conductivity": 0.1}}, "uncertainties is .*; expected Uncertainties"),
            ({"view_factors": [0.8, 0.2]}, "view_factors is .*; expected ViewFactors"),
            ({"wall_layer": (0.4, 1e6)}, "wall_layer is .*; expected WallLayer or ParticleWallLayer"),
            ({"bulk": 0.4}, "bulk is 0.4; expected Bulk or str"),
            ({"samples": 10.5}, "samples is 10.5; expected int"),
            ({"uncertainties": Uncertainties(heat_flux=1.0)}, "standard error of heat_flux is 1 W/m2, but there is no"),
        ],
    )
    def test_numbers_in_place_of_records_are_refused(self, options, message):
        with pytest.raises(ValueError, match=message):
            prediction.predict(TUBE, 900.0, **options)

    def test_nothing_to_predict_and_several_tubes_are_refused(self):
        with pytest.raises(ValueError, match=r"wall_temperature has the shape \(0,\)"):
            prediction.predict(TUBE, [])
        for bad in ([7e-3], None, "7 mm", np.array([7e-3, 8e-3])):
            with pytest.raises(ValueError, match=r"tube_diameter is .*; expected one number"):
                System(bad, 1e-4, 0.05)
        for values, name in (
            ((np.nan, 1e6), "packing_fraction"),
            ((0.4, -1.0), "contacts_per_area"),
            ((0.4, 1e6, 1.0), "nc_distance"),
            (([0.4], 1e6), "packing_fraction"),
        ):
            with pytest.raises(ValueError, match=rf"^{name} is .*; expected"):
                WallLayer(*values)

    def test_a_gas_of_one_conductivity_may_say_so(self):
        one = prediction.predict(TUBE, T, gas_conductivity=lambda temperature: 0.05)
        assert (one.gas_conductivity == 0.05).all()

    def test_the_budget_is_of_the_hottest_wall_by_itself(self):
        budget = prediction.predict(TUBE, [1373.15, 400.0], uncertainties=GIVEN).budget
        assert str(budget).splitlines()[0].endswith("at 1373.15 K")
        assert budget.table(1).splitlines()[0].endswith("at 400.00 K")

    def test_published_deviations_are_those_of_watkins_correlations_alone(self):
        for correlation, same in (("bedrad", True), ("watkins", False)):
            bare, with_ = (
                prediction.predict(NARROW, 900.0, correlation=correlation, uncertainties=given).budget
                for given in (None, Uncertainties.published())
            )
            row = bare.names.index("contacts_per_area")
            assert (bare.errors[row] == with_.errors[row]) == same

    def test_far_outside_the_fits_it_is_they_that_are_named(self):
        far = System(3.0, 3e-4, 0.05)
        with (
            pytest.warns(RangeWarning),
            pytest.raises(ValueError, match=r"bedrad's correlation, far outside the flows|packing"),
        ):
            prediction.predict(System(1.2e-3, 3e-4, 0.9), 900.0, correlation="bedrad")
        huge = System(3e5, 3e-4, 0.05)
        with (
            pytest.warns(RangeWarning),
            pytest.raises(ValueError, match=r"contact_ratio \(Watkins 2018, eq. 40\) gives -"),
        ):
            prediction.predict(huge, 900.0)
        with pytest.warns(RangeWarning):
            assert prediction.predict(far, 900.0).nusselt > 7.9


def test_view_factors_of_bedrads_flows_go_together():
    """Their sum hardly varies from flow to flow, so the radiative conductivity is surer than its parts."""
    factors = ViewFactors.from_correlations(NARROW, "bedrad")
    assert factors.covariance[0, 1] < -0.9 * factors.errors[0] * factors.errors[1]
    steps = np.arange(1.0, 4.0)
    together = np.sqrt(steps @ factors.covariance @ steps)
    assert together < 0.7 * np.linalg.norm(steps * factors.errors)
