# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panels of the sidebar are made of."""

from ..operators import requirements
from ..scene.read.active_field import active_field
from ..session import running


class SidebarPanel:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Stormfield"

    def settings_layout(self):
        """The panel's layout for settings: names on the left, no dots for keyframes."""
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        return self.layout


class FieldPanel(SidebarPanel):
    """A panel that shows only where there is a field."""

    @classmethod
    def poll(cls, context):
        return active_field(context) is not None


def job_button(context, layout, operator, obj, icon: str, on_right=None, titles: tuple[str, ...] = ()) -> None:
    """The large button of a panel's long work, and below it why it is grey; while it runs, its progress instead.

    on_right(row): draws more on the button's right. titles: of other jobs whose progress this panel shows.
    """
    if draw_progress(layout, operator.job_title, *titles):
        return
    row = layout.row(align=True)
    row.scale_y = 1.4
    row.operator(operator.bl_idname, icon=icon)
    if on_right is not None:
        on_right(row)
    hint(context, layout, operator.why_not(obj))


def draw_progress(layout, *titles: str) -> bool:
    """The running job instead of its button, where it has one of these titles."""
    job = running.current()
    if job is None or job.title not in titles:
        return False
    row = layout.row(align=True)
    row.progress(factor=job.fraction, text=f"{job.title} {job.fraction:.0%}", type="BAR")
    row.operator("stormfield.cancel_job", text="", icon="CANCEL")
    if job.message and job.message != job.title:
        layout.label(text=job.message)
    return True


def hint(context, layout, reason: str) -> None:
    """Why the button above is grey. The Field panel alone names what this Blender lacks."""
    if reason and reason != requirements.problem():
        text_lines(context, layout, reason, icon="INFO")


def text_lines(context, layout, text: str, icon: str) -> None:
    """A sentence in as many lines as the sidebar's width asks for."""
    width = max(18, int(context.region.width / (7.5 * context.preferences.system.ui_scale)) - 5)
    column = layout.column(align=True)
    line = ""
    for word in text.split():
        if line and len(line) + len(word) + 1 > width:
            column.label(text=line, icon=icon)
            icon, line = "BLANK1", word
        else:
            line = f"{line} {word}".strip()
    column.label(text=line, icon=icon)
