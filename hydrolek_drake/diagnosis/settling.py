"""The parameters of joints that move together, fitted with what the joints do to each other.

Rollouts of one joint take the movement of the others as given, so that their Jacobian says nothing of how a parameter
acts through the other joints: a tenth of a column, and far more than what is left along a valley, where parameters make
up for each other. Fits that take turns with a rollout of all joints then end where neither moves on, a droop of the
supply 9 % off. Near the noise all joints are rolled out for every residual and every column.
"""

from hydrolek_drake.diagnosis.together import felt_together
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.problem_together import ProblemTogether
from hydrolek_drake.identification.secant_descent import SecantDescent

WORTH = 1.0
"""A step that takes less than so many squares moves no parameter by more than its own standard deviation."""


def settled_together(bench: Workbench, hypothesis: Hypothesis) -> Hypothesis:
    """A fit near the noise, gone on with by rollouts of all joints, whose telling replaces that of the training data.

    It does not end where the noise is reached: a noise that is told 2 % too high leaves hundreds of squares, and a
    valley along which a parameter is off by many times its standard deviation.

    Args:
        bench: fits, and the training data.
        hypothesis: fitted to these.

    Returns:
        The place where it ends, with its fit as the joints' own rollouts have it there.
    """
    bench.alive()
    problem = bench.problem(hypothesis.effects, bench.fine, kind=ProblemTogether)
    moving = bench.movable(hypothesis.effects, problem.parameters)
    descent = SecantDescent(problem, worth=WORTH, stop=bench.interrupted, moving=moving)
    fit = descent.from_start(hypothesis.fit.unit)
    bench.evaluations += fit.evaluations
    values = problem.parameters.values(fit.unit)
    bench.training = tuple(felt_together(bench.rig.with_values(values), bench.training))
    there = Hypothesis(hypothesis.effects, values, fit, bench.fine)
    return bench.refit(there, bench.fine, 1)  # which only tells what is left there
