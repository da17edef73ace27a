"""A bag from a stranger, its checksums all in order: what would reach outside or never end is refused."""

import json
import os

import h5py
import numpy as np
import pytest
from archived_lab import CAMPAIGN, describe, faults, named, seal, sha256_of
from small_unit import call

from fogreduce.archive import walk

RESULTS = f"data/results/{CAMPAIGN}/r1"
DATASET = f"{RESULTS}/datasets/ingest.nc"
RUN = f"data/campaigns/{CAMPAIGN}/runs/r1"


def refused(bag, *said):
    """The command refuses the bag: exit status 2, every word said, no traceback."""
    status, out, err = call("verify", bag)
    assert status == 2, out
    assert "Traceback" not in err
    for words in said:
        assert words in err, err
    return err


@pytest.mark.parametrize(
    "path",
    [
        "data/../../outside.txt",
        "../outside.txt",
        "/etc/hostname",
        "data/a/../../b",
        "data//x",
        "data/./x",
        "~/x",
    ],
)
def test_a_path_that_leaves_the_bag(bag, path):
    (bag.parent / "outside.txt").write_text("secret\n")
    with (bag / "manifest-sha256.txt").open("a") as file:
        file.write(f"{sha256_of(bag.parent / 'outside.txt')}  {path}\n")
    seal_tags(bag)
    refused(bag, "manifest-sha256.txt", "leaves the bag")


@pytest.mark.parametrize("path", ["data/%2e%2e/x%0a", "data/a\\b", "data/\x1b[2J", "data/x%0Ay"])
def test_a_path_that_is_not_plain(bag, path):
    with (bag / "manifest-sha256.txt").open("a") as file:
        file.write(f"{'0' * 64}  {path}\n")
    seal_tags(bag)
    assert "\x1b" not in refused(bag, "data")


@pytest.mark.parametrize("target", ["/etc/hostname", "r2", "nowhere"])
def test_a_link(bag, target):
    (bag / RUN / "link").symlink_to(target)
    refused(bag, f"{RUN}/link: found a link")


def test_a_link_in_place_of_a_file_with_the_right_bytes(bag):
    capture = bag / RUN / "capture.fogcap"
    outside = bag.parent / "outside"
    capture.rename(outside)
    capture.symlink_to(outside)
    refused(bag, f"{RUN}/capture.fogcap: found a link")


def test_a_folder_that_is_a_link(bag):
    (bag / RUN).rename(bag.parent / "outside")
    (bag / RUN).symlink_to(bag.parent / "outside")
    refused(bag, f"{RUN}: found a link")


def test_a_pipe_does_not_make_it_wait(bag):
    os.mkfifo(bag / RUN / "pipe")
    refused(bag, f"{RUN}/pipe")


def test_a_name_with_an_escape_is_shown_harmless(bag):
    (bag / RUN / "\x1b[2Jx").write_text("")
    assert "\x1b" not in refused(bag, "control characters")


def test_a_name_that_is_not_utf8(bag):
    os.close(os.open(os.fsencode(bag / RUN) + b"/\xff", os.O_CREAT | os.O_WRONLY))
    refused(bag, "not UTF-8")


def test_an_absurd_size(bag):
    """A sparse file costs its maker nothing, and its reader hours."""
    with (bag / RUN / "capture.fogcap").open("r+b") as file:
        file.truncate(walk.LARGEST_FILE_BYTES + 1)
    refused(bag, f"{RUN}/capture.fogcap", str(walk.LARGEST_FILE_BYTES))


def test_folders_without_end(bag):
    deep = bag / "data"
    for _ in range(30):
        deep /= "d"
    deep.mkdir(parents=True)
    (deep / "x").write_text("")
    refused(bag, "nested without end")


def test_files_without_end(bag, monkeypatch):
    monkeypatch.setattr(walk, "MOST_FILES", 50)
    refused(bag, "files without end")


def test_json_nested_without_end(bag):
    cover_up(bag, f"{RESULTS}/reports/fit.json", ("[" * 200_000).encode())
    refused(bag, "reports/fit.json")


@pytest.mark.parametrize("raw", [b"[1]", b"{", b'{"a": NaN}', b"\xff\xfe", b'{"a": ' + b"9" * 5000 + b"}"])
@pytest.mark.parametrize("name", ["manifest.json", "outputs.json", "reports/fit.json"])
def test_json_that_is_none(bag, name, raw):
    cover_up(bag, f"{RESULTS}/{name}", raw)
    refused(bag, name)


def test_an_output_that_lies_outside(bag):
    path = bag / RESULTS / "outputs.json"
    data = json.loads(path.read_text())
    data["files"][0]["name"] = "../../../../../../etc/hostname"
    cover_up(bag, f"{RESULTS}/outputs.json", json.dumps(data).encode())
    refused(bag, "outputs.json")


@pytest.mark.parametrize("inputs", ["/etc", "../..", "campaigns/../../x", "software/fogreduce/cli"])
def test_a_record_whose_folders_lie_outside(bag, inputs):
    data = json.loads((bag / "data/archive.json").read_text())
    data["runs"][0]["inputs"] = inputs
    cover_up(bag, "data/archive.json", json.dumps(data).encode())
    refused(bag, "data/archive.json", "inputs")


