# SPDX-License-Identifier: BSD-3-Clause
"""A real window on a screen, a view in a notebook: where pyvista and what they need are there."""

from __future__ import annotations

import base64
import io
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageGrab

from bezsoma.view import window

SCRIPT = """
import bezsoma as bz
mesh = bz.block((20, 6, 6), (2, 1, 1))
bent = bz.Field.interpolating(bz.ControlNet(mesh, 2), lambda x: x**2 / 40)
bz.show(bz.Shot(mesh, bent, bent, label="displacement, mm"))
"""
SECONDS = 120
"""A window may take so long to open on a busy machine."""
COLOURS = 200
"""An empty screen has one or two; a shaded, coloured block has more than so many."""


@pytest.fixture
def screen(monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """The screen of this machine, or one that shows nothing to anybody (Xvfb)."""
    pytest.importorskip("pyvista", reason="the extra `view` is not installed")
    if "DISPLAY" in os.environ:
        yield os.environ["DISPLAY"]
        return
    server = shutil.which("Xvfb")
    if server is None:
        pytest.skip("there is no screen here, and no Xvfb to stand for one")
    read, write = os.pipe()
    words = [server, "-displayfd", str(write), "-screen", "0", "1400x1100x24"]
    running = subprocess.Popen(words, pass_fds=[write], stderr=subprocess.DEVNULL)
    os.close(write)
    try:
        with os.fdopen(read) as said:
            monkeypatch.setenv("DISPLAY", f":{said.readline().strip()}")
        yield os.environ["DISPLAY"]
    finally:
        running.terminate()
        running.wait()


def test_a_window_opens_on_a_screen_and_shows_the_body(screen: str) -> None:
    window._trial.cache_clear()
    if said := window._trial(False):
        pytest.skip(f"VTK cannot draw on this screen: {said}")
    shown = subprocess.Popen([sys.executable, "-c", SCRIPT])
    try:
        ends = time.monotonic() + SECONDS
        while (count := colours_on(screen)) < COLOURS and shown.poll() is None:
            if time.monotonic() > ends:
                break
            time.sleep(0.5)
        assert shown.poll() is None, "the window closed by itself"
        assert count >= COLOURS
    finally:
        shown.terminate()
        shown.wait()


def colours_on(screen: str) -> int:
    """How many colours a screen shows."""
    return len(np.unique(np.asarray(ImageGrab.grab(xdisplay=screen)).reshape(-1, 3), axis=0))


def test_a_notebook_has_a_picture_in_its_page(tmp_path: Path) -> None:
    for package in ("pyvista", "nbformat", "nbclient", "ipykernel"):
        pytest.importorskip(package, reason=f"{package} is not installed")
    if said := window._trial(True):
        pytest.skip(f"VTK cannot draw on this machine: {said}")
    (tmp_path / "run.py").write_text(NOTEBOOK, encoding="utf-8")
    words = [sys.executable, str(tmp_path / "run.py"), SCRIPT]
    done = subprocess.run(words, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stderr
    image = Image.open(io.BytesIO(base64.b64decode(done.stdout.strip().splitlines()[-1])))
    assert np.asarray(image.convert("RGB"), float).std() > 10


NOTEBOOK = """
import sys
import nbformat
from nbclient import NotebookClient
book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(sys.argv[1])])
NotebookClient(book, timeout=500, kernel_name="python3").execute()
shown = [each["data"] for each in book.cells[0].outputs if "image/png" in each.get("data", {})]
print(shown[0]["image/png"].replace("\\n", ""))
"""
"""A process of its own: the client warns of things that are none of ours."""
