"""FMUs in an importer that is not ours: FMPy, where it is installed (docs/fmi.md)."""

import csv
import importlib
import os
import pathlib
import subprocess

import numpy
import pytest

fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed: FMUs are not tried in an importer of others")
PROGRAM = os.environ.get("WITHY_PROGRAM")
SCENES = pathlib.Path(__file__).parents[2] / "scenes"
pytestmark = pytest.mark.skipif(not PROGRAM, reason="needs WITHY_PROGRAM, the command line")

TIGHT = {"integrator.rtol": 1e-9, "integrator.atol": 1e-11}
CASES = {"pendulum": {}, "commanded-arm": {"command": 2.0}, "manipulator-pid": {}, "attitude-jets": {}}


def table(scene, folder, inputs):
    """Columns of a run by their names."""
    initial = f"initial={{inputs: {{{', '.join(f'{k}: {v}' for k, v in inputs.items())}}}}}"
    changes = [f"{path}={value}" for path, value in TIGHT.items()] + ["time.end=2", "time.output=0.01"]
    words = [word for change in changes + [initial] * bool(inputs) for word in ("--set", change)]
    subprocess.run([PROGRAM, "run", scene, *words, "--no-hdf5", "--out", folder], check=True, capture_output=True)
    with open(folder / "results.csv", newline="", encoding="utf-8") as file:
        heads, *rows = csv.reader(file)
    numbers = numpy.array(rows, float)
    units = {head: head[head.rindex("["):] for head in heads}
    return {head.removesuffix(units[head]): numbers[:, i] for i, head in enumerate(heads)}


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("name", CASES)
def test_fmpy_finds_no_fault_and_simulates_what_a_run_does(name, version, tmp_path):
    from fmpy.validation import validate_fmu

    scene, file = SCENES / f"{name}.yaml", tmp_path / f"{name.replace('-', '_')}.fmu"
    subprocess.run([PROGRAM, "fmu", scene, "--fmi", str(version), "--out", file], check=True, capture_output=True)
    assert validate_fmu(str(file)) == []
    described = fmpy.read_model_description(str(file), validate=True)  # by the schemas of the standard
    run = table(scene, tmp_path / "run", CASES[name])
    outputs = [v.name for v in described.modelVariables if v.causality == "output" and v.name in run]
    assert len(outputs) > 5
    kinds = {"CoSimulation": {}}
    try:
        importlib.import_module("fmpy.sundials.cvode")  # what FMPy brings of SUNDIALS
        kinds["ModelExchange"] = {"solver": "CVode", "relative_tolerance": 1e-9}
    except OSError:
        pass
    for kind, options in kinds.items():
        given = {**{k: v for k, v in TIGHT.items() if k in {v.name for v in described.modelVariables}}, **CASES[name]}
        rows = fmpy.simulate_fmu(str(file), fmi_type=kind, stop_time=2, output_interval=0.01, start_values=given,
                                 output=outputs, **options)
        for output in outputs:
            expected = numpy.interp(rows["time"], run["t"], run[output])
            at = numpy.isin(rows["time"], run["t"])  # events have rows of their own
            assert at.sum() > 100
            error = numpy.abs(rows[output] - expected)[at].max()
            assert error < 1e-5 * max(numpy.abs(run[output]).max(), 1), (kind, output, error)
