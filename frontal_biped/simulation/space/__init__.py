"""Walks of the whole robot in space: what disturbs it, the loop that walks it, and the run that is recorded."""
