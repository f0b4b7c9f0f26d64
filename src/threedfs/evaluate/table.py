"""A table of text, and how it looks in Markdown."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Table:
    """A table.

    Attributes
    ----------
    title : str
    header : tuple of str
    rows : tuple of tuple of str
        As long as the header.
    note : str
        Sentences below the table.
    """

    title: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str = ""


def render_markdown(table: Table) -> str:
    """Return a table as Markdown: heading, rows, note; every column but the first to the right.

    Examples
    --------
    >>> print(render_markdown(Table("IoU", ("sequence", "a|b"), (("mug", "0.912"),), "One video.")))
    ### IoU
    <BLANKLINE>
    | sequence |  a\\|b |
    |:---------|------:|
    | mug      | 0.912 |
    <BLANKLINE>
    One video.
    <BLANKLINE>
    """
    rows = [tuple(_escape(cell) for cell in row) for row in (table.header, *table.rows)]
    # a long sentence in a cell does not widen the column of all others
    widths = [max(3, *(len(row[column]) for row in rows if len(row[column]) <= 30)) for column in range(len(rows[0]))]
    lines = [_line(row, widths) for row in rows]
    rule = "|".join("-" * (width + 1) + ":" for width in widths[1:])
    lines.insert(1, f"|:{'-' * (widths[0] + 1)}|{rule}|")
    note = f"\n{table.note}\n" if table.note else ""
    return "### {}\n\n{}\n{}".format(table.title, "\n".join(lines), note)


def _line(cells: tuple[str, ...], widths: list[int]) -> str:
    first = cells[0].ljust(widths[0])
    others = (cell.rjust(width) for cell, width in zip(cells[1:], widths[1:], strict=True))
    return f"| {' | '.join([first, *others])} |"


def _escape(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")
