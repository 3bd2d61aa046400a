"""The committed pictures show the diagrams that run."""

import pytest

from hydrolek_drake.scenarios.block_diagram import as_text, scenario_diagram, text_of_svg
from hydrolek_drake.scenarios.scenario import load_scenario, scenario_files


@pytest.mark.parametrize("name", sorted(scenario_files()))
def test_committed_picture_is_current(name):
    picture = scenario_files()[name].with_suffix(".svg")
    assert picture.is_file(), "run python -m hydrolek_drake.scenarios.block_diagram"
    shown = text_of_svg(picture.read_text(encoding="utf-8"))
    assert shown == as_text(scenario_diagram(load_scenario(name)))


def test_text_has_everything_that_drake_draws():
    diagram = scenario_diagram(load_scenario("both_arms"))
    drawn = diagram.GetGraphvizString(max_depth=1)
    text = as_text(diagram)
    hidden = [system.get_name() for system in diagram.GetSystems() if f"{system.get_name()}: " not in text]
    assert all(name.startswith("log_") or name == "scene_graph" for name in hidden)
    # to logs goes one connection each, between plant and scene graph three
    assert drawn.count(" -> ") == text.count(" -> ") + len(hidden) - 1 + 3
