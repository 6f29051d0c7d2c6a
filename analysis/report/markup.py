"""HTML from plain values: everything that is text is escaped, nothing else is invented."""

from __future__ import annotations

import base64
import html
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import pandas as pd

Cell = Callable[[Any], str]


class Markup(str):
    """Text that is already HTML."""

    __slots__ = ()


def text(value: object) -> Markup:
    """`value` as HTML text; Markup stays as it is."""
    return value if isinstance(value, Markup) else Markup(html.escape(str(value), quote=True))


def element(tag: str, *children: object, **attributes: object) -> Markup:
    """`<tag attribute="...">children</tag>`; a trailing underscore of an attribute's name is dropped."""
    written = "".join(f' {name.rstrip("_")}="{text(value)}"' for name, value in attributes.items())
    return Markup(f"<{tag}{written}>{''.join(text(child) for child in children)}</{tag}>")


def join(parts: Iterable[object], between: str = "\n") -> Markup:
    return Markup(between.join(text(part) for part in parts))


def bullets(items: Sequence[object], **attributes: object) -> Markup:
    return element("ul", *(element("li", item) for item in items), **attributes)


def image(content: bytes, kind: str, description: str) -> Markup:
    """A picture inside the page; kind is its media type."""
    data = base64.b64encode(content).decode("ascii")
    return Markup(f'<img alt="{text(description)}" src="data:{kind};base64,{data}">')


def table(data: pd.DataFrame, columns: Mapping[str, tuple[object, Cell]], emphasis: Sequence[bool] = ()) -> Markup:
    """Rows of `data` as a table, emphasised ones bold; columns: name -> (heading, how values are written).

    A column whose writer is `text` is aligned left, all others right.
    """
    sides = {name: "left" if writer in (text, str) else "right" for name, (_, writer) in columns.items()}
    head = element(
        "tr", *(element("th", title, class_=sides[name], scope="col") for name, (title, _) in columns.items())
    )
    rows = []
    for place, values in enumerate(data[list(columns)].itertuples(index=False)):
        cells = [
            element("td", writer(value), class_=sides[name])
            for value, (name, (_, writer)) in zip(values, columns.items(), strict=True)
        ]
        rows.append(element("tr", *cells, class_="found" if place < len(emphasis) and emphasis[place] else "plain"))
    return element("div", element("table", element("thead", head), element("tbody", *rows)), class_="scroll")
