# SPDX-License-Identifier: MIT
"""`frame_switch`: frames in time, late ones, abandoned and black ones, with any number of cycles in between."""

from vectors import named

from raycaster.rtl.common.interfaces import FrameEvents
from raycaster.rtl.span.frame_switch import frame_switch
from raycaster.sim.register_model import Switch


def test_frame_switch(leaf_of, random):
    leaf, model = leaf_of(frame_switch, events=FrameEvents), Switch()
    leaf.case({"reset": 1})
    seen = dict.fromkeys(("drawn", "shown", "again", "late", "list_full", "black"), 0)
    for number in range(6000):
        cycle = leaf.cycle
        reset = int(random.random() < 0.002)
        start_screen = random.random() < (0.3 if model.state == "wait" else 0.04)
        whole, full, run = (bool(random.random() < chance) for chance in (0.05, 0.02, 0.8))
        whole, full = whole and model.state == "draw", full and model.state == "draw" and not whole
        leaf.case({"reset": reset, "start_screen": start_screen, "run": run, "whole": whole, "full": full})
        events = model.events(start_screen, whole, full, cycle)
        new_frame, take_scene = model.state == "begin" and run, model.state == "wait" and start_screen
        leaf.expect(named("events", events))
        leaf.expect({"take_scene": take_scene, "new_frame": new_frame, "stop": model.state == "draw" and full})
        leaf.expect({"upper": model.upper, "view_run": model.shown is not None})
        seen = {name: seen[name] + bool(events.get(name)) for name in seen}
        seen["black"] += model.state == "begin" and not run
        model.clock(start_screen, run, number, whole, full, cycle)
        if reset:
            model.reset()
    leaf.check(settled=1)
    assert min(seen.values()) > 20