@pytest.mark.parametrize(
    "text",
    [
        "run_id: !!python/object/apply:os.system ['touch TOUCHED']\n",
        "a: &a [x, x]\nb: [*a, *a]\n",
        "notes: !custom x\n",
        "a: [" + "[" * 100_000 + "\n",
    ],
)
def test_yaml_that_runs_code_or_fills_the_memory(bag, text, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    cover_up(bag, f"{RUN}/run.yaml", text.encode(), inputs=True)
    refused(bag, "run.yaml")
    assert not (tmp_path / "TOUCHED").exists()


def external_link(file):
    file["more"] = h5py.ExternalLink("/etc/hostname", "/")


def external_data(file):
    file.create_dataset("more", (10,), "i1", external=[("/etc/hostname", 0, 10)])


def virtual_data(file):
    layout = h5py.VirtualLayout((10,), "i1")
    layout[:] = h5py.VirtualSource("other.nc", "x", (10,))
    file.create_virtual_dataset("more", layout)


def unknown_filter(file):
    creation = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    creation.set_chunk((10,))
    # 32,015 is zstandard; optional, so that HDF5 lets the dataset be made without it.
    creation.set_filter(32015, h5py.h5z.FLAG_OPTIONAL, (1,))
    h5py.h5d.create(file.id, b"more", h5py.h5t.NATIVE_INT8, h5py.h5s.create_simple((10,)), creation)


def huge_shape(file):
    file.create_dataset("more", (10**15,), "i1", chunks=(1 << 20,))


def soft_link(file):
    file["more"] = h5py.SoftLink("/volts")


@pytest.mark.parametrize(
    "spoil", [external_link, external_data, virtual_data, unknown_filter, huge_shape, soft_link]
)
def test_a_dataset_that_reaches_outside(bag, spoil):
    with h5py.File(bag / DATASET, "r+") as file:
        spoil(file)
    cover_up(bag, DATASET, None)
    refused(bag, f"{DATASET}: found 'more'")


def test_a_dataset_that_is_none(bag):
    cover_up(bag, DATASET, np.random.default_rng(1).bytes(5000))
    refused(bag, DATASET, "HDF5 does not read")


def test_a_dataset_that_keeps_hdf5_busy_for_ever(bag):
    raw = bytearray((bag / DATASET).read_bytes())
    at = raw.index(b"GCOL") + 16  # the heap of strings; its objects: index, count, size, padded content
    while raw[at]:
        at += 16 + -(-int.from_bytes(raw[at + 8 : at + 16], "little") // 8) * 8
    raw[at + 8 : at + 16] = bytes(8)  # the space that is left, of no size
    cover_up(bag, DATASET, bytes(raw))
    refused(bag, DATASET, "HDF5 does not read")


def test_a_cover_up_without_a_change_is_sound(bag):
    """The tests above refuse for what they spoil, not for how they cover it up."""
    cover_up(bag, DATASET, None)
    cover_up(bag, f"{RUN}/run.yaml", None, inputs=True)
    assert faults(bag) == []
    (bag / DATASET).unlink()
    assert named(faults(bag), bag, DATASET)


def seal_tags(bag):
    tags = ["bag-info.txt", "bagit.txt", "manifest-sha256.txt"]
    text = "".join(f"{sha256_of(bag / tag)}  {tag}\n" for tag in tags)
    (bag / "tagmanifest-sha256.txt").write_text(text)


def cover_up(bag, name, raw, inputs=False):
    """Put bytes in place of a file's, and make everything that says what it was fit."""
    path = bag / name
    if raw is not None:
        path.write_bytes(raw)
    results = bag / RESULTS
    if inputs:
        manifest = json.loads((results / "manifest.json").read_text())
        for entry in manifest["inputs"]:
            if entry["name"] == path.name:
                entry["sha256"], entry["bytes"] = sha256_of(path), path.stat().st_size
        (results / "manifest.json").write_text(json.dumps(manifest))
        reversion(bag, manifest)
    if path.name != "outputs.json":
        outputs = json.loads((results / "outputs.json").read_text())
        for entry in outputs["files"]:
            file = results / entry["name"]
            entry["sha256"], entry["bytes"] = sha256_of(file), file.stat().st_size
        (results / "outputs.json").write_text(json.dumps(outputs))
    describe(bag)
    seal(bag)


def reversion(bag, manifest):
    """Give a changed manifest its version id, and every result of the run that id."""
    from fogreduce.provenance.digest import data_digest

    old = manifest.pop("version_id")
    new = data_digest(manifest)[:16]
    results = bag / RESULTS
    (results / "manifest.json").write_text(json.dumps({"version_id": new, **manifest}))
    for path in [*results.glob("tables/*"), *results.glob("reports/*"), results / "outputs.json"]:
        path.write_text(path.read_text().replace(old, new))
    record = bag / "data/archive.json"
    record.write_text(record.read_text().replace(old, new))
    for path in results.glob("datasets/*.nc"):
        with h5py.File(path, "r+") as file:
            file.attrs["version_id"] = new
