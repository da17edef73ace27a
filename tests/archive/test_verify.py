"""Whatever is changed in a bag is found, and the file is named."""

import json
import random
import shutil

import pytest
from archived_lab import CAMPAIGN, describe, faults, named, seal, sha256_of
from small_unit import call, succeed

RESULTS = f"data/results/{CAMPAIGN}"
CAPTURE = f"data/campaigns/{CAMPAIGN}/runs/r1/capture.fogcap"


def test_a_sound_bag(archived):
    out = succeed("verify", archived.bag, "--expect", archived.digest)
    assert out.startswith(archived.digest)


@pytest.fixture(scope="module")
def flipping(archived, tmp_path_factory):
    """A bag to flip bits in, each flipped back."""
    return archived.copy(tmp_path_factory.mktemp("flipping") / "bag")


def flip_and_verify(bag, places):
    """Flip a bit at each place, verify, flip it back; the places that were not found, or not named."""
    missed = []
    for path, byte, bit in places:
        with path.open("r+b") as file:
            file.seek(byte)
            old = file.read(1)
            file.seek(byte)
            file.write(bytes([old[0] ^ (1 << bit)]))
        found = faults(bag)
        # A manifest that is spoilt shows by the files that it lists, and is named with them.
        if not any(str(path) in line for line in found):
            missed.append((path.relative_to(bag).as_posix(), byte, bit, found[:2]))
        with path.open("r+b") as file:
            file.seek(byte)
            file.write(old)
    return missed


def random_places(bag, count, seed):
    """`count` bits of a bag, every byte as likely as any other."""
    draw = random.Random(seed)
    files = sorted(path for path in bag.rglob("*") if path.is_file())
    sizes = [path.stat().st_size for path in files]
    for path in draw.choices(files, weights=sizes, k=count):
        yield path, draw.randrange(path.stat().st_size), draw.randrange(8)


def test_flipped_bits_are_found(flipping):
    assert flip_and_verify(flipping, random_places(flipping, 40, seed=1)) == []
    assert faults(flipping) == []


@pytest.mark.slow
def test_a_thousand_flipped_bits_are_found(flipping):
    assert flip_and_verify(flipping, random_places(flipping, 1000, seed=2)) == []
    assert faults(flipping) == []


@pytest.mark.parametrize("name", ["bagit.txt", "bag-info.txt", "tagmanifest-sha256.txt"])
def test_a_flipped_bit_in_a_tag_file_is_found(flipping, name):
    path = flipping / name
    places = [(path, byte, bit) for byte in range(0, path.stat().st_size, 11) for bit in (0, 5)]
    assert flip_and_verify(flipping, places) == []


def test_a_file_added(bag):
    (bag / RESULTS / "r1" / "tables" / "more.csv").write_text("a\n")
    assert named(faults(bag), bag, f"{RESULTS}/r1/tables/more.csv")


def test_a_tag_file_added(bag):
    (bag / "fetch.txt").write_text("https://example.org/x 1 data/x\n")
    assert named(faults(bag), bag, "fetch.txt")


def test_a_file_removed(bag):
    (bag / CAPTURE).unlink()
    assert named(faults(bag), bag, CAPTURE)


def test_a_file_renamed(bag):
    (bag / CAPTURE).rename(bag / CAPTURE.replace("capture", "captured"))
    found = faults(bag)
    assert named(found, bag, CAPTURE)
    assert named(found, bag, CAPTURE.replace("capture", "captured"))


@pytest.mark.parametrize("size", [0, 63, 5000])
def test_a_file_truncated(bag, size):
    with (bag / CAPTURE).open("r+b") as file:
        file.truncate(size)
    assert named(faults(bag), bag, CAPTURE)


def test_files_swapped_between_runs(bag):
    one, other = (f"{RESULTS}/{run}/tables/drift.csv" for run in ("r1", "r2"))
    swap(bag / one, bag / other)
    found = faults(bag)
    assert named(found, bag, one)
    assert named(found, bag, other)


