"""The page itself: one HTML file that needs nothing else."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from threedfs.report.findings import Finding, sum_up


@dataclass(frozen=True)
class KeyframePictures:
    """Addresses of a keyframe's pictures inside of the page, by what they show."""

    name: str
    pictures: Mapping[str, str]


@dataclass(frozen=True)
class Report:
    """All that a page shows; what there is none of is left out.

    Attributes
    ----------
    sequence : str
    failures : tuple of str
        Sentences of the jobs that failed.
    findings : tuple of Finding
    viewer, path : str
        Parts of the page: the mesh, and the camera's path.
    keyframes : tuple of KeyframePictures
    size : str
        How large the object is, and how that was found.
    files : mapping of str to str
        What the run made: what it is, by its place relative to the page.
    left_out : tuple of str
        Frames without a pose.
    scores : mapping of str to mapping of str to str
        By method, figures by name.
    costs : tuple of (stage, seconds, megabytes)
    settings : mapping of str to str
        Settings that differ from the defaults.
    versions : mapping of str to str
    """

    sequence: str
    failures: tuple[str, ...] = ()
    findings: tuple[Finding, ...] = ()
    viewer: str = ""
    path: str = ""
    keyframes: tuple[KeyframePictures, ...] = ()
    size: str = ""
    files: Mapping[str, str] = field(default_factory=dict)
    left_out: tuple[str, ...] = ()
    scores: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    costs: tuple[tuple[str, float, float], ...] = ()
    settings: Mapping[str, str] = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=dict)


def write_page(report: Report) -> str:
    """Return the page of a sequence; all that comes from a user is escaped."""
    parts = [
        f"<h1>{html.escape(report.sequence)}</h1>",
        _tell_failures(report.failures),
        _show(report.viewer),
        _tell_findings(report.findings),
        _section("Size", f"<p>{html.escape(report.size)}</p>" if report.size else ""),
        _list_files(report.files),
        _show_keyframes(report.keyframes),
        _section("Where the camera went", report.path, _tell_left_out(report.left_out) if report.path else ""),
        _tell_scores(report.scores),
        _tell_costs(report.costs),
        _section("Settings that differ from the defaults", lay_out_rows(("setting", "value"), report.settings.items())),
        _section("Versions", lay_out_rows(("package", "version"), report.versions.items())),
    ]
    return wrap_page(f"{report.sequence}: threedfs", "".join(parts))


def wrap_page(title: str, body: str) -> str:
    """Return a whole page with a title, plain text, and a body, HTML."""
    return (
        '<!DOCTYPE html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<link rel="icon" href="data:,"><title>{html.escape(title)}</title><style>{_STYLE}</style></head>'
        f"<body><main>{body}</main></body></html>\n"
    )


def lay_out_rows(columns: Sequence[str], rows) -> str:
    """Return a table of plain texts as HTML, nothing if it has no rows."""
    lines = ["".join(f"<td>{html.escape(str(cell))}</td>" for cell in row) for row in rows]
    if not lines:
        return ""
    head = "".join(f"<th>{html.escape(column)}</th>" for column in columns)
    return f"<table><tr>{head}</tr>" + "".join(f"<tr>{line}</tr>" for line in lines) + "</table>"


def _section(title: str, *parts: str) -> str:
    return f"<section><h2>{title}</h2>{''.join(parts)}</section>" if any(parts) else ""


def _show(part: str) -> str:
    return f"<section>{part}</section>" if part else ""


def _tell_failures(failures: Sequence[str]) -> str:
    return "".join(f'<p class="bad">{html.escape(sentence)}</p>' for sentence in failures)


def _tell_findings(findings: Sequence[Finding]) -> str:
    if not findings:
        return ""
    rows = "".join(
        f'<tr class="{"good" if each.good else "bad"}"><td>{"✓" if each.good else "!"} {html.escape(each.what)}</td>'
        f"<td>{html.escape(each.value)}</td><td>{html.escape(each.expected)}</td>"
        f"<td>{'' if each.good else html.escape(each.advice)}</td></tr>"
        for each in findings
    )
    return _section(
        "Can it be trusted?",
        f"<p>{html.escape(sum_up(list(findings)))}</p>",
        f"<table><tr><th>check</th><th>found</th><th>good is</th><th>what to do</th></tr>{rows}</table>",
    )


