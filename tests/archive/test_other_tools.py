"""Bags as other tools write them: valid ones verify, with one line of what is unusual; bagit.py agrees."""

import hashlib
import shutil

import bagit
import pytest
from archived_lab import CAMPAIGN, sha256_of
from small_unit import call, succeed

PAYLOAD, TAGS = "manifest-sha256.txt", "tagmanifest-sha256.txt"


def retagged(bag, name, change):
    """Change the bytes of a tag file, and make the tag manifest fit."""
    path = bag / name
    path.write_bytes(change(path.read_bytes()))
    if name != TAGS:
        lines = (bag / TAGS).read_text().splitlines()
        names = sorted(
            {line.split(None, 1)[1] for line in lines} | ({name} if not name.startswith("tag") else set())
        )
        (bag / TAGS).write_text("".join(f"{sha256_of(bag / item)}  {item}\n" for item in names))


def upper(raw):
    lines = raw.decode().splitlines()
    return "".join(f"{line[:64].upper()}{line[64:]}\n" for line in lines).encode()


UNUSUAL = {
    "digests in upper case": upper,
    "lines that end in CR": lambda raw: raw.replace(b"\n", b"\r\n"),
    "* before names": lambda raw: raw.replace(b"  ", b" *"),
    "./ before names": lambda raw: raw.replace(b"  ", b"  ./"),
    "a byte-order mark": lambda raw: b"\xef\xbb\xbf" + raw,
    "no end of the last line": lambda raw: raw.rstrip(b"\n"),
    "blank lines or comments": lambda raw: b"# SHA-256\n\n" + raw + b"\n",
}


def accepted(bag, said=""):
    """Both accept it; what is unusual is said in one line."""
    bagit.Bag(str(bag)).validate()
    status, out, err = call("verify", bag)
    assert status == 0, err
    assert len(err.splitlines()) == (1 if said else 0)
    assert said in err
    return out


def refused(bag, *said):
    """`fogreduce verify` refuses it, in few lines."""
    status, out, err = call("verify", bag)
    assert (status, out) == (2, "")
    assert all(words in err for words in said), err
    assert len(err.splitlines()) <= 4
    return err


@pytest.mark.parametrize("name", [PAYLOAD, TAGS])
@pytest.mark.parametrize("said", UNUSUAL)
def test_manifests_written_otherwise(bag, name, said):
    retagged(bag, name, UNUSUAL[said])
    accepted(bag, said)


@pytest.mark.parametrize("space", [b" ", b"\t", b"    "])
def test_other_white_space_between_digest_and_name(bag, space):
    """bagit.py itself writes one space in tag manifests."""
    retagged(bag, PAYLOAD, lambda raw: raw.replace(b"  ", space))
    retagged(bag, TAGS, lambda raw: raw.replace(b"  ", space))
    accepted(bag)


def test_lines_that_end_in_cr_alone(bag):
    retagged(bag, PAYLOAD, lambda raw: raw.replace(b"\n", b"\r"))
    accepted(bag, f"lines that end in CR ({PAYLOAD})")


def test_all_of_it_at_once_is_still_one_line(bag):
    retagged(bag, PAYLOAD, lambda raw: upper(raw).replace(b"\n", b"\r\n").replace(b"  ", b" *"))
    retagged(bag, "bag-info.txt", lambda raw: raw.replace(b"\n", b"\r\n"))
    accepted(bag, "* before names")


def test_a_digest_of_both_cases_is_a_changed_byte(bag):
    retagged(bag, PAYLOAD, lambda raw: raw[:64].upper() + raw[64:])
    refused(bag, f"{bag / PAYLOAD}: line", "upper and in lower case")


