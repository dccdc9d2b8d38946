"""What several files of these tests begin with."""

import pathlib

import pytest

import withy


@pytest.fixture
def slew():
    return withy.load(pathlib.Path(__file__).parents[2] / "scenes" / "two-link-slew.yaml")
