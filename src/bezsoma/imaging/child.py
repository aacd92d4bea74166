# SPDX-License-Identifier: BSD-3-Clause
"""The process that reads image files for us, so that a damaged file cannot take us with it."""

from __future__ import annotations

import importlib.util
import json
import queue
import re
import subprocess
import sys
import tempfile
import threading
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from bezsoma.errors import InputError, MissingExtra
from bezsoma.imaging.volume import Grid

MEMORY = 4 << 30
"""Bytes of memory that a reader may ask for: a file that claims more is damaged or no head."""
SECONDS = 120.0
"""How long one request may take."""


class Child:
    """A reader in a process of its own; it is started when asked first and again if it died."""

    def __init__(self, memory: int = MEMORY, seconds: float = SECONDS) -> None:
        if importlib.util.find_spec("SimpleITK") is None:
            raise MissingExtra(
                "reading CT images needs the package SimpleITK, which is not installed: "
                'python -m pip install "bezsoma[imaging]"'
            )
        self.memory, self.seconds = memory, seconds
        self._folder = tempfile.TemporaryDirectory(prefix="bezsoma-")
        self._process: subprocess.Popen[str] | None = None
        self._answers: queue.Queue[str] = queue.Queue()

    def __enter__(self) -> Child:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._end()
        self._folder.cleanup()

    def answer(self, about: str, **request: Any) -> tuple[dict[str, Any], Grid | None]:
        """What the reader answers, and the values if it read any; `about` names the file."""
        process = self._running()
        out = Path(self._folder.name) / "values.npy"
        assert process.stdin is not None
        try:
            process.stdin.write(json.dumps({**request, "out": str(out)}) + "\n")
            process.stdin.flush()
            line = self._answers.get(timeout=self.seconds)
        except queue.Empty:
            self._end()
            raise InputError(
                f"{about}: reading took longer than {self.seconds:g} s and was stopped; the file "
                "is damaged, or its disk is too slow: copy it to this machine"
            ) from None
        except BrokenPipeError:
            line = ""
        if not line:
            self._end()
            raise InputError(
                f"{about}: the reader died over it; the file is damaged or cut short: copy it again"
            )
        answer: dict[str, Any] = json.loads(line)
        if "error" in answer:
            raise InputError(f"{about}: {_reason(answer['error'])}")
        values = None
        if answer.get("saved"):
            values = np.load(out, allow_pickle=False)
            out.unlink()
        return answer, values

    def _running(self) -> subprocess.Popen[str]:
        if self._process is None or self._process.poll() is not None:
            self._end()
            script = Path(__file__).with_name("itk.py")
            self._process = subprocess.Popen(
                [sys.executable, "-c", _START, str(self.memory), str(script), repr(sys.path)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                text=True,
                encoding="utf-8",
            )
            self._answers = queue.Queue()
            listener = threading.Thread(
                target=_listen, args=(self._process, self._answers), daemon=True
            )
            listener.start()
            if not self._answers.get():
                self._end()
                raise MissingExtra(
                    "the package SimpleITK is installed but does not start; install it again: "
                    'python -m pip install --force-reinstall "bezsoma[imaging]"'
                )
        return self._process

    def _end(self) -> None:
        if self._process is None:
            return
        self._process.kill()
        self._process.wait()
        for stream in (self._process.stdin, self._process.stdout):
            if stream is not None:
                try:
                    stream.close()
                except BrokenPipeError:
                    continue
        self._process = None


_START = (
    "import ast, runpy, sys; sys.path[:] = ast.literal_eval(sys.argv.pop()); "
    "runpy.run_path(sys.argv.pop(), run_name='__main__')"
)
"""The script by its path, without the package around it: it starts in the time SimpleITK needs."""


def _listen(process: subprocess.Popen[str], answers: queue.Queue[str]) -> None:
    """Pass on lines; an empty one says that the process is gone."""
    assert process.stdout is not None
    try:
        for line in process.stdout:
            answers.put(line)
    except ValueError:  # closed while we were listening
        pass
    answers.put("")


def _reason(error: str) -> str:
    """What a library's many lines come down to."""
    if "memory" in error.lower() or "bad_alloc" in error:
        return (
            "reading it needs more memory than a head can (its header is damaged, or the picture "
            "is far larger than a head): crop it, or copy it again"
        )
    lines = [line for line in error.splitlines() if "ITK ERROR" in line] or error.splitlines()
    said = re.sub(r"0x[0-9a-f]+|/[^ ]*\.(hxx|cxx|h)", "", lines[-1] if lines else "")
    said = " ".join(said.replace("ITK ERROR:", "").split())
    return (
        f"it cannot be read ({said[:200] or 'no reason given'}); it is damaged, cut short, or of "
        "another format than its ending says: copy or export it again"
    )
