"""MeshCat's animations: one clip for each node, one track for each of its properties."""

from typing import Any

REPETITIONS = 1_000_000
"""MeshCat plays once unless told otherwise."""


def clip_of(animation: Any, node: Any, fps: float) -> Any:
    """The clip of a node in an animation, made if there is none."""
    from meshcat.animation import AnimationClip

    return animation.clips.setdefault(node.path, AnimationClip(fps=float(fps)))


def add_track(clip: Any, name: str, kind: str, frames: list[float], values: list[Any]) -> None:
    """Give a clip the values of a property at its key frames."""
    from meshcat.animation import AnimationTrack

    clip.tracks[name] = AnimationTrack(name, kind, frames=list(frames), values=values)
