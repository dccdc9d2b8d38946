"""Files that runs leave, by readers that are not ours."""

import csv
import os
import re
import shutil
import subprocess
import xml.etree.ElementTree
import zipfile

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


def test_cells_are_plain_numbers_in_every_spreadsheet(run):
    # RFC 4180 without quotes: heads that need none, and numbers that no program takes for a formula, a date or a text.
    folder, heads, _ = run
    text = (folder / "results.csv").read_bytes()
    assert text.isascii() and b"\r" not in text and b'"' not in text and text.endswith(b"\n")
    assert all(re.fullmatch(r"[A-Za-z_][\w.-]*\[[^\[\],]+\]", head) for head in heads)
    cells = [cell for line in text.decode().splitlines()[1:] for cell in line.split(",")]
    assert all(re.fullmatch(r"-?\d+(\.\d+)?(e[-+]?\d+)?", cell) for cell in cells)


@pytest.mark.skipif(not shutil.which("soffice"), reason="LibreOffice is not installed")
def test_libreoffice_reads_the_numbers_of_the_table(run, tmp_path):
    folder, heads, numbers = run
    subprocess.run(["soffice", f"-env:UserInstallation=file://{tmp_path}/profile", "--headless", "--convert-to", "xlsx", "--infilter=CSV:44,34,76,1,,1033",
                    "--outdir", str(tmp_path), str(folder / "results.csv")], check=True, timeout=300, stdout=subprocess.DEVNULL)
    with zipfile.ZipFile(tmp_path / "results.xlsx") as book:
        sheet = xml.etree.ElementTree.fromstring(book.read("xl/worksheets/sheet1.xml"))
    name = "{http://schemas.openxmlformats.org/spreadsheetml/2006/main}"
    rows = [[(cell.get("t", "n"), cell.findtext(name + "v")) for cell in row] for row in sheet.iter(name + "row")]
    assert len(rows[0]) == len(heads) and all(kind == "s" for kind, _ in rows[0])
    assert all(kind == "n" for row in rows[1:] for kind, _ in row), "no date, no text"
    read = numpy.array([[float(value) for _, value in row] for row in rows[1:]])
    assert numpy.allclose(read, numbers, rtol=1e-14, atol=0), "a spreadsheet keeps 15 digits"


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


def test_meshio_finds_a_node_in_the_middle_of_an_edge_where_the_engine_has_it(tmp_path):
    meshio = pytest.importorskip("meshio")
    withy("run", os.path.join(SCENES, "imported-boom.yaml"), "--set", "bodies.boom.visual.mesh=cantilever.vtk", "--output", "camera.position", "--out", tmp_path)
    with open(tmp_path / "results.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    series = tmp_path / "motion.pvd"
    withy("report", tmp_path, "--out", series)
    sets = xml.etree.ElementTree.parse(series).getroot().findall("Collection/DataSet")
    for entry in sets[:: len(sets) // 5]:
        row = min(rows, key=lambda row: abs(float(row["t[s]"]) - float(entry.get("timestep"))))
        grid = meshio.read(tmp_path / entry.get("file"))
        assert max(numpy.bincount(grid.cell_data["body"][0])) == 6 * 28, "28 outer faces of 8 nodes"
        place = [float(row[f"camera.position.{axis}[m]"]) for axis in "xyz"]
        assert numpy.linalg.norm(grid.points - place, axis=1).min() < 1e-6
