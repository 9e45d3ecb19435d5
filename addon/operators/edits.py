# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits of what the analysis shows: cancel a pair, cancel the weakest, simplify."""

import bpy
from bpy.props import FloatProperty, IntProperty

from ..edits.proposals import pair_steps, weakest_steps
from ..model.edits import EntityAt
from ..model.errors import InputError
from ..work import Step
from .edit_choice import picked, why_not, why_not_cancel
from .edit_operator import REACH, EditOperator


class EntityOperator(EditOperator):
    """Mix-in of operators that take entities away."""

    why_not = staticmethod(why_not)

    def tell(self, edit, graph, before):
        if len(graph.entities) >= before:
            text = f"As many are left at λ {graph.lam:.3f}: the edit acts at the nearest sample, λ {edit.lam[0]:.3f}"
            self.report({"WARNING"}, text)

    def cancels(self, pair: tuple[EntityAt, EntityAt]) -> dict:
        entities = [{"kind": entity.kind, "at": list(entity.at)} for entity in pair]
        return {"type": "cancel", "entities": entities, "reach": self.reach}


class STORMFIELD_OT_cancel_pair(EntityOperator, bpy.types.Operator):
    """Take away the two selected entities, or the selected one with the nearest that it can vanish with. Verified, or
    refused with the reason and nothing is changed. Esc stops"""

    bl_idname = "stormfield.cancel_pair"
    bl_label = "Cancel"
    bl_options = {"REGISTER", "UNDO"}
    why_not = staticmethod(why_not_cancel)

    reach: FloatProperty(**REACH)

    def start(self, context, obj):
        items = [obj.stormfield.analysis.ecg.items[index] for index in picked(obj)]
        self._picked = [EntityAt(item.kind, tuple(item.position)) for item in items]
        return super().start(context, obj)

    def propose(self, sample):
        first, second = (*self._picked, None)[:2]
        field = yield from sample.field()
        return self.cancels((yield from pair_steps(field, first, second)))


class STORMFIELD_OT_cancel_weakest(EntityOperator, bpy.types.Operator):
    """Take away the pair of least persistence that can be cancelled at this λ. Repeat it to simplify step by step. Esc
    stops"""

    bl_idname = "stormfield.cancel_weakest"
    bl_label = "Cancel Weakest"
    bl_options = {"REGISTER", "UNDO"}

    reach: FloatProperty(**REACH)

    def propose(self, sample):
        field = yield from sample.field()
        return self.cancels((yield from weakest_steps(field)))


class STORMFIELD_OT_simplify(EntityOperator, bpy.types.Operator):
    """Cancel pairs at this λ, the least persistent first, until so many fixed points and orbits are left. Esc stops"""

    bl_idname = "stormfield.simplify"
    bl_label = "Simplify"
    bl_options = {"REGISTER", "UNDO"}

    keep: IntProperty(
        name="Keep", description="Fixed points and periodic orbits that are left (count)", default=12, min=1
    )
    reach: FloatProperty(**REACH)

    def start(self, context, obj):
        count = len(obj.stormfield.analysis.ecg.items)
        if count <= self.keep:
            raise InputError(f"The field has {count} fixed points and orbits; keep fewer than that")
        return super().start(context, obj)

    def propose(self, _sample):
        yield Step(0.0, "Simplifying")
        return {"type": "simplify", "keep": self.keep, "reach": self.reach}

    def title(self, edit):
        return f"Keep {edit.keep}"


CLASSES = (STORMFIELD_OT_cancel_pair, STORMFIELD_OT_cancel_weakest, STORMFIELD_OT_simplify)