def _list_files(files: Mapping[str, str]) -> str:
    links = "".join(
        f'<li><a href="{html.escape(place)}">{html.escape(place)}</a>: {html.escape(what)}</li>'
        for what, place in files.items()
    )
    return _section("Files", f"<ul>{links}</ul>") if files else ""


def _show_keyframes(keyframes: Sequence[KeyframePictures]) -> str:
    if not keyframes:
        return ""
    kinds = list(dict.fromkeys(kind for each in keyframes for kind in each.pictures))
    show = "document.getElementById('keyframes').dataset.shown='{}'"
    buttons = "".join(f'<button type="button" onclick="{show.format(kind)}">{kind}</button>' for kind in kinds)
    figures = ""
    for each in keyframes:
        pictures = "".join(_picture(kind, each) for kind in each.pictures)
        figures += f"<figure>{pictures}<figcaption>{html.escape(each.name)}</figcaption></figure>"
    style = "".join(f"#keyframes[data-shown={kind}] img.{kind}{{display:block}}" for kind in kinds)
    return _section(
        "Keyframes",
        f'<style>{style}</style><p class="buttons">{buttons}</p>',
        f'<div id="keyframes" data-shown="{kinds[0]}">{figures}</div>',
    )


def _picture(kind: str, keyframe: KeyframePictures) -> str:
    what = f"{kind} of keyframe {html.escape(keyframe.name)}"
    return f'<img class="{kind}" loading="lazy" src="{keyframe.pictures[kind]}" alt="{what}">'


def _tell_left_out(left_out: Sequence[str]) -> str:
    if not left_out:
        return "<p>Every frame has its place.</p>"
    return f"<p>Left out, as they could not be placed: {html.escape(', '.join(left_out))}.</p>"


def _tell_scores(scores: Mapping[str, Mapping[str, str]]) -> str:
    names = list(dict.fromkeys(name for figures in scores.values() for name in figures))
    rows = [(name, *(figures.get(name, "") for figures in scores.values())) for name in names]
    return _section("Figures", lay_out_rows(("figure", *(method or "all" for method in scores)), rows))


def _tell_costs(costs: Sequence[tuple[str, float, float]]) -> str:
    if not costs:
        return ""
    most = max(seconds for _, seconds, _ in costs) or 1.0
    rows = "".join(
        f"<tr><td>{html.escape(stage)}</td><td>{seconds:.1f}</td><td>{megabytes:.0f}</td>"
        f'<td><span class="bar" style="width:{160 * seconds / most:.0f}px"></span></td></tr>'
        for stage, seconds, megabytes in costs
    )
    total = sum(seconds for _, seconds, _ in costs)
    return _section(
        "Time and memory",
        f"<p>{total:.0f} seconds of all jobs together, when the work was done; some jobs use several cores.</p>",
        f"<table><tr><th>stage</th><th>seconds</th><th>peak MB</th><th></th></tr>{rows}</table>",
    )


_STYLE = """
body{margin:0;background:#f4f4f2;color:#222;font:15px/1.5 system-ui,sans-serif}
main{max-width:1100px;margin:0 auto;padding:1rem}
h1{margin:.5rem 0;overflow-wrap:anywhere}h2{font-size:1.1rem;margin:1.6rem 0 .4rem}
.viewer iframe,.viewer img{width:100%;height:min(70vh,620px);border:0;border-radius:8px;object-fit:contain}
.viewer [hidden]{display:none}
button{font:inherit;margin:0 .3rem .3rem 0;padding:.2rem .7rem;border:1px solid #bbb;border-radius:5px;background:#fff}
table{border-collapse:collapse;display:block;overflow-x:auto}
td,th{padding:.15rem .9rem .15rem 0;text-align:left;vertical-align:top}
tr.bad td:first-child,p.bad{color:#a3241a;font-weight:600}tr.good td:first-child{color:#20662f}
#keyframes{display:grid;grid-template-columns:repeat(auto-fill,minmax(210px,1fr));gap:.6rem}
#keyframes img{display:none;width:100%;border-radius:5px}
figure{margin:0}figcaption{font-size:.8rem;color:#666}
svg{max-width:420px;background:#fff;border-radius:8px}
.bar{display:inline-block;height:.7em;background:#7a9cc6}
"""
