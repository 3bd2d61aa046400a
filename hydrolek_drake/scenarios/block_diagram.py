"""Block diagrams of the scenarios' stations, drawn from the Drake diagrams that are run.

`python -m hydrolek_drake.scenarios.block_diagram` refreshes `diagrams/<scenario>.svg`; it needs Graphviz's `dot`.
Each picture carries what it shows as text in its `<metadata>`, so that whether it is current can be told
without drawing it again.
"""

import argparse
import html
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydrake.systems.framework import Diagram, InputPortIndex, OutputPortIndex, System

from hydrolek_drake.errors import InputError
from hydrolek_drake.files import write_whole
from hydrolek_drake.scenarios.scenario import Scenario, load_scenario, scenario_files
from hydrolek_drake.scenarios.scenario_station import scenario_station

_HIDDEN = ("log_", "scene_graph", "meshcat_visualizer", "cylinder_poses")
"""Systems that only write down or draw; they are not part of the machine."""

_INPUTS, _OUTPUTS = "in", "out"
_COMPUTER, _ELECTRIC, _OIL, _MECHANICS = "#e8eef7", "#fdf3dc", "#fbe3d6", "#e3f1e4"
_COLOURS = {
    "command_player": _COMPUTER,
    "controllers": _COMPUTER,
    "operator_computer": _COMPUTER,
    "field_point": _COMPUTER,
    "transport_delay": _COMPUTER,
    "command_ramp": _ELECTRIC,
    "proportional_amplifier": _ELECTRIC,
    "solenoid_spool": _ELECTRIC,
    "electric_motor": _ELECTRIC,
    "supply": _OIL,
    "four_way_valve": _OIL,
    "actuator": _OIL,
    "rocking_base": _MECHANICS,
    "play": _MECHANICS,
    "linkage": _MECHANICS,
    "load": _MECHANICS,
    "arms": _MECHANICS,
    "plant": _MECHANICS,
    "tilt_reversed": _MECHANICS,
    "link_less_tilt": _MECHANICS,
    "potentiometer": _ELECTRIC,
}
"""By system, in the order in which a command passes them: what runs against this order is feedback."""

_FORWARD, _FEEDBACK = "#3e4c59", "#c46a2b"
_OTHER_COLOUR = "#eeeeee"
_METADATA = re.compile(r"<metadata>(.*?)</metadata>", re.DOTALL)


@dataclass(frozen=True)
class Port:
    """A port of a system, or of the diagram itself where `system` is "in" or "out"."""

    system: str
    name: str


@dataclass(frozen=True)
class Connection:
    """From an output to an input, with the number of values (0 for lists and other objects)."""

    source: Port
    target: Port
    size: int


def connections(diagram: Diagram) -> tuple[Connection, ...]:
    """All connections of a diagram between systems that are drawn, and to its own ports, sorted."""
    found = []
    for (target, target_port), (source, source_port) in diagram.connection_map().items():
        if not (_hidden(source) or _hidden(target)):
            output = source.get_output_port(source_port)
            found.append(
                Connection(
                    Port(source.get_name(), _short(output.get_name(), source)),
                    Port(target.get_name(), target.get_input_port(target_port).get_name()),
                    output.size(),
                )
            )
    for index in range(diagram.num_input_ports()):
        port = diagram.get_input_port(index)
        for system, inside in diagram.GetInputPortLocators(InputPortIndex(index)):
            name = system.get_input_port(inside).get_name()
            found.append(
                Connection(Port(_INPUTS, port.get_name()), Port(system.get_name(), name), port.size())
            )
    for index in range(diagram.num_output_ports()):
        port = diagram.get_output_port(index)
        system, inside = diagram.get_output_port_locator(OutputPortIndex(index))
        name = _short(system.get_output_port(inside).get_name(), system)
        found.append(Connection(Port(system.get_name(), name), Port(_OUTPUTS, port.get_name()), port.size()))
    return tuple(sorted(found, key=_line))


def as_text(diagram: Diagram) -> str:
    """One line per system and per connection: what a picture of the diagram must show."""
    systems = sorted(
        f"{system.get_name()}: {_kind(system)}" for system in diagram.GetSystems() if not _hidden(system)
    )
    return "\n".join([*systems, *(_line(connection) for connection in connections(diagram))])


def text_of_svg(svg: str) -> str:
    """What a picture says it shows; empty if it says nothing."""
    found = _METADATA.search(svg)
    return html.unescape(found.group(1)).strip() if found else ""


