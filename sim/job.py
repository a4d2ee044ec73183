# SPDX-License-Identifier: MIT
"""What is handed from the process that starts a simulation to the bench that runs inside it."""

from __future__ import annotations

import dataclasses
import json
import os
from collections.abc import Mapping, Sequence
from typing import Any

from raycaster.configuration import Configuration, configure
from raycaster.scene import Scene

JOB_VARIABLE = "RAYCASTER_JOB"
"""The environment variable that carries a job, as JSON, into a simulation."""


@dataclasses.dataclass(frozen=True)
class Job:
    """What a simulation is to do."""

    configuration: Configuration
    scene: str = ""
    """Path of a scene file, or nothing where a bench has scenes of its own."""

    output: str = ""
    """Directory for pictures and results."""

    reflections: int | None = None
    """Instead of the scene's own."""

    progress: str = ""
    """File that is to hold the number of visible lines seen so far."""

    seeds: tuple[int, ...] = ()
    """Of random scenes, for a bench that shows them."""

    stiff: bool = False
    """The seeds are places in the stiff catalogue instead."""

    registers: Mapping[str, Sequence[str]] = dataclasses.field(default_factory=dict)
    """By module of the design, names of its registers, for a bench that writes them."""

    buttons: tuple[int, ...] = ()
    """For a system with a processor: which are held from each frame's vertical sync on, a bit each."""

    def reflections_of(self, scene: Scene) -> int:
        """The number of reflections to show a scene with."""
        return scene.reflections if self.reflections is None else self.reflections

    def environment(self) -> dict[str, str]:
        """The environment in which a simulation finds this job."""
        return {JOB_VARIABLE: json.dumps(dataclasses.asdict(self))}

    @classmethod
    def from_environment(cls) -> Job:
        """The job that this simulation was started with."""
        values: dict[str, Any] = json.loads(os.environ[JOB_VARIABLE])
        values["configuration"] = configure(**values["configuration"])
        return cls(**values)
