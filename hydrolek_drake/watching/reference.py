"""The healthy machine: the nominal model fitted to its reference recordings, and how surely its numbers are known."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.diagnosis.fitting.entrants import Entrant
from hydrolek_drake.diagnosis.fitting.race import race
from hydrolek_drake.diagnosis.search.by_continuation import continued_nominal
from hydrolek_drake.diagnosis.search.weighed_anew import as_weighed
from hydrolek_drake.diagnosis.settings import NOISE
from hydrolek_drake.diagnosis.structures.candidates import Candidate, candidates_of
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.experiments.natural_scales import natural_scales
from hydrolek_drake.identification.least_squares.lockstep import descend
from hydrolek_drake.identification.least_squares.place import Place, fit_of
from hydrolek_drake.identification.parameter_set import free_of_joints
from hydrolek_drake.rigs import Rig
from hydrolek_drake.watching.changing import ReferenceBench, changing_of, contains, kept_of
from hydrolek_drake.watching.excitation import ReferenceTold
from hydrolek_drake.watching.knowledge import Knowledge, KnownProblem, KnownTogether, with_drift


@dataclass(frozen=True)
class Posterior:
    """What the reference recordings tell of the machine's own numbers.

    Attributes:
        mean: places in the unit cube where the fit ended. # (n,)
        information: of them, J'J of the residuals in units of what the fit leaves, and the ranges' weak prior. # (n, n)
        over_noise: root mean square of what the fit leaves over the noise.
    """

    mean: np.ndarray
    information: np.ndarray
    over_noise: float

    @property
    def scale(self) -> float:
        """Squares of residuals that count as one: the mean square that the reference leaves where it is above 1."""
        return max(1.0, self.over_noise) ** 2

    def known(self, drift: np.ndarray) -> Knowledge:
        """What a later recording's fit may begin with. # drift: (n,) in ranges."""
        return with_drift(self.mean, self.information / self.scale, drift)


@dataclass(frozen=True)
class Reference:
    """What a session is made of once its reference was fitted; it can be sent to another computer.

    Attributes:
        rig: the machine's nominal model.
        training: the reference recordings.
        drift: path or beginning or section of one -> drift in ranges; "" for all others.
        posterior: of the machine's own numbers.
        changes: names of what changes between recordings of a healthy machine.
    """

    rig: Rig
    training: tuple[Experiment, ...]
    drift: Mapping[str, float]
    posterior: Posterior
    changes: tuple[str, ...] = ()

    def session(self, pool: Executor, cores: int) -> "Session":
        """The session, on this computer.

        Args:
            pool: threads.
            cores: that roll out at the same time.
        """
        return Session(self.rig, self.training, pool, cores, self.drift, self.posterior, changes=self.changes)


