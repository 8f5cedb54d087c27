"""A rig and its swings, simulated by the program: these tests are about the way between Python and the program."""

import os
from pathlib import Path

import numpy
import pytest

import pendulum_rig as pr

WORKSPACE = Path(__file__).resolve().parents[3]


@pytest.fixture(scope="session")
def host():
    """The program whose numbers must come out."""
    return os.environ["HOST_PROGRAM"]


@pytest.fixture(scope="session")
def rig():
    return pr.Rig(mass=0.1466084, length=0.1562177, inertia=0.00284252)


@pytest.fixture(scope="session")
def swing(rig):
    """A swing in memory."""
    return pr.simulate(rig, seconds=20.0, rate=200.0)


@pytest.fixture(scope="session")
def files(rig, swing, tmp_path_factory):
    """The model and the swing as files."""
    folder = tmp_path_factory.mktemp("rig")
    rig.save(folder / "rig.toml")
    swing.save(folder / "swing.csv")
    return folder / "rig.toml", folder / "swing.csv"


@pytest.fixture(scope="session")
def spin(rig):
    """The same swing as a gyroscope has it."""
    model = rig.model()
    _, rates = model.run(model.release(1.5), 5e-3, 4000)
    noise = numpy.random.default_rng(1).normal(0.0, 5e-3, len(rates))
    return pr.Recording(5e-3 * numpy.arange(len(rates)), numpy.asarray(rates) + noise, rates=True)


@pytest.fixture(scope="session")
def fitted(files):
    model, recording = files
    return pr.fit(recording, model, method="least-squares")
