# SPDX-License-Identifier: GPL-3.0-or-later
"""The options that the panel shows, kept with the scene.

They are made from the declarations of `Settings`.
"""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any

import bpy

from ...lib.settings.comparison import Settings
from ...lib.settings.declaration import Option
from ...lib.settings.models import ModelName
from ...lib.settings.presets import PRESETS
from ...lib.settings.units import Choice, FilePath, Flag, Seconds, Share, Unit, Whole
from .preferences import preferred_folder, preferred_threads

SHOWN = tuple(declared for declared in Settings.options() if declared.panel is not None)

# What the panel multiplies a value by to show it: shares are shown in per cent.
_PERCENT = 100.0


def _share(declared: Option, common: dict[str, Any]) -> Any:
    limits = {name: _PERCENT * value for name, value in _limits(declared).items()}
    common["default"] *= _PERCENT
    return bpy.props.FloatProperty(**common, **limits, subtype="PERCENTAGE", precision=2)


def _seconds(declared: Option, common: dict[str, Any]) -> Any:
    return bpy.props.FloatProperty(**common, **_limits(declared), subtype="TIME_ABSOLUTE")


def _flag(declared: Option, common: dict[str, Any]) -> Any:
    return bpy.props.BoolProperty(**common)


def _path(declared: Option, common: dict[str, Any]) -> Any:
    return bpy.props.StringProperty(**common, subtype="DIR_PATH")


def _name(declared: Option, common: dict[str, Any]) -> Any:
    return bpy.props.StringProperty(**common)


def _whole(declared: Option, common: dict[str, Any]) -> Any:
    return bpy.props.IntProperty(**common, **_limits(declared))


def _choice(declared: Option, common: dict[str, Any]) -> Any:
    names = declared.unit.names
    return bpy.props.EnumProperty(**common, items=[(name, name.replace("_", " ").capitalize(), "") for name in names])


_MAKERS = {
    Share: _share,
    Seconds: _seconds,
    Flag: _flag,
    FilePath: _path,
    Whole: _whole,
    Choice: _choice,
    ModelName: _name,
}


def _limits(declared: Option) -> dict[str, float]:
    """The limits of a number, by Blender's names."""
    panel = declared.panel
    found = {"min": panel.low, "max": panel.high, "soft_max": panel.soft_high}
    return {name: value for name, value in found.items() if value is not None}


def make_property(declared: Option) -> Any:
    """Blender's property for one option: its label, tooltip, default and limits."""
    panel = declared.panel
    help = declared.help[0].upper() + declared.help[1:]
    common = {
        "name": panel.label,
        "description": f"{help}; {panel.help}" if panel.help else help,
        "default": declared.default if panel.default is None else panel.default,
    }
    return _MAKERS[type(declared.unit)](declared, common)


def _value(unit: Unit, shown: Any) -> Any:
    """A property's value in the option's unit.

    Blender keeps single precision, of which six digits are what was typed.
    """
    if isinstance(shown, float):
        shown = float(f"{shown:.6g}")
    if isinstance(unit, ModelName) and not shown:
        return None
    return shown / _PERCENT if isinstance(unit, Share) else shown


class EtalonSettings(bpy.types.PropertyGroup):
    """The settings of one comparison."""

    __annotations__ = {declared.name: make_property(declared) for declared in SHOWN}


def apply_preset(scene: bpy.types.Scene, name: str) -> None:
    """Set the options of `scene` that the preset of that name has."""
    for declared in SHOWN:
        if declared.name in PRESETS[name]:
            value = PRESETS[name][declared.name]
            setattr(scene.etalon, declared.name, _PERCENT * value if isinstance(declared.unit, Share) else value)


def read_settings(scene: bpy.types.Scene, **instead: Any) -> Settings:
    """The panel's settings of `scene`, but for those that are given `instead`.

    Without a preference, one processor is left to the window. The caller decides where results go.
    """
    chosen = {d.name: _value(d.unit, getattr(scene.etalon, d.name)) for d in SHOWN if not isinstance(d.unit, FilePath)}
    return Settings(**chosen | instead, threads=preferred_threads() or max(1, (os.cpu_count() or 2) - 1))


def output_folder(scene: bpy.types.Scene) -> Path:
    """The folder chosen in the panel.

    For a file that was never saved it is one among the system's temporary files.
    """
    chosen = scene.etalon.out
    if not scene.etalon.is_property_set("out"):
        chosen = preferred_folder() or chosen
    if chosen.startswith("//") and not bpy.data.filepath:
        return Path(tempfile.gettempdir()) / chosen.lstrip("/")
    return Path(bpy.path.abspath(chosen))
