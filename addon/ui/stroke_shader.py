# SPDX-License-Identifier: GPL-3.0-or-later
"""Strokes on the GPU: one ribbon, drawn once for each stroke, that reads the stroke's points from a texture.

When λ changes one texture is filled; when nothing changes nothing is sent. Width, length on screen, and which strokes a
view has room for are found by the vertex shader, so that zooming is smooth. A light core within a dark rim stands out
from any surface: at least one of the two differs from it by more than 3 : 1.
"""

from dataclasses import dataclass
from functools import cache

import gpu
import numpy as np
from mathutils import Matrix

from .shader_parts import FRAMEBUFFER_COLOUR, TARGET
from .strokes import POINTS, Strokes

#: Cross-sections of the ribbon.
SECTIONS = 12
#: Strokes whose points are kept in one row of the texture.
PER_ROW = 64
#: Core in calm and in fast flow, and the rim (sRGB). Blue to yellow is told apart by eyes that confuse red and green.
SLOW, FAST, RIM = (0.46, 0.80, 1.00), (1.00, 0.93, 0.66), (0.015, 0.02, 0.03)

_VERTEX = """
vec4 texel(int i)
{
  int stroke = gl_InstanceID;
  return texelFetch(points, ivec2((stroke % PER_ROW) * (POINTS + 1) + i, stroke / PER_ROW), 0);
}

vec3 place(float t)
{
  float x = clamp(t, 0.0, 1.0) * float(POINTS - 1);
  int i = min(int(x), POINTS - 2);
  return mix(texel(i).xyz, texel(i + 1).xyz, x - float(i));
}

vec2 screen(vec4 clip)
{
  return clip.xy / max(clip.w, 1e-9) * 0.5 * view.xy;
}

void main()
{
  vec4 about = texel(POINTS);  /* speed, distance of its level, reach, number between 0 and 1 */
  vec4 middle = projection * vec4(texel((POINTS - 1) / 2).xyz, 1.0);
  float pixels = view.z / max(middle.w, 1e-9);  /* of one mesh unit */
  float room = smoothstep(0.95, 1.15, about.y * pixels / look.x) * step(1e-6, about.x) * step(1e-9, middle.w);
  float size = room > 0.0 ? mix(0.5, 1.0, room) : 0.0;  /* strokes that join grow from half their size */
  float share = clamp(look.y / max(about.z * pixels, 1e-9), 0.0, 1.0) * size;  /* of the traced length */
  float t = 0.5 + (clamp(along, 0.0, 1.0) - 0.5) * share;
  vec4 clip = projection * vec4(place(t), 1.0);
  vec4 ahead = projection * vec4(place(t + 0.04), 1.0), behind = projection * vec4(place(t - 0.04), 1.0);
  vec2 direction = screen(ahead) - screen(behind);
  float far = length(direction);
  direction = far > 1e-4 ? direction / far : vec2(1.0, 0.0);
  float border = (look.w > 0.5 ? 3.2 : 1.0) * look.z * size + moving.z + 1.0;
  float beyond = along < 0.0 ? -border : along > 1.0 ? border : 0.0;
  vec2 offset = direction * beyond + vec2(-direction.y, direction.x) * side * border;
  clip.xy += offset / (0.5 * view.xy) * clip.w;
  gl_Position = size > 0.0 ? clip : vec4(2.0, 2.0, 2.0, 1.0);
  float total = max(length(screen(projection * vec4(place(0.5 + 0.5 * share), 1.0))
                           - screen(projection * vec4(place(0.5 - 0.5 * share), 1.0))), 1.0);
  reach = vec2(clamp(along, 0.0, 1.0) * total + beyond, side * border);
  stroke = vec4(total, about.x, size, about.w);
}
"""

_FRAGMENT = """
void main()
{
  float total = stroke.x, t = clamp(reach.x / total, 0.0, 1.0);
  float outside = max(max(-reach.x, reach.x - total), 0.0);
  float d = length(vec2(outside, reach.y));
  float width = look.z * mix(0.38, 1.0, t);
  vec3 core = mix(vec3(SLOW), vec3(FAST), stroke.y);
  if (look.w > 0.5) {  /* arrows: shaft and head */
    float head = clamp((total - reach.x) / (6.0 * look.z), 0.0, 1.0);
    width = head < 1.0 ? 2.6 * look.z * head : 0.55 * look.z;
    d = outside > 0.0 && reach.x > total ? d : abs(reach.y);
    d = reach.x < 0.0 ? length(vec2(outside, reach.y)) : d;
  }
  if (moving.y > 0.5) {  /* a bright dash runs to the front */
    float behind = fract(moving.x + stroke.w - t);
    float dash = smoothstep(0.0, 0.06, behind) * (1.0 - smoothstep(0.12, 0.6, behind));
    width *= mix(0.55, 1.15, dash);
    core = mix(core * 0.92, vec3(1.0), 0.85 * dash);
  }
  width *= stroke.z;
  float inner = clamp(width - d + 0.5, 0.0, 1.0);
  float outer = clamp(width + moving.z - d + 0.5, 0.0, 1.0);
  if (outer <= 0.0) discard;
  fragColor = framebuffer_colour(mix(vec3(RIM), core, inner), outer * moving.w);
}
"""


