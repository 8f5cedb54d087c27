"""A rig on a port: the simulated one."""

import pytest

import pendulum_rig as pr


def test_a_model_is_pulled_changed_and_pushed():
    with pr.connect("sim") as rig:
        model = rig.pull()
        assert "simulated" in rig.firmware
        pushed = rig.push(model.with_values(Mc=2e-3))
        assert {number["symbol"]: number["value"] for number in pushed["parameters"]}["Mc"] == 2e-3
        assert rig.pull()["Mc"].value == 2e-3
    with pytest.raises(ValueError, match="closed"):
        rig.pull()


def test_a_swing_is_recorded_and_told_of(tmp_path):
    stages = []
    with pr.connect("sim") as rig:
        recording = rig.record(tmp_path / "swing.csv", rate=200.0, progress=stages.append)
        assert recording.rate_hz == pytest.approx(200.0, rel=1e-3)
        with pytest.raises(pr.Error, match="exists"):
            rig.record(tmp_path / "swing.csv")
    assert any("released" in stage for stage in stages)


def test_ctrl_c_keeps_what_was_recorded(tmp_path):
    def interrupt(stage):
        if "released" in stage:
            raise KeyboardInterrupt

    with pr.connect("sim") as rig, pytest.raises(KeyboardInterrupt):
        rig.record(tmp_path / "swing.csv", progress=interrupt)
    assert len(pr.read(tmp_path / "swing.csv")) > 100
