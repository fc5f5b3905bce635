"""The parts of Mitsuba's scene: an eye, a probe and a shape, each where our own shader has it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from gonio.render.mesh import mesh_of
from gonio.render.shapes import Relief, Sphere

if TYPE_CHECKING:
    from gonio.render.mesh import Mesh
    from gonio.render.probe import Probe
    from gonio.render.shapes import Shape


def eye_of(mitsuba: Any, size_px: int, paths: int) -> dict[str, Any]:
    """Return a camera that sees -1 to 1 from far away at +z; boxes keep pixels independent."""
    at = mitsuba.ScalarTransform4f().look_at(origin=[0, 0, 5], target=[0, 0, 0], up=[0, 1, 0])
    film = {
        "type": "hdrfilm", "width": size_px, "height": size_px, "pixel_format": "rgba",
        "component_format": "float32", "rfilter": {"type": "box"},
    }  # fmt: skip
    # of its samplers the one with the least noise at so few paths
    sampler = {"type": "multijitter", "sample_count": paths}
    return {"type": "orthographic", "to_world": at, "film": film, "sampler": sampler}


def probe_of(mitsuba: Any, probe: Probe) -> dict[str, Any]:
    """Return the light."""
    # the middle of its panoramas looks to +z, of ours to -z
    turned = mitsuba.ScalarTransform4f().rotate([0, 1, 0], 180)
    panorama = mitsuba.Bitmap(probe.panorama().astype(np.float32))
    return {"type": "envmap", "bitmap": panorama, "to_world": turned}


def body_of(mitsuba: Any, shape: Shape, bsdf: Any) -> Any:
    """Return a shape made of a material, dp_du along its marked edge."""
    if isinstance(shape, Sphere):
        # its poles are on z, ours on y
        placed = mitsuba.ScalarTransform4f().rotate([1, 0, 0], -90).scale(shape.radius)
        return mitsuba.load_dict({"type": "sphere", "to_world": placed, "bsdf": bsdf})
    assert isinstance(shape, Relief)
    return _triangles(mitsuba, mesh_of(shape), bsdf)


def _triangles(mitsuba: Any, mesh: Mesh, bsdf: Any) -> Any:
    properties = mitsuba.Properties()
    properties["mesh_bsdf"] = bsdf
    count = len(mesh.corner)
    body = mitsuba.Mesh(
        "relief", 3 * count, count, properties, has_vertex_normals=True, has_vertex_texcoords=True
    )
    fields = mitsuba.traverse(body)
    fields["faces"] = np.arange(3 * count, dtype=np.uint32)
    fields["vertex_positions"] = mesh.corner.astype(np.float32).ravel()
    fields["vertex_normals"] = mesh.normal.astype(np.float32).ravel()
    fields["vertex_texcoords"] = mesh.texture.astype(np.float32).ravel()
    fields.update()
    return body
