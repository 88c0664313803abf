"""What the tests of the Python package share. Run by ctest, which says where the package and the command are."""
import os
import pathlib
import subprocess

import pytest

import sfumato

DATA = pathlib.Path(os.environ.get("SFUMATO_TEST_DATA", pathlib.Path(__file__).parents[2] / "../shared/data"))


@pytest.fixture(scope="session")
def command():
    """Runs the command; returns what it writes to standard output."""
    program = os.environ["SFUMATO_COMMAND"]

    def run(*words):
        environment = {**os.environ, "SFUMATO_CONFIG": ""}
        done = subprocess.run([program, *map(str, words)], capture_output=True, env=environment, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout

    run.program = program
    return run


@pytest.fixture(scope="session")
def scan(tmp_path_factory):
    """A file with colours, normals and scalars."""
    file = tmp_path_factory.mktemp("scan") / "courtyard.ply"
    sfumato.write(file, sfumato.synth("courtyard", points=12_000, seed=3))
    return file


@pytest.fixture(scope="session")
def data():
    """A file of the test data, or a skip that says so."""

    def find(name):
        file = DATA / name
        if not file.exists():
            pytest.skip(f"there is no {file}")
        return file

    return find


@pytest.fixture(scope="session")
def sphere():
    """10,000 points on a sphere of radius 2, float32, and their normals."""
    import numpy as np

    directions = np.random.default_rng(1).normal(size=(10_000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return (2 * directions).astype(np.float32), directions.astype(np.float32)
