"""The XML of LBNL's WINDOW, in which Klems matrices and tensor trees lie.

Layout as WINDOW writes it (namespace http://windows.lbl.gov) and as Radiance's `bsdf_m.c` and
`bsdf_t.c` read it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat
from xml.sax.saxutils import escape

import numpy as np

from gonio.color import XYZ_FROM_SRGB
from gonio.errors import BadFileError
from gonio.exchange.limits import read_whole
from gonio.files import write_bytes

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

REMEDY: Final = "give an XML file as WINDOW, genBSDF or gonio export writes it"
FRONT: Final = "Reflection Back"
"""Radiance's front is WINDOW's back: the side that faces the room."""

_BEHIND = "Reflection Front"
_DEPTH = 32
_ELEMENTS = 10_000
_LARGEST = 1 << 26
_SHELL = """\
<?xml version="1.0" encoding="UTF-8"?>
<WindowElement xmlns="http://windows.lbl.gov">
<WindowElementType>System</WindowElementType>
<FileType>BSDF</FileType>
<Optical>
<Layer>
<Material>
<Name>{name}</Name>
<Manufacturer>measured by gonio</Manufacturer>
<DeviceType>Other</DeviceType>
</Material>
<DataDefinition>
<IncidentDataStructure>{structure}</IncidentDataStructure>
{definition}</DataDefinition>
{blocks}</Layer>
</Optical>
</WindowElement>
"""
_BLOCK = """\
<WavelengthData>
<LayerNumber>System</LayerNumber>
<Wavelength unit="Integral">{wavelength}</Wavelength>
<SourceSpectrum>CIE Illuminant D65 1nm.ssp</SourceSpectrum>
<DetectorSpectrum>ASTM E308 1931 Y.dsp</DetectorSpectrum>
<WavelengthDataBlock>
<WavelengthDataDirection>{direction}</WavelengthDataDirection>
{bases}<ScatteringDataType>BRDF</ScatteringDataType>
<ScatteringData>
{data}
</ScatteringData>
</WavelengthDataBlock>
</WavelengthData>
"""


@dataclass(frozen=True)
class WindowFile:
    """What a file says of the light that one side reflects.

    Attributes
    ----------
    structure
        Columns, Rows, TensorTree3 or TensorTree4.
    blocks
        Elements WavelengthDataBlock by the name of their wavelength, in lower case.
    mirrored
        Whether the side is the one away from the room, whose x axis runs the other way.
    """

    structure: str
    blocks: dict[str, Element]
    mirrored: bool


def write_window(
    path: Path, name: str, structure: str, definition: str, bases: str, data: dict[str, str]
) -> None:
    """Write the reflection of the side that faces the room; `data` by the wavelength's name."""
    blocks = [
        _BLOCK.format(wavelength=wavelength, direction=FRONT, bases=bases, data=each)
        for wavelength, each in data.items()
    ]
    # what XML cannot hold at all, such as a bell in a file's name
    name = "".join(letter if letter.isprintable() else "?" for letter in name)
    text = _SHELL.format(
        name=escape(name), structure=structure, definition=definition, blocks="".join(blocks)
    )
    write_bytes(path, text.encode())


def read_window(path: Path) -> WindowFile:
    """Read the reflection of the side that faces the room, or else of the other.

    Document types, and with them entities, are refused; so is what is larger than 67 MB, deeper
    than 32 elements or of more than ten thousand.

    Raises
    ------
    gonio.errors.BadFileError
        When the file is missing, no such XML, or says nothing of reflection.
    """
    layer = _parsed(path).find(".//Layer")
    if layer is None:
        raise BadFileError(path, "has no element Layer", REMEDY)
    structure = text_of(layer, "DataDefinition/IncidentDataStructure")
    for side in (FRONT, _BEHIND):
        blocks = _blocks(layer, side)
        if "visible" in blocks:
            return WindowFile(structure, blocks, side == _BEHIND)
    raise BadFileError(path, "has no visible reflection", REMEDY)


def text_of(element: Element, path: str) -> str:
    """Return the text of an element inside, without space around it; empty where there is none."""
    return (element.findtext(path) or "").strip()


def is_window(head: bytes, *, tree: bool) -> bool:
    """Tell whether a file that begins like this is such XML, of a tree or of a matrix."""
    # not anywhere: a material may be called by that word
    of_tree = re.search(rb"<IncidentDataStructure[^>]*>\s*TensorTree", head, re.IGNORECASE)
    return b"<WindowElement" in head and (of_tree is not None) == tree


def xyz_of(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return CIE XYZ of linear sRGB, both of shape (..., 3), Y the luminance."""
    return np.asarray(rgb @ XYZ_FROM_SRGB.T)


def rgb_of(xyz: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return linear sRGB, not below 0, of CIE XYZ, both of shape (..., 3)."""
    return np.asarray((xyz @ np.linalg.inv(XYZ_FROM_SRGB).T).clip(0.0))


def _blocks(layer: Element, side: str) -> dict[str, Element]:
    found = {}
    for wavelength in layer.iterfind("WavelengthData"):
        for block in wavelength.iterfind("WavelengthDataBlock"):
            if text_of(block, "WavelengthDataDirection").lower() == side.lower():
                found[text_of(wavelength, "Wavelength").lower()] = block
    return found


def _parsed(path: Path) -> Element:
    content = read_whole(path)
    if len(content) > _LARGEST:
        raise BadFileError(path, "is longer than 67 MB", REMEDY)
    parser = expat.ParserCreate()
    parser.buffer_text = True
    building = _Building(path)
    parser.StartDoctypeDeclHandler = building.refuse
    parser.StartElementHandler = building.start
    parser.EndElementHandler = building.end
    parser.CharacterDataHandler = building.builder.data
    try:
        parser.Parse(content, True)
        return building.builder.close()
    # expat raises the last two for encodings that it does not know
    except (expat.ExpatError, LookupError, ValueError) as error:
        raise BadFileError(path, f"is no XML ({error})", REMEDY) from None


class _Building:
    """The tree as it is read, without namespaces, and no larger than such files are."""

    def __init__(self, path: Path) -> None:
        self.builder = TreeBuilder()
        self._path = path
        self._depth = self._count = 0

    def start(self, name: str, attributes: dict[str, Any]) -> None:
        self._depth += 1
        self._count += 1
        if self._depth > _DEPTH or self._count > _ELEMENTS:
            raise BadFileError(self._path, "has more elements than such files have", REMEDY)
        self.builder.start(name.rpartition(":")[2], attributes)

    def end(self, name: str) -> None:
        self._depth -= 1
        self.builder.end(name.rpartition(":")[2])

    def refuse(self, *_: object) -> None:
        raise BadFileError(self._path, "has a document type, which is not read", REMEDY)