def test_a_manifest_of_something_else_is_one_line(bag):
    retagged(bag, PAYLOAD, lambda raw: raw.replace(b"  ", b"?"))
    status, _, err = call("verify", bag)
    assert status == 2
    assert sum(PAYLOAD in line and "something else (and" in line for line in err.splitlines()) == 1


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda raw: raw.replace(b"fogreduce archive", b"fogreduce\n\tarchive"), "folded lines"),
        (lambda raw: b"Contact-Name: A\nContact-Name: B\n" + raw, "labels that are repeated"),
        (lambda raw: raw + b"\n\n", "blank lines"),
        (lambda raw: raw + b"Source-Organization:no space\n", ""),
        (lambda raw: raw.replace(b"\n", b"\r\n"), "CR"),
        (lambda raw: raw + "Contact-Name: Jürgen 測\n".encode(), ""),
    ],
)
def test_bag_info_written_otherwise(bag, change, said):
    retagged(bag, "bag-info.txt", change)
    assert f"{bag}: " in accepted(bag, said)


def test_a_label_in_lower_case(bag):
    retagged(bag, "bag-info.txt", lambda raw: raw.replace(b"Payload-Oxum", b"payload-oxum"))
    accepted(bag)


@pytest.mark.parametrize("oxum", [b"1.1", b"x", b"", b"-5.3"])
def test_a_payload_oxum_that_is_wrong(bag, oxum):
    lines = (bag / "bag-info.txt").read_bytes().splitlines(keepends=True)
    lines = [b"Payload-Oxum: " + oxum + b"\n" if line.startswith(b"Payload") else line for line in lines]
    retagged(bag, "bag-info.txt", lambda raw: b"".join(lines))
    refused(bag, "bag-info.txt: Payload-Oxum", "bytes and files of data/")


def test_the_declaration_with_cr_lf(bag):
    retagged(bag, "bagit.txt", lambda raw: raw.replace(b"\n", b"\r\n"))
    accepted(bag)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (b"1.0", b"9.0", "BagIt-Version"),
        (b"UTF-8", b"KLINGON", "Tag-File-Character-Encoding"),
        (b"BagIt-Version", b"\xef\xbb\xbfBagIt-Version", "bagit.txt"),
    ],
)
def test_a_declaration_that_is_wrong(bag, old, new, said):
    retagged(bag, "bagit.txt", lambda raw: raw.replace(old, new))
    refused(bag, said)


def other_bag(folder, **options):
    """A bag that bagit.py makes of some files."""
    (folder / "sub dir").mkdir(parents=True)
    (folder / "a.csv").write_text("a,b\n1,2\n")
    (folder / "sub dir" / "ö 1.bin").write_bytes(bytes(range(256)))
    bagit.make_bag(str(folder), {"Contact-Name": "A. Nyone"}, **options)
    return folder


ALGORITHMS = [["md5"], ["sha1"], ["sha256"], ["sha512"], ["sha256", "sha512"], ["md5", "sha384", "sha224"]]


@pytest.mark.parametrize("checksums", ALGORITHMS)
def test_a_bag_that_bagit_made_of_something_else(tmp_path, checksums):
    bag = other_bag(tmp_path / "bag", checksums=checksums)
    status, out, err = call("verify", bag)
    assert status == 0, err
    assert "no archive.json" in out
    (bag / "data" / "a.csv").write_text("a,b\n1,3\n")
    refused(bag, "a.csv", checksums[0].upper()[:3])


def test_our_payload_in_a_bag_that_bagit_made(archived, tmp_path):
    """A repository that takes the content out of our bag and bags it anew."""
    bag = tmp_path / "bag"
    shutil.copytree(archived.bag / "data", bag)
    bagit.make_bag(str(bag), {"External-Identifier": CAMPAIGN}, checksums=["sha256", "sha512"])
    accepted(bag)
    succeed("restore", bag, "--out", tmp_path / "restored")
    path = bag / "data" / "archive.json"
    path.write_bytes(path.read_bytes().replace(b"c1", b"c2", 1))
    refused(bag, "data/archive.json", "SHA-256", "SHA-512")


