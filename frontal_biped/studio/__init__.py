"""A live studio in the browser: move a slider and watch the gait designed anew.

`worker` runs one job at a time in a process of its own, the newest first; `jobs` are what it runs; `workbench` keeps
the last good gait and decides what runs next. None of these knows the browser: `stage` draws, `panel` has the sliders,
`app` starts and stops it all. Only those three need viser, the extra of that name.
"""
