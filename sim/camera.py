"""The twin's camera: what it sees of the holder from the arms' true poses, as DNG files."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Literal

import numpy as np

from gonio.materials import reference_material
from sim import sensor
from sim.blur import blurred_mosaic
from sim.camera_imperfections import NONE
from sim.dng import dng_bytes
from sim.optics.lens import Lens
from sim.pixels.chip import Chip
from sim.scene import irradiance, render
from sim.spectral_mix import spectral_mix
from sim.warmth import COOL

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gonio.geometry import ArmPose
    from gonio.protocols import Material
    from gonio.rig import Rig
    from sim.camera_imperfections import CameraImperfections
    from sim.scene import Scene
    from sim.warmth import Warmth

Holder = Literal["sample", "reference"]
_SceneKey = tuple[Holder, "ArmPose", "ArmPose", tuple[float, ...]]


class SimCamera:
    """Renders the holder per pixel, with perspective, and exposes it with noise.

    Parameters
    ----------
    rig
        Geometry of camera and lamps, and the white reference.
    sample
        The material in the holder.
    seed
        Of all noise, and of how this sensor's pixels differ.
    imperfections
        Of camera and lamps.
    """

    def __init__(
        self, rig: Rig, sample: Material, seed: int, imperfections: CameraImperfections = NONE
    ) -> None:
        self._camera = rig.camera
        self._lamps = rig.lamps
        self._seed = seed
        self._imperfections = imperfections
        self._lens = None if imperfections == NONE else Lens(rig.camera, imperfections)
        self._chip = Chip((rig.camera.height, rig.camera.width), imperfections, seed)
        self._materials = {"sample": sample, "reference": reference_material(rig)}
        self._last: tuple[_SceneKey, Scene] | None = None

    def frame(
        self,
        *,
        holder: Holder,
        view: ArmPose,
        light: ArmPose,
        flux: NDArray[np.float64],
        exposure_s: float,
        key: str,
        shake_rad: NDArray[np.float64] | None = None,
        warmth: Warmth = COOL,
    ) -> bytes:
        """Return a whole DNG file; equal arguments give equal bytes.

        Parameters
        ----------
        holder
            What lies in it.
        view, light
            True poses of the arms.
        flux
            Mean of lamps 1 to 11 over the exposure, shape (11,); 1 is 700 mA at 25 deg C.
        exposure_s
            As requested; the file says how long the shutter truly was open.
        key
            Name of the exposure, on which its noise depends.
        shake_rad
            How far the picture was off meanwhile, along rows' and columns' numbers, shape (n, 2).
        warmth
            Of lamps and sensor, which only imperfect ones show.
        """
        random = sensor.keyed_generator(self._seed, key)
        true_s = sensor.true_exposure_s(exposure_s, random)
        light_e = true_s * self._electrons_per_s(holder, view, light, flux, warmth)
        if shake_rad is not None:
            light_e = blurred_mosaic(light_e, self._camera.focal_px * shake_rad)
        mean = self._chip.mean_electrons(light_e, true_s, warmth.sensor)
        electrons = self._chip.read(sensor.count(mean, random))
        return dng_bytes(
            sensor.read_out(electrons, random, self._imperfections.camera_end),
            cfa=sensor.CFA,
            black=sensor.BLACK_LEVEL,
            white=sensor.WHITE_LEVEL,
            exposure_s=true_s,
            iso=100,
            color_matrix=sensor.CAMERA_FROM_XYZ,
            as_shot_neutral=sensor.CAMERA_NEUTRAL,
            camera_model="gonio simulated camera",
            unique_id=hashlib.sha256(f"{self._seed}/{key}".encode()).hexdigest()[:32],
        )

    def _electrons_per_s(
        self,
        holder: Holder,
        view: ArmPose,
        light: ArmPose,
        flux: NDArray[np.float64],
        warmth: Warmth,
    ) -> NDArray[np.float64]:
        """Return the mean rate of each pixel for light alone, shape (height, width)."""
        strength = np.array([flux[lamp.n - 1] for lamp in self._lamps.lamp])
        total = np.zeros((self._camera.height, self._camera.width))
        if not strength.any():
            return total
        scene = self._scene((holder, view, light, _weights(strength)))
        for lamp, share in zip(self._lamps.lamp, strength, strict=True):
            if share > 0:
                place = light.place(1000.0 * self._lamps.distance_m, lamp.x_mm, lamp.y_mm)
                total += share * irradiance(scene.points, place)
        if self._lens is None:
            return sensor.ELECTRONS_PER_S * scene.response * total
        radiance = scene.brdf * total[..., None] * self._mix(strength, warmth)
        seen = self._lens.image(radiance, scene.points @ view.direction)
        return sensor.ELECTRONS_PER_S * sensor.mosaic(seen)

    def _mix(self, strength: NDArray[np.float64], warmth: Warmth) -> NDArray[np.float64]:
        """Return the lit lamps' mix, shape (3,): so far away they make one source."""
        junctions_c = np.array([warmth.junctions_c[lamp.n - 1] for lamp in self._lamps.lamp])
        mean_c = float(strength @ junctions_c / strength.sum())
        sizes = self._imperfections
        return spectral_mix(mean_c, sizes.lamp_red_per_c, sizes.lamp_blue_per_c)

    def _scene(self, key: _SceneKey) -> Scene:
        """Return the scene of a pose; the last one is kept, for the frames of a bracket."""
        if self._last is None or self._last[0] != key:
            holder, view, light, weights = key
            x = sum(w * lamp.x_mm for w, lamp in zip(weights, self._lamps.lamp, strict=True))
            y = sum(w * lamp.y_mm for w, lamp in zip(weights, self._lamps.lamp, strict=True))
            centre = light.place(1000.0 * self._lamps.distance_m, x, y)
            self._last = (key, render(self._camera, self._materials[holder], view, centre))
        return self._last[1]


def _weights(strength: NDArray[np.float64]) -> tuple[float, ...]:
    """Return each lamp's share in the source's centre.

    In whole percents: lamps warm up within a bracket, and their centre, which that moves by less
    than 0.1 mm in 2 m, shall not be rendered anew each time.
    """
    shares = np.round(strength / strength.sum(), 2)
    return tuple((shares / shares.sum()).tolist())
