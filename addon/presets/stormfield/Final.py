# SPDX-License-Identifier: GPL-3.0-or-later
"""For the render."""

import bpy

field = bpy.context.object.stormfield

field.solve.samples = 120
field.solve.lambda_weight = 10.0
field.solve.even_speed = 0.5
field.solve.tolerance = 0.0001
field.bake.period = 72
field.bake.speed = 1.0