@dataclass(frozen=True)
class StrokeLook:
    """Lengths in pixels."""

    distance: float  #: between strokes
    length: float  #: of a stroke in fast flow
    width: float  #: of the core at the front
    rim: float
    opacity: float = 1.0
    arrows: bool = False
    phase: float | None = None  #: of the moving dashes, in strokes; None while they rest


class StrokeBatch:
    """Strokes as a texture on the GPU."""

    def __init__(self, strokes: Strokes, spacing: np.ndarray, reach: np.ndarray) -> None:
        self.count = len(strokes.points)
        self._texture = _texture(strokes, spacing, reach) if self.count else None

    def draw(self, projection: Matrix, viewport: tuple[float, float], scale: float, look: StrokeLook) -> None:
        """projection: object to clip space. scale: pixels of one mesh unit where clip space has w = 1."""
        if self._texture is None:
            return
        shader = _shader()
        shader.bind()
        shader.uniform_sampler("points", self._texture)
        shader.uniform_float("projection", projection)
        shader.uniform_float("view", (*viewport, scale, 0.0))
        shader.uniform_float("look", (look.distance, 0.5 * look.length, 0.5 * look.width, float(look.arrows)))
        shader.uniform_float("moving", (look.phase or 0.0, float(look.phase is not None), look.rim, look.opacity))
        _ribbon().draw_instanced(shader, instance_start=0, instance_count=self.count)


def release() -> None:
    """Give shader and ribbon back while there is still a GPU to give them to."""
    _shader.cache_clear()
    _ribbon.cache_clear()


def _texture(strokes: Strokes, spacing: np.ndarray, reach: np.ndarray):
    rows = -(-len(strokes.points) // PER_ROW)
    content = np.zeros((rows * PER_ROW, POINTS + 1, 4), np.float32)
    count = len(strokes.points)
    content[:count, :POINTS, :3] = strokes.points
    content[:count, POINTS, 0] = strokes.speed
    content[:count, POINTS, 1] = spacing
    content[:count, POINTS, 2] = reach
    content[:count, POINTS, 3] = (np.arange(count) * 0.6180339887498949) % 1.0
    data = gpu.types.Buffer("FLOAT", content.size, content.ravel())
    return gpu.types.GPUTexture(((POINTS + 1) * PER_ROW, rows), format="RGBA32F", data=data)


@cache
def _shader():
    info = gpu.types.GPUShaderCreateInfo()
    info.define("POINTS", str(POINTS))
    info.define("PER_ROW", str(PER_ROW))
    for name, colour in (("SLOW", SLOW), ("FAST", FAST), ("RIM", RIM)):
        info.define(name, ", ".join(map(str, colour)))
    info.push_constant("MAT4", "projection")
    for name in ("view", "look", "moving"):
        info.push_constant("VEC4", name)
    info.push_constant("BOOL", TARGET)
    info.sampler(0, "FLOAT_2D", "points")
    info.vertex_in(0, "FLOAT", "along")
    info.vertex_in(1, "FLOAT", "side")
    interface = gpu.types.GPUStageInterfaceInfo("stormfield_stroke")
    interface.smooth("VEC2", "reach")
    interface.flat("VEC4", "stroke")
    info.vertex_out(interface)
    info.fragment_out(0, "VEC4", "fragColor")
    info.vertex_source(_VERTEX)
    info.fragment_source(FRAMEBUFFER_COLOUR + _FRAGMENT)
    return gpu.shader.create_from_info(info)


@cache
def _ribbon():
    """A strip of SECTIONS cross-sections, and one beyond each end for its round cap."""
    along = np.concatenate([[-0.01], np.linspace(0.0, 1.0, SECTIONS), [1.01]])
    layout = gpu.types.GPUVertFormat()
    for name in ("along", "side"):
        layout.attr_add(id=name, comp_type="F32", len=1, fetch_mode="FLOAT")
    vertices = gpu.types.GPUVertBuf(layout, len(along) * 2)
    vertices.attr_fill("along", np.repeat(along, 2).astype(np.float32).reshape(-1, 1))
    vertices.attr_fill("side", np.tile([-1.0, 1.0], len(along)).astype(np.float32).reshape(-1, 1))
    return gpu.types.GPUBatch(type="TRI_STRIP", buf=vertices)
