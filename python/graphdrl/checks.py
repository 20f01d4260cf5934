"""Arguments of callers: each is given back as the extension takes it, or is an Error of one line."""

from __future__ import annotations

import operator
import os
from typing import Any

import numpy as np

from ._core import Error

LARGEST_INT = 2**31 - 1
LARGEST_SEED = 2**64 - 1


def shown(value: Any) -> str:
    """A value on one line of an error."""
    return " ".join(repr(value).split())[:100]


def wrong(name: str, expected: str, value: Any) -> Error:
    """The error of a value that is not what it should be."""
    return Error(f"bad {name}: expected {expected}, got {shown(value)}")


def whole_number(value: Any, name: str, lowest: int = 0, highest: int = LARGEST_SEED) -> int:
    """A whole number in a range; no flag, no text, no 1.0."""
    try:
        number = None if isinstance(value, (bool, np.bool_)) else operator.index(value)
    except TypeError:
        number = None
    if number is None or not lowest <= number <= highest:
        span = f"from {lowest} up" if highest in (LARGEST_INT, LARGEST_SEED) else f"from {lowest} to {highest}"
        if number is not None and number > highest:
            span = f"from {lowest} to {highest}"
        raise wrong(name, f"a whole number {span}", value)
    return number


def number(value: Any, name: str) -> float:
    """A number as a float."""
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise wrong(name, "a number", value) from error


def flag(value: Any, name: str) -> bool:
    """True or False, of Python or NumPy."""
    if not isinstance(value, (bool, np.bool_)):
        raise wrong(name, "True or False", value)
    return bool(value)


def one_of(choices: tuple[str, ...], value: Any, name: str) -> None:
    """A text among some."""
    if value not in choices:
        raise wrong(name, " or ".join(choices), value)


def text(value: Any, name: str) -> str:
    """A text that UTF-8 can write."""
    if not isinstance(value, str):
        raise wrong(name, "text", value)
    try:
        value.encode()
    except UnicodeEncodeError as error:
        raise wrong(name, "text without lone surrogates", value) from error
    return str(value)


def path_text(value: Any, name: str = "path") -> str:
    """The path of a file as text."""
    return text(os.fspath(value) if isinstance(value, os.PathLike) else value, name)


def function(value: Any, name: str) -> Any:
    """A callable, or None."""
    if value is not None and not callable(value):
        raise wrong(name, "a function", value)
    return value


def listed(values: Any, name: str, expected: str) -> list[Any]:
    """What can be iterated over, as a list."""
    try:
        each = iter(values)
    except TypeError as error:
        raise wrong(name, expected, values) from error
    return list(each)
