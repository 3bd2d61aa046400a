"""What a browser may say to the console: declared types, and one validator for all of them."""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from hydrolek_drake.errors import InputError

_LONGEST_TEXT = 200  # characters
_SHOWN = 40  # characters of what was not understood

Joints = Annotated[list[float], Field(min_length=14, max_length=14)]
Text = Annotated[str, Field(max_length=_LONGEST_TEXT)]


class Message(BaseModel):
    """Something with a `do`; numbers are finite numbers, and what is not declared is refused."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False)


class Token(Message):
    """Shows the token that control needs."""

    do: Literal["token"]
    token: Text


class Here(Message):
    """The page lives: it has drawn a state."""

    do: Literal["here"]


class Stop(Message):
    """Stop the arms; anybody may."""

    do: Literal["stop"]


class Plain(Message):
    """A button of the task."""

    do: Literal["snapshot", "back", "confirm", "release", "resume", "abort", "let_go"]


class Click(Message):
    """A click on a picture, in its pixels."""

    do: Literal["click"]
    u: float
    v: float


class Sliders(Message):
    """Settings of the edge picture, each if it is to change."""

    do: Literal["sliders"]
    low_contrast: float | None = None
    high_contrast: float | None = None
    sensitivity: float | None = None

    def given(self) -> dict[str, float]:
        """Those that are to change."""
        return self.model_dump(exclude={"do"}, exclude_none=True)


class Fill(Message):
    """What a click is filled up to."""

    do: Literal["fill"]
    name: Literal["surfaces", "edges"]


class TaskChoice(Message):
    """What is to be done with the object."""

    do: Literal["task"]
    name: Literal["cut", "place"]


class Joystick(Message):
    """Joysticks that are held, in percent."""

    do: Literal["joystick"]
    deflection: Joints


class SlidersTo(Message):
    """Angles in degrees to which joints are moved while this is repeated."""

    do: Literal["sliders_to"]
    angles_deg: Joints


class Timer(Message):
    """The trial's timer."""

    do: Literal["timer"]
    action: Literal["start", "stop", "reset"]


class Ratings(Message):
    """A trial to be saved; `trial.TrialLog` says what the ratings must be."""

    do: Literal["ratings"]
    operator: Text = ""
    control: Text = ""
    note: Text = ""
    mental: float | None = None
    physical: float | None = None
    temporal: float | None = None
    performance: float | None = None
    effort: float | None = None
    frustration: float | None = None

    def given(self) -> dict[str, Any]:
        """What was filled in."""
        return self.model_dump(exclude={"do"}, exclude_none=True)


AnyMessage = (
    Token | Here | Stop | Plain | Click | Sliders | Fill | TaskChoice | Joystick | SlidersTo | Timer | Ratings
)

_VALIDATOR: TypeAdapter[AnyMessage] = TypeAdapter(Annotated[AnyMessage, Field(discriminator="do")])


def parse(text: str | bytes) -> AnyMessage:
    """A message from its JSON text.

    Raises:
        InputError: What is wrong with it, in one line.
    """
    try:
        return _VALIDATOR.validate_json(text)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        raise InputError(_sentence(dict(first))) from None


def _sentence(error: dict[str, Any]) -> str:
    kind, place, context = error["type"], error["loc"], error.get("ctx", {})
    if kind == "json_invalid":
        return "a message to the console must be JSON"
    if kind in ("dict_type", "union_tag_not_found"):
        return "a message to the console is an object with 'do'"
    if kind == "union_tag_invalid":
        return f"the console does not know {_short(context.get('tag'))}"
    name = ".".join(str(part) for part in place[1:])[:_SHOWN]
    what = {
        "missing": "is missing",
        "extra_forbidden": "is unknown",
        "float_type": "must be a finite number",
        "finite_number": "must be a finite number",
        "string_type": "must be text",
        "string_too_long": f"must be text of at most {_LONGEST_TEXT} characters",
        "too_short": "must be 14 numbers, right_j1 to left_j7",
        "too_long": "must be 14 numbers, right_j1 to left_j7",
        "list_type": "must be 14 numbers, right_j1 to left_j7",
        "literal_error": f"is unknown; choose from {context.get('expected')}",
    }.get(kind, str(error["msg"]))
    return f"{place[0]}: '{name}' {what}"


def _short(value: Any) -> str:
    return repr(str(value)[:_SHOWN])
