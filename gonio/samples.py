"""BRDF samples: what a rig measured, with sigma, direction by direction."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from enum import IntFlag
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gonio.errors import BadFileError, BadInputError
from gonio.files import write_bytes
from gonio.uncertainty import COMPONENTS

if TYPE_CHECKING:
    import xarray
    from numpy.typing import ArrayLike, NDArray

SCHEMA = "gonio.samples/1"
RGB = ("r", "g", "b")
_REMEDY = "make it again with: gonio reduce"
WHITE_PER_MEDIAN = 4.0
LARGEST = 1e12
"""Of values and sigmas, in 1/sr: far beyond any mirror, and its square overflows no model."""

SMALLEST_WHITE = 1e-30
"""In 1/sr: far below any black; grids of models are single precision, which ends at 1e-38."""


class Flag(IntFlag):
    """What is to be known about a value, as bits."""

    CLIPPED = 1
    """Saturated in every exposure: the value is a lower bound."""
    FAINT = 2
    """Not above its own noise."""
    FEW_PIXELS = 4
    """The patch held fewer than eight pixels of this channel."""
    NO_SIGMA = 8
    """The table that it came from stated no sigma."""
    SUSPECT = 64
    """A check of its shot failed (see `gonio.checks`)."""


@dataclass(frozen=True)
class Samples:
    """Values at pairs of directions, as measured.

    Attributes
    ----------
    light, view
        Unit vectors away from the sample, shape (n, 3), from the encoders, not the targets.
    value, sigma
        BRDF and one standard uncertainty in 1/sr, shape (n, c); sigma is NaN where unknown.
    flag
        Bits of `Flag`, shape (n, c).
    light_solid_angle, view_solid_angle
        Of the source and of the receiver as the sample sees them, in sr, shape (n,); NaN unknown.
    shot_index, attempt
        Which shot of the plan and which try at it, shape (n,).
    channels
        Names of the c channels.
    color_space
        What the channels are, such as "linear sRGB".
    color_made_by
        What the camera's channels became it by: `chart` (then `provenance` has its hash),
        the frames' own matrix, such as `ColorMatrix1`, `none`; empty where unknown.
    provenance
        SHA-256 hashes of what the samples were made from, by name.
    patch_mm
        Side of the square of the sample that each value is the mean over; None where unknown.
    components
        What sigma is made of: standard uncertainties in 1/sr, shape (n, c), by the names of
        `gonio.uncertainty.COMPONENTS`; empty where unknown.
    """

    light: NDArray[np.float64]
    view: NDArray[np.float64]
    value: NDArray[np.float64]
    sigma: NDArray[np.float64]
    flag: NDArray[np.uint32]
    light_solid_angle: NDArray[np.float64]
    view_solid_angle: NDArray[np.float64]
    shot_index: NDArray[np.int64]
    attempt: NDArray[np.int64]
    channels: tuple[str, ...] = RGB
    color_space: str = "linear sRGB"
    color_made_by: str = ""
    provenance: dict[str, str] = field(default_factory=dict)
    patch_mm: float | None = None
    components: dict[str, NDArray[np.float64]] = field(default_factory=dict)

    @classmethod
    def from_values(
        cls,
        light: NDArray[np.float64],
        view: NDArray[np.float64],
        value: NDArray[np.float64],
        sigma: NDArray[np.float64] | None = None,
        channels: tuple[str, ...] = RGB,
        color_space: str = "linear sRGB",
    ) -> Samples:
        """Make samples of values alone, with everything else unknown.

        Raises
        ------
        BadInputError
            When shapes do not fit, a value is not finite, or a direction is not a unit vector of
            the upper hemisphere.
        """
        count = len(value)
        unknown = np.full(count, np.nan)
        flag = np.zeros(value.shape, np.uint32)
        samples = cls(
            light=np.asarray(light, np.float64),
            view=np.asarray(view, np.float64),
            value=np.asarray(value, np.float64),
            sigma=np.full(value.shape, np.nan) if sigma is None else np.asarray(sigma, np.float64),
            flag=flag if sigma is not None else flag | np.uint32(Flag.NO_SIGMA),
            light_solid_angle=unknown,
            view_solid_angle=unknown.copy(),
            shot_index=np.arange(count, dtype=np.int64),
            attempt=np.ones(count, np.int64),
            channels=channels,
            color_space=color_space,
        )
        samples.check()
        return samples

    def __len__(self) -> int:
        return len(self.value)

    @property
    def white(self) -> float:
        """Exposure scale of the 8-bit error metric: 4 x the median value, in 1/sr.

        Raises
        ------
        BadInputError
            When there is no sample, or the median is not positive or below all that is black.
        """
        if not len(self):
            raise BadInputError("there are no samples; capture and reduce at least one shot")
        white = WHITE_PER_MEDIAN * float(np.median(self.value))
        if not white > 0:
            raise BadInputError(
                f"the samples' median is {white / WHITE_PER_MEDIAN:g} 1/sr, so they have no scale; "
                "check exposures, the dark frames and the white reference"
            )
        if white < SMALLEST_WHITE:
            raise BadInputError(
                f"the samples' median is {white / WHITE_PER_MEDIAN:g} 1/sr, darker than anything; "
                "check their unit"
            )
        return white

    def trusted(self) -> Samples:
        """Return the samples without suspect shots; all of them, where half or fewer would stay."""
        kept = ~np.asarray((self.flag & np.uint32(Flag.SUSPECT)).any(axis=1))
        if kept.all() or 2 * kept.sum() <= len(self):
            return self
        per_shot = {name: getattr(self, name)[kept] for name in _DTYPES}
        components = {name: part[kept] for name, part in self.components.items()}
        return replace(self, **per_shot, components=components)

    def check(self) -> None:
        """Refuse samples that no estimator can use.

        Raises
        ------
        BadInputError
            Naming the first sample that is wrong.
        """
        count, channels = len(self.value), len(self.channels)
        shapes = {
            "light": (count, 3), "view": (count, 3), "value": (count, channels),
            "sigma": (count, channels), "flag": (count, channels),
            "light_solid_angle": (count,), "view_solid_angle": (count,),
            "shot_index": (count,), "attempt": (count,),
        }  # fmt: skip
        for name, shape in shapes.items():
            if getattr(self, name).shape != shape:
                found = getattr(self, name).shape
                raise BadInputError(f"samples: {name} has shape {found}, not {shape}")
        for name, part in self.components.items():
            if part.shape != self.sigma.shape:
                raise BadInputError(f"samples: sigma_{name} has shape {part.shape}")
            _refuse_rows(f"sigma_{name} is negative or infinite", _bad_sigma(part).any(axis=1))
        for name in ("light", "view"):
            _check_directions(name, getattr(self, name))
        _refuse_rows("value is not finite", ~np.isfinite(self.value).all(axis=1))
        _refuse_rows(
            f"value is beyond {LARGEST:g} 1/sr", (np.abs(self.value) > LARGEST).any(axis=1)
        )
        _refuse_rows("sigma is negative or infinite", _bad_sigma(self.sigma).any(axis=1))
        _refuse_rows(f"sigma is beyond {LARGEST:g} 1/sr", (self.sigma > LARGEST).any(axis=1))
        if self.patch_mm is not None and not 0 < self.patch_mm < np.inf:
            raise BadInputError(f"samples: patch_mm is {self.patch_mm:g}, no positive number")

    def save(self, path: Path | str) -> None:
        """Write netCDF-4, whole or not at all (layout: docs/topics/files.md)."""
        # through memory: on a full disk, HDF5 itself prints tracebacks and names no reason
        write_bytes(Path(path), bytes(self._dataset().to_netcdf(engine="h5netcdf")))

    @classmethod
    def load(cls, path: Path | str) -> Samples:
        """Read samples written by `save`.

        Raises
        ------
        gonio.errors.BadFileError
            When the file is missing, is no netCDF, of another schema, or lacks a variable.
        """
        import xarray

        path = Path(path)
        if not path.is_file():
            raise BadFileError(path, "no such file", _REMEDY)
        try:
            with xarray.open_dataset(path, engine="h5netcdf", phony_dims="sort") as dataset:
                dataset.load()
        except (OSError, ValueError, KeyError, RuntimeError) as error:
            raise BadFileError(path, f"is not a samples file ({error})", _REMEDY) from None
        return cls._from_dataset(dataset, path)

    def _dataset(self) -> xarray.Dataset:
        import xarray

        per_value = ("shot", "channel")
        dataset = xarray.Dataset(
            {
                "light": (("shot", "xyz"), self.light),
                "view": (("shot", "xyz"), self.view),
                "value": (per_value, self.value, {"units": "sr-1"}),
                "sigma": (per_value, self.sigma, {"units": "sr-1"}),
                "flag": (per_value, self.flag, _flag_attributes()),
                "light_solid_angle": ("shot", self.light_solid_angle, {"units": "sr"}),
                "view_solid_angle": ("shot", self.view_solid_angle, {"units": "sr"}),
                "shot_index": ("shot", self.shot_index),
                "attempt": ("shot", self.attempt),
            },
            coords={"channel": list(self.channels), "xyz": ["x", "y", "z"]},
            attrs={"schema": SCHEMA, "color_space": self.color_space, "units": "sr-1"},
        )
        dataset.attrs.update({f"sha256_{name}": digest for name, digest in self.provenance.items()})
        for component in COMPONENTS:
            if component.name in self.components:
                shared = "common to all samples" if component.common else "independent"
                about = {"units": "sr-1", "long_name": component.meaning, "correlation": shared}
                part = (per_value, self.components[component.name], about)
                dataset[f"sigma_{component.name}"] = part
        if self.color_made_by:
            dataset.attrs["color_made_by"] = self.color_made_by
        if self.patch_mm is not None:
            dataset.attrs["patch_mm"] = self.patch_mm
        return dataset

    @classmethod
    def _from_dataset(cls, dataset: xarray.Dataset, path: Path) -> Samples:
        if dataset.attrs.get("schema") != SCHEMA:
            found = dataset.attrs.get("schema")
            raise BadFileError(path, f"has schema {found!r}, not {SCHEMA!r}", _REMEDY)
        for name in (*_DTYPES, "channel"):
            if name not in dataset.variables:
                raise BadFileError(path, f"{name}: is missing", _REMEDY)
        try:
            samples = cls(
                **{name: _typed(dataset, name) for name in _DTYPES},
                channels=tuple(str(name) for name in dataset["channel"].to_numpy()),
                color_space=str(dataset.attrs["color_space"]),
                color_made_by=str(dataset.attrs.get("color_made_by", "")),
                provenance={
                    name.removeprefix("sha256_"): str(digest)
                    for name, digest in dataset.attrs.items()
                    if name.startswith("sha256_")
                },
                patch_mm=_patch_mm(dataset),
                components=_components(dataset),
            )
            samples.check()
        except KeyError as error:
            raise BadFileError(path, f"{error.args[0]}: is missing", _REMEDY) from None
        except BadInputError as error:
            raise BadFileError(path, str(error), _REMEDY) from None
        return samples


_DTYPES: dict[str, type[np.generic]] = {
    "light": np.float64, "view": np.float64, "value": np.float64, "sigma": np.float64,
    "flag": np.uint32, "light_solid_angle": np.float64, "view_solid_angle": np.float64,
    "shot_index": np.int64, "attempt": np.int64,
}  # fmt: skip


def _typed(dataset: xarray.Dataset, name: str) -> Any:
    wanted = _DTYPES.get(name, np.float64)
    try:
        return dataset[name].to_numpy().astype(wanted, casting="same_kind")
    except TypeError:
        found = dataset[name].dtype
        raise BadInputError(f"{name}: holds {found}, not {wanted.__name__}") from None


def _components(dataset: xarray.Dataset) -> dict[str, NDArray[np.float64]]:
    """Return what the file tells of sigma's parts; files of before there were such tell none."""
    names = [component.name for component in COMPONENTS]
    return {name: _typed(dataset, f"sigma_{name}") for name in names if f"sigma_{name}" in dataset}