def test_a_second_algorithm_that_disagrees(bag):
    lines = (bag / PAYLOAD).read_text().splitlines()
    names = [line[66:] for line in lines]
    text = "".join(f"{hashlib.sha512((bag / name).read_bytes()).hexdigest()}  {name}\n" for name in names)
    (bag / "manifest-sha512.txt").write_text(text)
    retagged(bag, "manifest-sha512.txt", lambda raw: raw)
    accepted(bag)
    digit = "0" if text[0] != "0" else "1"
    retagged(bag, "manifest-sha512.txt", lambda raw: (digit + text[1:]).encode())
    refused(bag, "SHA-512", names[0])
    retagged(bag, "manifest-sha512.txt", lambda raw: text.split("\n", 1)[1].encode())
    refused(bag, names[0], "manifest-sha512.txt")


def test_other_tag_files_and_a_folder_of_them(tmp_path):
    bag = other_bag(tmp_path / "bag")
    (bag / "aptrust-info.txt").write_text("Title: x\n")
    (bag / "tags").mkdir()
    (bag / "tags" / "x.xml").write_text("<x/>\n")
    bagit.Bag(str(bag)).validate()
    status, _, err = call("verify", bag)
    assert status == 0
    assert len(err.splitlines()) == 1
    assert "aptrust-info.txt" in err
    assert "tags/x.xml" in err


def test_a_bag_without_a_tag_manifest_or_bag_info(tmp_path):
    bag = other_bag(tmp_path / "bag", checksums=["sha256"])
    (bag / TAGS).unlink()
    (bag / "bag-info.txt").unlink()
    status, out, err = call("verify", bag)
    assert status == 0, err
    assert out.startswith("-  ")
    assert len(err.splitlines()) == 1
    assert call("verify", bag, "--expect", "0" * 64)[0] == 2


def test_fetch_txt(tmp_path):
    bag = other_bag(tmp_path / "bag", checksums=["sha256"])
    (bag / "fetch.txt").write_text("https://example.org/a.csv - data/a.csv\n")
    bagit.Bag(str(bag)).validate()
    assert call("verify", bag)[0] == 0
    (bag / "data" / "a.csv").unlink()
    (bag / "bag-info.txt").write_text("Contact-Name: A. Nyone\n")
    (bag / TAGS).unlink()
    refused(bag, "fetch.txt: found 1 files that are still to be fetched, the first data/a.csv")


def test_a_percent_sign_as_bagit_writes_it_and_as_the_standard_does(tmp_path):
    bag = tmp_path / "bag"
    bag.mkdir()
    (bag / "50%.csv").write_text("x\n")
    bagit.make_bag(str(bag), checksums=["sha256"])
    status, _, err = call("verify", bag)
    assert status == 0, err
    assert "not escaped" in err
    retagged(bag, PAYLOAD, lambda raw: raw.replace(b"%", b"%25"))
    assert call("verify", bag)[0] == 0


def test_what_is_no_archive_of_ours_is_not_restored(tmp_path):
    bag = other_bag(tmp_path / "bag")
    status, out, err = call("restore", bag, "--out", tmp_path / "out")
    assert (status, out) == (2, "")
    assert "archive.json" in err
    assert not (tmp_path / "out").exists()


def test_our_bag_without_its_record_is_no_other_tools_bag(bag):
    (bag / "data" / "archive.json").unlink()
    lines = [line for line in (bag / PAYLOAD).read_text().splitlines() if "archive.json" not in line]
    retagged(bag, PAYLOAD, lambda raw: "".join(f"{line}\n" for line in lines).encode())
    status, _, err = call("verify", bag)
    assert status == 2
    assert "archive.json" in err


@pytest.mark.parametrize("name", [".DS_Store", "Thumbs.db"])
def test_what_a_file_manager_leaves_in_the_payload(bag, name):
    (bag / "data" / name).write_bytes(b"x")
    with pytest.raises(bagit.BagValidationError):
        bagit.Bag(str(bag)).validate()
    err = call("verify", bag)[2]
    assert f"{bag / 'data' / name}: found a file that is not listed" in err
