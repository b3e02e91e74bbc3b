"""MeshCat's animations: one clip for each node, one track for each of its properties."""

from typing import Any

REPETITIONS = 1_000_000
"""MeshCat plays once unless told otherwise."""

CLOCK = "clock"
"""An empty node that keeps time."""


def clip_of(animation: Any, node: Any, fps: float) -> Any:
    """The clip of a node in an animation, made if there is none."""
    from meshcat.animation import AnimationClip

    return animation.clips.setdefault(node.path, AnimationClip(fps=float(fps)))


def add_track(clip: Any, name: str, kind: str, frames: list[float], values: list[Any]) -> None:
    """Give a clip the values of a property at its key frames."""
    from meshcat.animation import AnimationTrack

    clip.tracks[name] = AnimationTrack(name, kind, frames=list(frames), values=values)


def start_clock(visualizer: Any, duration: float) -> None:
    """MeshCat's own animation of nothing at all: the page asks it for the time [s], and moves the scene itself."""
    from meshcat.animation import Animation

    fps = 1000.0  # key times are whole numbers of it
    animation = Animation(default_framerate=fps)
    still = clip_of(animation, visualizer[CLOCK], fps)
    add_track(still, "position", "vector3", [0.0, duration * fps], [[0.0, 0.0, 0.0]] * 2)
    visualizer.set_animation(animation, play=True, repetitions=REPETITIONS)
