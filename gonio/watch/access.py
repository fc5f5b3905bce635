"""Who may look, and who may act: a token in the address, and no page of another origin."""

from __future__ import annotations

import hmac
import ipaddress
import secrets
import socket
from dataclasses import dataclass, field

_OWN_SITES = (None, "none", "same-origin")


@dataclass(frozen=True)
class Access:
    """What a request has to show.

    On this machine alone everybody may look; from elsewhere only who knows the token may. To pause
    or stop needs the token in a header of its own, which no foreign page can send, everywhere.

    Attributes
    ----------
    host, port
        Where it is served.
    token
        The secret; a new one for each server.
    """

    host: str
    port: int
    token: str = field(default_factory=lambda: secrets.token_urlsafe(16))

    @property
    def is_local(self) -> bool:
        """Whether only this machine can reach it."""
        try:
            return ipaddress.ip_address(self.host).is_loopback
        except ValueError:
            return self.host == "localhost"

    @property
    def url(self) -> str:
        """Where to look at it, and act."""
        anywhere = self.host in ("", "0.0.0.0", "::")
        host = socket.gethostname() if anywhere else self.host
        named = f"[{host}]" if ":" in host else host
        return f"http://{named}:{self.port}/?token={self.token}"

    def refusal(
        self,
        *,
        host: str | None,
        origin: str | None,
        site: str | None,
        token: str | None,
        acts: bool,
    ) -> str | None:
        """Return why a request is refused; None where it is not.

        Parameters
        ----------
        host, origin
            Its headers of these names.
        site
            Its header Sec-Fetch-Site; None for the page itself, to which any other may link.
        token
            What it shows: to act, in a header of its own; to look, in the address will do.
        acts
            Whether it wants to do something rather than to look.
        """
        if not self._is_named(host):
            return "this server is not called that"
        # a browser names no origin where another page asks for a mere picture or script
        if not self._is_same_origin(origin, host) or site not in _OWN_SITES:
            return "another page may not ask"
        if (acts or not self.is_local) and not self._knows(token):
            return "open the address that gonio watch printed"
        return None

    def _knows(self, token: str | None) -> bool:
        """Whether somebody has the token, told in a time that says nothing of it."""
        return hmac.compare_digest((token or "").encode(), self.token.encode())

    def _is_named(self, host: str | None) -> bool:
        """Whether the Host header names this server: a name rebound to its address does not."""
        name, _, port = (host or "").rpartition(":")
        return port == str(self.port) and self._is_own(name.strip("[]").lower())

    def _is_same_origin(self, origin: str | None, host: str | None) -> bool:
        """Whether a page of this server asks, or what is no browser."""
        return origin is None or origin == f"http://{host}"

    def _is_own(self, name: str) -> bool:
        own = {"localhost", self.host.lower()}
        if not self.is_local:
            own |= {socket.gethostname().lower(), socket.getfqdn().lower()}
        if name in own:
            return True
        try:
            address = ipaddress.ip_address(name)
        except ValueError:
            return False
        # an address in figures cannot be rebound
        return address.is_loopback or not self.is_local
