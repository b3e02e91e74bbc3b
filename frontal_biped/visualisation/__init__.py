"""Look at a run: exported page, report, live viewer, figures. Importing this loads neither MeshCat nor Matplotlib."""

from frontal_biped.visualisation.figures import figure_svg, write_figures
from frontal_biped.visualisation.live import LiveViewer, view_live
from frontal_biped.visualisation.meshcat_page import animation_page
from frontal_biped.visualisation.orbit import orbit_trajectory
from frontal_biped.visualisation.report_page import report_page
from frontal_biped.visualisation.world import world_configurations, world_motion

__all__ = [
    "LiveViewer",
    "animation_page",
    "figure_svg",
    "orbit_trajectory",
    "report_page",
    "view_live",
    "world_configurations",
    "world_motion",
    "write_figures",
]