def _patch_mm(dataset: xarray.Dataset) -> float | None:
    stated = dataset.attrs.get("patch_mm")
    try:
        return None if stated is None else float(stated)
    except (TypeError, ValueError):
        raise BadInputError(f"patch_mm: holds {stated!r}, no number") from None


def _flag_attributes() -> dict[str, object]:
    masks = np.array([flag.value for flag in Flag], np.uint32)
    return {"flag_masks": masks, "flag_meanings": " ".join(str(flag.name) for flag in Flag).lower()}


def _bad_sigma(sigma: NDArray[np.float64]) -> NDArray[np.bool_]:
    return (sigma < 0) | np.isinf(sigma)


def _check_directions(name: str, direction: NDArray[np.float64]) -> None:
    length = np.linalg.norm(direction, axis=1)
    _refuse_rows(f"{name} is not a unit vector", ~(np.abs(length - 1) < 1e-6))
    _refuse_rows(
        f"{name} points below the sample (transmission, which gonio does not measure)",
        direction[:, 2] < -1e-9,
    )


def _refuse_rows(problem: str, bad: ArrayLike) -> None:
    bad = np.asarray(bad)
    if bad.any():
        first, count = int(np.argmax(bad)), int(bad.sum())
        more = f" (and {count - 1} more)" if count > 1 else ""
        raise BadInputError(f"samples: row {first}: {problem}{more}; correct or remove it")
