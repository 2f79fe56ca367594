"""Mutants of the sources: small changes of one line each, drawn over all rooms in proportion to their statements.

Cosmic Ray supplies the general operators; what numerical code needs besides (a transpose, a factor, two arguments, a returned
value) is added here by the same interface. Replacements that only raise a TypeError (``a << b`` for ``a + b``) are left out.

A mutant is drawn by a hash of its scope and its line, not by its place in the file: an edit elsewhere keeps the other mutants.
"""

from __future__ import annotations

import ast
import hashlib
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import parso
from cosmic_ray.ast import ast_nodes, get_ast
from cosmic_ray.mutating import mutate_code
from cosmic_ray.operators.operator import Example, Operator
from cosmic_ray.plugins import get_operator

CORE = {
    "ReplaceBinaryOperator": "Add_Sub Sub_Add Mul_Div Div_Mul Pow_Mul Mod_Mul FloorDiv_Mul BitAnd_BitOr BitOr_BitAnd",
    "ReplaceComparisonOperator": "Lt_LtE Lt_GtE LtE_Lt LtE_Gt Gt_GtE Gt_LtE GtE_Gt GtE_Lt Eq_NotEq NotEq_Eq Is_IsNot IsNot_Is",
    "ReplaceUnaryOperator": "Delete_USub Delete_Not Delete_Invert",
    "": "AddNot ReplaceTrueWithFalse ReplaceFalseWithTrue ReplaceAndWithOr ReplaceOrWithAnd ReplaceBreakWithContinue "
    "ReplaceContinueWithBreak ExceptionReplacer NumberReplacer ZeroIterationForLoop",
}
#: Nodes of the syntax tree that no operator changes, and those that are text.
INERT = {"name", "newline", "string", "fstring_string", "fstring_start", "fstring_end", "endmarker", "error_leaf"}
TEXT = {"string", "strings", "fstring"}


class DropTranspose(Operator):
    """``a.T`` becomes ``a``."""

    def mutation_positions(self, node: Any) -> Iterator[Any]:
        """Yield the trailer ``.T``."""
        if node.type == "trailer" and node.get_code(include_prefix=False) == ".T":
            yield node.start_pos, node.end_pos

    def mutate(self, node: Any, index: int) -> None:
        """Remove the trailer."""

    @classmethod
    def examples(cls) -> tuple[Example, ...]:
        """Show what it does."""
        return (Example("y = a.T @ b", "y = a @ b"),)


class DropFactor(Operator):
    """``a * b`` and ``a / b`` become ``a``."""

    def mutation_positions(self, node: Any) -> Iterator[Any]:
        """Yield each factor behind the first."""
        if node.type == "term":
            for k in self._places(node):
                yield node.children[k].start_pos, node.children[k + 1].end_pos

    def mutate(self, node: Any, index: int) -> Any:
        """Remove the factor with its operator."""
        k = self._places(node)[index]
        del node.children[k : k + 2]
        return node

    @staticmethod
    def _places(node: Any) -> list[int]:
        return [k for k, child in enumerate(node.children) if child.type == "operator" and child.value in ("*", "/")]

    @classmethod
    def examples(cls) -> tuple[Example, ...]:
        """Show what it does."""
        return (Example("y = a * b", "y = a"), Example("y = a * b / c", "y = a * b", occurrence=1))


class SwapArguments(Operator):
    """Two neighbouring positional arguments of a call change places, unless one is a text."""

    def mutation_positions(self, node: Any) -> Iterator[Any]:
        """Yield each pair of different arguments."""
        for k in self._places(node):
            yield node.children[k].start_pos, node.children[k + 2].end_pos

    def mutate(self, node: Any, index: int) -> Any:
        """Swap them, and leave the white space where it is."""
        k = self._places(node)[index]
        one, two = node.children[k], node.children[k + 2]
        first, second = one.get_first_leaf(), two.get_first_leaf()
        first.prefix, second.prefix = second.prefix, first.prefix
        node.children[k], node.children[k + 2] = two, one
        return node

    @staticmethod
    def _places(node: Any) -> list[int]:
        if node.type != "arglist" or node.parent.type != "trailer":
            return []
        plain = [c.type not in {"argument", *TEXT} for c in node.children]
        code = [c.get_code(include_prefix=False) for c in node.children]
        pairs = range(0, len(node.children) - 2, 2)
        return [k for k in pairs if plain[k] and plain[k + 2] and code[k] != code[k + 2]]

    @classmethod
    def examples(cls) -> tuple[Example, ...]:
        """Show what it does."""
        return (Example("f(a, b, c=1)", "f(b, a, c=1)"),)


