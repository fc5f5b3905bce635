"""What a disk may hold after a power cut: replays the system calls that strace saw."""

import posixpath
import re
from dataclasses import dataclass, field

CALLS = (
    "openat,close,write,pwrite64,writev,lseek,ftruncate,fsync,fdatasync,"
    "rename,renameat,renameat2,unlink,unlinkat,mkdir,mkdirat,rmdir"
)
STRACE = ("strace", "-qq", "-y", "-xx", "-s", "100000000", "-e", f"trace={CALLS}")

_CALL = re.compile(r"^(\w+)\((.*)\)\s+= (-?\d+)")
_STRING = re.compile(r'"((?:\\x[0-9a-f]{2})*)"')
_FD = re.compile(r"^(-?\d+|AT_FDCWD)(?:<((?:\\x[0-9a-f]{2})*)>)?")


@dataclass(eq=False)
class File:
    live: bytearray = field(default_factory=bytearray)
    synced: bytes = b""


@dataclass(eq=False)
class Folder:
    live: dict = field(default_factory=dict)
    synced: dict = field(default_factory=dict)


@dataclass
class Open:
    node: object
    offset: int = 0
    appends: bool = False


class Disk:
    """A folder as the system calls so far left it, and as much of it as was synced."""

    def __init__(self, root):
        self.root = str(root)
        self.top = Folder()
        self._fds = {}
        for path in root.iterdir():
            data = path.read_bytes()
            self.top.live[path.name] = self.top.synced[path.name] = File(bytearray(data), data)

    def do(self, line):
        """Replay a line; return the call's name where it changed what a power cut would leave."""
        parts = _CALL.match(line)
        if not parts or parts[3].startswith("-"):
            return None
        name, text, result = parts[1], parts[2], int(parts[3])
        action = getattr(self, f"_{name}", None)
        return name if action and action(text, result) else None

    def tree(self, entries, contents):
        """Return what is there as nested dicts of bytes.

        `entries` and `contents` are "live" or "synced": whether names, and what files hold, count
        as they are or as they were synced.
        """

        def of(node):
            if isinstance(node, File):
                return bytes(getattr(node, contents))
            return {name: of(child) for name, child in getattr(node, entries).items()}

        return of(self.top)

    def _find(self, path):
        """Return the folder and the name of a path below the root, or None."""
        if not path.startswith(self.root + "/"):
            return None
        *folders, name = path[len(self.root) + 1 :].split("/")
        folder = self.top
        for each in folders:
            folder = folder.live[each]
        return folder, name

    def _path(self, text, index=0):
        """Return a call's path, whole: the index-th string, below the folder before it if any."""
        path = bytes.fromhex(_STRING.findall(text)[index].replace("\\x", "")).decode()
        if path.startswith("/"):
            return posixpath.normpath(path)
        at = re.findall(r"(?:AT_FDCWD|\d+)<((?:\\x[0-9a-f]{2})*)>", text)
        base = bytes.fromhex(at[index].replace("\\x", "")).decode() if at else self.root
        return posixpath.normpath(f"{base}/{path}")

    def _openat(self, text, result):
        self._fds.pop(result, None)
        path = self._path(text)
        if path == self.root:
            self._fds[result] = Open(self.top)
            return False
        place = self._find(path)
        if place is None:
            return False
        folder, name = place
        made = name not in folder.live
        if made:
            folder.live[name] = File()
        node = folder.live[name]
        if "O_TRUNC" in text and isinstance(node, File):
            node.live.clear()
        self._fds[result] = Open(node, appends="O_APPEND" in text)
        return made

    def _close(self, text, _):
        self._fds.pop(int(_FD.match(text)[1]), None)
        return False

    def _open_file(self, text):
        opened = self._fds.get(int(_FD.match(text)[1]))
        return opened if opened and isinstance(opened.node, File) else None

    def _data(self, text):
        return b"".join(bytes.fromhex(s.replace("\\x", "")) for s in _STRING.findall(text))

    def _write(self, text, result):
        opened = self._open_file(text)
        if opened is None:
            return False
        if opened.appends:
            opened.offset = len(opened.node.live)
        self._put(opened.node, self._data(text)[:result], opened.offset)
        opened.offset += result
        return False

    _writev = _write

    def _pwrite64(self, text, result):
        opened = self._open_file(text)
        if opened is not None:
            self._put(opened.node, self._data(text)[:result], int(text.rpartition(", ")[2]))
        return False

    def _put(self, node, data, offset):
        if len(node.live) < offset:
            node.live.extend(bytes(offset - len(node.live)))
        node.live[offset : offset + len(data)] = data

    def _lseek(self, text, result):
        opened = self._open_file(text)
        if opened is not None:
            opened.offset = result
        return False

    def _ftruncate(self, text, _):
        opened = self._open_file(text)
        if opened is not None:
            size = int(text.rpartition(", ")[2])
            del opened.node.live[size:]
            self._put(opened.node, b"", size)
        return False

    def _fsync(self, text, _):
        opened = self._fds.get(int(_FD.match(text)[1]))
        if opened is None:
            return False
        node = opened.node
        node.synced = bytes(node.live) if isinstance(node, File) else dict(node.live)
        return True

    _fdatasync = _fsync

    def _rename(self, text, _):
        source, target = self._find(self._path(text)), self._find(self._path(text, 1))
        if source and target:
            target[0].live[target[1]] = source[0].live.pop(source[1])
        return bool(source)

    _renameat = _renameat2 = _rename

    def _unlink(self, text, _):
        place = self._find(self._path(text))
        if place:
            place[0].live.pop(place[1], None)
        return bool(place)

    _unlinkat = _rmdir = _unlink

    def _mkdir(self, text, _):
        place = self._find(self._path(text))
        if place:
            place[0].live[place[1]] = Folder()
        return bool(place)

    _mkdirat = _mkdir
