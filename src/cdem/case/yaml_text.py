"""YAML texts as trees that know their lines; hostile texts are refused before they cost time."""

from __future__ import annotations

import io
import warnings
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.composer import Composer, ComposerError, MaxDepthExceededError
from ruamel.yaml.constructor import ConstructorError, DuplicateKeyError, RoundTripConstructor
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.events import AliasEvent
from ruamel.yaml.nodes import ScalarNode
from ruamel.yaml.scanner import RoundTripScanner, ScannerError

from cdem.errors import CaseError

DEEPEST = 40
"""Deepest nesting of lists and mappings; a case needs ten."""
REPEATED = 100_000
"""Most values that aliases may repeat."""
_CORE = "tag:yaml.org,2002:"
_KINDS = {f"{_CORE}{kind}" for kind in ("str", "int", "float", "bool", "null", "seq", "map")}
_TEXT = {f"{_CORE}timestamp", f"{_CORE}value"}  # texts like a date, and "="


class _Scanner(RoundTripScanner):
    """Stops at many open brackets: looking ahead over them takes quadratic time."""

    def fetch_flow_collection_start(self, TokenClass: Any, to_push: str) -> None:
        if len(self.flow_context) >= DEEPEST:
            raise ScannerError(
                None, None, f"more than {DEEPEST} open brackets", self.reader.get_mark()
            )
        super().fetch_flow_collection_start(TokenClass, to_push)


class _Composer(Composer):
    """Counts the values that aliases repeat, and refuses an alias inside its own anchor."""

    def __init__(self, loader: Any = None) -> None:
        super().__init__(loader)
        self._seen, self._repeated = 0, 0
        self._size: dict[str, int | None] = {}  # number of values of an anchor; None until its end

    def compose_node(self, parent: Any, index: Any) -> Any:
        event = self.parser.peek_event()
        anchor, before = event.anchor, self._seen
        if isinstance(event, AliasEvent):
            self._take_alias(anchor, event.start_mark)
            return super().compose_node(parent, index)
        self._seen += 1
        if anchor is not None:
            self._size[anchor] = None
        node = super().compose_node(parent, index)
        if anchor is not None:
            self._size[anchor] = self._seen - before
        return node

    def _take_alias(self, anchor: str, mark: Any) -> None:
        size = self._size.get(anchor, 0)
        if size is None:
            raise ComposerError(None, None, f"*{anchor} is inside its own anchor", mark)
        self._seen += size
        self._repeated += size
        if self._repeated > REPEATED:
            raise ComposerError(None, None, f"aliases repeat more than {REPEATED:,} values", mark)


class _Constructor(RoundTripConstructor):
    """Builds texts, numbers, lists and mappings, and nothing else; dates stay texts."""

    def construct_non_recursive_object(self, node: Any, tag: str | None = None) -> Any:
        kind = tag or node.tag
        if kind in _TEXT and isinstance(node, ScalarNode):
            return self.construct_scalar(node)
        if kind not in _KINDS:
            tag = kind.replace(_CORE, "!!")
            raise ConstructorError(
                None, None, f"the tag {tag} is not allowed; remove it", node.start_mark
            )
        try:
            return super().construct_non_recursive_object(node, tag)
        except YAMLError:
            raise
        except (ValueError, LookupError, ArithmeticError, AttributeError, TypeError):
            kind = kind.removeprefix(_CORE)
            raise ConstructorError(
                None, None, f"this is not a valid {kind}", node.start_mark
            ) from None


def parse(text: str, name: str) -> Any:
    """Read a YAML text.

    Args:
        text: One document.
        name: Name of the text in an error.

    Returns:
        Nested mappings and lists of ruamel.yaml, which know their lines, and scalars.

    Raises:
        CaseError: Not YAML, a repeated key, tags other than plain data, too much nesting, or
        aliases that repeat too much.
    """
    yaml = YAML(typ="rt", pure=True)
    yaml.Scanner, yaml.Composer, yaml.Constructor = _Scanner, _Composer, _Constructor
    yaml.max_depth = DEEPEST
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return yaml.load(io.StringIO(text))
    except DuplicateKeyError as error:
        key = str(error.problem).partition('"')[2].partition('"')[0]
        raise CaseError(
            f"{_mark(name, error.problem_mark)}: {key}: this key is given twice; keep one"
        ) from None
    except MaxDepthExceededError as error:
        raise CaseError(
            f"{_mark(name, error.problem_mark)}: more than {DEEPEST} nested lists and mappings; "
            "look for superfluous brackets and dashes"
        ) from None
    except MarkedYAMLError as error:
        what = " ".join(filter(None, (error.context, error.problem)))
        place = _mark(name, error.problem_mark or error.context_mark)
        raise CaseError(
            f"{place}: not valid YAML: {what}; look at the indentation, brackets, quotes and "
            "colons here and just above"
        ) from None
    except TypeError:  # ruamel.yaml lets a list or mapping be a key, and fails later
        raise CaseError(
            f"{name}: not valid YAML here: a list or mapping is used as a key"
        ) from None
    except YAMLError as error:
        raise CaseError(f"{name}: not valid YAML: {str(error).splitlines()[0]}") from None


def _mark(name: str, mark: Any) -> str:
    return f"{name}:{mark.line + 1}:{mark.column + 1}" if mark is not None else name
