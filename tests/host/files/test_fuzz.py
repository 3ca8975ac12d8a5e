"""Corrupted files of every format: a cloud, or one line of error, at once, without a warning."""

import pytest

from splatline.host.files.readers import FORMATS, read_cloud
from tests.host.files.corrupt import whole_files
from tests.host.files.fuzz import limited_memory, load_readers, run_seed

PART = 960


def test_the_whole_files_are_clouds_of_every_format(tmp_path):
    samples = whole_files()
    for sample in samples:
        path = tmp_path / sample.name
        path.write_bytes(sample.pack(sample.data))
        assert len(read_cloud(path)) in (60, 8, 4)  # the meshes are smaller
    suffixes = {sample.name.removesuffix(".gz")[1:] for sample in samples}
    assert suffixes == set(FORMATS)


@pytest.mark.parametrize("part", range(5))
def test_corrupted_files_are_read_or_refused_in_one_line(tmp_path, part):
    samples = whole_files()
    load_readers(samples, tmp_path)
    with limited_memory():
        results = [
            (seed, *run_seed(seed, samples, tmp_path)[:2])
            for seed in range(part * PART, (part + 1) * PART)
        ]
    assert not [result for result in results if result[2]]
    outcomes = [outcome for _, outcome, _ in results]
    assert min(outcomes.count("cloud"), outcomes.count("refused")) > PART // 10
