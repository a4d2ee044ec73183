# SPDX-License-Identifier: MIT
"""Pass a job from the process that starts a simulation to the bench that runs inside it."""

from __future__ import annotations

import dataclasses
import json
import os
from typing import Any

from raycaster.configuration import Configuration
from raycaster.design.decide import configure
from raycaster.scene import Scene

JOB_VARIABLE = "RAYCASTER_JOB"
"""The environment variable that carries a job, as JSON, into a simulation."""


@dataclasses.dataclass(frozen=True)
class Job:
    """Task of a simulation."""

    configuration: Configuration
    scene: str = ""
    """Path of a scene file; empty if the bench makes its own scenes."""

    output: str = ""
    """Directory for pictures and results."""

    reflections: int | None = None
    """Number of reflections; None for the scene's number."""

    progress: str = ""
    """File for the number of visible lines so far."""

    seeds: tuple[int, ...] = ()
    """Seeds of random scenes, for a bench that shows them."""

    stiff: bool = False
    """True if the seeds are indices into the stiff catalogue instead."""

    buttons: tuple[int, ...] = ()
    """Buttons held from each frame's vertical sync on, one bit each, for a system with a processor."""

    def reflections_of(self, scene: Scene) -> int:
        """Return the number of reflections to show a scene with."""
        return scene.reflections if self.reflections is None else self.reflections

    def environment(self) -> dict[str, str]:
        """Return the environment variables that pass this job to a simulation."""
        values = dataclasses.asdict(self)
        del values["configuration"]["facts"]  # the engine's name stands for them
        return {JOB_VARIABLE: json.dumps(values)}

    @classmethod
    def from_environment(cls) -> Job:
        """Read the job that this simulation was started with."""
        values: dict[str, Any] = json.loads(os.environ[JOB_VARIABLE])
        values["configuration"] = configure(**values["configuration"])
        return cls(**values)
