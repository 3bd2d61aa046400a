"""Machine code is kept by the source that it was compiled from."""

import os
from pathlib import Path

import pytest

from hydrolek_drake import compiled


@pytest.mark.parametrize("place", ["physics/law.py", "effects/listed/cylinder/friction.py", "compiling.py"])
def test_an_edit_anywhere_in_what_is_compiled_takes_a_fresh_folder(
    place: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = tmp_path / "package" / place
    source.parent.mkdir(parents=True)
    (tmp_path / "package" / "compiling.py").write_text("")
    source.write_text("gain = 1.0\n")
    monkeypatch.setattr(compiled, "__file__", str(tmp_path / "package" / "compiled.py"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    for name in ("NUMBA_CACHE_DIR", "HYDROLEK_CACHE_DIR"):
        monkeypatch.setenv(name, "")

    def folder() -> str:
        compiled.use_cache_for_this_source()
        return os.environ["NUMBA_CACHE_DIR"]

    try:
        before = folder()
        assert folder() == before
        source.write_text("gain = 2.0\n")
        assert folder() != before
    finally:
        monkeypatch.undo()
        compiled.use_cache_for_this_source()
