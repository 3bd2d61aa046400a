"""What is said of how an answer came about."""

INTERRUPTED = "interrupted: this is what was known by then; run it again for the whole answer"

BY_BOTH = (
    "the model that explains the training data best fails on the held-out data, and another fit explains both: two "
    "thirds of the held-out data were fitted too, and the rest was held out"
)

ASKED_FOR = (
    "the half of the held-out data that only reports tells parameters that the other data do not tell: the model "
    "leaves {predicted:.3g} times the noise there as a prediction, and {fitted:.3g} times once it is fitted to these "
    "data too"
)

AT_THE_CUT = (
    "the recorded supply pressure is an input of the model, which with it leaves {behind:.3g} times the noise of the "
    "held-out data behind the supply; the supply is simulated under the flow that the valves draw, and compared with "
    "the recorded pressure. With the simulated supply pressure in its place, where errors of the ringing line stay, "
    "all signals together leave {uncut:.3g} times the noise"
)

AT_BEST = (
    "the model leaves {trained:.3g} times the noise of the fitted and {left:.3g} times that of the held-out data. The "
    "rig says that its equations leave {share:.3g} % of each signal's range at best (integration.model_error), which "
    "is {least:.3g} times the noise: nothing below that is looked for"
)

SIGNALS_APART = (
    "no model comes near the noise of any signal, so that signals count by how far models are off from them: 'times "
    "the noise' is that of the one which they follow best ({told})"
)
