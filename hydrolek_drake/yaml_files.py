"""The one reader of YAML: rigs, scenarios, designs, and the tables that come with the package.

A file is read event by event into mappings, lists, text, numbers, booleans and nothing: no other type exists here,
so no constructor can fail behind the reader's back. A date stays text. Depth, size and what aliases multiply are
limited while reading, before anything is built from them.
"""

import copy
from collections.abc import Callable, Iterator
from importlib import resources
from pathlib import Path
from typing import Any, NoReturn

import yaml
from yaml.constructor import SafeConstructor

from hydrolek_drake.errors import InputError

LARGEST_FILE = 2_000_000  # bytes; the largest rig of the project has 50,000
DEEPEST = 32  # mappings and lists in each other; a rig needs 8
MOST_VALUES = 100_000  # with each alias counted as what it stands for
MOST_CHARACTERS = 2_000_000  # of all text, counted in the same way
LONGEST_TEXT = 10_000  # characters of one value
LARGEST_INTEGER = 2**63 - 1
_LONGEST_INTEGER = 80  # characters that are looked at: 64 of a binary one, with its underscores

_PARSER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # ten times as fast, where PyYAML has libyaml
_RESOLVERS = yaml.SafeLoader.yaml_implicit_resolvers
_CORE = "tag:yaml.org,2002:"
_MERGE = _CORE + "merge"
_NUMBERS = SafeConstructor()
_SCALARS: dict[str, tuple[str, Callable[[Any], Any]]] = {
    _CORE + "str": ("text", lambda node: node.value),
    _CORE + "null": ("nothing", _NUMBERS.construct_yaml_null),
    _CORE + "bool": ("true or false", _NUMBERS.construct_yaml_bool),
    _CORE + "int": ("a whole number", _NUMBERS.construct_yaml_int),
    _CORE + "float": ("a number", _NUMBERS.construct_yaml_float),
}
"""Tag -> what a value of it is called, and what makes one of a node."""
_HINTS = {
    "cannot start any token": "indent with blanks, and quote text that begins with a special character",
    "mapping values are not allowed": "quote text that holds ': '",
    "could not find expected ':'": "write 'key: value'",
    "undefined alias": "an alias stands behind its anchor",
    "found unexpected end of stream": "close the quotes",
    "but found another document": "one file holds one document",
    "but found '<stream end>'": "close the bracket",
    "but got '<stream end>'": "close the bracket",
    "did not find expected node content": "close the bracket, and quote text that begins with a special character",
    "did not find expected key": "write 'key: value', indented as the lines above",
}


def read_yaml(path: Path, what: str) -> Any:
    """Content of a YAML file.

    Args:
        path: the file.
        what: it is, for errors: "rig file".

    Returns:
        Mappings, lists, text, numbers, booleans and None; an alias gives a copy of what it stands for.

    Raises:
        InputError: it cannot be read, is no YAML, or exceeds the limits; with line and column.
    """
    try:
        with path.open("rb") as stream:
            data = stream.read(LARGEST_FILE + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"{what} {path} cannot be read: {reason}") from None
    if len(data) > LARGEST_FILE:
        raise InputError(f"{what} {path} is larger than {LARGEST_FILE // 1_000_000} MB, which no {what} is")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line, column = _place(data[: error.start].decode("utf-8", "replace"))
        raise InputError(
            f"{what} {path} cannot be read: line {line}, column {column}: "
            f"byte 0x{data[error.start]:02x} is not UTF-8; save it as UTF-8 text"
        ) from None
    return parse_yaml(text, f"{what} {path}")


