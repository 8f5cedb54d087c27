"""Numbers with their uncertainty, and how they are shown."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from math import floor, isfinite, log10


@dataclass(frozen=True)
class Number:
    """A number of a model.

    Attributes:
        symbol: of the literature.
        name: the effect it belongs to, ``inertia`` or ``pendulum``.
        value: in :attr:`unit`.
        std: standard deviation in :attr:`unit`, if one is known.
        unit: SI.
        verdict: how well the swings tell it, of a fit: ``identified``, ``weak`` or ``not``.
        status: how far it may be trusted, of a fit: ``identified``, ``upper-bound``, ``at-bound``, ``not-identified``.
        upper: with 95 % confidence it is not larger; where that is all the swings tell.
    """

    symbol: str
    name: str
    value: float
    std: float | None
    unit: str
    verdict: str | None = None
    status: str | None = None
    upper: float | None = None

    def __str__(self) -> str:
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{self.symbol} = {with_spread(self.value, self.std)}{unit}"


def with_spread(value: float, std: float | None) -> str:
    """The value with two digits of its spread, such as ``(5.42 ± 0.11)e-4``."""
    if std is None or not std > 0.0 or not isfinite(std):
        return f"{value:.6g}"
    power = floor(log10(max(abs(value), std)))
    power = 0 if -3 <= power <= 4 else power
    scale = 10.0**power
    digits = max(0, 1 - floor(log10(std / scale)))
    pair = f"{value / scale:.{digits}f} ± {std / scale:.{digits}f}"
    return pair if power == 0 else f"({pair})e{power}"


def listing(numbers: Sequence[Number]) -> str:
    """One number a line."""
    rows = [(n.symbol, with_spread(n.value, n.std), n.unit, n.name, n.verdict or "") for n in numbers]
    widths = [max((len(row[column]) for row in rows), default=0) for column in range(5)]
    line = lambda row: "  ".join(text.ljust(width) for text, width in zip(row, widths)).rstrip()  # noqa: E731
    return "\n".join("  " + line(row) for row in rows)


def html_table(numbers: Sequence[Number]) -> str:
    """A table for a notebook."""
    has_verdict = any(number.verdict for number in numbers)
    heads = ["", "value", "unit", "what"] + ["verdict"] * has_verdict
    rows = [
        [n.symbol, with_spread(n.value, n.std), n.unit, n.name] + [n.verdict or ""] * has_verdict for n in numbers
    ]
    return html_rows(heads, rows)


def html_rows(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table of texts."""
    cells = lambda texts, tag: "".join(f"<{tag}>{escape(str(text))}</{tag}>" for text in texts)  # noqa: E731
    body = "".join(f"<tr>{cells(row, 'td')}</tr>" for row in rows)
    return f"<table><thead><tr>{cells(heads, 'th')}</tr></thead><tbody>{body}</tbody></table>"
