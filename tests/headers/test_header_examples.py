# SPDX-License-Identifier: GPL-3.0-or-later
"""Every example in the opening comment of a header compiles.

An example is a block of lines `//   code` after an empty line, three spaces deep; formulas stand five spaces deep. What
an example takes for granted is declared here: CONTEXT for all, OWN for a header whose names mean something else.
"""

import re
import subprocess
import sysconfig
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

CONTEXT = """
Points points
Triangles triangles
TriangleMesh& mesh
std::shared_ptr<const VertexCharts> charts
VectorField field
FlatFaces faces
SurfacePoint p, seed
Eigen::Vector3d barycentric
Index e, f, s, v
extern Progress progress
"""
ELEMENTS = "std::vector<DesignElement> elements, movedElements"
SHARED = """
std::shared_ptr<const VectorField> field
std::shared_ptr<const FlatFaces> faces
"""
TRACE = """
CrossingTrace trace
std::vector<Index> componentOf
"""
LAMBDAS = """
ParameterizedField field, fieldOverLambda
std::vector<SurfacePoint> seeds
"""
TASK = """
EditTask task
Interval interval
ConleyIndex index
extern EditResult result
"""
#: One declaration a line; constants, where they do not say what else they are.
OWN = {
    "bindings/job.h": """
using namespace bindings
extern py::module_ m
extern py::object toPython(const SpaceTimeResult& result)
extern Work<SpaceTimeResult> prepare(const ConstraintSet& constraints)
""",
    "design/design_solve.h": ELEMENTS,
    "design/element_constraints.h": ELEMENTS,
    "design/log_map_cache.h": ELEMENTS + "\nElementOptions options",
    "edit/detail/block_growth.h": "Topology topology\nInterval interval",
    "edit/detail/block_sequence.h": """
Topology topology
Interval interval
ConleyIndex index
extern void use(const Block& block)
""",
    "edit/detail/cancel_search.h": TASK,
    "edit/detail/cancel_steps.h": TASK,
    "edit/detail/harmonic_fill.h": "std::vector<Index> freeVertices",
    "edit/detail/interval_index.h": "Topology topology\nInterval interval",
    "edit/detail/rotation_fill.h": "std::vector<Index> freeVertices",
    "edit/detail/verification.h": "Topology before, after\nInterval interval\nContents wanted",
    "edit/entity_names.h": "Topology topology",
    "edit/interval.h": "Topology topology",
    "edit/transform.h": LAMBDAS,
    "io/flow_map.h": "FaceUvs uvs",
    "io/voxel_band.h": "ClosestPointQuery query",
    "morse/detail/deadline.h": "extern void work(Progress* limited)",
    "morse/detail/exit_set.h": "FaceSets sets",
    "morse/morse_model.h": "std::shared_ptr<const FlatFaces> faces",
    "morse/conley_index.h": "FaceSets sets\nIndexPair pair",
    "morse/morse_analysis.h": "std::shared_ptr<const FlatFaces> faces",
    "morse/morse_connection_graph.h": "CombinatorialMap map\nComponents components\nFaceSets sets",
    "morse/morse_decomposition.h": "CombinatorialMap map\nMorseOptions options",
    "morse/persistence.h": "ErrorBoundedMap bounded\nFaceSets sets\ndouble epsilon",
    "morse/tau_refinement.h": SHARED,
    "morse/transit_persistence.h": "TransitRefinement refinement",
    "morse/transit_refinement.h": SHARED,
    "solver/space_time_solver.h": "ConstraintSet constraints, movedConstraints",
    "streamlines/detail/line_tracer.h": "LineRules rules\nextern NearLines lines",
    "streamlines/detail/straightest_path.h": "SurfacePoint from\ndouble length",
    "texture/flow_attributes.h": LAMBDAS + "StreamFunctionSolver streams\nIndex j",
    "texture/rotation.h": "Points vectors",
    "topology/detail/known_limit_sets.h": """
std::vector<FixedPoint> fixedPoints
std::vector<TrappingRegion> trappingRegions
""",
    "topology/detail/orbit_search.h": "std::vector<Index> componentOf\nOrbitCandidate candidate",
    "topology/detail/return_map.h": TRACE + "Section section\nIndex component",
    "topology/detail/section.h": "Index halfedge\nEdgePassage passage",
    "topology/detail/streamline_search.h": TRACE + "KnownLimitSets limitSets",
    "topology/detail/trapping_region.h": "FixedPoint fixedPoint\nComplex p",
    "topology/zero_search.h": "Index face",
    "topology/detail/topology_memory.h": """
Topology topologyBefore
VectorField before, now
std::vector<FixedPoint> fixedPointsNow
StreamlineSeed seed
extern void use(const StreamlineEnd& end)
""",
    "tracing/arrivals.h": "ParameterizedField field",
    "tracing/detail/face_steps.h": "StepLimits limits\nFaceFlow faceFlow\nSidePoint entry\nEigen::Vector3d inside",
    "tracing/flat_faces.h": "Complex* values",
    "tracing/particle_lines.h": LAMBDAS + "std::vector<SurfacePoint> curve",
    "tracing/pathline.h": LAMBDAS,
    "tracing/streamline.h": "std::vector<SurfacePoint> seeds",
    "tracking/persistence.h": "Tracking tracking",
    "tracking/tracking.h": LAMBDAS + "extern std::vector<Vec3> begins",
}


