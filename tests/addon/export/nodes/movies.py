# SPDX-License-Identifier: GPL-3.0-or-later
"""Small movies that Blender writes."""

import bpy
import numpy as np
import OpenImageIO

SIZE = 16


def write_movie(folder, frames, codec="FFV1", depth="8"):
    """The path of a movie of `frames`, each the RGBA of all its texels, in 0..1; its left half is half as bright.

    FFV1 keeps 8 bits as they are.
    """
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    names = [_write_frame(folder, number, rgba) for number, rgba in enumerate(frames, 1)]
    editor = scene.sequence_editor_create()
    strips = editor.strips if hasattr(editor, "strips") else editor.sequences
    strip = strips.new_image("frames", str(folder / names[0]), 1, 1)
    for name in names[1:]:
        strip.elements.append(name)
    scene.frame_start, scene.frame_end = 1, len(names)
    render, image = scene.render, scene.render.image_settings
    render.resolution_x = render.resolution_y = SIZE
    render.resolution_percentage = 100
    if hasattr(image, "media_type"):  # since Blender 5.0
        image.media_type = "VIDEO"
    image.file_format = "FFMPEG"
    render.ffmpeg.format, render.ffmpeg.codec = "MKV", codec
    image.color_mode, image.color_depth = "RGBA" if (codec, depth) == ("FFV1", "8") else "RGB", depth
    scene.view_settings.view_transform = "Standard"
    render.filepath = str(folder / f"{codec}{depth}.mkv")
    bpy.ops.render.render(animation=True)
    return render.filepath


def _write_frame(folder, number, rgba):
    texels = np.empty((SIZE, SIZE, 4), np.float32)
    texels[:] = rgba
    texels[:, : SIZE // 2, :3] *= 0.5
    buffer = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(SIZE, SIZE, 4, OpenImageIO.UINT8))
    buffer.specmod().attribute("oiio:UnassociatedAlpha", 1)
    buffer.set_pixels(OpenImageIO.ROI(), texels)
    name = f"frame{number:03d}.png"
    assert buffer.write(str(folder / name))
    return name
