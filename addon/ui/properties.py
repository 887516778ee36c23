# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panel lets a user choose, kept with the scene."""

import bpy


class EtalonSettings(bpy.types.PropertyGroup):
    """The settings of one comparison."""

    tolerance: bpy.props.FloatProperty(
        name="Tolerance",
        description="Relative difference that still counts as equal",
        subtype="PERCENTAGE",
        default=1.0,
        min=0.01,
        max=50.0,
        precision=2,
    )
    confidence: bpy.props.FloatProperty(
        name="Confidence",
        description="Confidence of the whole verdict, all regions together",
        subtype="PERCENTAGE",
        default=99.0,
        min=50.0,
        max=99.99,
        precision=2,
    )
    time: bpy.props.FloatProperty(
        name="Time",
        description="Budget in seconds; the comparison ends sooner where everything is decided sooner",
        subtype="TIME_ABSOLUTE",
        default=120.0,
        min=5.0,
        soft_max=3600.0,
    )
    partial: bpy.props.BoolProperty(
        name="Partial",
        description="With materials that are not simulated, compare the pixels that their light does not reach",
        default=False,
    )
    out: bpy.props.StringProperty(
        name="Output",
        description="Folder for the report and the images; // is the folder of this file",
        subtype="DIR_PATH",
        default="//etalon-out",
    )
