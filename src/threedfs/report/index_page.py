"""A page over several sequences: one row each, with a way to its report."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from urllib.parse import quote

from threedfs.report.page import wrap_page


@dataclass(frozen=True)
class Row:
    """A sequence on the page.

    Attributes
    ----------
    sequence : str
    report : str
        Place of its report relative to the page, empty without any.
    picture : str
        Address of an image inside of the page, empty without any.
    verdict : str
    good : bool, optional
        Whether all checks passed; None where there is nothing to check.
    figures : mapping of str to str
        By the title of their column.
    """

    sequence: str
    report: str = ""
    picture: str = ""
    verdict: str = ""
    good: bool | None = None
    figures: Mapping[str, str] = field(default_factory=dict)


def write_index(rows: Sequence[Row], columns: Sequence[str]) -> str:
    """Return the page; a column that no sequence has a figure for is left out, and all texts are escaped."""
    shown = [column for column in columns if any(column in row.figures for row in rows)]
    head = "".join(f"<th>{html.escape(title)}</th>" for title in ("", "sequence", "verdict", *shown))
    lines = "".join(_lay_out(row, shown) for row in rows)
    good = sum(row.good is True for row in rows)
    return wrap_page(
        "threedfs",
        f"<style>{_STYLE}</style><h1>{len(rows)} sequence{'s' * (len(rows) != 1)}</h1>"
        f"<p>{good} passed all checks.</p><table><tr>{head}</tr>{lines}</table>",
    )


def _lay_out(row: Row, columns: Sequence[str]) -> str:
    name = html.escape(row.sequence)
    picture = f'<img src="{html.escape(row.picture)}" alt="{name}">' if row.picture else ""
    if row.report:
        place = html.escape(quote(row.report))
        name, picture = f'<a href="{place}">{name}</a>', picture and f'<a href="{place}">{picture}</a>'
    cells = [picture, name, html.escape(row.verdict), *(html.escape(row.figures.get(title, "")) for title in columns)]
    kind = {True: "good", False: "bad", None: "unknown"}[row.good]
    return f'<tr class="{kind}">' + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>"


_STYLE = "td img{width:160px;border-radius:5px;display:block}tr.bad td:nth-child(3){color:#a3241a;min-width:14rem}"
