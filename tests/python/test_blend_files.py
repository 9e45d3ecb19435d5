# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of caches are found in files as Blender writes them; what cannot be read is said, never taken for empty."""

import gzip

import pytest
from stormfield.cache import blend_files
from stormfield.cache.blend_files import caches_named

TEXT = (
    b"BLENDER-v502\0\0//stormfield_cache/Ball/lambda-0123456789ab/field.usdc\0\0//x/Ball/exr/frames/frame_0001.exr\0"
    b"ENDB\0\0\0\0"
)
NAMES = {"lambda-0123456789ab", "exr"}


def compressed(data: bytes) -> bytes:
    zstandard = pytest.importorskip("zstandard", reason="zstandard is not installed; Blender brings it")
    half = len(data) // 2  # Blender writes many frames, and a table that readers skip
    frames = [zstandard.ZstdCompressor().compress(part) for part in (data[:half], data[half:])]
    return b"".join(frames) + b"\x5e\x2a\x4d\x18" + (4).to_bytes(4, "little") + b"seek"


WAYS = {"plain": bytes, "gzip": gzip.compress, "zstandard": compressed}


@pytest.mark.parametrize("way", WAYS)
def test_names_are_found_however_a_file_is_compressed(way, tmp_path):
    (tmp_path / "shot.blend").write_bytes(WAYS[way](TEXT))
    assert caches_named(tmp_path / "shot.blend") == NAMES


@pytest.mark.parametrize("way", WAYS)
def test_names_that_lie_across_two_parts_are_found(way, tmp_path, monkeypatch):
    for size in range(60, 90):
        monkeypatch.setattr(blend_files, "PART", size)
        (tmp_path / "shot.blend").write_bytes(WAYS[way](TEXT))
        assert caches_named(tmp_path / "shot.blend") == NAMES


@pytest.mark.parametrize("way", WAYS)
def test_a_damaged_file_is_not_taken_for_an_empty_one(way, tmp_path):
    (tmp_path / "shot.blend").write_bytes(WAYS[way](TEXT)[:-20])
    assert caches_named(tmp_path / "shot.blend") is None
    assert caches_named(tmp_path / "none.blend") is None


def test_files_and_backups_are_found_to_the_depth_asked_for(tmp_path):
    (tmp_path / "a" / "b").mkdir(parents=True)
    for name in ("one.blend", "one.blend1", "a/two.BLEND", "a/b/three.blend", "a/notes.txt"):
        (tmp_path / name).write_bytes(b"")
    found, all_seen = blend_files.blend_files(tmp_path, 1, 100)
    assert sorted(path.name for path in found) == ["one.blend", "one.blend1", "two.BLEND"] and all_seen
    assert blend_files.blend_files(tmp_path, 9, 2)[1] is False
