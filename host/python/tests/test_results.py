"""What results give: typed values, matrices, tables, pictures."""

import builtins
import json

import numpy
import pytest

import pendulum_rig as pr


def test_the_covariance_has_the_squares_of_the_spreads_on_its_diagonal(fitted):
    covariance = fitted.covariance
    assert covariance.shape == (len(fitted.symbols),) * 2
    assert fitted.symbols == tuple(number.symbol for number in fitted.parameters)
    spreads = numpy.array([numpy.nan if number.std is None else number.std for number in fitted.parameters])
    numpy.testing.assert_allclose(numpy.diag(covariance), spreads**2, rtol=1e-12)
    known = ~numpy.isnan(fitted.correlations)
    expected = fitted.correlations * numpy.outer(spreads, spreads)
    numpy.testing.assert_allclose(covariance[known], expected[known], rtol=1e-12)
    numpy.testing.assert_array_equal(covariance, covariance.T)


def test_what_is_found_covers_the_truth(rig, fitted):
    for number in fitted.parameters:
        if number.status == "identified":
            assert abs(number.value - rig[number.symbol].value) < 5 * number.std, number


def test_the_curves_leave_what_the_fit_says(fitted):
    curve = fitted.curves[0]
    assert curve.measured.shape == curve.modelled.shape == curve.times_s.shape
    assert numpy.sqrt(numpy.mean(curve.residuals**2)) == pytest.approx(fitted.rmse, rel=1e-6)


def test_the_fitted_rig_holds_the_found_values(fitted):
    assert fitted.rig["Mc"].value == pytest.approx(fitted["Mc"].value, rel=1e-3)
    assert fitted.rig["Mc"].std == pytest.approx(fitted["Mc"].std, rel=0.1)


def test_arrays_are_shared_and_cannot_be_written_to(swing):
    assert numpy.shares_memory(swing.times_s, swing.times_s)
    with pytest.raises(ValueError):
        swing.readings[0] = 0.0


def test_a_step_of_the_model_is_a_step_of_its_run(rig):
    model = rig.model()
    one, many = model.release(1.5), model.release(1.5)
    angles, velocities = model.run(many, 1e-3, 100)
    for angle, velocity in zip(angles, velocities):
        model.step(one, 1e-3)
        assert (one.angle_rad, one.velocity_rad_s) == (angle, velocity)
    assert (one.time_s, one.is_resting) == (many.time_s, many.is_resting)


def test_results_show_themselves(fitted, rig, swing):
    for shown in (fitted, rig, pr.effects("quadratic-drag")["quadratic-drag"]):
        assert "<table>" in shown._repr_html_()
        assert repr(shown).startswith("<")
    assert "±" in repr(fitted) and "identified" in repr(fitted)
    assert "200 Hz" in repr(swing)


def test_what_rates_leave_is_told_in_their_unit(rig, spin, fitted):
    turned = pr.fit(spin, rig, method="least-squares")
    assert (fitted.measured, turned.measured) == ("angle", "rate")
    assert "mrad rms" in repr(fitted) and "mrad/s rms" in repr(turned) and "mrad/s rms" in turned._repr_html_()
    by_hand = pr.improve(spin, rig, add=["quadratic-drag"])
    assert by_hand.measured == "rate" and "mrad/s" in repr(by_hand) and "mrad/s" in by_hand._repr_html_()
    assert "mrad/s rms" in repr(pr.diagnose(spin, rig))


def test_an_improvement_by_a_diagnosis_shows_its_steps(rig, swing):
    improved = pr.improve(swing, rig)
    assert improved.measured == "angle" and improved.steps[0]["words"] == "base"
    assert repr(improved).startswith("<Improvement: error after each step\n  base ")


def test_tables(fitted, rig, swing):
    pandas = pytest.importorskip("pandas")
    assert list(fitted.to_dataframe()["symbol"]) == list(fitted.symbols)
    assert rig.to_dataframe().loc["Mc", "value"] == rig.values["Mc"]
    assert isinstance(swing.to_dataframe(), pandas.DataFrame)


def test_pictures(fitted, swing, rig, spin):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    above, below = fitted.plot()
    assert len(above.get_lines()) == 2 and below.get_ylabel() == "left (mrad)"
    assert swing.plot().get_ylabel() == "reading (rad)"
    above, below = pr.fit(spin, rig, method="least-squares").plot()
    assert (above.get_ylabel(), below.get_ylabel()) == ("reading (rad/s)", "left (mrad/s)")


def test_without_matplotlib_an_error_says_what_to_install(fitted, monkeypatch):
    real = builtins.__import__

    def refused(name, *rest):
        if name.startswith("matplotlib"):
            raise ImportError(name)
        return real(name, *rest)

    monkeypatch.setattr("pendulum_rig.extras.import_module", lambda name: refused(name))
    with pytest.raises(pr.MissingExtra, match="pip install matplotlib"):
        fitted.plot()


def test_what_was_noticed_is_noted(rig, fitted):
    assert any("held still before the release" in note for note in fitted.notes)


def test_a_diagnosis_without_a_name_says_whether_anything_is_missing():
    def said(**fields):
        common = {"undecided": [], "suspect": None, "verdict": [], "rmse_before": 5e-3, "rmse_after": 2e-3}
        text = json.dumps({**common, "noise": 1e-3, "values": [], **fields})
        return repr(pr.Diagnosis(text))

    assert "nothing is missing; error 5.000" in said(unexplained=False)
    assert "more than noise is left" in said(unexplained=True)
    assert "likely missing, but not proven, is detent;" in said(unexplained=True, suspect="detent")
    tied = said(unexplained=False, verdict=["detent", "backlash"], undecided=["presliding"])
    assert "missing is detent + backlash, which can't be told from presliding" in tied