def parse_yaml(text: str, where: str) -> Any:
    """Content of YAML text; see `read_yaml`.

    Args:
        text: one document.
        where: it stands, for errors.

    Raises:
        InputError: it is no YAML or exceeds the limits; with line and column.
    """
    try:
        return _Builder(text, where).document()
    except yaml.reader.ReaderError as error:  # its position counts characters where the text is one
        line, column = _place(text[: error.position])
        problem = f"line {line}, column {column}: a character that text cannot hold; leave it out"
    except yaml.MarkedYAMLError as error:
        said = " ".join(part for part in (error.context, error.problem) if part)
        hint = next((hint for known, hint in _HINTS.items() if known in said), "")
        mark = error.problem_mark or error.context_mark
        place = "" if mark is None else f"line {mark.line + 1}, column {mark.column + 1}: "
        problem = place + _short(said, 200) + (f"; {hint}" if hint else "")
    except yaml.YAMLError as error:
        problem = _short(str(error), 200)
    raise InputError(f"{where} is not valid YAML: {problem}")


def package_yaml(package: str, name: str) -> Any:
    """Content of a YAML file that comes with a package of the project, such as `__package__`, "teleop.yaml"."""
    return parse_yaml(
        resources.files(package).joinpath(name).read_text(encoding="utf-8"), f"{package}/{name}"
    )


