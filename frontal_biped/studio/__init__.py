"""A live studio in the browser: move a slider and watch the gait designed anew.

Every move of a slider starts a design from the present gait, in a process of its own; a newer value interrupts it. What
appears has kept C01 to C09 on the dense grid, has residuals below 1e-9 and has been simulated for a step; the
certificate of its reversal point follows some seconds later. Where a specification has no gait the last one stays, with
the reason. *Push* sends the gait, under the ankle stabiliser at 1 kHz, into a push at the pelvis and shows the walk.
*Save* writes gait and page into the folder that the command line names. How long a change takes:
`tests/benchmarks/benchmark_studio.py`.

`worker` runs one job at a time in a process of its own, the newest first; `jobs` are what it runs; `workbench` keeps
the last good gait and decides what runs next. None of these knows the browser: `stage` draws, `panel` has the sliders,
`app` starts and stops it all. `closed_server` is viser for the page at the printed address alone, `messages` what that
page may say. Only these five need viser, the extra of that name.
"""
