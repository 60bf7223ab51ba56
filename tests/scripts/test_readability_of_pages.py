"""`scripts/checks/readability.py` counts texts whose figures are known."""

from __future__ import annotations

import subprocess

import pytest
from checks import readability

#: Two sentences of 4 and 6 words; "joints" has six letters, "gripper" seven.
PAGE = """# A heading with many words that count for nothing

The arm has joints. Its gripper holds a heavy payload.

- One item.

| a table | of cells |
|---|---|

```python
code = "is not read"
```
"""


def test_a_page_of_known_counts():
    found = readability.readability(PAGE)
    assert (found.words, found.paragraph, found.item, found.sentence) == (12, 10, 2, 6)
    sentences, long_words = 3, 2  # gripper, payload
    assert found.lix == pytest.approx(12 / sentences + 100 * long_words / 12)


def test_hyphens_and_digits_are_no_letters():
    assert readability.letters("self-collision") == 13
    assert readability.lix(["It is 1234567 mm."]) == pytest.approx(3.0)
    assert readability.lix([]) == 0.0


def test_longer_words_and_sentences_are_harder():
    easy = readability.readability("It is a cat. It is a dog.")
    hard = readability.readability("It is a caterpillar, it is a dog.")
    assert hard.lix > easy.lix


def git(folder, *arguments):
    me = ["-c", "user.name=me", "-c", "user.email=me@example.org"]
    subprocess.run(["git", "-C", folder, *me, *arguments], check=True)


def test_a_revision_is_counted_as_it_was(tmp_path, monkeypatch, capsys):
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "page.md").write_text("One two three.\n")
    (tmp_path / "notes.md").write_text("Not a page.\n")
    git(tmp_path, "init", "--quiet")
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "--quiet", "--message=first")
    (tmp_path / "docs" / "page.md").write_text("One two.\n")
    monkeypatch.setattr(readability, "REPOSITORY", tmp_path)

    assert readability.main([]) == 0
    now = capsys.readouterr().out.splitlines()
    assert readability.main(["--revision", "HEAD"]) == 0
    before = capsys.readouterr().out.splitlines()

    assert now[0].split() == ["page", "words", "paragraph", "item", "sentence", "LIX"]
    assert now[1].split() == ["docs/page.md", "2", "2", "0", "2", "2"]
    assert before[1].split() == ["docs/page.md", "3", "3", "0", "3", "3"]
    assert len(now) == len(before) == 2


def test_an_unknown_revision_is_one_line(tmp_path, monkeypatch, capsys):
    git(tmp_path, "init", "--quiet")
    monkeypatch.setattr(readability, "REPOSITORY", tmp_path)
    assert readability.main(["--revision", "nowhere"]) == 1
    assert "nowhere" in capsys.readouterr().err
