"""Which encoding a text has that is no Unicode: by its letters, where they leave no doubt."""

from __future__ import annotations

import re

#: Runs of bytes that are no ASCII.
_RUNS = re.compile(rb"[\x80-\xff]+")
#: Two bytes of Shift-JIS whose first one is no letter of the western encodings: kana and the most frequent signs.
_JAPANESE = re.compile(rb"[\x81-\x9f][\x40-\x7e\x80-\xfc]")
#: Signs of Chinese and Japanese, and the wide forms of ASCII beside them.
_WIDE = re.compile(r"[\u3000-\u30ff\u3400-\u9fff\uff01-\uff60]")
#: Fewer letters leave doubt.
_FEWEST = 4


def legacy_encoding(data: bytes) -> str:
    """Return the encoding of a text that is not UTF-8.

    Parameters
    ----------
    data : bytes
        The text, or its beginning: whole lines.

    Returns
    -------
    str
        ``cp932`` (Japanese), ``gb18030`` (Chinese), ``cp1251`` (Cyrillic) where its letters are those of one of them; else
        ``cp1252``.
    """
    runs = _RUNS.findall(data)
    total = sum(map(len, runs))
    if total < _FEWEST:
        return "cp1252"
    if 2 * len(_JAPANESE.findall(data)) > total / 2 and _all_wide(data, "cp932"):
        return "cp932"
    if all(len(run) % 2 == 0 for run in runs) and _all_wide(data, "gb2312"):
        return "gb18030"
    cyrillic = sum(len(run) for run in runs if len(run) >= 3 and all(byte >= 0xC0 for byte in run))
    return "cp1251" if cyrillic > 0.8 * total else "cp1252"


def _all_wide(data: bytes, encoding: str) -> bool:
    """Whether a text can be read so, and holds nothing but ASCII and wide signs."""
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError:
        return False
    letters = [sign for sign in text if ord(sign) > 127 and sign not in "°±·×"]
    return len(letters) >= _FEWEST and all(_WIDE.match(sign) for sign in letters)
