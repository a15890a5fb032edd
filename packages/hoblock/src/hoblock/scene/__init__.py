"""What a scene says about its mesh: plain data, not yet a mesh.

The places (``"mesh.curve[3]"``) tell where in the scene each entry stands, for errors that only show when
the blocks are built.
"""

from hoblock.scene.curves import ArcAbout, ArcThrough, CurveScene, Formula, Shape
from hoblock.scene.gradings import GradingScene
from hoblock.scene.mesh import HIGHEST_ORDER, CountScene, MeshScene
from hoblock.scene.paths import Path, Quad
from hoblock.scene.quads import NodeOrder, QuadsScene, Spacing
from hoblock.scene.template import TemplateScene

__all__ = [
    "HIGHEST_ORDER",
    "ArcAbout",
    "ArcThrough",
    "CountScene",
    "CurveScene",
    "Formula",
    "GradingScene",
    "MeshScene",
    "NodeOrder",
    "Path",
    "Quad",
    "QuadsScene",
    "Shape",
    "Spacing",
    "TemplateScene",
]
