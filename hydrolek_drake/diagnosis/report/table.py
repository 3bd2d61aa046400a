"""The diagnosis on the terminal."""

from collections.abc import Iterator

from rich.markup import escape
from rich.table import Table

from hydrolek_drake.diagnosis.diagnosis import Diagnosis
from hydrolek_drake.diagnosis.report.as_json import effects_json, fit_json, models_of
from hydrolek_drake.diagnosis.report.words import behind, headline, off_zero_sentences
from hydrolek_drake.replay.display import ratio

SHOWN = 5
"""So many models are shown."""


def summary(diagnosis: Diagnosis) -> Iterator[str | Table]:
    """Verdict, effects, errors and the models that came closest."""
    yield f"[bold]{diagnosis.verdict}[/bold]: {escape(headline(diagnosis))}"
    for reason in diagnosis.reasons:
        yield escape(f"- {reason}")
    for told in effects_json(diagnosis):
        yield escape(f"- {told['id']} (probability {told['probability']:.2f}): {told['sentence']}")
    for sentence in off_zero_sentences(diagnosis):
        yield escape(f"- {sentence}")
    fit = fit_json(diagnosis)
    if fit is None:
        return
    for name, errors in models_of(diagnosis, fit):
        yield (
            f"{name}: {errors['train_rms']:.3g} {fit['unit']} rms fitted, "
            f"{errors['holdout_rms']:.3g} {fit['unit']} held out (noise {fit['noise_floor']:.3g})"
        )
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="bold")
    table.add_column("model")
    for title in ("posterior", "fitted / noise", "held out / noise", "behind"):
        table.add_column(title, justify="right", no_wrap=True)
    for judged in diagnosis.judged[:SHOWN]:
        table.add_row(
            escape(judged.hypothesis.label),
            f"{judged.probability:.3f}",
            ratio(judged.hypothesis.fit.over_noise),
            ratio(judged.over_noise),
            behind(judged),
        )
    yield table
