"""Look at a run: exported page and live viewer. Importing this does not load MeshCat."""

from frontal_biped.viewer.live import LiveViewer, view_live
from frontal_biped.viewer.page import animation_page

__all__ = [
    "LiveViewer",
    "animation_page",
    "view_live",
]
