"""`.. schema-reference:: case`: every key of a case or study, from what `cdem schema` prints.

Parts are ordered and named by the path that leads to them, as `model.blocks[].box`.
"""

import json
import re

from docutils import nodes
from docutils.parsers.rst import Directive
from tables import paragraph, section, table, words

LIMITS = (("exclusiveMinimum", ">"), ("minimum", "≥"), ("exclusiveMaximum", "<"), ("maximum", "≤"))
KINDS = {"string": "text", "boolean": "true or false", "integer": "whole number"}
PAIR = "InterfacePair"
"""Parts of this name are those of an interface with keys that name the pair."""


class Reference:
    """Makes the sections of a schema; each part is described where a path first leads to it."""

    def __init__(self, schema):
        self.parts = schema.get("$defs", {})
        self.schema = schema
        self.seen = set()

    def sections(self):
        """The table of all keys, then a section for each key that has parts, with those in it."""
        yield section("Keys", "keys", self.keys(self.schema["properties"], self.schema))
        for key, value in self.schema["properties"].items():
            first, *others = [*self.of_value(value, key), None]
            if first is not None:
                first.extend(others[:-1])
                yield first

    def of_value(self, value, path):
        """Sections of the parts that a value may be, and of theirs."""
        if "$ref" in value and (name := _name(value)) not in self.seen:
            self.seen.add(name)
            yield from self.of_part(name, path)
        if "items" in value:
            yield from self.of_value(value["items"], f"{path}[]")
        if isinstance(value.get("additionalProperties"), dict):
            yield from self.of_value(value["additionalProperties"], f"{path}.NAME")
        for one in _choices(value):
            yield from self.of_value(one, path)

    def of_part(self, name, path):
        """The section of a part, and those of its parts."""
        part = self.parts[name]
        law = self.law(name)
        heading = [nodes.literal("", path)] + ([nodes.Text(f", law {law}")] if law else [])
        text = part.get("description", "").split("\n\n")[0]
        properties = part.get("properties", {})
        if name.startswith(PAIR):
            self.seen |= {other for other in self.parts if other.startswith(PAIR)}
            common = self.parts[name.replace(PAIR, "Interface")]["properties"]
            properties = {k: v for k, v in properties.items() if k not in common}
            heading = [nodes.literal("", path)]
            text = "The keys of a law, as in `interfaces.default`, and the place where it holds."
        yield section(heading, self.id(name), paragraph(text), self.keys(properties, part))
        for key, inner in properties.items():
            yield from self.of_value(inner, f"{path}.{key}")

    def keys(self, properties, part):
        """The table of the keys of a part."""
        needed = part.get("required", [])
        rows = [
            [
                [nodes.literal("", key)],
                self.kind(value),
                [nodes.strong("", "needed")] if key in needed else _default(value),
                words(value.get("description", "")),
            ]
            for key, value in properties.items()
        ]
        return table(("key", "value", "default", "meaning"), rows, (18, 24, 16, 42))

    def kind(self, value):
        """What may stand for a value, as nodes."""
        if "$ref" in value:
            return [self.link(_name(value))]
        if "unit" in value and "anyOf" in value:
            return [nodes.Text(_number(value))]
        if choices := _choices(value):
            return _joined([self.kind(one) for one in choices if one.get("type") != "null"])
        if value.get("type") == "array":
            count = value.get("minItems") == value.get("maxItems") and value.get("minItems")
            prefix = f"{count} of: " if count else "list of: "
            return [nodes.Text(prefix), *self.kind(value.get("items", {}))]
        if isinstance(value.get("additionalProperties"), dict):
            return [nodes.Text("by name: "), *self.kind(value["additionalProperties"])]
        return _simple(value)

    def link(self, name):
        """A link to a part: its law, or its name in words."""
        text = self.law(name) or re.sub(r"(?<!^)(?=[A-Z])", " ", name).lower()
        return nodes.reference("", "", nodes.Text(text), refid=self.id(name), internal=True)

    def id(self, name):
        """Anchor of a part on the page; pairs of all laws have one."""
        return nodes.make_id(f"part-{PAIR if name.startswith(PAIR) else name}")

    def law(self, name):
        """The law that a part is of, or None."""
        law = self.parts[name].get("properties", {}).get("law", {})
        return law.get("const") or law.get("default")


def _name(value):
    return value["$ref"].rsplit("/", 1)[1]


def _choices(value):
    return value.get("anyOf") or value.get("oneOf") or []


def _simple(value):
    """One of some words, or a plain kind with its limits."""
    if allowed := value.get("enum") or [value[key] for key in ("const",) if key in value]:
        return _joined([[nodes.literal("", str(one))] for one in allowed])
    kind = value.get("type", "any value")
    return [nodes.Text(" ".join([KINDS.get(kind, kind), *_limits(value)]))]


def _joined(kinds):
    """Kinds of which each may stand, each once."""
    out, texts = [], set()
    for kind in kinds:
        text = "".join(node.astext() for node in kind)
        if text not in texts:
            out += ([nodes.Text(" or ")] if out else []) + kind
        texts.add(text)
    return out


def _limits(value):
    return [f"{sign} {value[key]:g}" for key, sign in LIMITS if key in value]


def _number(value):
    """Unit and range of a quantity."""
    plain = next((one for one in value["anyOf"] if one.get("type") in ("number", "integer")), {})
    auto = ["auto or"] if {"const": "auto"} in value["anyOf"] else []
    unit = [] if value["unit"] == "1" else [f"[{value['unit']}]"]
    return " ".join([*auto, "number", *unit, *_limits(plain)])


def _default(value):
    default = value.get("default")
    if isinstance(default, dict) and default.keys() == {"value", "relative"}:
        default = "auto"  # a stiffness
    if default is None or isinstance(default, dict) or default == []:
        return []
    if isinstance(default, list) and len(default) > 6:
        return [nodes.Text("all")]
    return [nodes.literal("", default if isinstance(default, str) else json.dumps(default))]


class SchemaReference(Directive):
    """The directive; its argument is what `cdem schema` takes."""

    required_arguments = 1

    def run(self):
        """Sections of the whole schema."""
        from cdem.case.case import Case
        from cdem.fit.fitting import Fit
        from cdem.rockfall.rockfall import Rockfall
        from cdem.screening.uncertain import Uncertain
        from cdem.study.study import Study

        kinds = {"case": Case, "study": Study, "fit": Fit}
        kinds |= {"rockfall": Rockfall, "uncertain": Uncertain}
        return list(Reference(kinds[self.arguments[0]].schema()).sections())


def setup(app):
    """Called by Sphinx."""
    app.add_directive("schema-reference", SchemaReference)
    return {"parallel_read_safe": True}
