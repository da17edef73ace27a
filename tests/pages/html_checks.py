"""What must hold of every page, read by the standard library's parser."""

import re
from html.parser import HTMLParser
from itertools import pairwise

VOID = {"meta", "link", "img", "br", "input", "path", "rect", "circle", "line", "hr"}
FETCHING = {"src", "srcset", "data", "poster", "action", "background"}


class Page(HTMLParser):
    """Tags of a page, whether they are nested rightly, and its text."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.tags, self.open, self.wrong, self.text = [], [], [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.wrong.append((tag, self.getpos()))

    def handle_data(self, data):
        self.text.append(data)

    def all(self, tag):
        """Attributes of every element of a kind."""
        return [attrs for name, attrs in self.tags if name == tag]

    @property
    def words(self):
        """The text, white space as single spaces."""
        return " ".join("".join(self.text).split())


def check(text, scripts):
    """Well-formed, self-contained, named for who cannot see; nothing of the hostile names acts.

    `scripts`: how many there are, data (JSON) not counted.
    """
    page = Page(text)
    assert page.wrong == []
    assert page.open == []
    assert len([attrs for attrs in page.all("script") if attrs.get("type") != "application/json"]) == scripts
    for tag, attrs in page.tags:
        assert not [name for name in attrs if name.startswith("on")], (tag, attrs)
        for name in FETCHING & set(attrs):
            assert attrs[name].startswith("data:"), (tag, name, attrs[name][:80])
        assert "://" not in (attrs.get("href") or ""), attrs
    assert "@import" not in text
    assert "url(" not in text
    assert page.all("html")[0]["lang"] == "en"
    assert len(page.all("h1")) == len(page.all("main")) == len(page.all("title")) == 1
    levels = [int(tag[1]) for tag, _ in page.tags if re.fullmatch("h[1-6]", tag)]
    assert all(after <= before + 1 for before, after in pairwise(levels)), levels
    assert len(page.all("caption")) == len(page.all("table"))
    assert all("scope" in attrs for attrs in page.all("th"))
    assert all(attrs.get("alt") for attrs in page.all("img"))
    assert all(attrs.get("aria-label") for attrs in page.all("svg"))
    ids = [attrs["id"] for _, attrs in page.tags if "id" in attrs]
    assert len(ids) == len(set(ids))
    known = set(ids)
    for _, attrs in page.tags:
        for name in ("aria-labelledby", "aria-describedby", "aria-controls", "for"):
            assert set((attrs.get(name) or "").split()) <= known, attrs
        if (attrs.get("href") or "").startswith("#"):
            assert attrs["href"][1:] in known
    return page
