"""The drive that most tests use, and the command, where it has been built."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

import itpms


@pytest.fixture(scope="session")
def drive() -> itpms.Simulation:
    """Forty seconds of a whole car; the front left tire goes down at 20 s."""
    return itpms.simulate("drive-puncture", seed=1)


@pytest.fixture(scope="session")
def result(drive: itpms.Simulation) -> itpms.Result:
    return itpms.estimate(drive, road=True)


@pytest.fixture(scope="session")
def command():
    """Runs the command `itpms`: that of ITPMS, or the one on the path."""
    program = os.environ.get("ITPMS") or shutil.which("itpms")
    if program is None or not Path(program).exists():
        pytest.skip("skipped: no command itpms; build it and set ITPMS")

    def run(*arguments: object) -> str:
        done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run
