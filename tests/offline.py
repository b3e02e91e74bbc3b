"""What a page would load, read from its text."""

import re
from html.parser import HTMLParser


class Links(HTMLParser):
    """Collects what a browser would load."""

    def __init__(self):
        super().__init__()
        self.loaded, self.frames = [], []

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        self.loaded += [attrs[key] for key in ("src", "href", "data", "xlink:href") if key in attrs and tag != "a"]
        if tag == "iframe":
            self.frames.append(attrs["srcdoc"])


def assert_offline(page):
    """Nothing but what is inside the page, and a policy that says so; returns its links."""
    links = Links()
    links.feed(page)
    assert all(link.startswith(("data:", "#")) for link in links.loaded), links.loaded
    styles = "".join(re.findall(r"<style>(.*?)</style>", page, re.DOTALL))
    assert "url(" not in styles.replace("url(#", "")
    assert "@import" not in styles
    assert "Content-Security-Policy" in page
    return links