def as_svg(diagram: Diagram, title: str) -> str:
    """The diagram as a picture, from left to right.

    Raises:
        InputError: Graphviz's `dot` is not installed.
    """
    import pydot

    graph = pydot.Dot(
        "station",
        graph_type="digraph",
        rankdir="LR",
        nodesep="0.35",
        ranksep="0.55",
        fontname="Helvetica",
        fontsize="15",
        labelloc="t",
        label=f"<<B>{html.escape(title)}</B><BR/> >",
    )
    wires = connections(diagram)
    for system in diagram.GetSystems():
        if not _hidden(system):
            graph.add_node(_block(pydot, system, wires))
    for port in dict.fromkeys(end for wire in wires for end in (wire.source, wire.target)):
        if port.system in (_INPUTS, _OUTPUTS):
            graph.add_node(
                pydot.Node(
                    _terminal(port), label=port.name, shape="plain", fontname="Helvetica", fontsize="11",
                    fontcolor="#1b6ca8",
                )
            )  # fmt: skip
    for wire in wires:
        back = _is_feedback(wire)
        graph.add_edge(
            pydot.Edge(
                _end(wire.source, "y", "e"),
                _end(wire.target, "u", "w"),
                label=f" {wire.size or ''} ",
                fontsize="9",
                fontname="Helvetica",
                fontcolor="#6b7785",
                color=_FEEDBACK if back else _FORWARD,
                arrowsize="0.6",
                penwidth="0.9",
                constraint="false" if back else "true",
            )
        )
    try:
        drawn = graph.create(format="svg")
        svg = drawn if isinstance(drawn, str) else drawn.decode()
    except (FileNotFoundError, OSError) as error:
        raise InputError(
            f"Graphviz's dot cannot be run ({error}); install Graphviz to refresh pictures"
        ) from None
    shown = html.escape(as_text(diagram))
    return svg.replace("<g id=", f"<metadata>\n{shown}\n</metadata>\n<g id=", 1)


def scenario_diagram(scenario: Scenario) -> Diagram:
    """The diagram that a scenario runs."""
    return scenario_station(scenario).station.diagram


def main() -> None:
    """Draw all scenarios anew."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, help="folder; beside the scenarios if not given")
    out = parser.parse_args().out
    for name, path in scenario_files().items():
        scenario = load_scenario(name)
        picture = (out or path.parent) / f"{name}.svg"
        svg = as_svg(scenario_diagram(scenario), f"{name}: rig {scenario.rig.name}")
        write_whole(picture, svg)
        print(picture)


def _block(pydot: Any, system: System, wires: Iterable[Connection]) -> Any:
    """A table: name on top, connected inputs on the left, connected outputs on the right."""
    name = system.get_name()
    inputs = list(dict.fromkeys(wire.target.name for wire in wires if wire.target.system == name))
    outputs = list(dict.fromkeys(wire.source.name for wire in wires if wire.source.system == name))
    rows = []
    for row in range(max(len(inputs), len(outputs))):
        cells = ""
        for ports, side, mark in ((inputs, "LEFT", "u"), (outputs, "RIGHT", "y")):
            if row < len(ports):
                cells += f'<TD ALIGN="{side}" PORT="{mark}_{ports[row]}"><FONT POINT-SIZE="11">{ports[row]}</FONT></TD>'
            else:
                cells += "<TD></TD>"
        rows.append(f"<TR>{cells}</TR>")
    colour = _COLOURS.get(name, _OTHER_COLOUR)
    label = (
        f'<<TABLE BORDER="1" CELLBORDER="0" CELLSPACING="0" CELLPADDING="4" COLOR="#8a94a0" BGCOLOR="{colour}" '
        f'STYLE="ROUNDED"><TR><TD COLSPAN="2"><B>{name}</B></TD></TR>{"".join(rows)}</TABLE>>'
    )
    return pydot.Node(name, label=label, shape="plain", fontname="Helvetica", fontsize="13")


def _is_feedback(wire: Connection) -> bool:
    order = list(_COLOURS)
    if wire.source.system not in order or wire.target.system not in order:
        return False
    return order.index(wire.source.system) > order.index(wire.target.system)


def _terminal(port: Port) -> str:
    return f"{port.system}_{port.name}"


def _end(port: Port, mark: str, edge: str) -> str:
    if port.system in (_INPUTS, _OUTPUTS):
        return f'"{_terminal(port)}":{edge}'
    return f'"{port.system}":"{mark}_{port.name}":{edge}'


def _line(connection: Connection) -> str:
    source, target = connection.source, connection.target
    return f"{source.system}.{source.name} -> {target.system}.{target.name} ({connection.size})"


def _kind(system: System) -> str:
    return system.GetSystemType().split("::")[-1].split(".")[-1].split("<")[0].split("𝓣")[0]


def _short(name: str, system: System) -> str:
    """Drake calls a source's only output y0."""
    return "output" if name == "y0" and system.num_output_ports() == 1 else name


def _hidden(system: System) -> bool:
    return system.get_name().startswith(_HIDDEN)


if __name__ == "__main__":
    main()
