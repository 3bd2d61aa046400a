"""A rig as an instance that PythonFMU3 runs: FMI 3, co-simulation."""

from functools import partial
from typing import Any

from pythonfmu3 import (
    DefaultExperiment,
    Fmi3Causality,
    Fmi3Initial,
    Fmi3SlaveBase,
    Fmi3StepResult,
    Fmi3Variability,
)
from pythonfmu3.cosimulation import CoSimulation
from pythonfmu3.unit import Unit
from pythonfmu3.variables import Float64

from hydrolek_drake.fmu.model import Model
from hydrolek_drake.fmu.variables import INPUT, OUTPUT, PARAMETER, UNITS, Variable

OPTIONS = {"canHandleVariableCommunicationStepSize": True}
"""What a builder has to be told besides."""

_KINDS = {
    INPUT: (Fmi3Causality.input, Fmi3Variability.continuous, None),
    OUTPUT: (Fmi3Causality.output, Fmi3Variability.continuous, Fmi3Initial.calculated),
    PARAMETER: (Fmi3Causality.parameter, Fmi3Variability.fixed, Fmi3Initial.exact),
}


class RigInstance(Fmi3SlaveBase, CoSimulation):
    """Base of the class that stands in a unit; its name is the unit's."""

    def __init__(self, **kwargs: Any) -> None:
        """Read the unit's resources."""
        super().__init__(**kwargs)
        self.model = Model(kwargs["resources"])
        self.description = self.model.title
        self.default_experiment = DefaultExperiment(
            start_time=0.0, stop_time=self.model.stop_time, step_size=self.model.step_size
        )
        self.register_units([Unit(name, **exponents) for name, exponents in UNITS.items()])
        self.time = 0.0
        self.register_variable(
            Float64("time", causality=Fmi3Causality.independent, variability=Fmi3Variability.continuous)
        )
        for each in self.model.variables.values():
            self.register_variable(self._float(each), nested=False)
        self._start = 0.0

    def _float(self, variable: Variable) -> Float64:
        causality, variability, initial = _KINDS[variable.causality]
        return Float64(
            variable.name,
            unit=variable.unit,
            causality=causality,
            variability=variability,
            initial=initial,
            description=variable.description,
            getter=partial(self.model.value, variable.name),
            setter=partial(self.model.put, variable.name),
        )

    def setup_experiment(self, start_time: float) -> None:
        """Remember when it is switched on."""
        self._start = self.time = start_time

    def exit_initialization_mode(self) -> None:
        """Put the machine at rest."""
        self.model.begin(self._start)

    def do_step(self, current_time: float, step_size: float) -> Fmi3StepResult:
        """Hold the commands over a step."""
        self.model.step(current_time, step_size)
        self.time = current_time + step_size
        return Fmi3StepResult()
