"""What a result says beside its numbers: one form for warnings, findings and guards, in text, JSON and reports."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from shipid.foundation.aliases import Plain

#: The kind of a sentence that names none.
NOTE = "note"


class Notice(str):
    """A sentence about a result, with its kind; it is the sentence wherever text is wanted.

    Attributes
    ----------
    kind : str
        What it is about, in lower case with hyphens: ``"noise-does-not-fit"``. Programs read it, and it does not change.
    serious : bool
        Whether the numbers beside it are not to be used as they are. The command then ends with `ExitCode.DOUBTFUL`.
    known : mapping of str to plain values
        What else is known: numbers, names of coefficients, the trial.
    """

    kind: str
    serious: bool
    known: Mapping[str, Plain]

    def __new__(cls, message: str, kind: str = NOTE, *, serious: bool = False, **known: Plain) -> Notice:
        """Make a notice of its sentence.

        Parameters
        ----------
        message : str
            One sentence or two, with their numbers and units.
        kind, serious, **known
            See the class.
        """
        notice = super().__new__(cls, message)
        notice.kind, notice.serious, notice.known = kind, serious, known
        return notice

    def about(self, subject: str) -> Notice:
        """Return the notice with the name of what it is about before it.

        Parameters
        ----------
        subject : str
            A ship, a condition, a file.
        """
        return Notice(f"{subject}: {self}", self.kind, serious=self.serious, **{"subject": subject, **self.known})

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values: ``kind``, ``serious``, ``message``, and what else is known."""
        return {"kind": self.kind, "serious": self.serious, "message": str(self), **self.known}


def notice_of(sentence: str) -> Notice:
    """Return a sentence as a notice; one that names no kind is a note.

    Parameters
    ----------
    sentence : str or Notice
        The sentence.
    """
    return sentence if isinstance(sentence, Notice) else Notice(sentence)


def plain_notices(sentences: Iterable[str]) -> list[dict[str, Plain]]:
    """Return the list of ``warnings`` of a result, for its `to_dict`.

    Parameters
    ----------
    sentences : iterable of str or Notice
        In the order in which they are told.
    """
    return [notice_of(s).to_dict() for s in sentences]
