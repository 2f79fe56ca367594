"""The contract of docstrings (numpydoc): arguments, results, errors and attributes of everything public are described."""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SOURCES = sorted([*(ROOT / "shipid").rglob("*.py"), *(ROOT / "models").rglob("*.py")])
#: What a decorator makes of a function that is not called by its name: an equation, a command, a property's setter.
UNCALLED = re.compile(r"\.(rate|next|equals|instead|command|group|setter)\b|^overload$")


def section(doc: str, name: str) -> str | None:
    """The body of a numpydoc section, or None."""
    found = re.search(rf"^{name}\n-+\n(.*?)(?=^\S[^\n]*\n-+\n|\Z)", inspect.cleandoc(doc), re.MULTILINE | re.DOTALL)
    return found and found[1]


def described(doc: str, name: str) -> set[str]:
    """Names that a section describes."""
    heads = [line.partition(":")[0] for line in (section(doc, name) or "").splitlines() if line[:1].strip()]
    return {part.strip().lstrip("*") for head in heads for part in head.split(",")}


def arguments(function: ast.FunctionDef) -> set[str]:
    a = function.args
    every = [*a.posonlyargs, *a.args, *a.kwonlyargs, *filter(None, (a.vararg, a.kwarg))]
    return {x.arg for x in every} - {"self", "cls"}


def raised(function: ast.FunctionDef) -> set[str]:
    """Names of the errors a function raises itself."""
    found = set()
    for node in ast.walk(function):
        if isinstance(node, ast.Raise) and node.exc is not None:
            error = node.exc.func if isinstance(node.exc, ast.Call) else node.exc
            name = error.id if isinstance(error, ast.Name) else getattr(error, "attr", "")
            if name.endswith("Error"):
                found.add(name)
    return found


def complaints(function: ast.FunctionDef) -> Iterator[str]:
    doc = ast.get_docstring(function) or ""
    decorators = [ast.unparse(d) for d in function.decorator_list]
    if not doc:
        yield "no docstring"
    listed, wanted = described(doc, "Parameters"), arguments(function)
    if listed != wanted:
        yield f"Parameters list {sorted(listed)}, and the arguments are {sorted(wanted)}"
    returns = "None" if function.returns is None else ast.unparse(function.returns)
    told = section(doc, "Returns") or section(doc, "Yields") or re.match(r"(Return|Yield)\b", doc)
    if returns not in ("None", "NoReturn") and not told and not any("property" in d for d in decorators):
        yield "it returns something, and neither a Returns section nor the summary says what"
    if lacking := raised(function) - described(doc, "Raises"):
        yield f"it raises {', '.join(sorted(lacking))}, which Raises does not list"


def is_public(function: ast.FunctionDef) -> bool:
    decorators = [ast.unparse(d) for d in function.decorator_list]
    return not any(UNCALLED.search(d) for d in decorators) and (
        not function.name.startswith("_") or function.name == "__call__"
    )


#: Class variables of every result, described once, by `Result`.
OF_RESULT = {"TABLE", "UNITS"}


def class_complaints(found: ast.ClassDef) -> Iterator[str]:
    doc = ast.get_docstring(found) or ""
    if len(doc.split()) < 3:
        yield f"{found.name}: no docstring"
    if any("dataclass" in ast.unparse(d) for d in found.decorator_list):
        fields = {x.target.id for x in found.body if isinstance(x, ast.AnnAssign) and isinstance(x.target, ast.Name)}
        if lacking := {f for f in fields - OF_RESULT if not f.startswith("_")} - described(doc, "Attributes"):
            yield f"{found.name}: Attributes do not list {', '.join(sorted(lacking))}"
    is_error = any(ast.unparse(b).endswith("Error") for b in found.bases)
    for member in found.body:
        if not isinstance(member, ast.FunctionDef):
            continue
        if member.name == "__init__" and not is_error and described(doc, "Parameters") != arguments(member):
            yield f"{found.name}: Parameters do not list the arguments of __init__"
        if is_public(member):
            yield from (f"{found.name}.{member.name}: {c}" for c in complaints(member))


def file_complaints(path: Path) -> list[str]:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    found = [] if ast.get_docstring(tree) else ["the file has no docstring"]
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and is_public(node):
            found += [f"{node.name}: {c}" for c in complaints(node)]
        elif isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            found += class_complaints(node)
    return [f"{path.relative_to(ROOT).as_posix()}: {words}" for words in found]


def test_everything_public_is_described() -> None:
    assert len(SOURCES) > 300
    found = [words for path in SOURCES for words in file_complaints(path)]
    assert not found, "\n".join(found)


def function_of(text: str) -> ast.FunctionDef:
    (found,) = ast.parse(inspect.cleandoc(text)).body
    assert isinstance(found, ast.FunctionDef)
    return found


GOOD = '''
def area(length: float, width: float) -> float:
    """Return the area.

    Parameters
    ----------
    length, width : float
        In m.

    Raises
    ------
    ValueError
        If one is negative.
    """
    if min(length, width) < 0:
        raise ValueError("negative")
    return length * width
'''


def test_the_contract_bites() -> None:
    assert list(complaints(function_of(GOOD))) == []
    for old, new, words in (
        ("length, width : float", "length : float", "Parameters list"),
        ("Return the area", "The area", "neither a Returns section"),
        ("    ValueError\n        If", "    KeyError\n        If", "it raises ValueError"),
        ('"""Return the area.', '"""', "neither a Returns section"),
    ):
        assert words in " ".join(complaints(function_of(GOOD.replace(old, new)))), new