class ReplaceReturn(Operator):
    """A returned sum, product or power becomes its negative, another value ``None``."""

    ARITHMETIC = ("arith_expr", "term", "factor", "power")

    def mutation_positions(self, node: Any) -> Iterator[Any]:
        """Yield the returned value."""
        if node.type == "return_stmt" and node.children[1].get_code(include_prefix=False) != "None":
            yield node.children[1].start_pos, node.children[1].end_pos

    def mutate(self, node: Any, index: int) -> Any:
        """Replace the value."""
        value = node.children[1]
        text = value.get_code(include_prefix=False)
        node.children[1] = parso.parse(f" -({text})" if value.type in self.ARITHMETIC else " None")
        return node

    @classmethod
    def examples(cls) -> tuple[Example, ...]:
        """Show what it does."""
        return (Example("return a + b", "return -(a + b)"), Example("return f(a)", "return None"))


OWN = (DropTranspose, DropFactor, SwapArguments, ReplaceReturn)
OPERATORS: dict[str, Operator] = {
    name: get_operator(f"core/{name}")()
    for family, kinds in CORE.items()
    for name in (f"{family}_{kind}" if family else kind for kind in kinds.split())
} | {own.__name__: own() for own in OWN}


@dataclass(frozen=True)
class Mutant:
    """One change of one line.

    Attributes
    ----------
    file : str
        The source file, relative to the root.
    scope : str
        Function or class that holds the line, with the classes around it.
    before, after : str
        The line as it is and as it becomes, without indentation.
    nth : int
        Which of the equal lines of the scope, from 0.
    operator : str
        Name of the operator.
    line : int
        Line number, from 1.
    statement : int
        Line number at which the statement begins.
    code : str
        The whole file with the change.
    """

    file: str
    scope: str
    before: str
    after: str
    nth: int
    operator: str
    line: int
    statement: int
    code: str

    @property
    def room(self) -> str:
        """Folder of the file."""
        return room_of(self.file)

    @property
    def key(self) -> tuple[str, str, str, str, int]:
        """What identifies it from one run to the next."""
        return self.file, self.scope, self.before, self.after, self.nth


def room_of(file: str) -> str:
    """Return the folder of a file, both relative to the root.

    Parameters
    ----------
    file : str
        The file.
    """
    return Path(file).parent.as_posix()


class Source:
    """A source file: its statements, scopes, and the places where nothing is changed.

    Parameters
    ----------
    root : Path
        Root of the tree.
    file : str
        The file, relative to the root.
    """

    def __init__(self, root: Path, file: str) -> None:
        self.file = file
        self.text = (root / file).read_text(encoding="utf-8")
        self.lines = self.text.split("\n")
        self.scope: dict[int, str] = defaultdict(str)
        self.statement: dict[int, int] = {}
        self.spared: list[tuple[tuple[int, int], tuple[int, int]]] = []
        self._visit(ast.parse(self.text), "")
        seen: Counter[tuple[str, str]] = Counter()
        self.nth: list[int] = []
        for number, line in enumerate(self.lines, 1):
            self.nth.append(seen[self.scope[number], line.strip()])
            seen[self.scope[number], line.strip()] += 1

    def _visit(self, node: ast.AST, scope: str) -> None:
        """Note the statement and the scope of each line, and what is spared: annotations, imports, errors, decorators."""
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            scope = f"{scope}.{node.name}".lstrip(".")
            self._spare(*node.decorator_list, getattr(node, "returns", None))
        elif isinstance(node, ast.Raise | ast.Import | ast.ImportFrom) or _warns(node):
            self._spare(node)
        elif isinstance(node, ast.arg | ast.AnnAssign):
            self._spare(node.annotation)
        if isinstance(node, ast.stmt):
            for line in range(node.lineno, (node.end_lineno or node.lineno) + 1):
                self.statement[line], self.scope[line] = node.lineno, scope
        for child in ast.iter_child_nodes(node):
            self._visit(child, scope)

    def _spare(self, *nodes: Any) -> None:
        for node in nodes:
            if node is not None:
                begin = self._place(node.lineno, node.col_offset)
                self.spared.append((begin, self._place(node.end_lineno, node.end_col_offset)))

    def _place(self, line: int, column: int) -> tuple[int, int]:
        """Line and column in characters; the syntax tree of Python counts bytes."""
        return line, len(self.lines[line - 1].encode()[:column].decode())

    def changes(self, executed: set[int]) -> dict[int, list[tuple[str, int]]]:
        """Return operator and occurrence of each possible change, by line.

        Parameters
        ----------
        executed : set of int
            Line numbers of the statements that tests execute.
        """
        found: dict[int, list[tuple[str, int]]] = defaultdict(list)
        counts: Counter[str] = Counter()
        for node in ast_nodes(get_ast(self.text)):
            if node.type in INERT or (node.type == "operator" and any(c.type in TEXT for c in node.parent.children)):
                continue
            for name, operator in OPERATORS.items():
                for begin, end in operator.mutation_positions(node):
                    one_line = begin[0] == end[0] and self.statement.get(begin[0]) in executed
                    if one_line and not any(a <= begin < b for a, b in self.spared):
                        found[begin[0]].append((name, counts[name]))
                    counts[name] += 1
        return found

    def mutant(self, line: int, operator: str, occurrence: int) -> Mutant | None:
        """Return a mutant, or None where the change is no Python or none of one line.

        Parameters
        ----------
        line : int
            Line number, from 1.
        operator : str
            Name of the operator.
        occurrence : int
            Which of the places that it finds in the file.
        """
        lines = (mutate_code(self.text, OPERATORS[operator], occurrence) or "").split("\n")
        differ = [k for k, (a, b) in enumerate(zip(self.lines, lines), 1) if a != b]
        if len(lines) != len(self.lines) or differ != [line]:
            return None
        before = self.lines[line - 1]
        lines[line - 1] = after = _tidy(before, lines[line - 1])
        code, nth = "\n".join(lines), self.nth[line - 1]
        if not _compiles(code):
            return None
        where = (line, self.statement[line])
        return Mutant(self.file, self.scope[line], before.strip(), after.strip(), nth, operator, *where, code)


