"""Look at a run: exported page and live viewer. Importing this does not load MeshCat.

``frontal-biped view RUN.npz --html page.html`` writes one page that opens offline in any browser (1.2 MB for the
Table I robot, 2 to 4 MB with the meshes of a humanoid):

* the robot from the front, with ground reaction, FRI, centre of mass and the swing foot's trace to tick on and off, and
  which of rising, reversal, falling and impact it is in; slow motion down to 1/20. A humanoid's own meshes, made light,
  at the locked posture; bars where a mesh is missing;
* a time line that marks every reversal, impact, push and fall; click a mark to go there;
* four plots that follow: joint angles, FRI in its sole, torques with their limits, phase portrait; or ground reaction,
  swing foot, pelvis roll, tracking error, velocities. Drag in a plot, and the robot follows the plot;
* two runs, ``view a.npz b.npz``, side by side, or with ``--overlay`` one translucent over the other; ``--ghost`` shows
  the desired posture. Any run file will do, pushed, fallen or from another simulator; also of two robots;
* light and dark; keys: space, left, right, shift with left or right from event to event, Home, End, -, +.

Of a walk in space the page shows the whole robot from any side (3.5 MB for TALOS, 6.4 MB of 200 steps): drag to turn
it, the camera goes along. Both soles' forces stand at their centres of pressure, with the yaw moment as an arc;
footsteps stay on the ground, the planned foothold is dashed, pushes are red. Beside it the frontal phase portrait runs
along its closed form; plots of speed, pressure and the largest shares of the joints' limits below.

In a notebook ``fb.view(run)`` shows the same page inline, and its ``save`` writes it.

Without ``--html`` the same page is served live at the address that is printed, on this machine only (from another one:
``ssh -L 7000:127.0.0.1:7000``), until Ctrl+C or SIGTERM. The server is a thread of the command: nothing outlives it.
"""

from frontal_biped.viewer.live import LiveViewer, view_live
from frontal_biped.viewer.page import animation_page
from frontal_biped.viewer.space_page import space_page
from frontal_biped.viewer.view import View, view

__all__ = [
    "LiveViewer",
    "View",
    "animation_page",
    "space_page",
    "view",
    "view_live",
]
