"""Pages set by LaTeX, where it is installed."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

needs_latex = pytest.mark.skipif(shutil.which("pdflatex") is None, reason="it needs LaTeX (pdflatex)")


def too_wide(folder: Path, preamble: str, body: str) -> tuple[str, list[float]]:
    """What LaTeX says of an article set in a folder, and by how many points its lines stand out of the page."""
    page = rf"\documentclass{{article}}{preamble}\begin{{document}}{body}\end{{document}}"
    (folder / "page.tex").write_text(page, encoding="utf-8")
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "page.tex"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, errors="replace", check=False)
    assert done.returncode == 0, done.stdout
    return done.stdout, [float(width) for width in re.findall(r"Overfull \\hbox \(([\d.]+)pt", done.stdout)]
