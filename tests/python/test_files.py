"""Files that runs leave, by readers that are not ours."""

import csv
import os
import subprocess
import xml.etree.ElementTree

import numpy
import pytest

PROGRAM = os.environ.get("WITHY_PROGRAM")
SCENES = os.path.join(os.path.dirname(__file__), "..", "..", "scenes")
pytestmark = pytest.mark.skipif(not PROGRAM, reason="needs WITHY_PROGRAM, the command line")


def withy(*words):
    subprocess.run([PROGRAM, *map(str, words)], check=True, stdout=subprocess.DEVNULL)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    # A free body, a quaternion, modes, sensors: every kind of head there is.
    withy("run", os.path.join(SCENES, "spacecraft.yaml"), "--set", "time.end=2", "--out", folder, "--force")
    with open(folder / "results.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    return folder, rows[0], numpy.array(rows[1:], dtype=float)


def test_a_spreadsheet_reads_the_table(run):
    _, heads, numbers = run
    assert len(set(heads)) == len(heads)
    assert all(head.count("[") == head.count("]") == 1 and head.endswith("]") for head in heads)
    assert {"t[s]", "float.qw[1]", "left_boom.bending_y.1[1]"} <= set(heads)
    assert numbers.shape[1] == len(heads) and numpy.isfinite(numbers).all()


def test_genfromtxt_reads_the_table_with_its_heads(run):
    folder, heads, numbers = run
    table = numpy.genfromtxt(folder / "results.csv", delimiter=",", names=True, deletechars="", replace_space=" ")
    assert list(table.dtype.names) == heads
    for index, head in enumerate(heads):
        assert (table[head] == numbers[:, index]).all()


def test_pandas_reads_the_table_with_its_heads(run):
    pandas = pytest.importorskip("pandas")
    folder, heads, numbers = run
    table = pandas.read_csv(folder / "results.csv", float_precision="round_trip")
    assert list(table.columns) == heads
    assert (table.to_numpy() == numbers).all()


def test_meshio_finds_the_tips_of_beams_where_the_table_has_them(run):
    meshio = pytest.importorskip("meshio")
    folder, heads, numbers = run
    series = folder / "motion.pvd"
    withy("report", folder, "--out", series)
    sets = xml.etree.ElementTree.parse(series).getroot().findall("Collection/DataSet")
    tips = [head[:-5] for head in heads if head.endswith(".tip.x[m]")]
    assert len(sets) == len(numbers) and any("boom" in tip for tip in tips)
    for entry in sets[:: len(sets) // 5]:
        grid = meshio.read(folder / entry.get("file"))
        row = numbers[numpy.argmin(abs(numbers[:, 0] - float(entry.get("timestep"))))]
        assert row[0] == pytest.approx(float(entry.get("timestep")))
        assert len(grid.cell_data["body"][0]) == len(grid.cells_dict["triangle"])
        for tip in (t for t in tips if "boom" in t):
            place = [row[heads.index(f"{tip}.{axis}[m]")] for axis in "xyz"]
            assert numpy.linalg.norm(grid.points - place, axis=1).min() < 1e-6
    # A series takes the place of an earlier one and leaves alone what is not its own.
    (folder / "motion" / "mine.vtu").write_text("")
    withy("report", folder, folder, "--out", series)
    assert (folder / "motion" / "mine.vtu").exists()
    assert len(list((folder / "motion").glob("2_*.vtu"))) == len(numbers)
