"""A run is not lost because nobody hears its messages."""

from __future__ import annotations

import io
import shlex
import signal
import subprocess
import sys
import time

import pytest
from shared.cases import ENDLESS

from cdem.cli.messages import Messages
from cdem.cli.options import STOPPED

RUN = f"{shlex.quote(sys.executable)} -m cdem run cube.yaml"


class Broken(io.StringIO):
    """A stream that cannot be written to."""

    def write(self, text):
        raise OSError(28, "No space left on device")


@pytest.mark.parametrize("stream", [None, Broken(), io.StringIO()])
def test_a_message_is_written_or_dropped(stream):
    if isinstance(stream, io.StringIO) and not isinstance(stream, Broken):
        kept = Messages(stream)
        print("hello", file=kept, flush=True)
        assert stream.getvalue() == "hello\n"
        stream.close()
    messages = Messages(stream)
    print("hello", file=messages, flush=True)
    assert not messages.isatty()


@pytest.mark.parametrize("stderr", ["2>/dev/full", "2>&-", "2> >(true)"])
def test_a_run_ends_well_without_its_messages(cube_folder, stderr):
    done = subprocess.run(["bash", "-c", f"{RUN} {stderr}"], capture_output=True, check=False)
    assert done.returncode == 0 and b"finished" in done.stdout
    assert (cube_folder / "cube.results/summary.json").exists()


def test_a_run_whose_reader_left_still_stops_with_a_checkpoint(cube_folder):
    (cube_folder / "cube.yaml").write_text(ENDLESS)
    run = subprocess.Popen(shlex.split(RUN), stderr=subprocess.PIPE)
    run.stderr.close()
    for _ in range(200):
        if (cube_folder / "cube.results/histories.csv").exists():
            break
        time.sleep(0.05)
    time.sleep(0.5)
    run.send_signal(signal.SIGINT)
    assert run.wait(20) == STOPPED
    assert (cube_folder / "cube.results/checkpoint.h5").exists()