def declared(lines: str) -> str:
    """Declarations of what an example takes for granted."""
    given = [line for line in lines.splitlines() if line]
    return "\n".join(f"{line if line.startswith(('extern', 'using')) else 'extern const ' + line};" for line in given)


def examples(text: str) -> list[tuple[int, str]]:
    """The examples of a header's opening comment: number of the first line, code."""
    head = text.partition("#pragma once")[0].splitlines()
    found: list[tuple[int, list[str]]] = []
    inside, before = False, "//"
    for number, line in enumerate(head, 1):
        if not inside and before == "//" and re.match(r"//   \S", line):
            found.append((number, []))
            inside = True
        inside = inside and line.startswith("//   ")
        if inside:
            found[-1][1].append(line[5:])
        before = line
    return [(number, "\n".join(lines)) for number, lines in found]


def source(headers: dict[str, str]) -> str:
    """One translation unit with the examples of all headers, each in a function and a namespace of its own."""
    includes = [f'#include "{path}"' for path in headers]
    parts = [*includes, "namespace stormfield::examples {", declared(CONTEXT)]
    count = 0
    for path, text in headers.items():
        for line, code in examples(text):
            count += 1
            parts += [
                f'#line 1 "context of {path}"',
                f"namespace example{count} {{",
                declared(OWN.get(path, "")),
                "void example() {",
            ]
            parts += [f'#line {line} "native/{path}"', code, "}", "}"]
    return "\n".join([*parts, "}", ""])


def faults(headers: dict[str, str], folder: Path) -> str:
    """What the compiler says of the examples; nothing when they are right."""
    import pybind11

    file = folder / "examples.cpp"
    file.write_text(source(headers), encoding="utf-8")
    includes = [ROOT / "native", "/usr/include/eigen3", pybind11.get_include(), sysconfig.get_path("include")]
    command = ["g++", "-std=c++20", "-fsyntax-only", *(f"-I{path}" for path in includes), file]
    return subprocess.run(command, capture_output=True, text=True, check=False).stderr


@pytest.fixture(scope="module")
def headers() -> dict[str, str]:
    native = ROOT / "native"
    texts = {path.relative_to(native).as_posix(): path.read_text() for path in sorted(native.rglob("*.h"))}
    return {path: text for path, text in texts.items() if examples(text)}


def test_every_example_in_a_header_compiles(headers, tmp_path):
    found = faults(headers, tmp_path)
    assert not found, found


def test_there_are_examples_and_their_context_is_used(headers):
    assert len(headers) > 20
    assert set(OWN) <= set(headers)


def test_an_example_that_is_wrong_is_named(tmp_path):
    text = (ROOT / "native/mesh/triangle_mesh.h").read_text()
    wrong = re.sub(r"^//   \S.*$", "//   mesh.noSuchThing();", text, count=1, flags=re.M)
    assert "native/mesh/triangle_mesh.h" in faults({"mesh/triangle_mesh.h": wrong}, tmp_path)


def test_examples_are_found():
    comment = "// - Text.\n//   Text.\n//\n//     y = f(x)\n//\n//   int a;\n//     a = 1;\n//\n//   f(a);\n"
    assert examples(comment + "#pragma once\n//\n//   no;\n") == [(6, "int a;\n  a = 1;"), (9, "f(a);")]