class Session:
    """A rig with its reference: what every question about a later recording needs.

    Attributes:
        rig: the machine; what changes between recordings is part of it.
        changing: paths of its numbers that change between recordings.
        bench: the reference recordings and problems of any structure.
        candidates: effects that are asked for.
        posterior: of the machine's own numbers.
        drift: standard deviations of the numbers from one recording to another, in ranges. # (n,)
        hypothesis: the nominal model where the reference left it.
        cores: that roll out at the same time.
    """

    def __init__(
        self,
        rig: Rig,
        training: Sequence[Experiment],
        pool: Executor,
        cores: int,
        drift: Mapping[str, float],
        kept: Posterior | None = None,
        say: Callable[[str], None] = lambda text: None,
        changes: Sequence[str] = (),
    ) -> None:
        """Fit the reference, or take what was found before.

        Args:
            rig: the machine's nominal model.
            training: the reference recordings.
            pool: threads.
            cores: that roll out at the same time.
            drift: path or beginning or section of one -> drift in ranges; "" for all others.
            kept: of the same reference, found before.
            say: told what is being done.
            changes: names of what changes between recordings of a healthy machine, see `changing`.

        Raises:
            InputError: the rig has nothing to fit, or nothing has a name that drift or changes name.
        """
        joints = list(dict.fromkeys(e.joint for e in training))
        self._given, self._training, self._drift = rig, tuple(training), dict(drift)
        self._changes, self.cores, self.joints = tuple(changes), cores, tuple(joints)
        scales = {joint: natural_scales(rig, joint, training) for joint in joints}
        changing = changing_of(rig, changes, scales)
        self.rig, self.changing = changing.rig, changing.paths
        nominal = free_of_joints(self.rig, set(joints))
        self.bench = Workbench(self.rig, nominal, training, pool, cores)
        self.drift = _drifts([free.path for free in nominal], drift)
        found = {c.size_path: c for joint in joints for c in candidates_of(self.rig, joint, scales[joint])}
        self.candidates: tuple[Candidate, ...] = tuple(found.values())
        self._reference = self.bench
        if self.changing:
            self._reference = ReferenceBench(self.rig, nominal, self.changing, training, pool, cores)
        if kept is None:
            say("fitting the nominal model to the reference")
            self._fit = _fitted(self._reference)
            self.posterior = self._posterior(self._reference, self._fit)
            fit = self._fit.fit
        else:
            self.posterior = kept
            problem = self.bench.problem((), self.bench.fine)
            moving = np.ones(kept.mean.size, dtype=bool)
            [place] = descend([Place(problem, moving, kept.mean)], 0, pool, cores)
            fit = fit_of(place)
        values = self.bench.parameters(()).values(self.posterior.mean)
        self.hypothesis = Hypothesis((), values, fit, self.bench.fine)

    @property
    def reference(self) -> Reference:
        """The same for another computer."""
        return Reference(self._given, self._training, self._drift, self.posterior, self._changes)

    @property
    def shared(self) -> np.ndarray:
        """Covariance of what is wrong about the reference's numbers, alike in all later recordings. # (n, n)."""
        covariance = np.linalg.inv(self.posterior.information / self.posterior.scale)
        stays = np.array([path not in self.changing for path in self.bench.parameters(()).paths])
        return np.asarray(covariance * np.outer(stays, stays))

    @property
    def told(self) -> ReferenceTold:
        """How surely the reference tells the machine's own numbers, those that change left out."""
        deviations = np.sqrt(np.diag(self.shared))
        paths = self.bench.parameters(()).paths
        own = [i for i, path in enumerate(paths) if path not in self.changing]
        # joints that move in one recording share its time
        lengths = {e.name: float(e.time[-1] - e.time[0]) for e in self._training}
        return ReferenceTold(
            {paths[i]: float(deviations[i]) for i in own},
            {paths[i]: float(self.drift[i]) for i in own},
            sum(lengths.values()),
        )

    @property
    def knowledge(self) -> Knowledge:
        """Of a later recording's numbers."""
        return self.posterior.known(self.drift)

    def knowledge_without(self, name: str) -> Knowledge:
        """The same by all reference recordings but one: the model fitted on to them from where it stands.

        Args:
            name: of the recording that is left out.
        """
        others = [e for e in self._reference.training if e.name != name]
        bench = self._reference.with_training(others)
        again = race(bench, [Entrant((), self._fit.values)], (bench.settings.again,))[0]
        return self._posterior(bench, again).known(self.drift)

    def _posterior(self, bench: Workbench, best: Hypothesis) -> Posterior:
        """What a fit of reference recordings says."""
        problem = bench.problem((), bench.fine)
        slopes = problem.jacobian_without_jumps(best.fit.unit, best.fit.residuals)
        prior = best.fit.prior_jacobian
        mean, information = best.fit.unit, slopes.T @ slopes + prior.T @ prior
        if self.changing:
            mean, information = kept_of(self.bench.parameters(()), self.changing, mean, information)
        return Posterior(mean, information, best.fit.over_noise)

    def problem(
        self, effects: tuple[Candidate, ...], experiments: Sequence[Experiment], known: Knowledge
    ) -> KnownProblem | KnownTogether:
        """Residuals of a structure on a recording, with what is known as the prior."""
        together = any(e.others is not None for e in experiments)
        kind = KnownTogether if together else KnownProblem
        problem = self.bench.problem(effects, self.bench.step_for(effects), experiments, kind=kind)
        assert isinstance(problem, KnownProblem | KnownTogether)
        problem.know(known)
        return problem


def _fitted(bench: Workbench) -> Hypothesis:
    """The nominal model, the data weighed by it."""
    first = race(bench, [Entrant((), {})], (*bench.settings.free, *bench.settings.ended))[0]
    best = as_weighed(bench, first)
    if isinstance(bench, ReferenceBench) and best.fit.over_noise > NOISE.at:
        # there are more local minima then
        led = continued_nominal(bench, best, best.fit.over_noise)
        if led is not None:
            best = min(best, as_weighed(bench, led), key=lambda each: each.fit.objective)
    return best


def _drifts(paths: Sequence[str], drift: Mapping[str, float]) -> np.ndarray:
    """Drift of each parameter: that of the longest name which is its path, or a part of that. # (n,)."""
    found = np.full(len(paths), drift.get("", 0.0))
    for name in sorted((n for n in drift if n), key=len):
        hit = [i for i, path in enumerate(paths) if contains(path, name)]
        if not hit:
            raise InputError(
                f"--drift {name}={drift[name]:g}: no free parameter of that name; {', '.join(paths)}"
            )
        found[hit] = drift[name]
    return found
