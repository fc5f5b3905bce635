"""What kills a run of `gonio` in a fork, when a function is called."""

import inspect
import os
import pkgutil
import signal


def die(where, when):
    """Let the function `where` kill the process, once `when` is true of its arguments."""
    owner, _, name = where.rpartition(".")
    owner = pkgutil.resolve_name(owner)
    real = getattr(owner, name)

    def deadly(*args, **kwargs):
        called = inspect.signature(real).bind(*args, **kwargs).arguments
        if eval(when, {}, called):
            os.kill(os.getpid(), signal.SIGKILL)
        return real(*args, **kwargs)

    setattr(owner, name, deadly)
