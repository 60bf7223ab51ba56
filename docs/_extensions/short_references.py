"""References in docstrings: `name` finds the documented object with a longer name.

A docstring says `Solutions` or `Arm.with_payload` for what the pages list as
``alpha5_model.kinematics.ik.Solutions`` and so on. A name that no page documents must
exist in the package; it is shown as code. Any other name is left to Sphinx, which
warns.
"""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.ext.napoleon import GoogleDocstring

#: Packages whose names docstrings mention; their documentation is elsewhere.
OTHERS = ("jax", "casadi", "numpy", "pinocchio", "pin", "matplotlib", "meshcat")
ATTRIBUTES = GoogleDocstring._parse_attributes_section
PACKAGE = Path(__file__).resolve().parents[2] / "alpha5_model"


@cache
def names() -> frozenset[str]:
    """Every name of the package's code: modules, definitions, arguments, attributes."""
    found = set()
    for path in PACKAGE.rglob("*.py"):
        found |= {path.stem, path.parent.name}
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            for field in ("name", "id", "attr", "arg"):
                value = getattr(node, field, None)
                if isinstance(value, str):
                    found.add(value)
    return frozenset(found)


def resolve(app: Any, env: Any, node: Any, content: Any) -> Any:
    """A link to the nearest documented object whose name ends in the target."""
    if node.get("refdomain") != "py":
        return None
    target = node["reftarget"].lstrip(".~")
    domain = env.domains["py"]
    places = [node.get("py:class"), node.get("py:module")]
    here = ".".join(place for place in places if place)
    matches = sorted(
        (name for name in domain.objects if f".{name}".endswith(f".{target}")),
        key=lambda name: (-common(name, here), len(name), name),
    )
    if matches:
        return reference(app, node, content, domain.objects[matches[0]])
    if target.rpartition(".")[2] in names() or target.partition(".")[0] in OTHERS:
        return content
    return None


def common(name: str, here: str) -> int:
    """Length of the shared beginning."""
    return next(
        (i for i, (a, b) in enumerate(zip(name, here, strict=False)) if a != b), 0
    )


def reference(app: Any, node: Any, content: Any, entry: Any) -> nodes.reference:
    """A link to a documented object."""
    uri = app.builder.get_relative_uri(node["refdoc"], entry.docname)
    return nodes.reference(
        "",
        "",
        content,
        internal=True,
        refuri=f"{uri}#{entry.node_id}",
        reftitle=node["reftarget"],
    )


def skip_fields(
    _app: Any, what: str, _name: str, member: Any, _skip: bool, _options: Any
) -> Any:
    """Leave out the fields of named tuples: their meaning stands under Attributes."""
    return True if what == "class" and type(member).__name__ == "_tuplegetter" else None


def returned(
    section: Any, preprocess_types: bool = False
) -> list[tuple[str, str, list[str]]]:
    """The text under Returns, unchanged.

    Napoleon would take words before a colon for a type.
    """
    del preprocess_types
    lines = section._dedent(section._consume_to_next_section())
    return [("", "", lines)] if any(lines) else []


def property_text(section: Any) -> tuple[str, list[str]]:
    """The text of a property as it stands, for the same reason."""
    lines = []
    while section._lines:
        lines.append(section._lines.next())
    return "", lines


def reshape(
    _app: Any, what: str, _name: str, _object: Any, _options: Any, lines: list[str]
) -> None:
    """Indented blocks of a module as code, the entries under References as a list."""
    if what == "module":
        before = [""]
        for line in tuple(lines):
            if (
                line.startswith("    ")
                and not before[-1]
                and not before[-2].startswith("    ")
            ):
                before += ["::", ""]
            before.append(line)
        lines[:] = before[1:]
    start = lines.index("References:") + 1 if "References:" in lines else len(lines)
    for i, line in enumerate(lines[start:], start):
        if line.startswith(" "):
            entry = line.lstrip()
            lines[i] = f"    - {entry}" if entry.startswith("[") else f"      {entry}"


def mend_ways_back(
    app: Any, page: str, _template: str, context: Any, _doctree: Any
) -> None:
    """Mend the links from the page of a source back to the documented objects."""
    if not page.startswith("_modules/") or "body" not in context:
        return
    documented = app.env.domains["py"].objects

    def mended(link: re.Match[str]) -> str:
        target = f"{link[2]}.html"
        name = link[3].removeprefix("alpha5_model.")
        for known, entry in documented.items():
            if target.endswith(f"/{entry.docname}.html") and known.endswith(f".{name}"):
                return f"{link[1]}{target}#{entry.node_id}"
        return link[0]

    context["body"] = re.sub(
        r'(class="viewcode-back" href=")([^"#]+)\.html#([^"]+)', mended, context["body"]
    )


def each_attribute(section: Any, name: str) -> list[str]:
    """An entry for each attribute, even if several are described in one line."""
    together = section._consume_fields
    section._consume_fields = lambda: together(multiple=True)
    lines: list[str] = ATTRIBUTES(section, name)
    section._consume_fields = together
    return lines


def setup(app: Any) -> dict[str, Any]:
    """Sphinx's entry point."""
    GoogleDocstring._parse_attributes_section = each_attribute  # type: ignore[method-assign]
    GoogleDocstring._consume_returns_section = returned  # type: ignore[method-assign]
    GoogleDocstring._consume_inline_attribute = property_text  # type: ignore[method-assign]
    app.connect("missing-reference", resolve)
    app.connect("autodoc-skip-member", skip_fields)
    app.connect("html-page-context", mend_ways_back)
    app.connect("autodoc-process-docstring", reshape, priority=100)
    return {"parallel_read_safe": True}
