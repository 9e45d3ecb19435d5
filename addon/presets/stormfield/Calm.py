# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes slowly in λ; long texture."""

import bpy

field = bpy.context.object.stormfield

field.solve.samples = 80
field.solve.lambda_weight = 40.0
field.solve.even_speed = 0.8
field.solve.tolerance = 0.0001
field.bake.period = 96
field.bake.speed = 1.0
