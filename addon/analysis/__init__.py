# SPDX-License-Identifier: GPL-3.0-or-later
"""What a field does, as plain data: graphs of entities, paths over λ. No Blender here."""
