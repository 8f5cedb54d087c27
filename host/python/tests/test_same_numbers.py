"""The same numbers as the command line's --json, to the bit."""

import json
import subprocess

import pytest

import pendulum_rig as pr

# A clock is never the same twice.
CLOCKS = {"seconds"}


def said(host, *arguments):
    done = subprocess.run([host, *map(str, arguments), "--json"], capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def without_clocks(fields):
    if isinstance(fields, dict):
        return {key: without_clocks(value) for key, value in fields.items() if key not in CLOCKS}
    return [without_clocks(each) for each in fields] if isinstance(fields, list) else fields


def same(result, expected):
    assert without_clocks(result.to_dict()) == without_clocks(expected)


def test_a_fit(host, files, fitted):
    model, recording = files
    same(fitted, said(host, "fit", recording, "--rig", model, "--method", "least-squares"))


def test_a_comparison(host, files):
    model, recording = files
    same(pr.compare(recording, model), said(host, "compare", recording, "--rig", model))


def test_a_diagnosis(host, files):
    model, recording = files
    same(pr.diagnose(recording, model), said(host, "diagnose", recording, "--rig", model))


def test_an_improvement_by_hand(host, files):
    model, recording = files
    improved = pr.improve(recording, model, add=["quadratic-drag"])
    same(improved, said(host, "improve", recording, "--rig", model, "--add", "quadratic-drag"))


def test_a_plan(host, files):
    model, recording = files
    same(pr.plan(recording, model), said(host, "plan", recording, "--rig", model))


def test_every_effect(host):
    effects = pr.effects()
    assert [effect.to_dict() for effect in effects.values()] == said(host, "effects")["effects"]


@pytest.mark.parametrize("form", ["recording", "arrays", "table"])
def test_a_swing_in_memory_is_fitted_as_its_file_is(files, fitted, form):
    model, path = files
    read = pr.read(path)
    if form == "table":
        pytest.importorskip("pandas")
    given = {"recording": lambda: read, "arrays": lambda: (read.times_s, read.readings), "table": read.to_dataframe}
    fit = pr.fit(given[form](), model, method="least-squares")
    assert [number.value for number in fit.parameters] == [number.value for number in fitted.parameters]
    assert fit.covariance.tobytes() == fitted.covariance.tobytes()


def test_a_simulated_swing_is_the_one_that_the_program_writes(host, rig, files, tmp_path):
    ours, theirs = tmp_path / "ours.csv", tmp_path / "theirs.csv"
    pr.simulate(rig, seconds=2.0, seed=7).save(ours)
    said(host, "simulate", "--rig", files[0], "--seconds", 2.0, "--seed", 7, "-o", theirs)
    assert ours.read_text() == theirs.read_text()