@pytest.mark.parametrize(
    "name", ["tables/drift.csv", "reports/fit.json", "datasets/ingest.nc", "manifest.json"]
)
def test_files_swapped_and_every_checksum_made_anew(bag, name):
    """Fixity is perfect; the results' own records still tell."""
    one, other = (f"{RESULTS}/{run}/{name}" for run in ("r1", "r2"))
    swap(bag / one, bag / other)
    describe(bag)
    seal(bag)
    found = faults(bag)
    assert any(str(bag / one) in line for line in found)
    assert any(str(bag / other) in line for line in found)


def test_captures_swapped_and_every_checksum_made_anew(bag):
    other = CAPTURE.replace("/r1/", "/r2/")
    swap(bag / CAPTURE, bag / other)
    describe(bag)
    seal(bag)
    found = faults(bag)
    assert named(found, bag, CAPTURE)
    assert named(found, bag, other)


def test_a_run_swapped_whole_and_every_checksum_made_anew(bag):
    swap(bag / RESULTS / "r1", bag / RESULTS / "r2")
    describe(bag)
    seal(bag)
    found = faults(bag)
    assert any("/r1/manifest.json" in line for line in found)
    assert any("/r2/manifest.json" in line for line in found)


def test_a_file_and_all_that_says_what_it_was_changed_together(archived, bag):
    """Only the digest that was kept elsewhere tells; the records agree."""
    table = bag / RESULTS / "r1" / "tables" / "drift.csv"
    table.write_text(table.read_text().replace("x,", "x,1", 1))
    outputs = bag / RESULTS / "r1" / "outputs.json"
    data = json.loads(outputs.read_text())
    for entry in data["files"]:
        if entry["name"] == "tables/drift.csv":
            entry["sha256"], entry["bytes"] = sha256_of(table), table.stat().st_size
    outputs.write_text(json.dumps(data))
    describe(bag)
    digest = seal(bag)
    assert faults(bag) == []
    assert digest != archived.digest
    found = faults(bag, archived.digest)
    assert named(found, bag, "tagmanifest-sha256.txt")
    status, _, err = call("verify", bag, "--expect", archived.digest)
    assert status == 2
    assert archived.digest in err


def test_a_file_and_the_manifests_of_the_bag_changed_together(bag):
    table = bag / RESULTS / "r1" / "tables" / "drift.csv"
    table.write_text(table.read_text().replace("x,", "x,1", 1))
    seal(bag)
    assert named(faults(bag), bag, f"{RESULTS}/r1/tables/drift.csv")


def test_software_changed_and_every_checksum_made_anew(bag):
    (bag / "data/software/fogreduce/units.py").write_text("# another\n")
    describe(bag)
    seal(bag)
    assert any("code_sha256" in line for line in faults(bag))


def test_a_calibration_record_changed_and_every_checksum_made_anew(bag):
    record = bag / "data/calibrations/TETRA-01/2012a.yaml"
    record.write_text(record.read_text().replace("0.075", "0.076", 1))
    describe(bag)
    seal(bag)
    assert named(faults(bag), bag, "data/calibrations/TETRA-01/2012a.yaml")


@pytest.mark.parametrize("given", ["ab", "A" * 64, "", "g" * 64])
def test_an_expectation_that_is_no_hash_is_refused(archived, given):
    status, _, err = call("verify", archived.bag, "--expect", given)
    assert status == 2
    assert "--expect" in err


@pytest.mark.parametrize(
    "name", ["bagit.txt", "bag-info.txt", "manifest-sha256.txt", "tagmanifest-sha256.txt"]
)
def test_a_tag_file_removed(bag, name):
    (bag / name).unlink()
    assert named(faults(bag), bag, name)


def test_what_is_no_bag(tmp_path):
    for path in (tmp_path / "none", tmp_path):
        status, out, err = call("verify", path)
        assert status == 2
        assert len(err.splitlines()) == 1
        assert out == ""


def swap(one, other):
    """Exchange two files or folders."""
    aside = one.with_name("aside")
    shutil.move(one, aside)
    shutil.move(other, one)
    shutil.move(aside, other)
