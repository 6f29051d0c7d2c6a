"""How a walk is seen: ground, camera, marks, level of detail, and where the viewer sits. Knows no drawing."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from protocols.parts import Level
from protocols.setting import SettingOf, SettingsPart, value_of

View = Literal["three_quarter", "side", "front", "legs", "elevated", "first_person"]
Ground = Literal["open_ground", "treadmill", "plain", "street"]
Coordinate = Annotated[float, Field(strict=True, ge=-1000.0, le=1000.0)]
Spot = Annotated[list[Coordinate], Field(min_length=2, max_length=2)]
Side = Annotated[int, Field(strict=True, ge=1, le=100)]
Distance = Annotated[float, Field(strict=True, ge=1.0, le=200.0)]
CameraHeight = Annotated[float, Field(strict=True, ge=0.1, le=100.0)]
Angle = Annotated[float, Field(strict=True, ge=5.0, le=100.0)]
Heading = Annotated[float, Field(strict=True, ge=-360.0, le=360.0)]

FOLLOWING: tuple[View, ...] = ("three_quarter", "side", "front", "legs")
"""The views that follow the walker."""

PLACED: tuple[View, ...] = ("elevated", "first_person")
"""The views that stand still at a place of their own."""

FIELD_OF_VIEW = 30.0
"""Degrees, vertical, when neither the study nor the display says otherwise."""


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class CameraPart(SettingsPart):
    """Where the walkers are seen from; each value is a constant, `$factor` or a table by a factor.

    In a table, null is what a value left out is, as the place of a view that follows the walker.
    """

    view: SettingOf[View] = Field(
        "three_quarter",
        description="three_quarter, side, front and legs follow the walker; elevated looks down at a place, "
        "first_person stands at one.",
    )
    distance: SettingOf[Distance] = Field(5.0, description="m from camera to walker or place.")
    height: SettingOf[CameraHeight] = Field(1.6, description="m above the ground.")
    field_of_view: SettingOf[Angle] | None = Field(
        None, description="Vertical, degrees; left out: what the screen fills for the viewer, else 30."
    )
    heading: SettingOf[Heading] | None = Field(
        None,
        description="Degrees in which the camera looks: 0 is the walkers' way, 90 their left, 180 towards them. "
        "The view's own when left out.",
    )
    place: SettingOf[Spot] | None = Field(
        None,
        description="m to the walkers' left and along their way from the start: what elevated looks at, or where "
        "first_person stands.",
    )

    @classmethod
    def takes(cls) -> dict[str, Any]:
        """Field to the type of its values."""
        return {
            "view": View, "distance": Distance, "height": CameraHeight, "field_of_view": Angle | None,
            "heading": Heading | None, "place": Spot | None,
        }  # fmt: skip

    def resolved(self, levels: Mapping[str, Level]) -> CameraView:
        """The camera of a trial with these levels; raises KeyError where a table has no value for one."""
        angle, heading, place = (value_of(it, levels) for it in (self.field_of_view, self.heading, self.place))
        return CameraView(
            view=value_of(self.view, levels),
            distance=float(value_of(self.distance, levels)),
            height=float(value_of(self.height, levels)),
            field_of_view=None if angle is None else float(angle),
            heading=None if heading is None else float(heading),
            place=None if place is None else (float(place[0]), float(place[1])),
        )


@dataclass(frozen=True)
class CameraView:
    """Where the walkers of a trial are seen from: m and degrees; see CameraPart, also for what None means."""

    view: View = "three_quarter"
    distance: float = 5.0
    height: float = 1.6
    field_of_view: float | None = None
    heading: float | None = None
    place: tuple[float, float] | None = None


class MarksLook(_Part):
    """How point lights and stick figures look."""

    dot_size: float = Field(0.15, strict=True, gt=0.0, le=5.0, description="Diameter of a dot, degrees.")
    line_width: float = Field(0.1, strict=True, gt=0.0, le=5.0, description="Width of a stick, degrees.")
    brightness: float = Field(1.0, strict=True, ge=0.0, le=1.0, description="Linear light; 1 is the display's white.")
    background: float = Field(0.0, strict=True, ge=0.0, le=1.0, description="Of the plain field, linear light.")
    seed: int = Field(0, strict=True, ge=0, description="Of the places of a scrambled point light.")
    each_trial: bool = Field(False, description="Scrambled differently in every trial; its number is added to seed.")


class Appearance(_Part):
    """What surrounds the walkers and how they are drawn: the part of a stimulus that is no motion."""

    ground: SettingOf[Ground] = Field("open_ground", description="street is for crowds, plain for point lights.")
    camera: CameraPart = CameraPart()
    marks: MarksLook = Field(MarksLook(), description="How point lights and stick figures look.")
    level_of_detail: Literal[0, 1, 2] | None = Field(
        None, description="0 draws every body at its finest, whatever its size; by size on the screen when left out."
    )


class Display(_Part):
    """Where the viewer sits before which screen, so that visual angles and perspective are true at full screen."""

    viewing_distance: float = Field(strict=True, ge=0.1, le=20.0, description="m from the eyes to the screen.")
    screen_height: float | None = Field(None, strict=True, ge=0.05, le=10.0, description="m, of the visible picture.")
    diagonal: float | None = Field(None, strict=True, ge=0.05, le=20.0, description="m, instead of the height.")
    aspect: Annotated[list[Annotated[int, Field(strict=True, ge=1, le=100)]], Field(min_length=2, max_length=2)] = (
        Field([16, 9], description="Width and height the diagonal goes with.")
    )

    @property
    def angle(self) -> float:
        """Degrees that the picture's height fills for the viewer; 0 when neither height nor diagonal is given."""
        height = self.screen_height
        if height is None:
            height = (self.diagonal or 0.0) * self.aspect[1] / math.hypot(*self.aspect)
        return math.degrees(2.0 * math.atan2(0.5 * height, self.viewing_distance))


def field_of_view(camera: CameraView, display: Display | None) -> float:
    """Degrees, vertical: the camera's own, else the true perspective's, else FIELD_OF_VIEW."""
    if camera.field_of_view is not None:
        return camera.field_of_view
    return display.angle if display is not None else FIELD_OF_VIEW
