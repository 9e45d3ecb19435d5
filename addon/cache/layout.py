# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of the folder, files and prims of a cache, and its time codes: usd.py explains the layout."""

import re

#: Names of the folders of caches: the sort, and the key of what made it (Plan.folder_name).
FOLDER_NAME = re.compile(rb"(?:lambda|frames|morse|exr|vdb)-[0-9a-f]{12}")
#: Names that folders of flow maps and volumes had before version 0.2.
OLD_FOLDERS = ("exr", "vdb")

#: Prims of the stage.
ROOT = "/stormfield"
PRIM = "/stormfield/mesh"
#: The one file that Blender opens: mesh and all samples.
STAGE = "field.usdc"
#: What stood in its place in caches of schema 1: value clips that join the sample files, and their mesh.
OLD_STAGE, OLD_MESH, OLD_CLIPS = "field.usda", "mesh.usdc", "clips.usda"
#: The manifest of a finished cache, and the plan of a bake in progress.
MANIFEST, PLAN = "manifest.json", "plan.json"
#: USD time codes per unit of λ; per frame there is one.
TIME_CODES_PER_LAMBDA = 1000.0
TIME_CODES_PER_SECOND = 24.0
#: What became of the edits of the design, in a λ cache.
EDITS = "edits.json"
