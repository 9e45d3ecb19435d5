# SPDX-License-Identifier: GPL-3.0-or-later
"""Follows its elements at once; short-lived texture."""

import bpy

field = bpy.context.object.stormfield

field.solve.samples = 160
field.solve.lambda_weight = 2.0
field.solve.even_speed = 0.3
field.solve.tolerance = 0.0001
field.bake.period = 32
field.bake.speed = 1.0
