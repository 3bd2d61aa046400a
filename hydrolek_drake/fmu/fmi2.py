"""A rig as an instance that PythonFMU runs: FMI 2, co-simulation."""

from functools import partial
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from pythonfmu import DefaultExperiment, Fmi2Causality, Fmi2Initial, Fmi2Slave, Fmi2Variability, Real

from hydrolek_drake.fmu.model import Model
from hydrolek_drake.fmu.variables import INPUT, OUTPUT, PARAMETER, UNITS, Variable

OPTIONS: dict[str, Any] = {}
"""What a builder has to be told besides."""

_KINDS = {
    INPUT: (Fmi2Causality.input, Fmi2Variability.continuous, None),
    OUTPUT: (Fmi2Causality.output, Fmi2Variability.continuous, Fmi2Initial.calculated),
    PARAMETER: (Fmi2Causality.parameter, Fmi2Variability.fixed, Fmi2Initial.exact),
}


class RigInstance(Fmi2Slave):
    """Base of the class that stands in a unit; its name is the unit's."""

    def __init__(self, **kwargs: Any) -> None:
        """Read the unit's resources."""
        super().__init__(**kwargs)
        self.model = Model(kwargs["resources"])
        self.description = self.model.title
        self.default_experiment = DefaultExperiment(
            start_time=0.0, stop_time=self.model.stop_time, step_size=self.model.step_size
        )
        for each in self.model.variables.values():
            self.register_variable(self._real(each), nested=False)
        self._start = 0.0

    def _real(self, variable: Variable) -> Real:
        causality, variability, initial = _KINDS[variable.causality]
        return Real(
            variable.name,
            causality=causality,
            variability=variability,
            initial=initial,
            description=variable.description,
            getter=partial(self.model.value, variable.name),
            setter=partial(self.model.put, variable.name),
        )

    def to_xml(self, model_options: dict[str, str] | None = None) -> Element:
        """The model's description, with the units and what is unknown at first, which PythonFMU leaves out."""
        root: Element = super().to_xml(model_options or {})
        units = Element("UnitDefinitions")
        for name, exponents in UNITS.items():
            base = {key: str(value) for key, value in exponents.items()}
            SubElement(SubElement(units, "Unit", name=name), "BaseUnit", base)
        root.insert(1, units)
        structure, listed = root.find("ModelStructure"), root.find("ModelVariables")
        assert structure is not None and listed is not None
        unknown = SubElement(structure, "InitialUnknowns")
        for place, each in enumerate(listed, start=1):
            own = self.model.variables[each.attrib["name"]]
            each[0].set("unit", own.unit)
            if own.causality == OUTPUT:
                SubElement(unknown, "Unknown", index=str(place))
        return root

    def setup_experiment(self, start_time: float, stop_time: float | None, tolerance: float | None) -> None:
        """Remember when it is switched on."""
        self._start = start_time

    def exit_initialization_mode(self) -> None:
        """Put the machine at rest."""
        self.model.begin(self._start)

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Hold the commands over a step."""
        self.model.step(current_time, step_size)
        return True
