# SPDX-License-Identifier: MIT
"""The exchange of the two lists: what is shown, what is drawn, and when the scene changes."""

from myhdl import Signal, always_comb, always_seq, block, enum, instances

from raycaster.hdl.signals import bit

SwitchState = enum("WAIT", "BEGIN", "DRAW")


@block
def frame_switch(
    clk, reset, start_screen, run, whole, full, take_scene, new_frame, stop, upper, view_run, busy, events
):
    """Show the last whole frame while the next one is drawn into the other list.

    A frame that is whole at StartScreen is shown from then on, and the next one begins with the scene that goes live.
    A frame that is not leaves the last one standing, and has its next chance at the next StartScreen. A frame whose
    list is full is abandoned: the next one begins at the next StartScreen, in the same list. So a list in view is never
    drawn into, and a scene never changes while it is drawn. A scene without run is a black frame, whole at once.
    After reset a black frame is whole.

    Args:
        start_screen: strobe before the first row.
        run: flag of the live `Picture`; read in the cycle after take_scene.
        whole: strobe; the frame's last entry is written. A frame that is whole in the cycle of StartScreen is late.
        full: flag; the list has no place for the frame's next entry.
        take_scene: output strobe; the pending scene goes live.
        new_frame: output strobe, in the cycle after take_scene; a frame begins.
        stop: output flag; the frame is abandoned in this cycle.
        upper: output flag; the list that is drawn is the upper one, and the other one is shown.
        view_run: output flag; run of the frame in view. If it is low, the frame is black, and its list don't care.
        busy: output flag; a frame is being drawn, from the cycle after take_scene on.
        events: `FrameEvents`; output.
    """
    longest = (1 << len(events.time)) - 1

    state = Signal(SwitchState.WAIT)
    ready, drawn_run = Signal(bool(1)), bit()
    drawing, hands_over, completes = bit(), bit(), bit()

    @always_comb
    def see_state():
        drawing.next = state == SwitchState.DRAW
        take_scene.next = start_screen and (state == SwitchState.WAIT)
        new_frame.next = (state == SwitchState.BEGIN) and run

    @always_comb
    def judge():
        hands_over.next = take_scene and ready
        completes.next = drawing and whole
        stop.next = drawing and full

    @always_seq(clk.posedge, reset=reset)
    def step():
        if take_scene:
            state.next = SwitchState.BEGIN
        elif new_frame:
            state.next = SwitchState.DRAW
        elif state == SwitchState.BEGIN or completes or stop:
            state.next = SwitchState.WAIT

    @always_seq(clk.posedge, reset=reset)
    def remember():
        if take_scene:
            ready.next = False
        elif completes:
            ready.next = True
        elif state == SwitchState.BEGIN:
            ready.next = not run
            drawn_run.next = run

    @always_seq(clk.posedge, reset=reset)
    def exchange():
        if hands_over:
            upper.next = not upper
            view_run.next = drawn_run

    @always_seq(clk.posedge, reset=reset)
    def measure():
        if take_scene or completes:
            events.time.next = 1
        elif events.time != longest:
            events.time.next = events.time + 1

    @always_comb
    def report():
        busy.next = state != SwitchState.WAIT
        events.drawn.next = completes
        events.shown.next = hands_over and drawn_run
        events.again.next = start_screen and not hands_over
        events.late.next = start_screen and drawing
        events.list_full.next = stop

    return instances()
