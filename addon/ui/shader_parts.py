# SPDX-License-Identifier: GPL-3.0-or-later
"""What our own shaders share."""

#: A switch that Blender sets by its name: whether the framebuffer turns linear colours into sRGB.
TARGET = "srgbTarget"
#: GLSL: framebuffer_colour(sRGB, alpha) as Blender's built-in shaders write it. Needs the push constant TARGET.
FRAMEBUFFER_COLOUR = """
vec4 framebuffer_colour(vec3 colour, float alpha)
{
  vec3 linear_colour = mix(colour / 12.92, pow((colour + 0.055) / 1.055, vec3(2.4)), step(0.04045, colour));
  return vec4(srgbTarget ? linear_colour : colour, alpha);
}
"""