class _Builder:
    """Builds the content of one document from its events."""

    def __init__(self, text: str, where: str) -> None:
        self._events: Iterator[Any] = iter(yaml.parse(text, Loader=_PARSER))
        self._where = where
        self._anchored: dict[str, tuple[Any, int, int, int] | None] = {}
        self._values = 0
        self._characters = 0

    def document(self) -> Any:
        content = None
        for event in self._events:
            if isinstance(event, yaml.DocumentStartEvent):
                content = self._node(next(self._events), 0)
                break
        next(self._events, None)  # the document's end
        for event in self._events:
            if isinstance(event, yaml.DocumentStartEvent):
                self._refuse(event, "another document begins; one file holds one document")
        return content

    def _node(self, event: Any, depth: int) -> Any:
        if isinstance(event, yaml.AliasEvent):
            return self._alias(event, depth)
        self._count(event, 1, 0)
        before = (self._values, self._characters)
        if event.anchor is not None:
            self._anchored[event.anchor] = None  # until it is complete
        if isinstance(event, yaml.ScalarEvent):
            content, height = self._scalar(event), 0
        elif depth >= DEEPEST:
            self._refuse(event, f"more than {DEEPEST} mappings or lists in each other; write it flatter")
        else:
            wanted = "map" if isinstance(event, yaml.MappingStartEvent) else "seq"
            if event.tag not in (None, "!", _CORE + wanted):
                self._refuse_tag(event)
            content = self._mapping(event, depth) if wanted == "map" else self._sequence(depth)
            height = _height(content) if event.anchor is not None else 0
        if event.anchor is not None:
            size = (self._values - before[0] + 1, self._characters - before[1])
            self._anchored[event.anchor] = (content, *size, height)
        return content

    def _alias(self, event: Any, depth: int) -> Any:
        if event.anchor not in self._anchored:
            self._refuse(
                event, f"alias *{_short(event.anchor)} has no anchor; write &{_short(event.anchor)} before it"
            )
        known = self._anchored[event.anchor]
        if known is None:
            self._refuse(
                event, f"alias *{_short(event.anchor)} stands within what it stands for; take it out"
            )
        content, values, characters, height = known
        self._count(event, values, characters)
        if depth + height > DEEPEST:
            self._refuse(event, f"more than {DEEPEST} mappings or lists in each other; write it flatter")
        return copy.deepcopy(content)

    def _sequence(self, depth: int) -> list[Any]:
        items = []
        while not isinstance(event := next(self._events), yaml.SequenceEndEvent):
            items.append(self._node(event, depth + 1))
        return items

    def _mapping(self, start: Any, depth: int) -> dict[Any, Any]:
        own: dict[Any, Any] = {}
        lines: dict[Any, int] = {}
        merged: dict[Any, Any] = {}
        while not isinstance(event := next(self._events), yaml.MappingEndEvent):
            if isinstance(event, yaml.ScalarEvent) and _tag(event) == _MERGE:
                given = self._node(next(self._events), depth + 1)
                for mapping in given if isinstance(given, list) else [given]:
                    if not isinstance(mapping, dict):
                        self._refuse(event, "'<<' takes a mapping, or a list of them, such as <<: *anchor")
                    merged = {**mapping, **merged}
                continue
            key = self._node(event, depth + 1)
            if isinstance(key, (dict, list)):
                self._refuse(event, "a key must be text or a number, not a mapping or a list")
            if key in lines:
                self._refuse(
                    event,
                    f"key '{_short(str(key))}' stands in line {lines[key]} already; keep one of both",
                )
            lines[key] = event.start_mark.line + 1
            own[key] = self._node(next(self._events), depth + 1)
        return {**merged, **own}

    def _scalar(self, event: Any) -> Any:
        text = event.value
        self._count(event, 0, len(text))
        if len(text) > LONGEST_TEXT:
            self._refuse(event, f"a value of {len(text)} characters; at most {LONGEST_TEXT} are read")
        if not text.isprintable():
            for character in text:
                if character not in "\t\n\r" and (ord(character) < 32 or 0x7F <= ord(character) < 0xA0):
                    self._refuse(event, f"text with the control character {character!a}; leave it out")
                if 0xD800 <= ord(character) < 0xE000:
                    self._refuse(event, f"text with half a character, {character!a}; leave it out")
        tag = _tag(event)
        tag = _CORE + "str" if tag == _MERGE else tag  # it merges as a key alone
        if tag not in _SCALARS:
            self._refuse_tag(event)
        name, construct = _SCALARS[tag]
        digits = sum(map(str.isdigit, text))
        if tag == _CORE + "int" and digits > _LONGEST_INTEGER:
            self._refuse(event, f"a whole number of {digits} digits; write large numbers as 1.0e+20")
        try:
            value = construct(yaml.ScalarNode(tag, text))
        except (ValueError, ArithmeticError, LookupError):
            self._refuse(event, f"'{_short(text)}' is not {name}, as its tag says")
        if isinstance(value, int) and abs(value) > LARGEST_INTEGER:
            self._refuse(event, f"a whole number beyond {LARGEST_INTEGER}; write it as {float(value):.1e}")
        return value

    def _count(self, event: Any, values: int, characters: int) -> None:
        self._values += values
        self._characters += characters
        if self._values > MOST_VALUES:
            self._refuse(event, f"more than {MOST_VALUES} values, each alias counted as what it stands for")
        if self._characters > MOST_CHARACTERS:
            self._refuse(
                event,
                f"more than {MOST_CHARACTERS} characters, each alias counted as what it stands for",
            )

    def _refuse_tag(self, event: Any) -> NoReturn:
        kinds = ", ".join(map(_short_tag, (*_SCALARS, _CORE + "map", _CORE + "seq")))
        self._refuse(event, f"tag {_short_tag(event.tag)} is not read here; leave it out (known are {kinds})")

    def _refuse(self, event: Any, problem: str) -> NoReturn:
        mark = event.start_mark
        raise InputError(
            f"{self._where} is not valid YAML: line {mark.line + 1}, column {mark.column + 1}: {problem}"
        )


def _tag(event: Any) -> str:
    """Tag of a scalar: as it states, or as its text looks like where it stands without quotes."""
    if event.tag not in (None, "!"):
        return str(event.tag)
    if event.implicit[0] and event.tag is None:
        text = event.value
        for tag, pattern in _RESOLVERS.get(text[:1], ()):
            if pattern.match(text):
                return tag if tag in _SCALARS or tag == _MERGE else _CORE + "str"
    return _CORE + "str"


def _height(content: Any) -> int:
    """How many mappings and lists are in each other."""
    inside = content.values() if isinstance(content, dict) else content if isinstance(content, list) else None
    return 0 if inside is None else 1 + max(map(_height, inside), default=0)


def _place(before: str) -> tuple[int, int]:
    """Line and column, from 1, of what follows a text."""
    return before.count("\n") + 1, len(before) - (before.rfind("\n") + 1) + 1


def _short_tag(tag: str) -> str:
    return _short(f"!!{tag.removeprefix(_CORE)}" if tag.startswith(_CORE) else tag)


def _short(text: str, longest: int = 60) -> str:
    return text if len(text) <= longest else f"{text[: longest - 3]}..."