def _tidy(before: str, after: str) -> str:
    """Leave out the space that an operator puts before what it writes where none was: ``a[ 2]``."""
    first = next((k for k, (a, b) in enumerate(zip(before, after)) if a != b), min(len(before), len(after)))
    return after[:first] + after[first:].lstrip(" ") if after[:first].endswith(tuple("([{=-+~ ")) else after


def _warns(node: ast.AST) -> bool:
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "warn"


def _compiles(code: str) -> bool:
    try:
        compile(code, "mutant", "exec")
    except SyntaxError:
        return False
    return True


def draw(root: Path, executed: Mapping[str, set[int]], quotas: Mapping[str, int], seed: int) -> list[Mutant]:
    """Draw mutants: so many of each room, at most one of each line.

    Parameters
    ----------
    root : Path
        Root of the tree.
    executed : mapping of str to set of int
        Line numbers of the statements that tests execute, by file.
    quotas : mapping of str to int
        How many of each room.
    seed : int
        Another seed draws others.

    Returns
    -------
    list of Mutant
        Fewer than asked where a room has no more.
    """
    drawn = []
    for room, quota in quotas.items():
        files = [f for f in executed if room_of(f) == room] if quota else []
        places = []
        for source in (Source(root, file) for file in files):
            for line, changes in source.changes(executed[source.file]).items():
                identity = f"{seed} {source.scope[line]} {source.lines[line - 1].strip()} {source.nth[line - 1]}"
                places.append((_hash(identity), source.file, line, identity, changes, source))
        taken = 0
        for *_, line, identity, changes, source in sorted(places, key=lambda p: p[:3]):
            # First which operator, then where in the line: a line of many numbers is not all numbers.
            order = sorted(
                range(len(changes)),
                key=lambda k: (_hash(f"{identity} {changes[k][0]}"), _hash(f"{identity} {k}")),
            )
            mutant = next(filter(None, (source.mutant(line, *changes[k]) for k in order)), None)
            if mutant:
                drawn.append(mutant)
                taken += 1
            if taken == quota:
                break
    return drawn


def quotas(statements: Mapping[str, int], number: int) -> dict[str, int]:
    """Share a number of mutants out to the rooms in proportion to their statements, by the largest remainders.

    Parameters
    ----------
    statements : mapping of str to int
        How many statements each room has.
    number : int
        How many mutants in all.
    """
    whole = sum(statements.values())
    exact = {room: number * n / whole for room, n in statements.items()}
    shares = {room: int(x) for room, x in exact.items()}
    rest = sorted(exact, key=lambda room: shares[room] - exact[room])[: number - sum(shares.values())]
    return {room: n + (room in rest) for room, n in shares.items()}


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
