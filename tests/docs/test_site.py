"""The documentation's site, as `scripts/docs` builds it: no warning, and nothing is loaded from a network."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
LOADED = re.compile(r"<(?:script|img|link)[^>]*?(?:src|href)=\"(https?:[^\"]*)\"")

pytest.importorskip("furo", reason="the extra docs is not installed")


@pytest.mark.thorough
def test_the_site_is_built_without_a_warning_and_needs_no_network(tmp_path):
    command = [sys.executable, "-m", "sphinx", "--quiet", "--fail-on-warning", "--keep-going"]
    done = subprocess.run(
        [*command, str(ROOT / "docs"), str(tmp_path)],
        capture_output=True,
        text=True,
        timeout=180,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    pages = list(tmp_path.rglob("*.html"))
    assert {"index.html", "architecture.html"} <= {p.name for p in pages}
    for name in ("commands", "rig_files", "report"):
        assert (tmp_path / "reference" / "generated" / f"{name}.html").stat().st_size > 10_000
    for page in pages:
        outside = LOADED.findall(page.read_text(encoding="utf-8"))
        assert not outside, f"{page.name} loads {outside}"
    assert 'id="hydrolek-diagnose"' in (tmp_path / "reference/generated/commands.html").read_text(
        encoding="utf-8"
    )
