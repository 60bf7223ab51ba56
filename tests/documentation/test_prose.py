"""The documentation's paragraphs and sentences are short."""

from __future__ import annotations

from pathlib import Path

import pytest
from checks.prose import prose, words

REPOSITORY = Path(__file__).parents[2]
PAGES = sorted(
    [REPOSITORY / "README.md", *(REPOSITORY / "docs").rglob("*.md")],
    key=lambda page: page.as_posix(),
)
#: Words of the longest paragraph, list item and sentence that are allowed.
PARAGRAPH = 80
ITEM = 40
SENTENCE = 30


def too_long(texts, most):
    return [f"{words(text)} words: {text[:80]}" for text in texts if words(text) > most]


@pytest.mark.parametrize(
    "page", PAGES, ids=lambda page: page.relative_to(REPOSITORY).as_posix()
)
def test_paragraphs_items_and_sentences_are_short(page):
    found = prose(page.read_text("utf-8"))
    assert too_long(found.paragraphs, PARAGRAPH) == []
    assert too_long(found.items, ITEM) == []
    assert too_long(found.sentences, SENTENCE) == []


def test_the_count_sees_what_is_long():
    long_sentence = "word " * 31
    page = f"""# A heading

{long_sentence}

- one item, with a [link](somewhere.md)
  on two lines
- {"word " * 41}

```sh
{long_sentence}
```

| a table | {long_sentence} |

One sentence. `code` begins another.
"""
    found = prose(page)
    assert [words(text) for text in found.paragraphs] == [31, 5]
    assert [words(text) for text in found.items] == [8, 41]
    assert found.items[0] == "one item, with a link on two lines"
    assert [words(text) for text in found.sentences] == [31, 2, 3, 8, 41]
    assert too_long(found.sentences, SENTENCE) == too_long(
        [long_sentence.strip(), "word " * 41], SENTENCE
    )
