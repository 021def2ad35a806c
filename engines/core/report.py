"""A run's report: one HTML file with its pictures, plots and figures, which needs no network."""

import base64
import html
import io
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import plotly.graph_objects as go
import plotly.offline
from PIL import Image

from .table import load_csv

STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #222; margin: 2.5rem auto; max-width: 70rem;
  padding: 0 1.5rem; }
h1 { font-size: 1.7rem; margin: 0 0 .2rem; } h2 { font-size: 1.15rem; margin: 2.2rem 0 .6rem; }
.quiet { color: #666; }
.note { border-left: 3px solid #c80; padding: .2rem .8rem; margin: .4rem 0; }
.pictures { display: flex; flex-wrap: wrap; gap: 1.2rem; } figure { margin: 0; flex: 1 1 24rem; }
figure img { width: 100%; max-width: 42rem; } figcaption { color: #666; font-size: .85rem; }
table { border-collapse: collapse; } td, th { padding: .2rem 1rem .2rem 0; text-align: left;
  border-bottom: 1px solid #e4e4e4; }
td.number { text-align: right; font-variant-numeric: tabular-nums; }
"""


def write_report(folder: Path, summary: Mapping[str, Any], pictures: Sequence[str]) -> None:
    """Write ``report.html`` into ``folder`` from what result.json says.

    ``pictures`` are names of PNG and CSV files in ``folder``: the former are embedded, the latter
    plotted against their first column.
    """
    images = [name for name in pictures if name.endswith(".png")]
    tables = [name for name in pictures if name.endswith(".csv")]
    body = [_head(summary)]
    body.append(_facts(summary["facts"]))
    body += [f'<p class="note">{html.escape(note)}</p>' for note in summary["notes"]]
    body.append('<div class="pictures">')
    body += [_picture(folder, name) for name in images]
    body.append("</div>")
    body += [_plot(folder, name) for name in tables]
    body += ["<h2>Figures</h2>", _figures(summary["figures"])]
    body += ["<h2>Files</h2>", "<p>" + ", ".join(map(html.escape, summary["files"])) + "</p>"]
    page = (
        "<!doctype html><html lang='en'><head><meta charset='utf-8'>"
        f"<title>{html.escape(summary['title'])}</title><style>{STYLE}</style>"
        + (f"<script>{plotly.offline.get_plotlyjs()}</script>" if tables else "")
        + "</head><body>"
        + "\n".join(body)
        + "</body></html>"
    )
    (folder / "report.html").write_text(page, encoding="utf-8")


def _head(summary: Mapping[str, Any]) -> str:
    quick = " · quick look" if summary["quick"] else ""
    study = summary["study"]
    named = f"Study “{html.escape(study)}” · " if study not in ("study", summary["title"]) else ""
    return (
        f"<h1>{html.escape(summary['title'])}</h1><p>{html.escape(summary['about'])}</p>"
        f"<p class='quiet'>{named}Heliform {summary['heliform']}"
        f" · seed {summary['seed']} · {summary['seconds']:.1f} s{quick}</p>"
    )


def _facts(facts: Mapping[str, str]) -> str:
    """What the results are of, a row each."""
    if not facts:
        return ""
    rows = [
        f"<tr><th>{html.escape(name)}</th><td>{html.escape(text)}</td></tr>"
        for name, text in facts.items()
    ]
    return "\n".join(["<table>", *rows, "</table>"])


def _picture(folder: Path, name: str) -> str:
    """A picture below which stands what it says that it is, else its file's name."""
    data = (folder / name).read_bytes()
    with Image.open(io.BytesIO(data)) as picture:
        caption = html.escape(picture.info.get("Title", name))
    text = base64.b64encode(data).decode("ascii")
    return (
        f'<figure><img alt="{caption}" src="data:image/png;base64,{text}">'
        f"<figcaption>{caption}</figcaption></figure>"
    )


def _plot(folder: Path, name: str) -> str:
    """A chart of every column against the first; “lower” and “upper” become a band."""
    columns, meta = load_csv(folder / name)
    (first, along), *curves = columns.items()
    figure = go.Figure()
    bounds = {key.split(" ")[0].lower(): key for key in columns}
    if {"lower", "upper"} <= set(bounds):
        clear = {"mode": "lines", "line": {"width": 0}, "hoverinfo": "skip"}
        figure.add_scatter(x=along, y=columns[bounds["lower"]], showlegend=False, **clear)
        band = {"fill": "tonexty", "fillcolor": "rgba(33,145,140,.25)", "name": "95 % interval"}
        figure.add_scatter(x=along, y=columns[bounds["upper"]], **clear, **band)
    for label, values in curves:
        if label not in (bounds.get("lower"), bounds.get("upper")):
            figure.add_scatter(x=along, y=values, mode="lines", name=label)
    figure.update_layout(
        template="plotly_white", height=380, margin={"l": 60, "r": 20, "t": 20, "b": 50}
    )
    figure.update_xaxes(title=first)
    figure.update_yaxes(rangemode="tozero")
    chart = figure.to_html(full_html=False, include_plotlyjs=False)
    return f"<h2>{html.escape(str(meta.get('title', name)))}</h2>{chart}"


def _figures(figures: Mapping[str, Mapping[str, Any]]) -> str:
    """A row a figure, its key in result.json where the mouse rests; ± only where some have it."""
    sure = any("uncertainty" in figure for figure in figures.values())
    head = ["figure", "value", *["± 95 %"] * sure, "unit"]
    rows = ["<table><tr>" + "".join(f"<th>{name}</th>" for name in head) + "</tr>"]
    for name, figure in figures.items():
        title = html.escape(figure.get("title", name))
        cells = [f"<td title='{html.escape(name)}'>{title}</td>", _cell(figure["value"], 6)]
        cells += [_cell(figure.get("uncertainty", math.nan), 3)] * sure
        rows.append(f"<tr>{''.join(cells)}<td>{html.escape(figure['unit'])}</td></tr>")
    return "\n".join([*rows, "</table>"])


def _cell(value: float, digits: int) -> str:
    text = f"{value:.{digits}g}" if math.isfinite(value) else ""
    return f"<td class='number'>{text}</td>"
