"""No module imports itself in a circle, and packages only what lies below them: `[tool.importlinter]` says how."""

import subprocess
import sys
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import grimp
import pytest

ROOT = Path(__file__).parents[1]


def _check(package: str) -> None:
    """Raises `CycleError` for a circle; what a function imports counts, and what only types need."""
    graph = grimp.build_graph(package, cache_dir=None)
    TopologicalSorter({m: graph.find_modules_directly_imported_by(m) for m in graph.modules}).prepare()


def test_no_module_imports_itself_in_a_circle() -> None:
    _check("hydrolek_drake")


def test_a_circle_of_late_imports_is_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "made_with_a_circle"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "above.py").write_text("from made_with_a_circle.below import one\n")
    (package / "below.py").write_text(
        "def one():\n    from made_with_a_circle.above import one\n    return one\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(CycleError, match="above"):
        _check("made_with_a_circle")


def test_packages_import_only_what_lies_below_them() -> None:
    linter = "from importlinter.cli import lint_imports; raise SystemExit(lint_imports(no_cache=True))"
    done = subprocess.run(
        [sys.executable, "-c", linter], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
