# SPDX-License-Identifier: GPL-3.0-or-later
"""Fast to solve: to find the design."""

import bpy

field = bpy.context.object.stormfield

field.solve.samples = 30
field.solve.lambda_weight = 10.0
field.solve.even_speed = 0.5
field.solve.tolerance = 0.001
field.bake.period = 48
field.bake.speed = 1.0
