from gonio.api.material import Material as Material
from gonio.api.plan import Plan as Plan
from gonio.api.samples import Samples as Samples
from gonio.api.session import Session as Session
from gonio.clock import Clock as Clock
from gonio.directions import paper_directions as paper_directions
from gonio.errors import GonioError as GonioError
from gonio.materials import MeasuredTable as MeasuredTable
from gonio.plan import Shot as Shot
from gonio.rig import Rig as Rig
from gonio.rig import default_rig as default_rig
from gonio.rig import load_rig as load_rig

__version__: str
__all__: list[str]
