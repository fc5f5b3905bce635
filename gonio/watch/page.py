"""The page, which holds nothing of the session: it asks for all that it shows."""

from __future__ import annotations

import base64
import hashlib
import re
from dataclasses import dataclass
from functools import lru_cache


@dataclass(frozen=True)
class Page:
    """A page, and what the browser is to let it do.

    Attributes
    ----------
    html
        Itself.
    policy
        Its Content-Security-Policy: the scripts and styles that are in it, and no others.
    """

    html: bytes
    policy: str


@lru_cache(maxsize=1)
def page() -> Page:
    """Return the page."""
    from jinja2 import Environment, PackageLoader, PrefixLoader

    loaders = {"watch": PackageLoader("gonio", "watch"), "report": PackageLoader("gonio", "report")}
    environment = Environment(loader=PrefixLoader(loaders), autoescape=True)
    html = environment.get_template("watch/page.html").render()
    policy = (
        f"default-src 'none'; script-src {_hashes('script', html)}; "
        f"style-src {_hashes('style', html)}; img-src blob: data:; connect-src 'self'; "
        "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )
    return Page(html.encode(), policy)


def _hashes(tag: str, html: str) -> str:
    inline = re.findall(f"<{tag}>(.*?)</{tag}>", html, re.DOTALL)
    digests = [base64.b64encode(hashlib.sha256(text.encode()).digest()) for text in inline]
    return " ".join(f"'sha256-{digest.decode()}'" for digest in digests)
