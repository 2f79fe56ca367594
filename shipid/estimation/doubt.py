"""What speaks against a result of a filter."""

from __future__ import annotations

from dataclasses import dataclass

from shipid.foundation.aliases import Plain


@dataclass(frozen=True)
class Doubt:
    """One reason to doubt a result.

    Attributes
    ----------
    kind : str
        In one word: "rejected", "noise", "coefficient", "levels", "correlated".
    message : str
        One or two sentences with the numbers.
    serious : bool
        Whether the result must not be used as it stands.
    """

    kind: str
    message: str
    serious: bool = True

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values."""
        return {"kind": self.kind, "message": self.message, "serious": self.serious}

    def __str__(self) -> str:
        return self.message
